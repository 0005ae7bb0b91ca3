#include "integ/rules/discrete.h"

#include "base/doubles.h"
#include "linalg/lu.h"
#include "linalg/solve/newton.h"
#include "mech/constraints.h"

#include <math.h>
#include <string.h>

/* unknowns z = (V[s][n], p0[n]) */
typedef struct {
    const dm_discrete_problem *in;
    dm_stage_table table;
    uint32_t n, m;                 /* dim Q, unknowns */
    double *x, *curve;             /* arguments and outputs of the stage kernel, one point */
    double *push;                  /* of the force there: f[n], f_q[n*n], f_v[n*n]; zeros: none */
    double *z, *q, *v, *p, *force; /* unknowns; [r][n] of the points */
    double *end, *form;            /* [n], [n*n] */
    double *J, *right, *scratch;   /* at the root; a right-hand side; of Newton */
    double size;
} between;

/* Velocities of all stages, and the momentum at the start. */
static size_t unknowns(const dm_galerkin *g, uint32_t n, uint32_t pieces) {
    return ((size_t)g->s * pieces + 1) * n;
}

/* In the order of lay_out; scratch also has the pivots of the two-form. */
size_t dm_discrete_work(const dm_galerkin *g, uint32_t n, uint32_t pieces) {
    const size_t N = pieces ? pieces : 1, m = unknowns(g, n, (uint32_t)N), nn = (size_t)n * n;
    const size_t r = (size_t)g->q.r * N;
    return dm_stage_table_size((size_t)g->s * N, r) +
           (N > 1 ? dm_stage_table_size((size_t)g->s, (size_t)g->q.r) : 0) + (2 * (size_t)n + 1) +
           (2 * n + 3 * nn) + (n + 2 * nn) + m + 4 * r * n + n + nn + m * m + m +
           dm_newton_work((uint32_t)m) + m;
}

/* w/N, from all digits */
static dm_weight part_of(dm_weight w, uint32_t N) {
    return dm_weight_of(dm_weight_exact(w) / N);
}

/* The table of N steps of a collocation that follow each other: in piece k behind it b_j of every
 * piece before. */
static void fill_pieces(dm_stage_table *out, const dm_stage_table *one, uint32_t N,
                        double *memory) {
    const uint32_t s = one->s, all = s * N;
    *out = (dm_stage_table){.s = all, .r = all, .a = (dm_weight *)(void *)memory};
    out->d = out->a + (size_t)all * all;
    out->b = out->d + (size_t)all * all;
    out->c = out->b + all;
    out->beta = out->c + all;
    memset(out->a, 0, 2 * (size_t)all * all * sizeof *out->a);
    for (uint32_t i = 0; i < all; i++) {
        const uint32_t k = i / s, own = i % s;
        out->b[i] = part_of(one->b[own], N);
        out->beta[i] = part_of(one->beta[own], N);
        out->c[i] = dm_weight_of((k + dm_weight_exact(one->c[own])) / N);
        out->d[i * (size_t)all + i] = dm_weight_of(1.0L);
        for (uint32_t j = 0; j < (k + 1) * s; j++)
            out->a[i * (size_t)all + j] =
                part_of(j < k * s ? one->beta[j % s] : one->a[own * s + j % s], N);
    }
}

/* The table of the problem; where the memory goes on. */
static double *lay_table(between *e, const dm_discrete_problem *in, double *memory) {
    const uint32_t N = in->pieces ? in->pieces : 1;
    dm_stage_table one;
    dm_stage_table_fill(&one, in->basis, memory);
    memory += dm_stage_table_size(one.s, one.r);
    e->table = one;
    if (N == 1) return memory;
    fill_pieces(&e->table, &one, N, memory);
    return memory + dm_stage_table_size(e->table.s, e->table.r);
}

/* A struct of pointers into the memory, which the result points into as well. */
static between lay_out(const dm_discrete_problem *in, double *memory) {
    const size_t n = in->model->n;
    const size_t m = unknowns(in->basis, (uint32_t)n, in->pieces ? in->pieces : 1);
    between e = {.in = in, .n = (uint32_t)n, .m = (uint32_t)m};
    memory = lay_table(&e, in, memory);
    const size_t r = e.table.r;
    e.x = dm_take(&memory, 2 * n + 1);
    e.curve = dm_take(&memory, 2 * n + 3 * n * n);
    e.push = dm_take(&memory, n + 2 * n * n);
    e.z = dm_take(&memory, m);
    e.q = dm_take(&memory, r * n);
    e.v = dm_take(&memory, r * n);
    e.p = dm_take(&memory, r * n);
    e.force = dm_take(&memory, r * n);
    e.end = dm_take(&memory, n);
    e.form = dm_take(&memory, n * n);
    e.J = dm_take(&memory, m * m);
    e.right = dm_take(&memory, m);
    e.scratch = dm_take(&memory, dm_newton_work((uint32_t)m) + m);
    return e;
}

