/* strip.h - a strip of cells between two levels, and the equation of its upper level.
 *
 * Of an action S = sum of L_c over the cells (Leok 5.1.2-5.1.3): p_i + dS/d(lower node i) = 0 for
 * the nodes of the upper level, and then p_i of it is dS/d(upper node i). Of boxes on a ring: every
 * cell has equations of its own, as many as a node has values. Either way the matrix of the upper
 * level is a band of blocks; a ring is folded, nodes 1, N, 2, N - 1, ..., so that it stays one. */
#ifndef DM_STRIP_H
#define DM_STRIP_H

#include "field/line/cell_map.h"
#include "linalg/band.h"

#include <signal.h>

/* Scalars of a cell: the time of the lower level, the height of the slab, then others. */
enum { DM_STRIP_TIME, DM_STRIP_HEIGHT, DM_STRIP_SCALARS };

/* Vectors of all nodes are node after node: value k of node i at i * values + k. */
typedef struct {
    uint32_t cells, nodes; /* as many nodes as cells on a ring, one more on an open line */
    int boxes;             /* equations of cells, not of nodes */
    dm_cell_layout layout;
    dm_cell_map equation; /* -> R[rows], rows = values of boxes, else 2 values: S_lower */
    dm_cell_map tangent;  /* -> R[rows], dR/dupper[rows][2 values] */
    dm_cell_map after;    /* -> S_upper[2 values] */
    dm_cell_map energy;   /* -> -S_h, S_t */
    /* of free heights, G = S_t - S_h: -> G, G_upper[2 values], G_h, dS_lower/dh[2 values] */
    dm_cell_map clock;
    /* second derivatives: -> d(slopes)/d(lower, upper), slopes = R of boxes, else S_lower and
     * S_upper, 4 values each in a row */
    dm_cell_map hessian;
    dm_cell_map slopes;  /* -> S_lower[2 values], S_upper[2 values] */
    int autonomous;      /* S_t = 0 */
    uint32_t moving;     /* which value is the displacement of a node, from 1; 0: none */
    double width;        /* of a cell whose nodes have not moved */
    const uint8_t *held; /* [nodes * values] 1: value and equation of that number are left out */
    double absorbs[2];   /* c of the force -c u_t at the first node and at the last; 0: none */
} dm_strip;

/* what a level is solved in, made by dm_strip_open */
typedef struct {
    const dm_strip *strip;
    dm_band band;
    double *memory;      /* both levels, columns (cell_map.h) */
    double *scalars;     /* a copy for every lane */
    double *p;           /* [unknowns] of the lower level */
    double *r, *dx;      /* [unknowns] in the order of the band, */
    double *z, *slope;   /* and derivatives of R and G by and for the height */
    double *A, *scratch; /* the band; [unknowns] */
    double *buffer;      /* of cell maps */
    int checked;         /* the matrix of this run's first level was looked at */
    double terms;        /* the largest of R, where the matrix was made last */
    double *corners;     /* [2][4][cells] of laws */
    double *old;         /* the two levels before, the last one first */
    uint32_t *pivot, *order;
} dm_strip_room;

typedef struct {
    int iterations;
    double residual; /* largest of the last iteration */
} dm_strip_report;

static inline uint32_t dm_strip_unknowns(const dm_strip *s) {
    return s->nodes * s->layout.values;
}
static inline uint32_t dm_strip_rows(const dm_strip *s) {
    return s->boxes ? s->layout.values : 2 * s->layout.values;
}
/* the node of an end, 0 the left, 1 the right */
static inline uint32_t dm_strip_end(const dm_strip *s, int right) {
    return right ? s->nodes - 1 : 0;
}
static inline int dm_strip_is_ring(const dm_strip *s) {
    return s->nodes == s->cells;
}
/* where node i stands in the band; node `nodes` of a ring is the first again */
static inline uint32_t dm_strip_place(const dm_strip *s, uint32_t i) {
    if (!dm_strip_is_ring(s)) return i;
    if (i == s->nodes) i = 0;
    return 2 * i < s->nodes ? 2 * i : 2 * (s->nodes - 1 - i) + 1;
}
/* the node right of cell c */
static inline uint32_t dm_strip_right(const dm_strip *s, uint32_t c) {
    return c + 1 == s->nodes ? 0 : c + 1;
}

/* Doubles of an array of the layout: nodes, the first once more on a ring, whole groups, padded. */
uint32_t dm_strip_stride(uint32_t cells);

/* Room in `arena`; 0 without memory. The columns of `memory` are to be filled in by the caller. */
int dm_strip_open(dm_strip_room *room, const dm_strip *strip, dm_arena *arena);

/* More room, where it is not there: for unknown heights, and for dm_strip_residual. */
int dm_strip_open_heights(dm_strip_room *room, dm_arena *arena);
int dm_strip_open_laws(dm_strip_room *room, dm_arena *arena);

/* A vector of all nodes from and to a level (dm_cell_lower or dm_cell_upper of value 0). */
void dm_strip_put(dm_strip_room *room, size_t level, const double *x);
void dm_strip_get(const dm_strip_room *room, size_t level, double *x);

/* The same of the levels before, 0 the last one. */
void dm_strip_put_old(dm_strip_room *room, int number, const double *x);
void dm_strip_get_old(const dm_strip_room *room, int number, double *x);

/* scalar k of all lanes */
void dm_strip_set(dm_strip_room *room, uint32_t k, double x);

/* The upper level, from a guess that stands there; *height: NULL, or the height is unknown, too,
 * and S_t - S_h = target. */
dm_status dm_strip_solve(dm_strip_room *room, double *height, double target,
                         dm_strip_report *report);

/* out[unknowns] += the outputs of a map of 2 values, for left and right node; sum of output k of
 * all cells. */
void dm_strip_collect(dm_strip_room *room, const dm_cell_map *f, uint32_t first, double *out);
void dm_strip_sum(dm_strip_room *room, const dm_cell_map *f, uint32_t count, double *out);

/* Sum of |output 0| of all cells. */
double dm_strip_size(dm_strip_room *room, const dm_cell_map *f);

/* upper - lower of value k at node i */
static inline double dm_strip_moved(const dm_strip_room *room, uint32_t i, uint32_t k) {
    const dm_cell_layout *l = &room->strip->layout;
    return room->memory[dm_cell_upper(l, k) + i] - room->memory[dm_cell_lower(l, k) + i];
}

/* The momenta of the upper level, forces of absorbing ends among them. */
void dm_strip_momenta(dm_strip_room *room, double *p);

#endif
