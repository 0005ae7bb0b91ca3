/* stage_worked.c - Newton's method with the matrix M - h^2 A (L_qq + f_q) - h R f_v, factorized
 * once a step, or once where all of it is made of numbers. */
#include "integ/stage/stage_worked.h"

#include "base/doubles.h"
#include "chain/curvature.h"
#include "chain/loops.h"
#include "chain/virtual_work.h"
#include "integ/method/stage_table.h"
#include "integ/stage/stage_continue.h"
#include "integ/stage/stage_factor.h"
#include "integ/stage/stage_place.h"
#include "integ/stage/stage_sparse.h"
#include "linalg/solve/newton_limits.h"
#include "linalg/sparse/conjugate_gradient.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

enum { MOST = 40 /* iterations */ };

typedef struct {
    dm_stage_table table;
    dm_sparse S; /* [n r]^2: unknown k of point m is k r + m */
    dm_stage_factor factors;
    dm_stage_place kept;     /* (q, p, t) that S may be of, where it is not constant */
    double h;                /* that S was made for; 0: none */
    int constant, symmetric; /* S is made of numbers; it is symmetric */
    double *x, *u, *F;       /* (q, v, t); [r][n] each */
    double *f, *f_q, *f_v;   /* [n], [r][n][values] */
    double *R, *dx, *cg;     /* [n r], [4 n r] */
    double *root;            /* [r][n] u of a shorter step, while it is continued */
    double *scratch, *begin; /* of the forces; the table */
} layout;

/* entries of S at most: those of L_qq, and the blocks of the forces */
static size_t entries(const dm_model *m, size_t r) {
    return ((size_t)m->curvature->A.start[m->n] + (size_t)m->n * m->work->values) * r * r;
}

/* numbers that a matrix is made of */
static size_t place_of(const dm_model *m) {
    const int constant = !m->curvature || !m->work || (m->curvature->constant && m->work->constant);
    return constant ? 0 : 2 * (size_t)m->n + 1;
}

/* In doubles; the pattern of S are integers, two of which go into one. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_stage_basis(&g, rule, m);
    const size_t n = m->n, r = (size_t)g.q.r, v = m->work ? m->work->values : 1;
    const size_t all = m->curvature && m->work ? entries(m, r) : 0;
    return dm_doubles(sizeof(layout)) + dm_stage_table_size((size_t)g.s, r) + 2 * n + 1 +
           2 * r * n + n + 2 * r * n * v + 7 * r * n + (m->work ? m->work->room : 0) + all +
           (all + r * n + 4) / 2 + 8 + dm_stage_place_room(place_of(m));
}

/* ---- the pattern of S ---- */

/* rows of column j of L_qq and of the block of its cell, ascending */
static uint32_t rows_of(const dm_model *m, int32_t j, int32_t *rows, int32_t *place) {
    const dm_sparse *A = &m->curvature->A;
    const int32_t v = (int32_t)m->work->values, first = j / v * v;
    int32_t p = A->start[j], block = first;
    uint32_t count = 0;
    while (p < A->start[j + 1] || block < first + v) {
        const int32_t here = p < A->start[j + 1] ? A->row[p] : INT32_MAX;
        const int32_t next = block < first + v && block < here ? block : here;
        if (rows) rows[count] = next;
        if (place) place[count] = next == here ? p : -1;
        block += next == block;
        p += next == here;
        count++;
    }
    return count;
}

/* Where S has entries: column j of point b, with every row of L_qq and of the block of its cell,
 * for all points a side by side. */
static void lay_pattern(layout *l, const dm_model *m) {
    const int32_t r = (int32_t)l->table.r, n = (int32_t)m->n;
    int32_t next = 0;
    for (int32_t j = 0; j < n; j++)
        for (int32_t b = 0; b < r; b++) {
            int32_t *row = l->S.row + next;
            const int32_t count = (int32_t)rows_of(m, j, row, NULL);
            l->S.start[j * r + b] = next;
            for (int32_t k = count - 1; k >= 0; k--)
                for (int32_t a = r - 1; a >= 0; a--) row[k * r + a] = row[k] * r + a;
            next += count * r;
        }
    l->S.start[n * r] = next;
    l->S.rows = l->S.columns = n * r;
}

/* Everything stands in the workspace, but for the factors, which a library makes. Without one a
 * symmetric matrix goes by conjugate gradients; any other cannot be solved for. */
