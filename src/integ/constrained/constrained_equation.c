/* constrained_equation.c - residual and exact matrix of the step equation; unknowns V[s][n],
 * impulses[K][m], m = k + l. */
#include "integ/constrained/constrained_inside.h"
#include "numbers/small_copy.h"

#include <math.h>
#include <string.h>

uint32_t dm_constrained_unknowns(const dm_constrained *g) {
    return g->table.s * g->n + g->K * (g->k + g->l);
}

/* sum_i b_i [h (a_ij - beta_j) (L_q + f)(i) + d_ij L_v(i)] */
static void add_slopes(dm_constrained *g, double *Rj, uint32_t j) {
    const uint32_t n = g->n, s = g->table.s;
    double size = g->size;
    for (uint32_t i = 0; i < g->table.r; i++) {
        const double *slope = g->slope + i * 2 * (size_t)n;
        const dm_weight wq = g->wq[i * s + j], wv = g->wv[i * s + j];
        for (uint32_t k = 0; k < n; k++) {
            const double term = dm_weighted(wq, slope[k]) + dm_weighted(wv, slope[n + k]);
            Rj[k] += term;
            size = dm_constrained_larger(size, fabs(term));
        }
    }
    g->size = size;
}

/* The first s n rows: the slopes, the impulses by their levers, less what p0 gives; the low-order
 * part of p0 comes last, where the sum is small. */
static void momentum_rows(dm_constrained *g, double *R) {
    const uint32_t n = g->n, s = g->table.s, m = g->k + g->l;
    const double *p0 = g->state + n, *low = g->state + 3 * n;
    for (uint32_t j = 0; j < s; j++) {
        double *Rj = R + j * (size_t)n;
        const dm_weight beta = g->table.beta[j];
        dm_small_zero(Rj, n);
        add_slopes(g, Rj, j);
        for (uint32_t k = 0; k < g->K && m; k++)
            dm_weighted_add(Rj, g->lever[k * s + j], g->impulse + k * (size_t)n, n);
        for (uint32_t k = 0; k < n; k++)
            Rj[k] = (Rj[k] - dm_weighted(beta, p0[k])) - beta.top * low[k];
    }
}

/* rounding q moves g by about G q, which is no error of the step */
double dm_constrained_position_size(const dm_constrained *g) {
    double most = 0.0;
    for (uint32_t i = 0; i < g->n; i++) most = dm_constrained_larger(most, fabs(g->state[i]));
    return g->k ? g->mass_size * most / fabs(g->h) : 0.0;
}

/* g(Q~_k+1) / h and phi at the Gauss point k, in units of momentum */
static void constraint_rows(const dm_constrained *g, double *R) {
    const uint32_t n = g->n, m = g->k + g->l;
    for (uint32_t k = 0; k < g->K; k++, R += m) {
        const double *hol = dm_constrained_holonomic(g, k + 1);
        const double *phi = g->roll + k * (size_t)g->l * (1 + 3 * (size_t)n);
        for (uint32_t c = 0; c < g->k; c++) R[c] = hol[c] * (g->row_unit[c] / g->h);
        for (uint32_t c = g->k; c < m; c++) R[c] = phi[c - g->k] * g->row_unit[c];
    }
}

typedef struct {
    double q, v;  /* of the slopes: h b_i (a_ij - beta_j), b_i d_ij */
    double ha, d; /* dQ/dV, dQdot/dV */
} chain;

/* the derivative of the equation j in the velocity k, by way of the point i */
static void slope_block(const dm_constrained *g, double *J, uint32_t j, uint32_t k, uint32_t i) {
    const uint32_t n = g->n, s = g->table.s, row = j * n, column = k * n;
    const size_t nn = (size_t)n * n;
    const double *qq = g->curve + i * (2 * n + 3 * nn) + 2 * n, *qv = qq + nn;
    const double *f_q = g->drag + i * (n + 2 * nn) + n;
    const chain w = {.q = dm_weight_double(g->wq[i * s + j]),
                     .v = dm_weight_double(g->wv[i * s + j]),
                     .ha = dm_weight_double(g->ha[i * s + k]),
                     .d = dm_weight_double(g->table.d[i * s + k])};
    dm_constrained_add(J, &g->step, row, column, w.q * w.ha, qq, &g->qq);
    dm_constrained_add(J, &g->step, row, column, w.q * w.d, qv, &g->qv);
    dm_constrained_add_transposed(J, &g->step, row, column, w.v * w.ha, qv, &g->qv);
    dm_constrained_add(J, &g->step, row, column, w.v * w.d, qv + nn, &g->vv);
    if (!g->constraints->forced) return;
    dm_constrained_add(J, &g->step, row, column, w.q * w.ha, f_q, &g->f_q);
    dm_constrained_add(J, &g->step, row, column, w.q * w.d, f_q + nn, &g->f_v);
}

