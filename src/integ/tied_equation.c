/* tied_equation.c - residual and exact matrix of the step equation; unknowns V[s][n], impulses[K][m], m = k + l. */
#include "integ/tied_inside.h"

#include <math.h>
#include <string.h>

uint32_t dm_tied_unknowns(const dm_tied *g) {
    return g->table.s * g->n + g->K * (g->k + g->l);
}

/* sum_i b_i [h (a_ij - beta_j) (L_q + f)(i) + d_ij L_v(i)] */
static void add_slopes(dm_tied *g, double *Rj, uint32_t j) {
    const uint32_t n = g->n, s = g->table.s;
    for (uint32_t i = 0; i < g->table.r; i++) {
        const double *slope = g->slope + i * 2 * (size_t)n;
        const dm_weight wq = g->wq[i * s + j], wv = g->wv[i * s + j];
        for (uint32_t k = 0; k < n; k++) {
            const double term = dm_weighted(wq, slope[k]) + dm_weighted(wv, slope[n + k]);
            Rj[k] += term;
            g->size = dm_tied_larger(g->size, fabs(term));
        }
    }
}

static void momentum_rows(dm_tied *g, double *R) {
    const uint32_t n = g->n, s = g->table.s, m = g->k + g->l;
    const double *p0 = g->state + n, *low = g->state + 3 * n;
    for (uint32_t j = 0; j < s; j++) {
        double *Rj = R + j * (size_t)n;
        const dm_weight beta = g->table.beta[j];
        memset(Rj, 0, n * sizeof *Rj);
        add_slopes(g, Rj, j);
        for (uint32_t k = 0; k < g->K && m; k++)
            dm_weighted_add(Rj, g->lever[k * s + j], g->impulse + k * (size_t)n, n);
        for (uint32_t k = 0; k < n; k++)
            Rj[k] = (Rj[k] - dm_weighted(beta, p0[k])) - beta.top * low[k];
    }
}

/* rounding q moves g by about G q, which is no error of the step */
static double position_size(const dm_tied *g) {
    double most = 0.0;
    for (uint32_t i = 0; i < g->n; i++) most = dm_tied_larger(most, fabs(g->state[i]));
    return g->k ? g->mass_size * most / fabs(g->h) : 0.0;
}

/* g(Q~_k+1) / h and phi at the Gauss point k, in units of momentum */
static void tie_rows(const dm_tied *g, double *R) {
    const uint32_t n = g->n, m = g->k + g->l;
    for (uint32_t k = 0; k < g->K; k++, R += m) {
        const double *hol = dm_tied_holonomic(g, k + 1);
        const double *phi = g->roll + k * (size_t)g->l * (1 + 3 * (size_t)n);
        for (uint32_t c = 0; c < g->k; c++) R[c] = hol[c] * (g->row_unit[c] / g->h);
        for (uint32_t c = g->k; c < m; c++) R[c] = phi[c - g->k] * g->row_unit[c];
    }
}

/* block += w B, or w B^T; rows of J are N long */
static void add_block(double *J, size_t N, double w, const double *B, uint32_t n) {
    if (w == 0.0) return;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) J[i * N + j] += w * B[i * (size_t)n + j];
}

static void add_transposed(double *J, size_t N, double w, const double *B, uint32_t n) {
    if (w == 0.0) return;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) J[i * N + j] += w * B[j * (size_t)n + i];
}

typedef struct {
    double q, v;  /* of the slopes: h b_i (a_ij - beta_j), b_i d_ij */
    double ha, d; /* dQ/dV, dQdot/dV */
} chain;

/* the derivative of one equation in one velocity, by way of the point i */
static void slope_block(const dm_tied *g, double *block, size_t N, uint32_t i, chain w) {
    const uint32_t n = g->n;
    const size_t nn = (size_t)n * n;
    const double *qq = g->curve + i * (2 * n + 3 * nn) + 2 * n, *qv = qq + nn;
    const double *f_q = g->drag + i * (n + 2 * nn) + n;
    add_block(block, N, w.q * w.ha, qq, n);
    add_block(block, N, w.q * w.d, qv, n);
    add_transposed(block, N, w.v * w.ha, qv, n);
    add_block(block, N, w.v * w.d, qv + nn, n);
    if (!g->ties->forced) return;
    add_block(block, N, w.q * w.ha, f_q, n);
    add_block(block, N, w.q * w.d, f_q + nn, n);
}

