#include "integ/method/lift.h"

#include "base/doubles.h"
#include "integ/method/lift_inside.h"

#include "numbers/small_copy.h"

#include <math.h>
#include <string.h>

/* the struct, in doubles */
static size_t head(void) {
    return dm_doubles(sizeof(dm_lift));
}

/* doubles of the arrays, without what the base leaves to its next step */
static size_t arrays(const dm_model *m) {
    const size_t n = m->n, d = m->group->momenta;
    return dm_state_size(m->n) + 4 * n + 1 + n * d + 2 * d + d * d + 2 * d + n * d + 2 * n +
           DM_LIFT_STATE + 8 * n;
}

/* Does the lift of polynomials serve the rule? */
static int is_kept(const dm_rule *rule, const dm_model *m) {
    const dm_model *lifted = m->group->liftable ? m->group->lifted : NULL;
    if (!lifted || m->constraints) return 0;
    const dm_engine *e = dm_rule_engine(rule, lifted);
    const int keeps = e->keeps_quadratic && e->keeps_quadratic(rule, lifted);
    return (m->n == m->group->momenta || keeps) && !dm_rule_fits(rule, lifted);
}

/* Of two homogeneous ones that with the stage kernel, where the rule wants it. */
const dm_model *dm_lifted_model(const dm_rule *rule, const dm_model *m) {
    const dm_homogeneous *h = &m->group->homogeneous;
    if (is_kept(rule, m)) return m->group->lifted;
    if (!h->lifted || h->lifted->structure & DM_HAMILTONIAN || dm_rule_fits(rule, h->lifted))
        return h->lifted;
    const unsigned wants = dm_rule_engine(rule, h->lifted)->wants(rule, h->lifted);
    return wants & (DM_WANT_STAGE | DM_WANT_STAGE_LATER) ? h->lifted : h->plain;
}

/* that steps the lifted model */
static const dm_engine *engine_of(const dm_rule *rule, const dm_model *m) {
    return dm_rule_engine(rule, dm_lifted_model(rule, m));
}

/* Why coordinates with a relation that are not homogeneous cannot be stepped. */
static const char *refusal(const dm_model *m) {
    if (!m->group->liftable)
        return "it goes by the collective lift, and this group is no level set of quadratic "
               "functions; lie(s) steps any group";
    if (m->constraints)
        return "it goes by the collective lift, which knows no constraints and forces on this "
               "group; lie(s) does";
    if (!m->group->lifted)
        return "it goes by the collective lift, which needs an L quadratic in the velocity; lie(s) "
               "does without";
    return "it goes by the collective lift, and does not keep the quadratic functions by which "
           "this group is given, nor are its coordinates homogeneous, as those of SO(3), SU(2), "
           "SE(3) and SL(n) are; gauss(s), midpoint, compositions of midpoint and lie(s) do, "
           "lie(s, lobatto(s + 1)) is the pair, and rotations(k) is for an L that splits";
}

/* The lift was made before, where it can be. */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    const dm_method *method = rule->method;
    const dm_model *above = m->group->homogeneous.lifted;
    if (method->traits & DM_OF_FUNCTIONS)
        return "its functions are of coordinates, and a group has none; lie(s) takes their place";
    if (method->traits & DM_OWN_TIME)
        return "it has a time of its own, which the lift to coordinates does not carry; lie(s) and "
               "gauss(s) take steps of h";
    if (is_kept(rule, m)) return NULL;
    if (!m->group->homogeneous.rates) return refusal(m);
    if (!above) return "the lift of its system to coordinates was not made";
    const char *why = dm_rule_fits(rule, above);
    if (why && method->splitting && method->splitting(NULL, rule))
        return "its kicks and drifts do not split an L on a group; rotations(k) splits it into "
               "turns and kicks, and kahan-li(6, midpoint) composes implicit steps";
    return why;
}

