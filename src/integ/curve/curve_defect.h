/* curve_defect.h - the equations R(q, v, t, w) = 0 of curve_field.h as nodes of a graph, all of
 * them in one: psi = U . R + l L. The graph has the inputs (q[n], v[n], t, w[N], U[N], l,
 * u[controls]), then what its maker wants. */
#ifndef DM_CURVE_DEFECT_H
#define DM_CURVE_DEFECT_H

#include "mech/constraints.h"

typedef struct {
    dm_graph *g;
    const dm_model *m;
    const dm_constraints *c;   /* NULL: none */
    uint32_t n, N, k, rolling; /* dim Q; and the constraints; holonomic, rolling ones */
    uint32_t t, w, U, l, more; /* inputs, by what stands there */
    dm_node L, psi;
    dm_node *gradient; /* [2n+1] of L in (q, v, t) */
    dm_node *push;     /* [n] work f + E^T mu; NULL: none but that of L */
} dm_defect;

/* In the model's arena, with `more` inputs of the caller. */
dm_status dm_defect_build(dm_defect *out, const dm_model *m, uint32_t more);

/* R[N] at w = 0, and S[N*N] = -R_w. */
dm_status dm_defect_rows(const dm_defect *b, dm_node *R, dm_node *S);

/* L_q - L_vq v - L_vt + f, without constraints; mixed[n*n + n] is scratch. */
void dm_defect_push(const dm_defect *b, dm_node *out, dm_node *mixed);

/* w[N] as nodes, by elimination; without a pivot where S has no entry at all. */
dm_status dm_defect_solve(const dm_defect *b, dm_node *w);

/* Nodes in the arena of the model; NULL without memory. */
dm_node *dm_defect_take(const dm_defect *b, size_t count);

/* sum + x y */
dm_node dm_defect_add(dm_graph *g, dm_node sum, dm_node x, dm_node y);

/* x = M^-1 x with the numbers of a constant mass; y[n] is scratch */
void dm_defect_divide(const dm_defect *b, dm_node *x, dm_node *y);

#endif