static dm_status open(dm_stepper *s) {
    layout *l = (layout *)(void *)s->work;
    const dm_model *m = s->model;
    const size_t n = m->n, v = m->work->values;
    dm_galerkin g;
    dm_stage_basis(&g, s->rule, m);
    *l = (layout){.begin = s->work + dm_doubles(sizeof(layout))};
    dm_stage_table_fill(&l->table, &g, l->begin);
    const size_t r = l->table.r, all = entries(m, r);
    l->x = l->begin + dm_stage_table_size(l->table.s, r);
    l->u = l->x + 2 * n + 1;
    l->F = l->u + r * n;
    l->f = l->F + r * n;
    l->f_q = l->f + n;
    l->f_v = l->f_q + r * n * v;
    l->R = l->f_v + r * n * v;
    l->dx = l->R + r * n;
    l->cg = l->dx + r * n;
    l->root = l->cg + 4 * r * n;
    l->scratch = l->root + r * n;
    dm_stage_place_open(&l->kept, l->scratch + m->work->room, place_of(m));
    l->S.value = l->scratch + m->work->room + dm_stage_place_room(place_of(m));
    l->S.start = (int32_t *)(void *)(l->S.value + all);
    l->S.row = l->S.start + r * n + 1;
    lay_pattern(l, m);
    dm_stage_factor_open(&l->factors, m->source.arena);
    memset(l->x, 0, (2 * n + 1) * sizeof *l->x);
    dm_kernel_prepare(&m->force, l->F);
    l->constant = m->curvature->constant && dm_loops_constant(&m->force) && m->work->constant;
    /* several points, or blocks of several values, need not give a symmetric matrix */
    l->symmetric = r == 1 && v == 1;
    return l->symmetric || s->solvers ? DM_OK : DM_NO_START;
}

static void close(dm_stepper *s) {
    dm_stage_factor_close(&((layout *)(void *)s->work)->factors, s->solvers);
}

/* ---- one step ---- */

/* x = (Q, V, t) for weights of the accelerations */
static void place(const dm_stepper *s, layout *l, const double *q, const double *p, double t,
                  double h, uint32_t m) {
    const uint32_t n = s->model->n, r = l->table.r;
    const double reach = h * dm_weight_double(l->table.reach[m]), *w = s->model->inverse_mass;
    for (uint32_t k = 0; k < n; k++) {
        const double v = w[k] * p[k];
        double Q = 0.0, V = 0.0;
        for (uint32_t i = 0; i < r; i++) {
            const double u = l->u[(size_t)i * n + k];
            Q += dm_weight_double(l->table.A[m * r + i]) * u;
            V += dm_weight_double(l->table.rate[m * r + i]) * u;
        }
        l->x[k] = q[k] + (reach * v + h * h * Q);
        l->x[n + k] = v + h * V;
    }
    l->x[2 * (size_t)n] = t + dm_weight_double(l->table.c[m]) * h;
}

/* F_m = L_q + f at point m; where anew, also the derivatives of f there */
static void evaluate(dm_stepper *s, layout *l, uint32_t m, int anew) {
    const uint32_t n = s->model->n;
    double *F = l->F + (size_t)m * n;
    const size_t at = (size_t)m * n * s->model->work->values;
    dm_kernel_eval(&s->model->force, l->x, F);
    dm_work_force(s->model->work, l->f, anew ? l->f_q + at : NULL, anew ? l->f_v + at : NULL, l->x,
                  0, n, l->scratch);
    for (uint32_t k = 0; k < n; k++) F[k] += l->f[k];
    s->report.evaluations++;
}

/* Rows of the equation of point a, with L_qq as it stands and the derivatives of f at `from`:
 * column j of point b has the rows of L_qq and of the block of its cell, each once for every
 * a (lay_pattern); rows of entries that are held are those of 1. */
static void fill(const dm_stepper *s, layout *l, double h, uint32_t a, uint32_t from) {
    const dm_model *m = s->model;
    const dm_sparse *A = &m->curvature->A;
    const uint32_t r = l->table.r, v = m->work->values;
    int32_t *place = (int32_t *)(void *)l->dx; /* free until it is solved for */
    for (int32_t j = 0; j < (int32_t)m->n; j++) {
        const uint32_t count = rows_of(m, j, NULL, place);
        for (uint32_t b = 0; b < r; b++) {
            const int32_t first = l->S.start[(uint32_t)j * r + b], *row = l->S.row + first;
            const double w = dm_weight_double(l->table.A[a * r + b]);
            for (uint32_t k = 0; k < count; k++) {
                const uint32_t i = (uint32_t)row[k * r] / r;
                const int own = i / v == (uint32_t)j / v;
                double curve = place[k] >= 0 ? A->value[place[k]] : 0.0;
                const size_t at = ((size_t)from * m->n + i) * v + (uint32_t)j % v;
                if (own) curve += l->f_q[at];
                double x = -h * h * w * curve;
                if (own) x -= h * dm_weight_double(l->table.rate[a * r + b]) * l->f_v[at];
                if (i == (uint32_t)j && a == b)
                    x += m->held && m->held[j] ? 1.0 : m->mass_matrix[j];
                l->S.value[(uint32_t)first + k * r + a] = x;
            }
        }
    }
}

