/* constrained_hidden.c - the impulses I_K that put p1 onto the hidden constraint, and v1:
 *   L_v(q1, v1) = p + I_K,  G v1 + g_t = 0,  phi(q1, v1) = 0. */
#include "integ/constrained/constrained_inside.h"

#include "linalg/lu.h"
#include "linalg/solve/newton.h"
#include "numbers/small_copy.h"

#include <math.h>
#include <string.h>

/* ---- in general: unknowns v1[n], impulses[m] ---- */

/* The first n rows, and I_K into its place; rows of rolling constraints are those at this v. */
static void end_momentum(dm_constrained *g, double *R, const double *v, const double *impulses) {
    const uint32_t n = g->n;
    double *impulse = g->impulse + g->K * (size_t)n;
    memcpy(g->x + n, v, n * sizeof *v);
    dm_kernel_eval(&g->m->mass, g->x, g->mass);
    if (g->l) dm_constrained_rows(g, g->K);
    dm_constrained_impulse(g, impulse, impulses, g->K);
    for (uint32_t i = 0; i < n; i++) {
        R[i] = (g->mass[i] - g->before[i]) - impulse[i];
        g->size = dm_constrained_larger(g->size, fabs(g->mass[i]));
        g->size = dm_constrained_larger(g->size, fabs(impulse[i]));
    }
}

/* The last m rows in units of momentum: the hidden constraint of holonomic ones, the value of
 * rolling ones. */
static void end_constraints(const dm_constrained *g, double *R, const double *v) {
    const double *hol = dm_constrained_holonomic(g, g->K), *G = hol + g->k;
    const double *g_t = G + (size_t)g->k * g->n, *phi = dm_constrained_rolling(g, g->K);
    for (uint32_t c = 0; c < g->k; c++) R[c] = g_t[c];
    for (uint32_t c = 0; c < g->l; c++) R[g->k + c] = phi[c];
    dm_constrained_product(R, G, v, &g->G);
    for (uint32_t c = 0; c < g->k + g->l; c++) R[c] *= g->row_unit[c];
}

/* rows across, as columns behind those of v, and rows of the equations */
static void add_constraints(const dm_constrained *g, double *J, const double *across,
                            const double *along, const dm_constrained_entries *e, uint32_t first) {
    const dm_step_matrix *m = &g->hidden;
    const double *unit = across ? g->impulse_unit + first : g->row_unit + first;
    for (uint32_t i = 0; i < e->count; i++) {
        const uint32_t c = e->row[i], v = e->column[i], at = g->n + first + c;
        if (across)
            J[m->row[v] + m->column[at]] = -across[e->entry[i]] * unit[c];
        else
            J[m->row[at] + m->column[v]] = along[e->entry[i]] * unit[c];
    }
}

/* [L_vv - dI/dv, -rows^T; rows, 0] */
void dm_constrained_hidden_matrix(const dm_constrained *g, double *J) {
    const size_t n = g->n;
    const double *G = dm_constrained_holonomic(g, g->K) + g->k;
    const double *E = dm_constrained_rolling(g, g->K) + g->l;
    const double *r_v = dm_constrained_curved(g, g->K) + n + n * n;
    dm_step_matrix_zero(J, &g->hidden);
    dm_constrained_add(J, &g->hidden, 0, 0, 1.0, g->mass + n, &g->mass_vv);
    if (g->l) dm_constrained_add(J, &g->hidden, 0, 0, -1.0, r_v, &g->r_v);
    add_constraints(g, J, G, NULL, &g->G, 0);
    add_constraints(g, J, NULL, G, &g->G, 0);
    add_constraints(g, J, E, NULL, &g->E, g->k);
    add_constraints(g, J, NULL, E + g->l * n, &g->phi_v, g->k);
}

