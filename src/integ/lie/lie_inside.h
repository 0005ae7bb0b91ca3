/* lie_inside.h - what a step in the natural chart works on, laid into the workspace of its
 * stepper. */
#ifndef DM_LIE_INSIDE_H
#define DM_LIE_INSIDE_H

#include "integ/lie/lie.h"
#include "linalg/solve/newton.h"

enum { DM_LIE_KEPT = 5, DM_LIE_TEXT = 128 };

/* Of one member, or of W of them side by side, every number [W] then but for coefficients and t.
 * Sizes: n flat coordinates, d dimension of the group, s velocities, r points, m = s d unknowns. */
typedef struct {
    const dm_model *model;
    const dm_group *group;
    uint32_t n, d, s, r, m;
    int is_free;                  /* by dm_group.free */
    double t, *h;                 /* of this step; h [1] */
    double *a, *D, *b, *c, *beta; /* [r*s], [r*s], [r], [r], [s]: coefficients */
    double *state;                /* of the run: q[n], p[n] ... */
    const dm_group_map *at;       /* point of the group; s = 1: line */
    const dm_kernel *last;        /* its change, where that is known, else its finish */
    double *x;                    /* [n + 2d + 2] inputs of a point */
    double *slope;                /* [3d] at a point */
    double *curve;                /* [3d (2d + 1)] at a point, then */
    double *V;                    /* [m] the unknowns */
    double *xi;                   /* [d] at the end of the step */
    double *gain;                 /* [d] P */
    double *mu;                   /* [d] p0 + P */
    double *mu_V;                 /* [d * m] its derivative */
    double *row;                  /* [m] a row of the matrix of b */
    uint32_t *seeing;             /* [d] entries of mu that see V in some lane, */
    double *sees;                 /* [d] and in which: not 0 */
    double *in;                   /* [n + 2d + 3] inputs of pull, finish and free */
    double *pull;                 /* [d (2d + 1)] */
    double *pulled;               /* [d] */
    double *end;                  /* [n + d + arcs] */
    double *work;                 /* of Newton's method, or of the Legendre transform */
    double *room;                 /* for maps */
    double *sizes;                /* [m] of the terms of each equation */
    double size;                  /* of the terms of the equation where it was last evaluated */
    /* what steps leave to the next: how many there are, their h, V of the last ones, newest first:
     * [2 + DM_LIE_KEPT m] */
    double *memory;
    struct dm_lie_lanes *lanes; /* members side by side, where they are */
    double turn;                /* rad, of a step that left the chart, else 0 */
    char text[DM_LIE_TEXT];     /* why a step failed */
} dm_lie;

/* For dm_newton: the step equation at V, and its matrix. */
dm_status dm_lie_equation(void *lie, double *R, double *J, const double *V);

/* Pointers of *e, whose sizes are known, for so many lanes from `memory` on, `work` last; how many
 * doubles they take, also where memory is NULL. */
size_t dm_lie_lay_out(dm_lie *e, uint32_t lanes, double *memory);

/* Which kernels of its group it steps by; their constant outputs into its arrays. */
void dm_lie_choose(dm_lie *e, const dm_group *group, uint32_t lanes);

static inline dm_lie *dm_lie_of(const dm_stepper *s) {
    return (dm_lie *)(void *)s->work;
}

#endif