/* All pairs of a row j and a velocity k meet in every point i of the quadrature. */
static void slope_columns(const dm_constrained *g, double *J) {
    for (uint32_t i = 0; i < g->table.r; i++)
        for (uint32_t j = 0; j < g->table.s; j++)
            for (uint32_t k = 0; k < g->table.s; k++) slope_block(g, J, j, k, i);
}

/* impulses of the inner constraint points move with the curve */
static void reaction_columns(const dm_constrained *g, double *J) {
    const uint32_t n = g->n, s = g->table.s;
    for (uint32_t i = 1; i < g->K; i++)
        for (uint32_t j = 0; j < s; j++)
            for (uint32_t k = 0; k < s; k++) {
                const double w = dm_weight_double(g->lever[i * s + j]);
                const double ha = dm_weight_double(g->constraint_ha[i * s + k]);
                const double d = dm_weight_double(g->constraint.d[i * s + k]);
                const double *r_q = dm_constrained_curved(g, i) + n, *r_v = r_q + (size_t)n * n;
                dm_constrained_add(J, &g->step, j * n, k * n, w * ha, r_q, &g->r_q);
                if (!dm_constrained_turns(g))
                    dm_constrained_add(J, &g->step, j * n, k * n, w * d, r_v, &g->r_v);
            }
}

/* where the rows of a block of constraints stand in J, and in what units */
typedef struct {
    uint32_t row, column;
    const double *unit;
} place;

/* dR/d impulse: columns of G^T and E^T */
static void add_across(const dm_constrained *g, double *J, place at, double w, const double *B,
                       const dm_constrained_entries *e) {
    const size_t *r = g->step.row + at.row, *c = g->step.column + at.column;
    for (uint32_t i = 0; i < e->count; i++)
        J[r[e->column[i]] + c[e->row[i]]] += w * at.unit[e->row[i]] * B[e->entry[i]];
}

/* Rows of the equations: their unknowns stand in the columns. */
static void add_along(const dm_constrained *g, double *J, place at, double w, const double *B,
                      const dm_constrained_entries *e) {
    const size_t *r = g->step.row + at.row, *c = g->step.column + at.column;
    for (uint32_t i = 0; i < e->count; i++)
        J[r[e->row[i]] + c[e->column[i]]] += w * at.unit[e->row[i]] * B[e->entry[i]];
}

/* How the momentum rows answer to the impulse of the constraint point k. */
static void impulse_columns(const dm_constrained *g, double *J, uint32_t k) {
    const uint32_t n = g->n, s = g->table.s, first = s * n + k * (g->k + g->l);
    for (uint32_t j = 0; j < s; j++) {
        const double w = dm_weight_double(g->lever[k * s + j]);
        const place G = {j * n, first, g->impulse_unit};
        const place E = {j * n, first + g->k, g->impulse_unit + g->k};
        add_across(g, J, G, w, dm_constrained_holonomic(g, k) + g->k, &g->G);
        add_across(g, J, E, w, dm_constrained_rolling(g, k) + g->l, &g->E);
    }
}

/* g at the constraint point k + 1, phi at the Gauss point k */
static void multiplier_columns(const dm_constrained *g, double *J, uint32_t k) {
    const uint32_t n = g->n, s = g->table.s, l = g->l;
    const uint32_t first = s * n + k * (g->k + l);
    const double *phi_v = g->roll + k * (size_t)l * (1 + 3 * n) + l + l * n;
    for (uint32_t j = 0; j < s; j++) {
        const place G = {first, j * n, g->row_unit};
        const place phi = {first + g->k, j * n, g->row_unit + g->k};
        const double a = dm_weight_double(g->constraint.a[(k + 1) * s + j]);
        const double ha = dm_weight_double(g->gauss_ha[k * s + j]);
        const double d = dm_weight_double(g->gauss.d[k * s + j]);
        add_along(g, J, G, a, dm_constrained_holonomic(g, k + 1) + g->k, &g->G);
        if (l == 0) continue;
        add_along(g, J, phi, d, phi_v, &g->phi_v);
        add_along(g, J, phi, ha, phi_v + l * n, &g->phi_q);
    }
}

/* From the derivatives that lie in the struct: of slopes, reactions and rows where they were last
 * evaluated. */
void dm_constrained_equation_matrix(const dm_constrained *g, double *J) {
    dm_step_matrix_zero(J, &g->step);
    slope_columns(g, J);
    if (g->k + g->l == 0) return;
    reaction_columns(g, J);
    for (uint32_t k = 0; k < g->K; k++) {
        impulse_columns(g, J, k);
        multiplier_columns(g, J, k);
    }
}

/* For dm_newton, whose ctx is the struct. What is evaluated stays there for the end of the step. */
dm_status dm_constrained_equation(void *ctx, double *R, double *J, const double *z) {
    dm_constrained *g = ctx;
    dm_constrained_slopes(g, z, J != NULL);
    dm_constrained_constraints(g, z, J != NULL);
    g->size = g->position_size;
    momentum_rows(g, R);
    constraint_rows(g, R + (size_t)g->table.s * g->n);
    if (J && !g->constant.made) dm_constrained_equation_matrix(g, J);
    return DM_OK;
}
