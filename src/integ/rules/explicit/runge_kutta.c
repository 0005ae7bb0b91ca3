#include "integ/rules/explicit/runge_kutta.h"

#include "base/doubles.h"
#include "chain/virtual_work.h"
#include "integ/method/cache.h"
#include "integ/method/hamilton.h"
#include "mech/constraints.h"
#include "numbers/compensated.h"

#include <string.h>

/* at the head of the workspace */
typedef struct {
    const dm_model *m;
    dm_kernel kernel; /* Hamilton's equations, outputs 0: the Legendre transform and L_q apart */
    const dm_runge_kutta *table;
    double *c;     /* [stages] times of the stages */
    double *x;     /* [2n+1] (q, p, t) of a stage; without a kernel (q, v, t) */
    double *slope; /* [stages][2n] */
    double *out;   /* [3n] of the kernel */
    double *next;  /* [4n] */
    double *p;     /* [n] momentum of a stage */
    double *scratch;
    double *beside;           /* of forces on a field beside L */
    dm_cells_split *massless; /* of values without mass, or NULL */
} layout;

/* Forces are evaluated at every stage, but controls are held for a whole step. */
const char *dm_runge_kutta_fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return m->constraints && m->constraints->controls
               ? "it knows no controls; take midpoint or gauss"
               : NULL;
}

/* The mass is needed for v(q, p) unless it is constant and known. */
unsigned dm_runge_kutta_wants(const dm_rule *rule, const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    const unsigned mass = (m->structure & simple) == simple ? 0 : DM_WANT_MASS;
    (void)rule;
    if (m->structure & DM_HAMILTONIAN) return DM_WANT_FIELD;
    return DM_WANT_FORCE | mass | (m->constraints ? DM_WANT_CONSTRAINT_FORCE : 0) |
           (m->massless ? DM_WANT_CURVATURE : 0);
}

size_t dm_runge_kutta_massless_work(const dm_model *m) {
    return m->massless ? dm_cells_split_work(m) : 0;
}

/* No kick or drift is made: only what is before one. */
dm_cells_split *dm_runge_kutta_massless(const dm_model *m, double *work) {
    const dm_splitting verlet = {.stages = 1, .b = {0.5, 0.5}, .a = {1.0}};
    return m->massless ? dm_cells_split_open(m, &verlet, 1, 1, work) : NULL;
}

/* What the row brings. */
static const dm_runge_kutta *table_of(const dm_rule *rule) {
    return rule->method->table;
}

/* The struct at the head of the workspace, in doubles. */
static size_t head(void) {
    return dm_doubles(sizeof(layout));
}

/* In the order of the struct. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n, stages = table_of(rule)->stages;
    return head() + stages + 2 * n + 1 + stages * 2 * n + 3 * n + 4 * n + n + dm_legendre_work(m) +
           dm_work_room(m->work) + dm_runge_kutta_massless_work(m);
}

/* Hamilton's equations as one kernel, where L is quadratic in v; the model keeps it for all
 * tableaus. */
static void find_kernel(layout *e) {
    static const char maker;
    if (e->m->structure & DM_HAMILTONIAN) {
        e->kernel = e->m->field;
        return;
    }
    if (dm_cache_find(&e->kernel, e->m, &maker, 0)) return;
    if (!dm_hamilton_build(&e->kernel, e->m, 1))
        e->kernel.outputs = 0;
    else
        dm_cache_add(e->m, &maker, 0, &e->kernel, 1);
}

/* Times of the stages are row sums of the tableau. */
static dm_status open(dm_stepper *s) {
    layout *e = (layout *)(void *)s->work;
    const size_t n = s->model->n;
    *e = (layout){.m = s->model, .table = table_of(s->rule), .c = s->work + head()};
    const uint32_t stages = e->table->stages;
    e->x = e->c + stages;
    e->slope = e->x + 2 * n + 1;
    e->out = e->slope + stages * 2 * n;
    e->next = e->out + 3 * n;
    e->p = e->next + 4 * n;
    e->scratch = e->p + n;
    e->beside = e->scratch + dm_legendre_work(e->m);
    e->massless = dm_runge_kutta_massless(e->m, e->beside + dm_work_room(e->m->work));
    for (uint32_t i = 0; i < stages; i++) {
        e->c[i] = 0.0;
        for (uint32_t j = 0; j < i; j++) e->c[i] += e->table->a[i * stages + j];
    }
    find_kernel(e);
    dm_kernel_prepare(e->kernel.outputs ? &e->kernel : &s->model->force, e->out);
    return DM_OK;
}

/* Two neighbouring numbers of a row: 2n is even. */
typedef double two __attribute__((vector_size(16), aligned(8), may_alias));

/* sum[k] += h sum_j weight[j] slope[j][k], k < columns: the sums of eight columns stay in
 * registers. Row "P3 rk8" of make bench. */
