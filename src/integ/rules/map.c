/* map.c - a step that is given as a function: (q0, p0) -> (q1, p1), mostly with implicit functions
 * in it (dm.root), as the step of a discrete Lagrangian that is reduced. */
#include "base/largest.h"
#include "integ/method/method.h"
#include "mech/constraints.h"

#include <math.h>
#include <string.h>

/* The kernel takes (q0[n], p0[n]) and gives q1[n], p1[n] and, with k constraints, holonomic and
 * rolling, the impulses [k] of the step, which the function has solved for. x and out are its
 * buffers; at and left those of the constraints, at = (q0, q1, 0, multipliers, which are 0). What a
 * step leaves to the next one is what the kernel remembers of its implicit functions. */
typedef struct {
    const dm_kernel *kernel;
    uint32_t n, k;
    double *x, *out, *roots, *at, *left;
} map;

/* holonomic and rolling ones */
static uint32_t constraints(const dm_model *m) {
    return m->constraints ? m->constraints->holonomic + m->constraints->rolling : 0;
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return DM_WANT_MAP | (constraints(m) ? DM_WANT_HOLONOMIC | DM_WANT_ROLLING : 0);
}

static size_t at_size(const dm_model *m) {
    return constraints(m) ? 2 * (size_t)m->n + 1 + constraints(m) : 0;
}

/* of the larger one of both kernels */
static size_t left_size(const dm_model *m) {
    return constraints(m) * (1 + 3 * (size_t)m->n);
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return 4 * (size_t)m->n + constraints(m) + m->map.memory_size + at_size(m) + left_size(m);
}

static map lay_out(const dm_stepper *s) {
    map e = {.kernel = &s->model->map, .n = s->model->n, .k = constraints(s->model), .x = s->work};
    e.out = e.x + 2 * (size_t)e.n;
    e.roots = e.out + 2 * (size_t)e.n + e.k;
    e.at = e.roots + e.kernel->memory_size;
    e.left = e.at + at_size(s->model);
    return e;
}

static void copy(double *to, const double *from, size_t count) {
    if (count) memcpy(to, from, count * sizeof *to);
}

static dm_status open(dm_stepper *s) {
    const map e = lay_out(s);
    memset(e.at, 0, at_size(s->model) * sizeof *e.at);
    dm_kernel_prepare(e.kernel, e.out);
    dm_kernel_remember(e.kernel, 1);
    copy(e.roots, e.kernel->memory, e.kernel->memory_size);
    return DM_OK;
}

/* a run depends on its start alone, not on the member before it */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    (void)state, (void)t, (void)h;
    return open(s);
}

static size_t memory(dm_stepper *s, double **place) {
    const map e = lay_out(s);
    *place = e.roots;
    return e.kernel->memory_size;
}

/* the largest of the first `count` outputs of a kernel of constraints at x */
static double largest_left(const map *e, const dm_kernel *kernel, const double *x, uint32_t count) {
    double largest = 0.0;
    if (count) {
        dm_kernel_prepare(kernel, e->left);
        dm_kernel_eval(kernel, x, e->left);
    }
    for (uint32_t c = 0; c < count; c++) largest = dm_largest(largest, e->left[c]);
    return largest;
}

/* What the map leaves of g(q1) and phi(q0, q1). */
static void report_constraints(dm_stepper *s, const map *e) {
    const dm_constraints *t = s->model->constraints;
    const size_t n = e->n;
    if (!e->k) return;
    copy(e->at, e->x, n);
    copy(e->at + n, e->out, n);
    const double on = largest_left(e, &t->rolling_kernel, e->at, t->rolling);
    s->report.rolling = fmax(s->report.rolling, on);
    copy(e->at, e->out, n);
    const double off = largest_left(e, &t->holonomic_kernel, e->at, t->holonomic);
    s->report.constraint = fmax(s->report.constraint, off);
}

/* sums are not compensated: q1 is found, not added up */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    const map e = lay_out(s);
    const size_t n = e.n;
    (void)t, (void)h;
    for (size_t i = 0; i < 2 * n; i++) e.x[i] = state[i] + state[2 * n + i];
    copy(e.kernel->memory, e.roots, e.kernel->memory_size);
    dm_kernel_eval(e.kernel, e.x, e.out);
    s->report.solves++;
    s->report.evaluations++;
    for (size_t i = 0; i < 2 * n + e.k; i++)
        if (!isfinite(e.out[i])) return DM_NOT_FINITE;
    report_constraints(s, &e);
    copy(e.roots, e.kernel->memory, e.kernel->memory_size);
    copy(state, e.out, 2 * n);
    memset(state + 2 * n, 0, 2 * n * sizeof *state);
    return DM_OK;
}

/* all of it at the start of the step, as for `del` */
static void impulses(const dm_stepper *s, double *out) {
    const map e = lay_out(s);
    copy(out, e.out + 2 * (size_t)e.n, e.k);
    for (uint32_t c = 0; c < e.k; c++) out[e.k + c] = 0.0;
}

static const dm_engine engine = {
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .memory = memory,
    .impulses = impulses,
};

const dm_method dm_method_map = {
    .name = "map",
    .signature = "map",
    .doc = "The step that a discrete Lagrangian brings with it as a function, map = f(q, p): that "
           "of a reduced one is found with the unreduced equations of Leok 2.3, solved for x1 and "
           "psi together.",
    .orders = "that of Ld: Ld:order()",
    .stages = "-",
    .cost = "one evaluation of the map",
    .instances = "",
    .traits = DM_SYMPLECTIC | DM_FOR_PAIRS | DM_CONSTRAINTS | DM_LOOSE_MOMENTUM,
    .engine = &engine,
};