/* For dm_newton; z = (v1, impulses). */
static dm_status end_equation(void *ctx, double *R, double *J, const double *z) {
    dm_constrained *g = ctx;
    g->size = 0.0;
    end_momentum(g, R, z, z + g->n);
    end_constraints(g, R + g->n, z);
    if (J && g->l) dm_constrained_reaction(g, z + g->n, g->K);
    if (J) dm_constrained_hidden_matrix(g, J);
    return DM_OK;
}

/* x = (q1, v of the curve's end, t1); rows of the holonomic constraints there */
static void place_end(dm_constrained *g) {
    const uint32_t n = g->n, s = g->table.s;
    dm_small_zero(g->end, n);
    for (uint32_t j = 0; j < s; j++)
        dm_weighted_add(g->end, g->constraint.d[g->K * s + j], g->root + j * (size_t)n, n);
    dm_small_copy(g->x, g->next, n);
    dm_small_copy(g->x + n, g->end, n);
    g->x[2 * n] = g->t + g->h;
    dm_constrained_rows(g, g->K);
}

/* From the velocity of the curve. The residual of a step that succeeds is that of its equation, not
 * of this one. */
static dm_status by_newton(dm_constrained *g, const dm_stepper *stepper) {
    dm_newton_report report = {0};
    const dm_newton_problem problem = {.m = g->n + g->k + g->l,
                                       .equation = end_equation,
                                       .ctx = g,
                                       .size = &g->size,
                                       .band = dm_step_matrix_band(&g->hidden),
                                       .place = g->next,
                                       .places = g->n,
                                       .shared = g->k + g->l,
                                       .over = g->h,
                                       .tolerance = stepper->tolerance,
                                       .max_iterations = stepper->max_iterations};
    const dm_status status = dm_newton(g->end, &problem, g->scratch, &report);
    g->residual = status == DM_OK ? g->residual : report.residual;
    if (status != DM_OK) return status;
    if (dm_constrained_is_lost(g, g->K)) return DM_SINGULAR;
    if (g->l == 0) return status;
    memcpy(g->x + g->n, g->end, g->n * sizeof *g->x);
    dm_constrained_rows(g, g->K); /* E at v1 itself */
    return DM_OK;
}

/* ---- constant mass, constraints linear in v: (A M^-1 A'^T) impulses = -(A v + g_t), m x m ---- */

/* out = M^-1 p */
static void by_inverse(const dm_model *m, double *out, const double *p) {
    const uint32_t n = m->n;
    const int diagonal = (m->structure & DM_DIAGONAL_MASS) != 0;
    for (uint32_t i = 0; i < n; i++) {
        const double *row = m->inverse_mass + (diagonal ? 0 : i * (size_t)n);
        double sum = diagonal ? row[i] * p[i] : 0.0;
        for (uint32_t j = 0; j < n && !diagonal; j++) sum += row[j] * p[j];
        out[i] = sum;
    }
}

/* Row c at the end: across, the way its reaction acts; else the row of its equation. */
static const double *row_of(const dm_constrained *g, uint32_t c, int across) {
    const double *E = dm_constrained_rolling(g, g->K) + g->l;
    if (c < g->k) return dm_constrained_holonomic(g, g->K) + g->k + c * g->n;
    return E + ((across ? 0 : g->l) + c - g->k) * g->n;
}

/* S[m][m] = rows . M^-1 rows of the impulses; M^-1 of these into `push`; *sines: det S over the
 * product of its diagonal, the squares of sines of the angles between rows */
static dm_status weigh(dm_constrained *g, double *S, double *push, uint32_t *pivot, double *sines) {
    const uint32_t n = g->n, m = g->k + g->l;
    for (uint32_t c = 0; c < m; c++) {
        by_inverse(g->m, push + c * n, row_of(g, c, 1));
        for (uint32_t b = 0; b < m; b++) {
            const double *row = row_of(g, b, 0);
            double sum = 0.0;
            for (uint32_t i = 0; i < n; i++) sum += row[i] * push[c * n + i];
            S[b * m + c] = sum;
        }
    }
    dm_wide_product cosines = DM_WIDE_ONE, inverse = DM_WIDE_ONE;
    for (uint32_t c = 0; c < m; c++) cosines = dm_wide_times(cosines, S[c * m + c]);
    const dm_status status = dm_lu_factor(S, pivot, m);
    for (uint32_t c = 0; c < m; c++) inverse = dm_wide_times(inverse, S[c * m + c]); /* 1/U */
    g->volume = (dm_wide_product){fabs(1.0 / inverse.part), -inverse.power};
    *sines = dm_wide_over(g->volume, (double)cosines.power) / cosines.part;
    return status;
}