/* Is there a force? */
static const dm_constraints *forced(const between *e) {
    const dm_constraints *c = e->in->model->constraints;
    return c && c->forced ? c : NULL;
}

/* += f, there: not to what the kernel gave, where an L_q that is constant stays from the start */
static void push(between *e, double *force) {
    if (!forced(e)) return;
    dm_kernel_eval(&forced(e)->force_curve, e->x, e->push);
    for (uint32_t k = 0; k < e->n; k++) force[k] += e->push[k];
}

/* Q_i, Qdot_i and the kernels there, whose first outputs stay for the result. */
static void place(between *e, uint32_t i, const double *z) {
    const uint32_t n = e->n, s = e->table.s;
    double *Q = e->q + i * (size_t)n, *v = e->v + i * (size_t)n;
    memset(Q, 0, n * sizeof *Q);
    memset(v, 0, n * sizeof *v);
    for (uint32_t j = 0; j < s; j++) {
        dm_weighted_add(Q, e->table.a[i * s + j], z + j * (size_t)n, n);
        dm_weighted_add(v, e->table.d[i * s + j], z + j * (size_t)n, n);
    }
    for (uint32_t k = 0; k < n; k++) Q[k] = e->in->q0[k] + e->in->h * Q[k];
    memcpy(e->x, Q, n * sizeof *Q);
    memcpy(e->x + n, v, n * sizeof *v);
    e->x[2 * n] = e->in->t + e->in->h * dm_weight_double(e->table.c[i]);
    dm_kernel_eval(&e->in->model->stage, e->x, e->curve);
    memcpy(e->force + i * (size_t)n, e->curve, n * sizeof *v);
    push(e, e->force + i * (size_t)n);
    memcpy(e->p + i * (size_t)n, e->curve + n, n * sizeof *v);
}

/* J[row block][column block] += w B, or w B^T */
static void add(const between *e, double *block, double w, const double *B, int transposed) {
    const uint32_t n = e->n;
    for (uint32_t i = 0; i < n && w != 0.0; i++)
        for (uint32_t j = 0; j < n; j++)
            block[i * (size_t)e->m + j] +=
                w * B[transposed ? j * (size_t)n + i : i * (size_t)n + j];
}

/* of point i: the terms of stage.c */
static void add_point(between *e, double *r, double *J, uint32_t i) {
    const dm_stage_table *t = &e->table;
    const uint32_t n = e->n, s = t->s;
    const size_t nn = (size_t)n * n;
    const double *qq = e->curve + 2 * n, *qv = qq + nn, *vv = qv + nn, h = e->in->h;
    const double *force = e->force + i * (size_t)n, *fq = e->push + n, *fv = fq + nn;
    const double b = dm_weight_double(t->b[i]);
    for (uint32_t j = 0; j < s; j++) {
        const double d = dm_weight_double(t->d[i * s + j]);
        const double w = h * (dm_weight_double(t->a[i * s + j]) - dm_weight_double(t->beta[j]));
        for (uint32_t k = 0; k < n; k++) {
            const double term = b * (w * force[k] + d * e->curve[n + k]);
            r[j * (size_t)n + k] += term;
            e->size = fmax(e->size, fabs(term));
        }
        for (uint32_t k = 0; J && (w != 0.0 || d != 0.0) && k < s; k++) {
            if (dm_weight_double(t->a[i * s + k]) == 0.0 &&
                dm_weight_double(t->d[i * s + k]) == 0.0)
                continue;
            double *block = J + j * (size_t)n * e->m + k * (size_t)n;
            const double ha = h * dm_weight_double(t->a[i * s + k]);
            const double dk = dm_weight_double(t->d[i * s + k]);
            add(e, block, b * w * ha, qq, 0);
            add(e, block, b * w * dk, qv, 0);
            add(e, block, b * w * ha, fq, 0);
            add(e, block, b * w * dk, fv, 0);
            add(e, block, b * d * ha, qv, 1);
            add(e, block, b * d * dk, vv, 0);
        }
    }
}

/* - beta_j p0, and sum_j beta_j V_j - (q1 - q0)/h */
static void add_ends(between *e, double *r, double *J, const double *z) {
    const uint32_t n = e->n, s = e->table.s;
    const double *p0 = z + s * (size_t)n;
    double *gap = r + s * (size_t)n;
    for (uint32_t k = 0; k < n; k++) gap[k] = -(e->in->q1[k] - e->in->q0[k]) / e->in->h;
    for (uint32_t j = 0; j < s; j++) {
        const dm_weight beta = e->table.beta[j];
        dm_weighted_add(gap, beta, z + j * (size_t)n, n);
        for (uint32_t k = 0; k < n; k++) {
            const size_t row = j * (size_t)n + k, column = s * (size_t)n + k;
            r[row] -= dm_weighted(beta, p0[k]);
            if (!J) continue;
            J[row * e->m + column] = -dm_weight_double(beta);
            J[column * e->m + row] = dm_weight_double(beta);
        }
    }
}