static void add_slopes(double *sum, const double *weight, double h, const double *slope,
                       uint32_t rows, size_t columns) {
    size_t k = 0;
    for (; k + 8 <= columns; k += 8) {
        two *to = (two *)(void *)(sum + k), s0 = to[0], s1 = to[1], s2 = to[2], s3 = to[3];
        for (uint32_t j = 0; j < rows; j++) {
            const double a = h * weight[j];
            const two *row = (const two *)(const void *)(slope + j * columns + k);
            if (a == 0.0) continue;
            s0 += a * row[0], s1 += a * row[1], s2 += a * row[2], s3 += a * row[3];
        }
        to[0] = s0, to[1] = s1, to[2] = s2, to[3] = s3;
    }
    for (; k < columns; k += 2) {
        two *to = (two *)(void *)(sum + k), s = *to;
        for (uint32_t j = 0; j < rows; j++) {
            const double a = h * weight[j];
            if (a != 0.0) s += a * *(const two *)(const void *)(slope + j * columns + k);
        }
        *to = s;
    }
}

/* x = (q0, p0, t) + h sum_j a_ij slope_j */
static void place(layout *e, const double *state, uint32_t i, double h) {
    const size_t n = e->m->n;
    double *x = e->x;
    memcpy(x, state + 2 * n, 2 * n * sizeof *x);
    add_slopes(x, e->table->a + i * e->table->stages, h, e->slope, i, 2 * n);
    for (size_t k = 0; k < 2 * n; k++) x[k] += state[k];
}

/* 0: there is no kernel, or the mass matrix is not positive and it cannot be trusted; that of an H
 * has no pivots */
static int by_kernel(layout *e, double *slope) {
    const uint32_t n = e->m->n;
    if (!e->kernel.outputs) return 0;
    dm_kernel_eval(&e->kernel, e->x, e->out);
    for (uint32_t k = 2 * n; k < e->kernel.outputs; k++)
        if (!(e->out[k] > 0.0)) return 0;
    memcpy(slope, e->out, 2 * n * sizeof *slope);
    return 1;
}

/* Newton's method for v begins at rest: a slope is a function of its arguments alone. */
static dm_status by_legendre(layout *e, double *slope) {
    const uint32_t n = e->m->n;
    double *v = e->x + n;
    memcpy(e->p, v, n * sizeof *v);
    memset(v, 0, n * sizeof *v); /* a function of (q, p, t) alone */
    const dm_status status = dm_legendre_inverse(e->m, v, e->x, e->p, e->x[2 * n], e->scratch);
    if (status != DM_OK) return status;
    memcpy(slope, v, n * sizeof *slope);
    dm_kernel_prepare(&e->m->force, slope + n);
    dm_kernel_eval(&e->m->force, e->x, slope + n);
    dm_constraints_add_force(slope + n, e->m->constraints, e->x, e->out);
    dm_work_add(e->m->work, slope + n, e->x, e->beside);
    return DM_OK;
}

static dm_status settle(const layout *e, double *q, double t) {
    return e->massless ? dm_cells_split_settle(e->massless, q, t) : DM_OK;
}

/* state + h sum_i b_i slope_i */
static dm_status finish(layout *e, double *state, double t, double h) {
    const uint32_t n = e->m->n, stages = e->table->stages;
    const double *b = e->table->a + stages * stages;
    double sum = 0.0; /* 0 * infinity is NaN */
    memcpy(e->next, state, 4 * (size_t)n * sizeof *state);
    for (uint32_t k = 0; k < 2 * n; k++) {
        const double *slope = e->slope + k;
        double change = 0.0;
        for (uint32_t i = 0; i < stages; i++, slope += 2 * n) change += b[i] * *slope;
        dm_sum_add(e->next + k, e->next + 2 * n + k, h * change);
        sum += 0.0 * e->next[k];
    }
    if (sum != 0.0) return DM_NOT_FINITE;
    const dm_status status = settle(e, e->next, t + h);
    if (status != DM_OK) return status;
    memcpy(state, e->next, 4 * (size_t)n * sizeof *state);
    return DM_OK;
}

/* Slopes of all stages lie in the workspace until the end of the step. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    layout *e = (layout *)(void *)s->work;
    const size_t n = s->model->n;
    dm_status status = DM_OK;
    const uint32_t stages = e->table->stages;
    for (uint32_t i = 0; i < stages && status == DM_OK; i++) {
        double *slope = e->slope + i * 2 * n;
        place(e, state, i, h);
        e->x[2 * n] = t + e->c[i] * h;
        status = settle(e, e->x, e->x[2 * n]);
        if (status == DM_OK && !by_kernel(e, slope)) status = by_legendre(e, slope);
    }
    s->report.evaluations += stages;
    s->report.solves++;
    return status == DM_OK ? finish(e, state, t, h) : status;
}

/* Values without mass are what the others make of them. */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    (void)h;
    return settle((const layout *)(const void *)s->work, state, t);
}

const dm_engine dm_engine_runge_kutta = {
    .hamiltonian = 1,
    .works = 1,
    .fits = dm_runge_kutta_fits,
    .wants = dm_runge_kutta_wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
};