/* The lift is there when a run asks. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return 0;
}

/* The workspace of the base twice: its memory is no more than that. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    return head() + arrays(m) + 2 * engine_of(rule, m)->work(rule, dm_lifted_model(rule, m));
}

/* Arrays in the order of the struct, then the workspace of the base. */
static void lay_out(dm_lift *l, double *memory) {
    const size_t n = l->n, d = l->d;
    l->lifted = memory;
    l->in = l->lifted + dm_state_size(l->n);
    l->X = l->in + 2 * n + 1;
    l->J = l->X + n * d;
    l->gram = l->J + d;
    l->below = l->gram + d * d + 2 * d;
    l->gauge = l->below + 2 * n + d;
    l->base.work = l->gauge + n * d + 2 * n;
}

/* The base shares the report; its memory is copied, since a restart wants all in one piece. */
static dm_status open(dm_stepper *s) {
    dm_lift *l = dm_lift_of(s);
    const dm_model *m = s->model;
    *l = (dm_lift){.base = *s, .group = m->group, .n = m->n, .d = m->group->momenta};
    l->base.model = dm_lifted_model(s->rule, m);
    l->above = l->base.model == m->group->lifted ? NULL : &m->group->homogeneous;
    memset(s->work + head(), 0, arrays(m) * sizeof *s->work);
    lay_out(l, s->work + head());
    l->memory = l->base.work + engine_of(s->rule, m)->work(s->rule, l->base.model);
    if (l->above) {
        dm_kernel_prepare(&l->above->up, l->X);
        dm_kernel_prepare(&l->above->down, l->below);
    } else {
        dm_kernel_prepare(&m->group->directions, l->X);
        dm_kernel_prepare(&m->group->directions, l->gauge);
        dm_kernel_prepare(&m->group->momentum, l->J);
    }
    const dm_status status = dm_stepper_open(&l->base);
    s->outside = l->base.outside;
    s->report = l->base.report;
    l->base_memory = dm_stepper_memory(&l->base, &l->of_base);
    l->memory[DM_LIFT_MARK] = 0.0;
    return status;
}

static size_t memory(dm_stepper *s, double **place) {
    const dm_lift *l = dm_lift_of(s);
    *place = l->memory;
    return DM_LIFT_STATE + 8 * (size_t)l->n + l->base_memory;
}

/* what the base has left to its next step, into the memory; and back */
static void keep_base(dm_lift *l) {
    if (!l->base_memory) return;
    dm_fresh_copy(l->memory + DM_LIFT_STATE + 8 * (size_t)l->n, l->of_base, l->base_memory);
}

static void give_base(dm_lift *l) {
    if (!l->base_memory) return;
    memcpy(l->of_base, l->memory + DM_LIFT_STATE + 8 * (size_t)l->n,
           l->base_memory * sizeof(double));
}

/* (q, p) of an element and its momentum, into the lifted state */
static dm_status rise(dm_lift *l, const double *state) {
    const size_t n = l->n;
    memcpy(l->lifted, state, n * sizeof *state);
    memcpy(l->lifted + 2 * n, state + 2 * n, n * sizeof *state);
    if (!l->above) return dm_lift_momentum(l, state, state + n);
    memcpy(l->in, state, 2 * n * sizeof *state);
    l->in[2 * n] = 0.0;
    dm_kernel_eval(&l->above->up, l->in, l->X);
    memcpy(l->lifted + n, l->X, n * sizeof *state);
    memset(l->lifted + 3 * n, 0, n * sizeof *state);
    l->memory[DM_LIFT_SINCE] = 0.0;
    return DM_OK;
}

/* the lifted state: the one that was left with this state of the run, or a new one */
dm_status dm_lift_enter(dm_lift *l, const double *state) {
    const size_t n = l->n;
    const double *kept = l->memory + DM_LIFT_STATE;
    give_base(l);
    if (l->memory[DM_LIFT_MARK] != 0.0 && memcmp(kept, state, 4 * n * sizeof *state) == 0) {
        memcpy(l->lifted, kept + 4 * n, 4 * n * sizeof *state);
        return DM_OK;
    }
    return rise(l, state);
}

/* what `down` makes of the lifted state, into `below` */
static void look_down(dm_lift *l) {
    memcpy(l->in, l->lifted, 2 * l->n * sizeof *l->in);
    l->in[2 * l->n] = 0.0;
    dm_kernel_eval(&l->above->down, l->in, l->below);
}

