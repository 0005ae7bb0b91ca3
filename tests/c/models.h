/* models.h - Lagrangians of inputs q[n], v[n] as a script would write them, for tests
 * that
 * measure derivatives and kernels. */
#ifndef MODELS_H
#define MODELS_H

#include "algebra/derive.h"

static inline dm_node square_of(dm_graph *g, dm_node a) {
    return dm_mul(g, a, a);
}

static inline dm_node sum_of_squares(dm_graph *g, const dm_node *x, uint32_t n) {
    dm_node sum = 0;
    for (uint32_t i = 0; i < n; i++) sum = dm_add(g, sum, square_of(g, x[i]));
    return sum;
}

static inline dm_node norm_of(dm_graph *g, const dm_node *x, uint32_t n) {
    return dm_apply(g, DM_OP_SQRT, sum_of_squares(g, x, n), 0, 0);
}

/* c / a and c a: one call that makes nodes per statement, so that all compilers agree */
static inline dm_node over(dm_graph *g, double c, dm_node a) {
    return dm_div(g, dm_constant(g, c), a);
}

static inline dm_node times_of(dm_graph *g, double c, dm_node a) {
    return dm_mul(g, dm_constant(g, c), a);
}

/* v.v/2 + 1/|q| */
static inline dm_node kepler(dm_graph *g, const dm_node *q, const dm_node *v) {
    const dm_node T = times_of(g, 0.5, sum_of_squares(g, v, 2));
    return dm_add(g, T, over(g, 1.0, norm_of(g, q, 2)));
}

/* V = -1/r + J2/(2 r^3) (3 z^2/r^2 - 1), J2 = 0.05 */
static inline dm_node satellite(dm_graph *g, const dm_node *q, const dm_node *v) {
    const dm_node T = times_of(g, 0.5, sum_of_squares(g, v, 3));
    const dm_node r = norm_of(g, q, 3);
    const dm_node r3 = dm_power(g, r, dm_constant(g, 3.0));
    const dm_node z2 = times_of(g, 3.0, square_of(g, q[2]));
    const dm_node r2 = square_of(g, r), one = dm_constant(g, 1.0);
    const dm_node bulge = dm_sub(g, dm_div(g, z2, r2), one);
    const dm_node twice = times_of(g, 2.0, r3);
    const dm_node V = dm_mul(g, over(g, 0.05, twice), bulge);
    return dm_sub(g, T, dm_sub(g, V, over(g, 1.0, r)));
}

/* velocity of a unit rod with polar angle a and azimuth b */
static inline void rod(dm_graph *g, dm_node out[3], const dm_node angle[2], const dm_node rate[2]) {
    const dm_node sa = dm_apply(g, DM_OP_SIN, angle[0], 0, 0);
    const dm_node ca = dm_apply(g, DM_OP_COS, angle[0], 0, 0);
    const dm_node sb = dm_apply(g, DM_OP_SIN, angle[1], 0, 0);
    const dm_node cb = dm_apply(g, DM_OP_COS, angle[1], 0, 0);
    const dm_node p = dm_mul(g, rate[0], ca), q = dm_mul(g, rate[1], sa);
    const dm_node pc = dm_mul(g, p, cb), qs = dm_mul(g, q, sb);
    const dm_node ps = dm_mul(g, p, sb), qc = dm_mul(g, q, cb);
    out[0] = dm_sub(g, pc, qs);
    out[1] = dm_add(g, ps, qc);
    out[2] = dm_mul(g, rate[0], sa);
}

/* double spherical pendulum in angles, unit masses and rods, g = 9.81 */
static inline dm_node pendulum(dm_graph *g, const dm_node *q, const dm_node *v) {
    dm_node first[3], second[3];
    rod(g, first, q, v);
    rod(g, second, q + 2, v + 2);
    dm_node T = sum_of_squares(g, first, 3);
    for (int i = 0; i < 3; i++) second[i] = dm_add(g, first[i], second[i]);
    T = times_of(g, 0.5, T);
    T = dm_add(g, T, times_of(g, 0.5, sum_of_squares(g, second, 3)));
    const dm_node c1 = dm_apply(g, DM_OP_COS, q[0], 0, 0);
    const dm_node c2 = dm_apply(g, DM_OP_COS, q[2], 0, 0);
    const dm_node height = dm_add(g, times_of(g, 2.0, c1), c2);
    return dm_add(g, T, times_of(g, 9.81, height));
}

/* three bodies in space, masses 1, 2, 3 */
static inline dm_node three_bodies(dm_graph *g, const dm_node *q, const dm_node *v) {
    dm_node L = 0;
    for (int i = 0; i < 3; i++)
        L = dm_add(g, L, times_of(g, (i + 1) / 2.0, sum_of_squares(g, v + 3 * i, 3)));
    for (int i = 0; i < 3; i++)
        for (int j = i + 1; j < 3; j++) {
            dm_node d[3];
            for (int k = 0; k < 3; k++) d[k] = dm_sub(g, q[3 * i + k], q[3 * j + k]);
            L = dm_add(g, L, over(g, (i + 1.0) * (j + 1.0), norm_of(g, d, 3)));
        }
    return L;
}

typedef struct {
    const char *name;
    uint32_t n;
    dm_node (*lagrangian)(dm_graph *g, const dm_node *q, const dm_node *v);
} model;

static const model models[] = {
    {"Kepler", 2, kepler},
    {"J2 satellite", 3, satellite},
    {"double spherical pendulum", 4, pendulum},
    {"three bodies", 9, three_bodies},
};
enum { MODELS = sizeof models / sizeof models[0] };

/* L and, behind it, its gradient and Hessian in all 2n inputs; gives their number */
static inline uint32_t model_roots(dm_graph *g, const model *m, dm_node *roots) {
    dm_node x[32];
    const uint32_t N = 2 * m->n;
    for (uint32_t i = 0; i < N; i++) x[i] = dm_input(g, i);
    roots[0] = m->lagrangian(g, x, x + m->n);
    dm_hessian(g, roots[0], 0, N, roots + 1, roots + 1 + N);
    return 1 + N + N * N;
}

#endif
