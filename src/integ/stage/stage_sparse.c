/* stage_sparse.c - the matrix is factorized once a step, or once for all where second derivatives
 * are numbers; one block is symmetric (CHOLMOD), several are not (UMFPACK). Without dm/sparse.so
 * one block goes by conjugate gradients. */
#include "integ/stage/stage_sparse.h"

#include "chain/curvature.h"
#include "chain/loops.h"
#include "integ/method/hamilton.h"
#include "integ/stage/stage_factor.h"
#include "linalg/sparse/conjugate_gradient.h"
#include "numbers/compensated.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST = 40 /* iterations */, FIRST = 0, SOLVED, LAST };
static const double NOISE = 4.0; /* of the rounding of a residual: so large may one be */

typedef struct {
    dm_stage_table table;
    uint32_t solved, at[DM_QUADRATURE_NODES]; /* points that are solved for */
    uint8_t kind[DM_QUADRATURE_NODES];
    dm_sparse S; /* [n solved]^2: unknown k of solved point i is k solved + i */
    dm_stage_factor factors;
    double h;                     /* that S was made for; 0: none */
    int fresh;                    /* forces at Z are there */
    int constant;                 /* second derivatives are numbers, and so are factors */
    double *x, *Z, *base, *u, *F; /* (q, v, t); [r][n] each: Z, what is known of it, M^-1 F, F */
    double *R, *dx, *cg;          /* [solved][n], [4 solved n] */
    double *diagonal;             /* [n][solved] of S, in the place of cg; NULL: not known */
    double *begin;                /* the table, in the workspace */
} layout;

/* In doubles. */
static size_t head(void) {
    return (sizeof(layout) + sizeof(double) - 1) / sizeof(double);
}

static void basis_of(dm_galerkin *g, const dm_rule *rule, const dm_model *m) {
    dm_stage_basis(g, rule, m);
}

static const char *fits(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    basis_of(&g, rule, m);
    if (!g.s) return "its pair of tables is for L = T(v) - V(q) alone";
    if (g.sweeps) return "a number of sweeps is not for fields; leave it out";
    if (m->massless)
        return "values without mass are eliminated by kicks and drifts alone; take verlet";
    if (!m->inverse_mass) return "cells without mass have no equation of motion";
    return NULL;
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return DM_WANT_FORCE | DM_WANT_CURVATURE;
}

/* entries of S, with r points at most */
static size_t entries(const dm_model *m, size_t r) {
    return (size_t)m->curvature->A.start[m->n] * r * r;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    basis_of(&g, rule, m);
    const size_t n = m->n, r = (size_t)g.q.r, all = m->curvature ? entries(m, r) : 0;
    return head() + dm_stage_table_size((size_t)g.s, r) + 2 * n + 1 + 4 * r * n + 6 * r * n + all +
           (all + r * n + 4) / 2 + 4 + (all + 1) / 2 + 8;
}

static int row_is_zero(const dm_stage_table *t, uint32_t m, int column) {
    for (uint32_t i = 0; i < t->r; i++)
        if (t->A[column ? i * t->r + m : m * t->r + i].top != 0.0) return 0;
    return 1;
}

/* first points are explicit, last ones are read off */
static void sort_points(layout *l) {
    for (uint32_t m = 0; m < l->table.r; m++) {
        l->kind[m] = (uint8_t)(row_is_zero(&l->table, m, 0)   ? FIRST
                               : row_is_zero(&l->table, m, 1) ? LAST
                                                              : SOLVED);
        if (l->kind[m] == SOLVED) l->at[l->solved++] = m;
    }
}

/* the pattern: that of L_qq in every block */
static void lay_pattern(layout *l, const dm_sparse *A) {
    const int32_t k = (int32_t)l->solved;
    int32_t next = 0;
    for (int32_t j = 0; j < A->columns; j++)
        for (int32_t b = 0; b < k; b++) {
            l->S.start[j * k + b] = next;
            for (int32_t p = A->start[j]; p < A->start[j + 1]; p++)
                for (int32_t a = 0; a < k; a++) l->S.row[next++] = A->row[p] * k + a;
        }
    l->S.start[A->columns * k] = next;
    l->S.rows = l->S.columns = A->columns * k;
}