/* The matrix and its factors: at the start of a step with the derivatives at the middle point
 * everywhere, anew each point has its own. */
static dm_status prepare(dm_stepper *s, layout *l, const double *q, const double *p, double t,
                         double h, int anew) {
    const dm_model *m = s->model;
    const uint32_t r = l->table.r;
    if (l->h == h && l->constant && !anew) return DM_OK;
    l->h = 0.0;
    l->kept.is_made = 0;
    for (uint32_t a = 0; a < r; a++) {
        const uint32_t from = anew ? a : r / 2;
        if (anew || a == 0) {
            place(s, l, q, p, t, h, from);
            evaluate(s, l, from, 1);
            dm_curvature_at(m->curvature, dm_loops_factors(&m->force, l->x), l->x);
        }
        fill(s, l, h, a, from);
    }
    l->h = h, s->report.matrices++;
    if (!s->solvers) return DM_OK;
    return dm_stage_factor_make(&l->factors, s->solvers, &l->S, l->symmetric, l->constant);
}

/* dx of the Newton step, by the factors or by conjugate gradients */
static dm_status solve(dm_stepper *s, layout *l) {
    if (l->factors.factor) return s->solvers->solve(l->factors.factor, l->dx, l->R);
    dm_cg how = {.tolerance = 1e-13, .most = 20 * l->S.rows + 100};
    memset(l->dx, 0, (size_t)l->S.rows * sizeof *l->dx);
    return dm_conjugate_gradient(l->dx, &l->S, l->R, l->cg, &how);
}

/* F - M u at all points; held entries have no acceleration */
static void residual(dm_stepper *s, layout *l, const double *q, const double *p, double t,
                     double h) {
    const dm_model *m = s->model;
    const uint32_t n = m->n, r = l->table.r;
    for (uint32_t i = 0; i < r; i++) {
        place(s, l, q, p, t, h, i);
        evaluate(s, l, i, 0);
        for (uint32_t k = 0; k < n; k++) {
            const int held = m->held && m->held[k];
            const double u = l->u[(size_t)i * n + k], F = l->F[(size_t)i * n + k];
            l->R[(size_t)k * r + i] = held ? -u : F - m->mass_matrix[k] * u;
        }
    }
}

/* Does no position show the last change of the accelerations, and was every row round-off? */
static int is_unseen(const layout *l, uint32_t n, double h) {
    const uint32_t r = l->table.r;
    double most = 0.0, position = 0.0, *size = l->cg;
    for (uint32_t k = 0; k < n * r; k++) {
        const dm_weight *A = l->table.A + k % r * r;
        double moved = 0.0;
        for (uint32_t i = 0; i < r; i++) moved += dm_weighted(A[i], l->dx[k / r * (size_t)r + i]);
        most = fmax(most, fabs(moved)), position = fmax(position, fabs(l->x[k / r]));
        size[k] = fabs(l->x[k / r]) / (h * h) + fabs(l->u[k % r * (size_t)n + k / r]);
    }
    if (!(h * h * most <= DM_NEWTON_UNSEEN * position)) return 0;
    return dm_sparse_is_within(&l->S, l->R, size, DM_NEWTON_UNSEEN, size + n * (size_t)r);
}

/* Accelerations from those in u on, until a change is below the tolerance or no longer gets
 * smaller; the matrix is made anew where that goes slowly, but one that is kept. */
static dm_status iterate(dm_stepper *s, layout *l, const double *q, double t, double h, int kept) {
    const uint32_t n = s->model->n, r = l->table.r;
    double last = INFINITY;
    dm_status status = DM_OK;
    for (int pass = 1; status == DM_OK; pass++) {
        double step = 0.0, size = 0.0;
        residual(s, l, q, q + n, t, h);
        status = solve(s, l);
        if (status != DM_OK) return status;
        for (uint32_t i = 0; i < r; i++)
            for (uint32_t k = 0; k < n; k++) {
                const double d = l->dx[(size_t)k * r + i];
                double *u = l->u + (size_t)i * n + k;
                *u += d;
                step = fmax(step, fabs(d));
                size = fmax(size, fabs(*u));
                if (!isfinite(d)) return DM_NOT_FINITE;
            }
        s->report.iterations = pass, s->report.newton++;
        s->report.residual = step;
        if (step <= s->tolerance * size || (step >= 0.5 * last && step <= 1e-11 * size)) break;
        if (pass >= DM_NEWTON_STALLED && step > 0.3 * last && is_unseen(l, n, h)) break;
        if (pass >= s->max_iterations || pass >= MOST) return DM_NO_CONVERGENCE;
        if (kept && step > DM_PLACE_SLOW * last) return DM_NO_CONVERGENCE;
        if (step > 0.3 * last) status = prepare(s, l, q, q + n, t, h, 1);
        last = step;
    }
    s->report.solves++;
    return status;
}

