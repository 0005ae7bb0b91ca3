/* hamilton_inside.h - what the kernels of dm_hamilton_split pass on to each other, for its files
 * only. */
#ifndef DM_HAMILTON_INSIDE_H
#define DM_HAMILTON_INSIDE_H

#include "algebra/extremum.h"
#include "integ/method/elimination.h"
#include "integ/method/hamilton.h"

/* what is known of M and b: an entry each of the lower triangle of M[wide*wide] by rows, then of
 * b[wide] */
typedef struct {
    const dm_model *m;
    uint32_t stages;
    uint32_t wide; /* n, or n + 1 where y of an extremum is left to the elimination */
    dm_graph *graph;
    dm_node *known;
} dm_splitting;

static inline uint32_t dm_known(uint32_t wide) {
    return wide * (wide + 1) / 2 + wide;
}

/* the lower triangle by rows, and its place in the square */
static inline void dm_unpack(dm_node *square, const dm_node *triangle, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) square[i * n + j] = *triangle++;
}

static inline void dm_pack(dm_node *triangle, const dm_node *square, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) *triangle++ = square[i * n + j];
}

/* M[wide*wide] = momentum_v and b[wide], the momentum at v = 0, in the graph `from` with v from
 * its input n on. */
void dm_split_momentum(dm_node *M, dm_node *b, dm_graph *from, const dm_node *momentum, uint32_t n,
                       uint32_t wide);

/* The extremum that L is, where that has one unknown; NULL: none, or derivatives of L are as
 * short. */
const dm_extremum *dm_split_extremum(const dm_model *m);

/* The kernel of forces of an extremum that is quadratic in (v, y); 0 lanes: it is not, or there
 * is no kernel. */
uint32_t dm_split_extremum_force(dm_kernel *out, dm_splitting *x, const dm_extremum *e);

/* M[n+1][n+1] and b of (v, y) become, in their first n rows, I M and b of the extremum; returns
 * I. */
dm_node dm_split_eliminate(dm_graph *g, dm_node *M, dm_node *b, uint32_t n);

#endif
