/* space.h - manifolds and groups that a system can live on or be symmetric under. A row of the
 * table is all that the core knows of one: its dimension, what it is as a place to live on, and
 * the infinitesimal generators of its standard action, of which momentum maps are made. Its
 * functions (exp, log, products, derivatives) are its kit, a file of lua/dm/group. */
#ifndef DM_SPACE_H
#define DM_SPACE_H

#include <stdint.h>

/* One family of spaces, by a number n; nothing else decides by the name of a family. */
typedef struct {
    const char *kit;  /* "rn": the file of lua/dm/group with its functions, and this row's own */
    const char *name; /* "R" */
    const char *signature; /* "R(n)", as help prints it */
    const char *doc;       /* what it is, coordinates, standard action */
    uint32_t least, most;  /* smallest and largest n */
    uint32_t multiple;     /* n is a multiple of it */
    uint32_t usual;        /* n when it is left out; 0: it must be given */
    int chart;             /* 1: coordinates are free numbers, a system can live on it */
    int vectors;           /* 1: a vector space, which others act on linearly */
    int sphere;            /* 1: unit vectors of R^(n+1), a system lives on it by a constraint */
    uint32_t (*dimension)(uint32_t n);
    /* Standard action on vectors of `block` entries: out[block] = xi_a(x), the infinitesimal
     * generator of basis element a < dimension(n) at x[block]. Blocks are moved alike. */
    int (*acts)(uint32_t n, uint32_t block); /* 1 when the action on such blocks is defined */
    void (*generator)(double *out, const double *x, uint32_t n, uint32_t block, uint32_t a);
} dm_space;

/* n of matrix groups: a block of coordinates holds a vector that they act on */
enum { DM_LARGEST_SPACE = 100000, DM_LARGEST_GROUP = 64 };

#define X(name) extern const dm_space dm_space_##name;
#include "geom/spaces.def"
#undef X
extern const dm_space *const dm_spaces[]; /* NULL-terminated */

#endif