/* with the matrix of an earlier step; where that does not serve u is 0 again */
static dm_status newton_kept(dm_stepper *s, layout *l, const double *q, double t, double h) {
    const double *place = dm_stage_place_of(&l->kept);
    const size_t n = s->model->n;
    dm_status status = DM_OK;
    if (l->h != h || !dm_stage_place_has(&l->kept)) {
        status = prepare(s, l, place, place + n, place[2 * n], h, 0);
        if (status == DM_OK) dm_stage_place_make(&l->kept);
    }
    if (status == DM_OK) status = iterate(s, l, q, t, h, 1);
    if (status != DM_OK) memset(l->u, 0, l->table.r * n * sizeof *l->u);
    return status;
}

/* with the matrix of its own start */
static dm_status newton_own(dm_stepper *s, layout *l, const double *q, double t, double h,
                            int first) {
    dm_status status = prepare(s, l, q, q + s->model->n, t, h, 0);
    if (status == DM_OK && first) dm_stage_place_make(&l->kept);
    if (status == DM_OK) status = iterate(s, l, q, t, h, 0);
    if (first && (status != DM_OK || !l->kept.is_made)) dm_stage_place_leave(&l->kept);
    return status;
}

static dm_status newton(dm_stepper *s, layout *l, const double *q, double t, double h,
                        int from_rest) {
    dm_place_use use = DM_PLACE_OWN;
    if (!l->constant && from_rest) use = dm_stage_place_ask(&l->kept, q, t, h);
    if (use == DM_PLACE_KEPT) {
        const dm_status status = newton_kept(s, l, q, t, h);
        if (status == DM_OK) dm_stage_place_ended(&l->kept, s->report.iterations);
        if (status == DM_OK || status == DM_STOPPED) return status;
        use = dm_stage_place_failed(&l->kept, q, t);
    }
    return newton_own(s, l, q, t, h, use == DM_PLACE_NEW);
}

/* a dm_stage_try: of a shorter step accelerations are the same */
static dm_status find_accelerations(dm_stepper *s, const double *state, double t, double h,
                                    double ratio) {
    layout *l = (layout *)(void *)s->work;
    const size_t all = l->table.r * (size_t)s->model->n * sizeof *l->u;
    if (ratio > 0.0)
        memcpy(l->u, l->root, all);
    else
        memset(l->u, 0, all);
    const dm_status status = newton(s, l, state, t, h, ratio == 0.0);
    if (status == DM_OK && !l->constant) memcpy(l->root, l->u, all);
    return status;
}

/* where its matrix was made is what a step leaves */
static size_t memory(dm_stepper *s, double **place) {
    const layout *l = (const layout *)(const void *)s->work;
    *place = l->kept.memory;
    return dm_stage_place_memory(&l->kept);
}

static dm_status start(dm_stepper *s, double *state, double t, double h) {
    (void)state, (void)t;
    dm_stage_place_clear(&((layout *)(void *)s->work)->kept, h);
    return DM_OK;
}

/* q1 and p1 of the forces at the accelerations that were found, into the compensated state */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    layout *l = (layout *)(void *)s->work;
    const uint32_t n = s->model->n, r = l->table.r;
    double *p = state + n, *low_q = p + n, *low_p = low_q + n;
    const dm_status status = l->constant ? find_accelerations(s, state, t, h, 0.0)
                                         : dm_stage_continue(s, find_accelerations, state, t, h);
    if (status != DM_OK) return status;
    for (uint32_t m = 0; m < r; m++) {
        place(s, l, state, p, t, h, m);
        evaluate(s, l, m, 0);
    }
    for (uint32_t k = 0; k < r * n; k++)
        if (!isfinite(l->F[k])) return DM_NOT_FINITE;
    for (uint32_t k = 0; k < n; k++) {
        const double w = s->model->inverse_mass[k];
        double dq = h * (w * p[k]), dp = 0.0;
        for (uint32_t m = 0; m < r; m++) {
            const double F = l->F[(size_t)m * n + k];
            dq += h * h * dm_weighted(l->table.mean[m], w * F);
            dp += h * dm_weighted(l->table.b[m], F);
        }
        dm_sum_add(state + k, low_q + k, dq);
        dm_sum_add(p + k, low_p + k, dp);
    }
    return DM_OK;
}

const dm_engine dm_engine_stage_worked = {
    .works = 1,
    .fits = dm_stage_field_fits,
    .wants = dm_stage_field_wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .memory = memory,
    .close = close,
};