/* what is missing at v1 to the constraints, negative: g_t + G v, phi with phi_v v instead of its
 * value at another v */
static void missing(const dm_constrained *g, double *out, const double *offset) {
    for (uint32_t c = 0; c < g->k + g->l; c++) {
        const double *row = row_of(g, c, 0);
        out[c] = -offset[c];
        for (uint32_t i = 0; i < g->n; i++) out[c] -= row[i] * g->end[i];
    }
}

/* the part of the constraints without v: g_t, and phi - phi_v v at the v where phi was evaluated */
static void offsets(const dm_constrained *g, double *offset) {
    const double *g_t = dm_constrained_holonomic(g, g->K) + g->k + g->k * g->n;
    const double *phi = dm_constrained_rolling(g, g->K);
    for (uint32_t c = 0; c < g->k + g->l; c++) {
        const double *row = row_of(g, c, 0);
        offset[c] = c < g->k ? g_t[c] : phi[c - g->k];
        for (uint32_t i = 0; i < g->n && c >= g->k; i++) offset[c] -= row[i] * g->x[g->n + i];
    }
}

/* Of what sines multiply to: at less it is asked whether rows depend on each other. */
static const double NEARLY = 1e-13;

/* twice: the second time from v1, for what rounding in S left */
static dm_status by_elimination(dm_constrained *g) {
    const uint32_t n = g->n, m = g->k + g->l;
    double *S = g->scratch, *push = S + (size_t)m * m, *offset = push + (size_t)m * n;
    double *more = offset + m;
    uint32_t *pivot = (uint32_t *)(void *)(more + m);
    double sines;
    dm_status status = weigh(g, S, push, pivot, &sines);
    if (status == DM_OK && !(fabs(sines) > NEARLY)) /* the check takes the place of S */
        status = dm_constrained_is_lost(g, g->K) ? DM_SINGULAR : weigh(g, S, push, pivot, &sines);
    if (status != DM_OK) return status;
    offsets(g, offset);
    for (uint32_t i = 0; i < n; i++) g->v[i] = g->before[i] - g->m->momentum_shift[i];
    by_inverse(g->m, g->end, g->v);
    dm_small_zero(g->end + n, m);
    for (int pass = 0; pass < 2; pass++) {
        missing(g, more, offset);
        dm_lu_solve(more, S, pivot, m);
        for (uint32_t c = 0; c < m; c++) {
            g->end[n + c] += more[c] / g->impulse_unit[c];
            for (uint32_t i = 0; i < n; i++) g->end[i] += more[c] * push[c * n + i];
        }
    }
    missing(g, more, offset);
    for (uint32_t c = g->k; c < m; c++) dm_constrained_rolling(g, g->K)[c - g->k] = -more[c];
    return DM_OK;
}

/* By elimination where the end is a linear problem with a constant matrix, which costs m^3 instead
 * of (n + m)^3; where the matrix is a band Newton is cheaper all the same. */
dm_status dm_constrained_hidden(dm_constrained *g, const dm_stepper *stepper) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    const unsigned constraints = g->constraints->structure;
    const int linear = !g->l || (constraints & DM_CONSTRAINTS_LINEAR &&
                                 !(constraints & DM_CONSTRAINTS_GIVEN_REACTIONS));
    place_end(g);
    if (linear && (g->m->structure & simple) == simple && !g->hidden.banded)
        return by_elimination(g);
    return by_newton(g, stepper);
}