/* Multiples of q that came to be large or small: by powers of 2, which no digit sees. */
static dm_status rescale(dm_lift *l) {
    const size_t n = l->n;
    if ((l->memory[DM_LIFT_SINCE] += 1.0) < DM_LIFT_SELDOM) return DM_OK;
    l->memory[DM_LIFT_SINCE] = 0.0;
    look_down(l);
    for (size_t i = 0; i < n; i++) {
        const double s = l->below[n + l->d + i];
        if (s > 0.25 && s < 4.0) continue;
        if (!(isfinite(s) && s > 0.0)) return DM_NOT_FINITE;
        int power;
        frexp(s, &power);
        for (size_t k = i; k < 4 * n; k += n)
            l->lifted[k] = ldexp(l->lifted[k], k / n % 2 ? power : -power);
    }
    return DM_OK;
}

dm_status dm_lift_settle(dm_lift *l) {
    return l->above ? rescale(l) : dm_lift_regauge(l);
}

/* element and momentum of the lifted state */
static void descend(dm_lift *l, double *state) {
    const size_t n = l->n;
    if (l->above) {
        look_down(l);
        memcpy(state, l->below, n * sizeof *state);
        memcpy(state + n, l->below + n, l->d * sizeof *state);
        memset(state + 2 * n, 0, n * sizeof *state);
        return;
    }
    memcpy(l->in, l->lifted, 2 * n * sizeof *state);
    dm_kernel_eval(&l->group->momentum, l->in, l->J);
    memcpy(state, l->lifted, n * sizeof *state);
    memcpy(state + n, l->J, l->d * sizeof *state);
    memcpy(state + 2 * n, l->lifted + 2 * n, n * sizeof *state);
}

/* the state of the run, and the memory of where it came of */
void dm_lift_leave(dm_lift *l, double *state) {
    const size_t n = l->n;
    double *kept = l->memory + DM_LIFT_STATE;
    descend(l, state);
    l->memory[DM_LIFT_MARK] = 1.0;
    memcpy(kept, state, 4 * n * sizeof *state);
    memcpy(kept + 4 * n, l->lifted, 4 * n * sizeof *state);
    keep_base(l);
}

/* Nothing is known of the state of the first step, which a step on the side has not got yet. */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    dm_lift *l = dm_lift_of(s);
    const dm_status status = dm_stepper_start(&l->base, state, t, h);
    l->memory[DM_LIFT_MARK] = 0.0;
    keep_base(l);
    return status;
}

/* The lifted state is entered and left once a burst. */
static dm_status advance(dm_stepper *s, double *state, double t, double h, long count, long *done) {
    dm_lift *l = dm_lift_of(s);
    *done = 0;
    dm_status status = dm_lift_enter(l, state);
    if (status != DM_OK) return status;
    for (; *done < count && status == DM_OK; *done += status == DM_OK) {
        status = l->base.engine->step(&l->base, l->lifted, t + (double)*done * h, h);
        if (status == DM_OK && l->n > l->d) status = dm_lift_settle(l);
    }
    if (*done) dm_lift_leave(l, state); /* else the state is as it was */
    s->report = l->base.report;
    return status;
}

/* A burst of one. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    long done;
    return advance(s, state, t, h, 1, &done);
}

/* Those of the base: covectors on the group and above it have the same multipliers. */
static void impulses(const dm_stepper *s, double *out) {
    const dm_stepper *base = &dm_lift_of(s)->base;
    base->engine->impulses(&dm_lift_of(s)->base, out);
}

/* The base has seen the lifted state last. */
static const char *why(dm_stepper *s, const double *state, dm_status status) {
    dm_lift *l = dm_lift_of(s);
    (void)state;
    return l->base.engine->why ? l->base.engine->why(&l->base, l->lifted, status) : NULL;
}

/* What is outside is the base's. */
static void close(dm_stepper *s) {
    dm_stepper_close(&dm_lift_of(s)->base);
    s->outside = NULL;
}

const dm_engine dm_engine_lift = {
    .hamiltonian = 1,
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .advance = advance,
    .memory = memory,
    .widen = dm_lift_widen,
    .advance_lanes = dm_lift_advance_lanes,
    .impulses = impulses,
    .why = why,
    .close = close,
};
