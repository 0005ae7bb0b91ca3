/* map.c - a step that is given as a function: (q0, p0) -> (q1, p1), mostly with implicit functions
 * in it (dm.root), as the step of a discrete Lagrangian that is reduced. */
#include "base/largest.h"
#include "integ/method/method.h"
#include "mech/constraints.h"

#include <math.h>
#include <string.h>

/* The kernel takes (q0[n], p0[n]) and gives q1[n], p1[n] and, with k constraints, the impulses [k]
 * of the step, which the function has solved for. x and out are its buffers. What a step leaves to
 * the next one is what the kernel remembers of its implicit functions. */
typedef struct {
    const dm_kernel *kernel;
    uint32_t n, k;
    double *x, *out, *roots;
} map;

static uint32_t constraints(const dm_model *m) {
    return m->constraints ? m->constraints->holonomic : 0;
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return DM_WANT_MAP | (constraints(m) ? DM_WANT_HOLONOMIC : 0);
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return 4 * (size_t)m->n + constraints(m) + m->map.memory_size;
}

static map lay_out(const dm_stepper *s) {
    map e = {.kernel = &s->model->map, .n = s->model->n, .k = constraints(s->model), .x = s->work};
    e.out = e.x + 2 * (size_t)e.n;
    e.roots = e.out + 2 * (size_t)e.n + e.k;
    return e;
}

static void copy(double *to, const double *from, size_t count) {
    if (count) memcpy(to, from, count * sizeof *to);
}

static dm_status open(dm_stepper *s) {
    const map e = lay_out(s);
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
    .traits = DM_SYMPLECTIC | DM_FOR_PAIRS | DM_HOLONOMIC | DM_LOOSE_MOMENTUM,
    .engine = &engine,
};