static dm_status open(dm_stepper *s) {
    layout *l = (layout *)(void *)s->work;
    const dm_model *m = s->model;
    const size_t n = m->n;
    dm_galerkin g;
    basis_of(&g, s->rule, m);
    *l = (layout){.begin = s->work + head()};
    dm_stage_table_fill(&l->table, &g, l->begin);
    sort_points(l);
    const size_t r = l->table.r, k = l->solved, all = entries(m, k);
    double *place = l->begin + dm_stage_table_size(l->table.s, r);
    l->x = place;
    l->Z = l->x + 2 * n + 1;
    l->base = l->Z + r * n;
    l->u = l->base + r * n;
    l->F = l->u + r * n;
    l->R = l->F + r * n;
    l->dx = l->R + k * n;
    l->cg = l->dx + k * n;
    l->S.value = l->cg + 4 * k * n;
    l->S.row = (int32_t *)(void *)(l->S.value + all + 1);
    l->S.start = (int32_t *)(void *)(l->S.value + all + 1 + (all + 1) / 2 + 1);
    lay_pattern(l, &m->curvature->A);
    dm_stage_factor_open(&l->factors, m->source.arena);
    memset(l->x, 0, (2 * n + 1) * sizeof *l->x);
    dm_kernel_prepare(&m->force, l->F);
    l->constant = m->curvature->constant && dm_loops_constant(&m->force);
    if (k > 1 && !s->solvers) return DM_NO_START;
    return DM_OK;
}

/* The factorization goes. */
static void drop(dm_stepper *s, layout *l) {
    dm_stage_factor_drop(&l->factors, s->solvers);
    l->h = 0.0;
}

static void close(dm_stepper *s) {
    dm_stage_factor_close(&((layout *)(void *)s->work)->factors, s->solvers);
}

/* ---- one step ---- */

/* force at q0 + Z_m, and M^-1 force */
static void evaluate(dm_stepper *s, layout *l, const double *q, uint32_t m, double t, double h) {
    const uint32_t n = s->model->n;
    const double *Z = l->Z + (size_t)m * n, *w = s->model->inverse_mass;
    double *F = l->F + (size_t)m * n, *u = l->u + (size_t)m * n;
    for (uint32_t i = 0; i < n; i++) l->x[i] = q[i] + Z[i];
    l->x[2 * (size_t)n] = t + dm_weight_double(l->table.c[m]) * h;
    dm_kernel_eval(&s->model->force, l->x, F);
    for (uint32_t i = 0; i < n; i++) u[i] = w[i] * F[i];
    s->report.evaluations++;
}

/* out += h^2 sum of A_im u_m over the points of one kind */
static void add_forces(const layout *l, uint32_t n, double *out, uint32_t i, int kind, double h) {
    for (uint32_t m = 0; m < l->table.r; m++) {
        if (l->kind[m] != kind) continue;
        const double w = h * h * dm_weight_double(l->table.A[i * l->table.r + m]);
        const double *u = l->u + (size_t)m * n;
        for (uint32_t k = 0; k < n; k++) out[k] += w * u[k];
    }
}

/* M - h^2 A L_qq; rows of entries that are held are those of 1 */
static void fill(const dm_stepper *s, layout *l, double h) {
    const dm_model *m = s->model;
    const dm_sparse *A = &m->curvature->A;
    const uint32_t k = l->solved, r = l->table.r;
    double *value = l->S.value;
    l->diagonal = s->solvers ? l->cg : NULL;
    for (int32_t j = 0; j < A->columns; j++)
        for (uint32_t b = 0; b < k; b++)
            for (int32_t p = A->start[j]; p < A->start[j + 1]; p++)
                for (uint32_t a = 0; a < k; a++) {
                    const dm_weight w = l->table.A[l->at[a] * r + l->at[b]];
                    double x = -h * h * dm_weight_double(w) * A->value[p];
                    if (A->row[p] == j && a == b)
                        x += m->held && m->held[j] ? 1.0 : m->mass_matrix[j];
                    if (A->row[p] == j && a == b && l->diagonal) l->diagonal[(size_t)j * k + a] = x;
                    *value++ = x;
                }
}

