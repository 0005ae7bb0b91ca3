#include "integ/rules/explicit/gsl_step.h"

#include "base/doubles.h"
#include "chain/virtual_work.h"
#include "integ/rules/explicit/runge_kutta.h"
#include "mech/constraints.h"
#include "numbers/small_copy.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

/* at the head of the workspace */
typedef struct {
    const dm_model *m;
    double *x;                          /* [2n+1] (q, v, t) */
    double *force, *constraint;         /* [n] dL/dq; a force beside L */
    double *y, *error, *before, *after; /* [2n] state, its error, slopes at the ends */
    double *end;                        /* [2n] where `after` holds */
    double end_time;
    int has_end;
    double *scratch, *beside; /* of the Legendre transform; of forces on a field beside L */
    dm_status status;         /* why the last right-hand side failed */
    long evaluations;
    dm_cells_split *massless; /* of values without mass, or NULL */
} explicit;

/* The struct at the head of the workspace, in doubles. */
static size_t head(void) {
    return dm_doubles(sizeof(explicit));
}

/* Arguments, two forces, five states of 2n, the Legendre transform. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n;
    (void)rule;
    return head() + 2 * n + 1 + 2 * n + 10 * n + dm_legendre_work(m) + dm_work_room(m->work) +
           dm_runge_kutta_massless_work(m);
}

static dm_status settle(const explicit *e, double *q, double t) {
    return e->massless ? dm_cells_split_settle(e->massless, q, t) : DM_OK;
}

/* H_p and -H_q of an H that is given */
static int field_of(explicit *e, double t, const double y[], double slope[]) {
    const size_t n = e->m->n;
    memcpy(e->x, y, 2 * n * sizeof *y);
    e->x[2 * n] = t;
    dm_kernel_prepare(&e->m->field, slope);
    dm_kernel_eval(&e->m->field, e->x, slope);
    e->evaluations++;
    return GSL_SUCCESS;
}

/* The callback of GSL; what went wrong is kept, since GSL knows only that something did. */
static int right_hand_side(double t, const double y[], double slope[], void *params) {
    explicit *e = params;
    const uint32_t n = e->m->n;
    if (e->m->structure & DM_HAMILTONIAN) return field_of(e, t, y, slope);
    double *v = e->x + n;
    memset(v, 0, n * sizeof *v); /* a function of (q, p, t) alone: no memory of the last v */
    e->status = dm_legendre_inverse(e->m, v, y, y + n, t, e->scratch);
    if (e->status != DM_OK) return GSL_EBADFUNC;
    dm_small_copy(e->x, y, n);
    e->x[2 * n] = t;
    e->status = settle(e, e->x, t);
    if (e->status != DM_OK) return GSL_EBADFUNC;
    dm_kernel_eval(&e->m->force, e->x, e->force);
    dm_small_copy(slope, v, n);
    dm_small_copy(slope + n, e->force, n);
    dm_constraints_add_force(slope + n, e->m->constraints, e->x, e->constraint);
    if (e->m->work) dm_work_add(e->m->work, slope + n, e->x, e->beside);
    e->evaluations++;
    return GSL_SUCCESS;
}

/* GSL allocates its own memory, which close gives back. */
static dm_status open(dm_stepper *s) {
    explicit *e = (explicit *)(void *)s->work;
    const size_t n = s->model->n;
    *e = (explicit){.m = s->model, .x = s->work + head()};
    e->force = e->x + 2 * n + 1;
    e->constraint = e->force + n;
    e->y = e->constraint + n;
    e->error = e->y + 2 * n;
    e->before = e->error + 2 * n;
    e->after = e->before + 2 * n;
    e->end = e->after + 2 * n;
    e->scratch = e->end + 2 * n;
    e->beside = e->scratch + dm_legendre_work(e->m);
    e->massless = dm_runge_kutta_massless(e->m, e->beside + dm_work_room(e->m->work));
    memset(e->x, 0, (2 * n + 1) * sizeof *e->x);
    if (!(s->model->structure & DM_HAMILTONIAN)) dm_kernel_prepare(&s->model->force, e->force);
    gsl_set_error_handler_off();
    s->outside =
        gsl_odeiv2_step_alloc(*(const gsl_odeiv2_step_type *const *)s->rule->method->table, 2 * n);
    return s->outside ? DM_OK : DM_NO_MEMORY;
}

/* Also after an open that failed. */
static void close(dm_stepper *s) {
    if (s->outside) gsl_odeiv2_step_free(s->outside);
    s->outside = NULL;
}

/* slope at the start: the one at the end of the last step when that is where we are */
static int start_slope(explicit *e, double t) {
    const size_t size = 2 * (size_t)e->m->n * sizeof *e->y;
    const int same_time = (e->m->structure & DM_AUTONOMOUS) || e->end_time == t;
    if (e->has_end && same_time && memcmp(e->end, e->y, size) == 0) {
        memcpy(e->before, e->after, size);
        return GSL_SUCCESS;
    }
    return right_hand_side(t, e->y, e->before, e);
}

/* The slope at the end is the first one of the next step, if that begins where this ends. */
static dm_status apply(explicit *e, dm_stepper *s, double t, double h) {
    const size_t size = 2 * (size_t)e->m->n;
    const gsl_odeiv2_system system = {right_hand_side, NULL, size, e};
    e->status = DM_OK;
    int failed = start_slope(e, t);
    e->has_end = 0;
    if (!failed)
        failed =
            gsl_odeiv2_step_apply(s->outside, t, h, e->y, e->error, e->before, e->after, &system);
    if (failed) return e->status != DM_OK ? e->status : DM_NOT_FINITE;
    for (size_t i = 0; i < size; i++)
        if (!isfinite(e->y[i])) return DM_NOT_FINITE;
    memcpy(e->end, e->y, size * sizeof *e->end);
    e->end_time = t + h;
    e->has_end = !e->massless; /* else the last slope is of values that are not yet settled */
    return settle(e, e->y, t + h);
}

/* Values without mass are what the others make of them. */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    (void)h;
    return settle((const explicit *)(const void *)s->work, state, t);
}

/* the low-order parts of the state are not used: these rules do not sum with compensation */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    explicit *e = (explicit *)(void *)s->work;
    const size_t size = 2 * (size_t)e->m->n * sizeof *state;
    memcpy(e->y, state, size);
    e->evaluations = 0;
    const dm_status status = apply(e, s, t, h);
    s->report.evaluations += e->evaluations;
    if (status != DM_OK) return status;
    memcpy(state, e->y, size);
    return DM_OK;
}

const dm_engine dm_engine_gsl = {
    .hamiltonian = 1,
    .works = 1,
    .fits = dm_runge_kutta_fits,
    .wants = dm_runge_kutta_wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .close = close,
};
