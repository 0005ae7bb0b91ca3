/* hamilton_extremum.c - forces and M of L(q, v) = ext_y f(q, v, y) with one y, f quadratic in w
 * = (v, y), as is a Routhian: by the envelope property L_q = f_q at y, which is a polynomial in
 * y, f_q = c0 + y (c1 + y c2),  y = -f_y(q, v, 0) / I,  I = f_yy, so that all but two products
 * of an entry are made while the division is under way. M and b are left as those of w, and I
 * times M of L, M_vv I - M_vy M_yv, is what is eliminated: no division comes before that. */
#include "integ/method/hamilton_inside.h"

#include "graph/analyse.h"
#include "algebra/compact.h"
#include "algebra/derive.h"
#include "algebra/implicit.h"

#include <string.h>

const dm_extremum *dm_split_extremum(const dm_model *m) {
    const dm_source *s = &m->source;
    const dm_extremum *e = s->graph ? dm_extremum_find(s->graph, s->lagrangian) : NULL;
    if (!e || m->structure & (DM_SEPARABLE | DM_CONSTANT_MASS)) return NULL;
    return e->n == 2 * m->n && e->m == 1 ? e : NULL;
}

/* c0[n], c1[n], c2[n], f_y at y = 0, and what is known of M and b of w */
static uint32_t count_of(uint32_t n) {
    return 3 * n + 1 + dm_known(n + 1);
}

/* c1 and c2, of y = 0, from f_q; first[n] is scratch */
static void differentiate(dm_node *c1, dm_graph *of, const dm_node *fq, uint32_t n,
                          dm_node *first) {
    const dm_node *with = first + n, half = dm_constant(of, 0.5);
    dm_node *c2 = c1 + n;
    dm_jacobian(of, fq, n, 2 * n, 1, first);
    dm_jacobian(of, first, n, 2 * n, 1, c2);
    dm_substitute(of, first, n, with, c1);
    for (uint32_t i = 0; i < n; i++) c2[i] = dm_mul(of, half, c2[i]);
}

/* all of them as nodes of the graph of f; 0 where f is not quadratic in w */
static int expand(dm_node *roots, const dm_extremum *e, uint32_t n, dm_node *scratch) {
    const uint32_t wide = n + 1, inputs = dm_graph_inputs(e->of);
    dm_node *slope = scratch, *M = slope + n + wide, *first = M + wide * (size_t)wide;
    dm_node *with = first + n, *known = roots + 3 * n + 1;
    for (uint32_t i = 0; i < inputs; i++) with[i] = i == 2 * n ? 0 : dm_input(e->of, i);
    dm_gradient(e->of, e->f, 0, n + wide, slope);
    dm_split_momentum(M, known + dm_known(wide) - wide, e->of, slope + n, n, wide);
    if (dm_graph_status(e->of) != DM_OK || dm_depends(e->of, M, wide * wide, n, wide) ||
        dm_has_roots(e->of, slope, n + wide))
        return 0;
    dm_pack(known, M, wide);
    dm_substitute(e->of, slope, n, with, roots);
    differentiate(roots + n, e->of, slope, n, first);
    dm_substitute(e->of, slope + 2 * n, 1, with, roots + 3 * n);
    return dm_graph_status(e->of) == DM_OK;
}

/* the same as nodes of the model's graph, compacted */
static dm_graph *write_out(dm_node *roots, const dm_model *m, const dm_extremum *e) {
    const uint32_t n = m->n, count = count_of(n), inputs = dm_graph_inputs(e->of);
    dm_graph *g = m->source.graph;
    dm_node *with = dm_arena_take(m->source.arena, (inputs + count) * sizeof *with);
    if (!with) return NULL;
    for (uint32_t i = 0; i < inputs; i++)
        with[i] = i == 2 * n ? 0 : dm_input(g, i < 2 * n ? i : i - 1);
    dm_transplant(g, e->of, roots, count, with, with + inputs);
    if (dm_graph_status(g) != DM_OK) return NULL;
    return dm_compact_graph(g, with + inputs, count, roots);
}

enum { PRODUCT = 4 }; /* clock cycles */

/* y = -f_y / I, or f_y times -1/I where the division can then begin earlier than the product
 * would take */
static dm_node solve(dm_graph *g, dm_node fy, dm_node I) {
    const dm_node both[2] = {fy, I}, minus_one = dm_constant(g, -1.0);
    uint32_t at[2];
    dm_depths(at, g, both, 2);
    if (at[0] > at[1] + PRODUCT) return dm_mul(g, fy, dm_div(g, minus_one, I));
    const dm_node minus = dm_neg(g, fy);
    dm_graph_verbatim(g, 1); /* dm_div would take the constants of I out */
    const dm_node y = minus ? dm_div(g, minus, I) : 0;
    dm_graph_verbatim(g, 0);
    return y;
}

/* f_q[n] behind that, at its y, for it must not be multiplied out */
static void evaluate(dm_node *fq, dm_graph *g, const dm_node *roots, uint32_t n) {
    const dm_node *c0 = roots, *c1 = c0 + n, *c2 = c1 + n, *fy = c2 + n;
    const dm_node I = fy[dm_known(n + 1) - (n + 1)]; /* the last of the triangle */
    const dm_node y = solve(g, *fy, I);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node inner = dm_add(g, c1[i], dm_mul(g, y, c2[i]));
        fq[i] = dm_add(g, c0[i], dm_mul(g, y, inner));
    }
}

uint32_t dm_split_extremum_force(dm_kernel *out, dm_splitting *x, const dm_extremum *e) {
    const uint32_t n = x->m->n, wide = n + 1, known = dm_known(wide);
    const size_t scratch = 2 * n + wide + wide * (size_t)wide + dm_graph_inputs(e->of);
    dm_node *roots = dm_arena_take(x->m->source.arena, (count_of(n) + n + scratch) * sizeof *roots);
    if (!roots || !expand(roots, e, n, roots + count_of(n))) return 0;
    dm_graph *g = write_out(roots, x->m, e);
    if (!g) return 0;
    dm_node *fq = roots + count_of(n), *made = roots + 2 * n + 1;
    evaluate(fq, g, roots, n);
    memcpy(made, fq, n * sizeof *made);
    x->wide = wide;
    x->graph = g;
    x->known = made + n;
    return dm_lanes_build_compacted(out, x->m, g, made, n + known, x->stages);
}

dm_node dm_split_eliminate(dm_graph *g, dm_node *M, dm_node *b, uint32_t n) {
    const uint32_t w = n + 1;
    const dm_node *a = M + n * (size_t)w, I = a[n], rate = dm_div(g, b[n], I);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node push = dm_mul(g, a[i], rate);
        b[i] = dm_sub(g, b[i], push);
        for (uint32_t j = 0; j <= i; j++) {
            dm_node *at = M + i * w + j;
            *at = dm_cross(g, I, *at, a[i], a[j]);
        }
    }
    return I;
}