/* second derivatives at q0 + the mean of Z, and the factors of the matrix */
static dm_status prepare(dm_stepper *s, layout *l, const double *q, double t, double h, int anew) {
    const dm_model *m = s->model;
    if (l->h == h && l->constant && !anew) return DM_OK;
    drop(s, l);
    for (uint32_t i = 0; i < m->n; i++) {
        double Z = 0.0;
        for (uint32_t a = 0; anew && a < l->solved; a++) Z += l->Z[(size_t)l->at[a] * m->n + i];
        l->x[i] = q[i] + Z / (double)l->solved;
    }
    l->x[2 * (size_t)m->n] = t;
    dm_curvature_at(m->curvature, dm_loops_factors(&m->force, l->x), l->x);
    fill(s, l, h);
    l->h = h;
    if (!s->solvers) return DM_OK;
    return dm_stage_factor_make(&l->factors, s->solvers, &l->S, l->solved == 1, l->constant);
}

static dm_status solve(dm_stepper *s, layout *l, double *dx, const double *R) {
    if (l->factors.factor) return s->solvers->solve(l->factors.factor, dx, R);
    dm_cg how = {.tolerance = 1e-13, .most = 20 * l->S.rows + 100};
    memset(dx, 0, (size_t)l->S.rows * sizeof *dx);
    return dm_conjugate_gradient(dx, &l->S, R, l->cg, &how);
}

/* M (Z - base - h^2 A u), unknown by unknown, with another sign */
static void residual(const dm_stepper *s, layout *l, double h) {
    const dm_model *m = s->model;
    const uint32_t n = m->n, k = l->solved;
    for (uint32_t a = 0; a < k; a++) {
        const uint32_t i = l->at[a];
        double *sum = l->dx; /* free until it is solved for */
        memcpy(sum, l->base + (size_t)i * n, n * sizeof *sum);
        add_forces(l, n, sum, i, SOLVED, h);
        for (uint32_t j = 0; j < n; j++) {
            const double mass = m->held && m->held[j] ? 1.0 : m->mass_matrix[j];
            l->R[(size_t)j * k + a] = mass * (sum[j] - l->Z[(size_t)i * n + j]);
        }
    }
}

/* Is the residual no more than its own rounding? Forces are rounded by |S - M| |x|, the rest by
 * |S| |Z|, of which the diagonal stands for a row; another solve would only bring other noise. */
static int is_noise(const dm_stepper *s, const layout *l) {
    const dm_model *m = s->model;
    const uint32_t n = m->n, k = l->solved;
    double position = 0.0, size = 0.0;
    if (!l->diagonal) return 0;
    for (uint32_t i = 0; i < n; i++) position = fmax(position, fabs(l->x[i]));
    for (uint32_t a = 0; a < k; a++)
        for (uint32_t i = 0; i < n; i++) size = fmax(size, fabs(l->Z[(size_t)l->at[a] * n + i]));
    for (uint32_t j = 0; j < n; j++) {
        const double mass = m->held && m->held[j] ? 1.0 : m->mass_matrix[j];
        for (uint32_t a = 0; a < k; a++) {
            const double S = l->diagonal[(size_t)j * k + a];
            const double noise = fabs(S - mass) * position + fabs(S) * size;
            if (!(fabs(l->R[(size_t)j * k + a]) <= NOISE * DBL_EPSILON * noise)) return 0;
        }
    }
    return 1;
}