static void slope_columns(const dm_tied *g, double *J, size_t N) {
    const uint32_t n = g->n, s = g->table.s;
    for (uint32_t i = 0; i < g->table.r; i++)
        for (uint32_t j = 0; j < s; j++)
            for (uint32_t k = 0; k < s; k++) {
                const chain w = {.q = dm_weight_double(g->wq[i * s + j]),
                                 .v = dm_weight_double(g->wv[i * s + j]),
                                 .ha = dm_weight_double(g->ha[i * s + k]),
                                 .d = dm_weight_double(g->table.d[i * s + k])};
                slope_block(g, J + j * n * N + k * n, N, i, w);
            }
}

/* impulses of the inner tie points move with the curve */
static void reaction_columns(const dm_tied *g, double *J, size_t N) {
    const uint32_t n = g->n, s = g->table.s;
    for (uint32_t i = 1; i < g->K; i++)
        for (uint32_t j = 0; j < s; j++)
            for (uint32_t k = 0; k < s; k++) {
                const double w = dm_weight_double(g->lever[i * s + j]);
                const double ha = dm_weight_double(g->tie_ha[i * s + k]);
                const double d = dm_weight_double(g->tie.d[i * s + k]);
                const double *r_q = dm_tied_curved(g, i) + n;
                double *block = J + j * n * N + k * n;
                add_block(block, N, w * ha, r_q, n);
                if (g->l) add_block(block, N, w * d, r_q + (size_t)n * n, n);
            }
}

/* dR/d impulse: column (k, c) holds G_c or E_c of the tie point k */
static void impulse_columns(const dm_tied *g, double *J, size_t N) {
    const uint32_t n = g->n, s = g->table.s, m = g->k + g->l;
    for (uint32_t k = 0; k < g->K; k++)
        for (uint32_t c = 0; c < m; c++) {
            const double *row = c < g->k ? dm_tied_holonomic(g, k) + g->k + c * n
                                         : dm_tied_rolling(g, k) + g->l + (c - g->k) * n;
            const double unit = g->impulse_unit[c];
            double *column = J + s * n + k * m + c;
            for (uint32_t j = 0; j < s; j++) {
                const double w = unit * dm_weight_double(g->lever[k * s + j]);
                for (uint32_t i = 0; i < n; i++) column[(j * n + i) * N] = w * row[i];
            }
        }
}

static void holonomic_row(const dm_tied *g, double *row, uint32_t k, uint32_t c) {
    const uint32_t n = g->n, s = g->table.s;
    const double *G = dm_tied_holonomic(g, k + 1) + g->k + c * n;
    const double unit = g->row_unit[c];
    for (uint32_t j = 0; j < s; j++) {
        const double w = unit * dm_weight_double(g->tie.a[(k + 1) * s + j]);
        for (uint32_t i = 0; i < n; i++) row[j * n + i] = w * G[i];
    }
}

static void rolling_row(const dm_tied *g, double *row, uint32_t k, uint32_t c) {
    const uint32_t n = g->n, s = g->table.s, l = g->l;
    const double *phi_v = g->roll + k * (size_t)l * (1 + 3 * n) + l + (l + c) * n;
    const double *phi_q = phi_v + l * n, unit = g->row_unit[g->k + c];
    for (uint32_t j = 0; j < s; j++) {
        const double ha = unit * dm_weight_double(g->gauss_ha[k * s + j]);
        const double d = unit * dm_weight_double(g->gauss.d[k * s + j]);
        for (uint32_t i = 0; i < n; i++) row[j * n + i] = ha * phi_q[i] + d * phi_v[i];
    }
}

static void matrix(const dm_tied *g, double *J) {
    const size_t N = dm_tied_unknowns(g);
    const uint32_t m = g->k + g->l;
    memset(J, 0, N * N * sizeof *J);
    slope_columns(g, J, N);
    if (m == 0) return;
    reaction_columns(g, J, N);
    impulse_columns(g, J, N);
    for (uint32_t k = 0; k < g->K; k++)
        for (uint32_t c = 0; c < m; c++) {
            double *row = J + ((size_t)g->table.s * g->n + k * m + c) * N;
            if (c < g->k)
                holonomic_row(g, row, k, c);
            else
                rolling_row(g, row, k, c - g->k);
        }
}

dm_status dm_tied_equation(void *ctx, double *R, double *J, const double *z) {
    dm_tied *g = ctx;
    dm_tied_slopes(g, z, J != NULL);
    dm_tied_ties(g, z, J != NULL);
    g->size = position_size(g);
    momentum_rows(g, R);
    tie_rows(g, R + (size_t)g->table.s * g->n);
    if (J) matrix(g, J);
    return DM_OK;
}
