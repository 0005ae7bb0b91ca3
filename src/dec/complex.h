/* complex.h - a simplicial complex of any dimension up to DM_DIMENSION (Leok 3.3, Def 3.1-3.4).
 *
 * A cell of degree k is an ascending tuple of k + 1 vertices, and cells of one degree stand in
 * lexicographic order: that order is the numbering of everything that lives on them. Ascending
 * is the positive orientation, so face j of a cell (the one opposite to its vertex j) is
 * ascending too and stands in its boundary with the sign (-1)^j; no signs are stored. Only cells
 * of the highest degree carry a sign of their own, that of the coherent orientation.
 *
 * The complex and its arrays lie in the caller's arena and never change after dm_complex_build:
 * forms, chains, operators and other threads may read them side by side. */
#ifndef DM_COMPLEX_H
#define DM_COMPLEX_H

#include "base/arena.h"
#include "base/status.h"

#include <stdint.h>

enum { DM_DIMENSION = 8, DM_SMALL = 3 };

typedef struct {
    uint32_t n;                       /* dimension: the highest degree */
    uint32_t count[DM_DIMENSION + 1]; /* cells of degree k; 0 above n */
    /* [count[k]][k + 1], from 0, of degrees up to DM_SMALL and n; between them NULL: a third of all
     * memory would be theirs there, and dm_complex_vertices finds them by faces */
    uint32_t *vertex[DM_DIMENSION + 1];
    /* [count[k]][k + 1]: cell of degree k - 1 opposite to vertex j; degree 0: NULL */
    uint32_t *face[DM_DIMENSION + 1];
    /* cofaces of cell i of degree k: coface[k][coface_at[k][i] .. coface_at[k][i + 1] - 1],
     * ascending; degree n: NULL */
    uint32_t *coface_at[DM_DIMENSION + 1];
    uint32_t *coface[DM_DIMENSION + 1];
    /* [count[n]]: sign of a top cell in the coherent orientation; NULL: there is none. Each
     * component begins with +1 at its first cell */
    int8_t *orientation;
    int pure; /* every cell lies in a top cell */
} dm_complex;

/* What dm_complex_build refuses, and at which of the given simplices (from 0). */
typedef enum {
    DM_COMPLEX_FINE,
    DM_COMPLEX_REPEATED,  /* a vertex twice in one simplex */
    DM_COMPLEX_DUPLICATE, /* the same simplex twice */
    DM_COMPLEX_UNKNOWN    /* a vertex that is not below `vertices` */
} dm_complex_fault;

typedef struct {
    dm_complex_fault fault;
    uint32_t simplex, other; /* the second one of a duplicate is `simplex` */
} dm_complex_report;

/* Simplices as they are given: of any degrees, in any order, vertices in any order. */
typedef struct {
    uint32_t vertices; /* how many there are; a vertex in no simplex is a cell of degree 0 */
    uint32_t simplices;
    const uint32_t *start;  /* [simplices + 1]: simplex i is vertex[start[i] .. start[i + 1] - 1] */
    const uint32_t *vertex; /* from 0 */
} dm_simplices;

/* The smallest complex that has all these simplices. DM_SINGULAR: refused, see *report;
 * DM_NO_MEMORY, DM_STOPPED (*stop was set). Time and memory grow linearly with its cells. */
dm_status dm_complex_build(dm_complex *K, dm_arena *arena, const dm_simplices *given,
                           volatile const int *stop, dm_complex_report *report);

/* The k + 1 vertices of a cell: where they are stored, or in room[DM_DIMENSION + 1]. */
const uint32_t *dm_complex_vertices(const dm_complex *K, uint32_t k, uint32_t cell, uint32_t *room);

/* The number of an ascending tuple of k + 1 vertices, or UINT32_MAX when it is no cell. */
uint32_t dm_complex_find(const dm_complex *K, uint32_t k, const uint32_t *tuple);

/* The face of cell `cell` of degree k whose vertices are the bits of `set`, bit j for vertex j;
 * its degree is one less than the number of bits. */
uint32_t dm_complex_face(const dm_complex *K, uint32_t k, uint32_t cell, uint32_t set);

/* Sum of (-1)^k count[k]. */
long dm_complex_euler(const dm_complex *K);

/* Marks component[count[0]] of every vertex, from 0 in the order of first vertices; returns how
 * many there are. work: count[0] entries. */
uint32_t dm_complex_components(const dm_complex *K, uint32_t *component, uint32_t *work);

#endif