/* For dm_newton; z = (V[s][n], p0[n]). */
static dm_status equation(void *ctx, double *r, double *J, const double *z) {
    between *e = ctx;
    e->size = 0.0;
    memset(r, 0, e->m * sizeof *r);
    if (J) memset(J, 0, (size_t)e->m * e->m * sizeof *J);
    for (uint32_t i = 0; i < e->table.r; i++) {
        place(e, i, z);
        add_point(e, r, J, i);
    }
    add_ends(e, r, J, z);
    return DM_OK;
}

/* V = (q1 - q0)/h, and L_v at the first point */
static void guess(between *e) {
    const uint32_t n = e->n, s = e->table.s;
    for (uint32_t j = 0; j < s; j++)
        for (uint32_t k = 0; k < n; k++)
            e->z[j * (size_t)n + k] = (e->in->q1[k] - e->in->q0[k]) / e->in->h;
    place(e, 0, e->z);
    memcpy(e->z + s * (size_t)n, e->p, n * sizeof *e->z);
}

/* dp0/dq1: the equations differentiated, 1/h on the right of the condition on the end */
static dm_status find_form(between *e) {
    const uint32_t n = e->n, m = e->m;
    uint32_t *pivot = (uint32_t *)(void *)e->scratch;
    dm_status status = dm_lu_factor(e->J, pivot, m);
    for (uint32_t k = 0; k < n && status == DM_OK; k++) {
        memset(e->right, 0, m * sizeof *e->right);
        e->right[m - n + k] = 1.0 / e->in->h;
        dm_lu_solve(e->right, e->J, pivot, m);
        for (uint32_t i = 0; i < n; i++) e->form[i * (size_t)n + k] = e->right[m - n + i];
    }
    return status;
}

/* the action and the momentum at the end */
static void finish(between *e, dm_discrete *out) {
    const uint32_t n = e->n;
    out->value = 0.0;
    const double *vv = e->curve + 2 * (size_t)n + 2 * (size_t)n * n; /* of the last point */
    for (size_t k = 0; k < (size_t)n * n; k++) out->mass = fmax(out->mass, fabs(vv[k]));
    memcpy(e->end, e->z + e->m - n, n * sizeof *e->end);
    for (uint32_t i = 0; i < e->table.r; i++) {
        const double hb = e->in->h * dm_weight_double(e->table.b[i]);
        double L = 0.0;
        memcpy(e->x, e->q + i * (size_t)n, n * sizeof *e->x);
        memcpy(e->x + n, e->v + i * (size_t)n, n * sizeof *e->x);
        e->x[2 * n] = e->in->t + e->in->h * dm_weight_double(e->table.c[i]);
        dm_kernel_prepare(&e->in->model->value, &L);
        dm_kernel_eval(&e->in->model->value, e->x, &L);
        out->value += hb * L;
        for (uint32_t k = 0; k < n; k++) e->end[k] += hb * e->force[i * (size_t)n + k];
    }
}

/* One sum of zeros, which NaN and infinity survive. */
static int is_finite(const between *e, const dm_discrete *out) {
    double sum = 0.0 * out->value; /* 0 * infinity is NaN */
    for (uint32_t k = 0; k < e->n; k++) sum += 0.0 * (e->z[e->m - e->n + k] + e->end[k]);
    for (size_t k = 0; k < (size_t)e->n * e->n; k++) sum += 0.0 * e->form[k];
    return sum == 0.0;
}

/* Once more at the root with its matrix: residual and two-form are those of the solution itself. */
dm_status dm_discrete_solve(dm_discrete *out, const dm_discrete_problem *problem, double *work) {
    between e = lay_out(problem, work);
    const dm_newton_problem newton = {.m = e.m,
                                      .equation = equation,
                                      .ctx = &e,
                                      .size = &e.size,
                                      .tolerance = 4e-15,
                                      .max_iterations = 50};
    dm_newton_report report;
    dm_kernel_prepare(&problem->model->stage, e.curve);
    memset(e.push, 0, (e.n + 2 * (size_t)e.n * e.n) * sizeof *e.push);
    if (forced(&e)) dm_kernel_prepare(&forced(&e)->force_curve, e.push);
    guess(&e);
    dm_status status = dm_newton(e.z, &newton, e.scratch, &report);
    if (status != DM_OK) return status;
    equation(&e, e.right, e.J, e.z);
    *out = (dm_discrete){.iterations = report.iterations, .points = e.table.r};
    for (uint32_t k = 0; k < e.m; k++) out->residual = fmax(out->residual, fabs(e.right[k]));
    status = find_form(&e);
    if (status != DM_OK) return status;
    finish(&e, out);
    out->p0 = e.z + e.m - e.n, out->p1 = e.end, out->two_form = e.form;
    out->q = e.q, out->v = e.v, out->p = e.p;
    return is_finite(&e, out) ? DM_OK : DM_NOT_FINITE;
}