/* Z of the points that are solved for */
static dm_status newton(dm_stepper *s, layout *l, const double *q, double t, double h) {
    const uint32_t n = s->model->n, k = l->solved;
    double last = INFINITY;
    dm_status status = prepare(s, l, q, t, h, 0);
    for (int pass = 1; status == DM_OK; pass++) {
        double step = 0.0, size = 0.0;
        for (uint32_t a = 0; a < k; a++) evaluate(s, l, q, l->at[a], t, h);
        residual(s, l, h);
        l->fresh = pass > 1 && is_noise(s, l);
        if (l->fresh) break;
        status = solve(s, l, l->dx, l->R);
        if (status != DM_OK) return status;
        for (uint32_t a = 0; a < k; a++)
            for (uint32_t j = 0; j < n; j++) {
                const double d = l->dx[(size_t)j * k + a];
                double *Z = l->Z + (size_t)l->at[a] * n + j;
                *Z += d;
                step = fmax(step, fabs(d));
                size = fmax(size, fabs(*Z));
                if (d != d) return DM_NOT_FINITE;
            }
        s->report.iterations = pass;
        s->report.newton++;
        s->report.residual = step;
        if (!isfinite(step)) return DM_NOT_FINITE;
        if (step <= s->tolerance * size || (step >= 0.5 * last && step <= 1e-12 * size)) break;
        if (pass >= s->max_iterations || pass >= MOST) return DM_NO_CONVERGENCE;
        if (step > 0.3 * last) status = prepare(s, l, q, t, h, 1);
        last = step;
    }
    s->report.solves++;
    return status;
}

/* what is known of Z_i: h r_i v0, and the forces of the first points */
static void begin(dm_stepper *s, layout *l, const double *q, const double *p, double t, double h) {
    const uint32_t n = s->model->n, r = l->table.r;
    const double *w = s->model->inverse_mass;
    for (uint32_t m = 0; m < r; m++) {
        const double reach = h * dm_weight_double(l->table.reach[m]);
        double *base = l->base + (size_t)m * n;
        for (uint32_t i = 0; i < n; i++) base[i] = reach * (w[i] * p[i]);
        memcpy(l->Z + (size_t)m * n, base, n * sizeof *base);
        if (l->kind[m] == FIRST) evaluate(s, l, q, m, t, h);
    }
    for (uint32_t m = 0; m < r; m++) {
        double *base = l->base + (size_t)m * n;
        if (l->kind[m] == FIRST) continue;
        add_forces(l, n, base, m, FIRST, h);
        memcpy(l->Z + (size_t)m * n, base, n * sizeof *base);
    }
}

/* q1 and p1 of all forces, into the compensated state */
static void end(const dm_stepper *s, const layout *l, double *state, double h) {
    const uint32_t n = s->model->n, r = l->table.r;
    double *p = state + n, *low_q = p + n, *low_p = low_q + n;
    for (uint32_t i = 0; i < n; i++) {
        double dq = h * (s->model->inverse_mass[i] * p[i]), dp = 0.0;
        for (uint32_t m = 0; m < r; m++) {
            dq += h * h * dm_weighted(l->table.mean[m], l->u[(size_t)m * n + i]);
            dp += h * dm_weighted(l->table.b[m], l->F[(size_t)m * n + i]);
        }
        dm_sum_add(state + i, low_q + i, dq);
        dm_sum_add(p + i, low_p + i, dp);
    }
}

static dm_status step(dm_stepper *s, double *state, double t, double h) {
    layout *l = (layout *)(void *)s->work;
    const uint32_t n = s->model->n, r = l->table.r;
    begin(s, l, state, state + n, t, h);
    const dm_status status = l->solved ? newton(s, l, state, t, h) : DM_OK;
    if (status != DM_OK) return status;
    for (uint32_t m = 0; m < r; m++) {
        if (l->kind[m] == FIRST) continue;
        if (l->kind[m] == LAST) {
            double *Z = l->Z + (size_t)m * n;
            add_forces(l, n, Z, m, SOLVED, h);
        }
        if (l->kind[m] == LAST || !l->fresh) evaluate(s, l, state, m, t, h);
    }
    for (uint32_t i = 0; i < r * n; i++)
        if (!isfinite(l->F[i])) return DM_NOT_FINITE;
    end(s, l, state, h);
    return DM_OK;
}

const dm_engine dm_engine_stage_sparse = {
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .step = step,
    .close = close,
};
