/* symplectic_euler.c - Ld = h L(q0, v) or h L(q1, v) with v = (q1 - q0)/h. */
#include "integ/split/splitting.h"
#include "integ/stage/lanes/stage_lanes.h"

#include <string.h>

/* a: L at q0, kick then drift; b: L at q1, drift then kick */
static int takes_end(const dm_rule *rule) {
    return rule->count && strcmp(rule->arg[0].rule->name, "b") == 0;
}

static const char *check(const dm_rule *rule) {
    const dm_rule *side = rule->count == 1 ? rule->arg[0].rule : NULL;
    if (!rule->count) return NULL;
    if (!side || side->count || strlen(side->name) != 1 || !strchr("ab", side->name[0]))
        return "symplectic-euler is written alone (then it is a), or with a or b";
    return NULL;
}

static int order(const dm_rule *rule) {
    (void)rule;
    return 1;
}

/* one velocity, one point at an end */
static void basis(dm_galerkin *g, const dm_rule *rule) {
    *g = (dm_galerkin){.s = 1, .node = {0.5L}, .q = {.r = 1, .b = {1.0L}}};
    g->q.c[0] = takes_end(rule) ? 1.0L : 0.0L;
}

/* a table that begins with a kick takes its force from the end of the step before: a drift of
 * length zero comes first */
static const dm_splitting kick_drift = {2, {0.0, 1.0, 0.0}, {0.0, 1.0}};
static const dm_splitting drift_kick = {1, {0.0, 1.0}, {1.0}};

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    return dm_splitting_fits(m) ? DM_WANT_FORCE : dm_stage_wants(rule, m);
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return dm_splitting_fits(m) ? dm_splitting_work(m) : dm_stage_work(1, 1, m);
}

static dm_status open(dm_stepper *s) {
    dm_galerkin g;
    if (dm_splitting_fits(s->model)) {
        dm_splitting_open(s, takes_end(s->rule) ? &drift_kick : &kick_drift);
        return DM_OK;
    }
    basis(&g, s->rule);
    return dm_stage_open(s, &g);
}

static dm_status start(dm_stepper *s, double *state, double t, double h) {
    return dm_splitting_fits(s->model) ? DM_OK : dm_stage_start(s, state, t, h);
}

static size_t memory(dm_stepper *s, double **place) {
    return dm_splitting_fits(s->model) ? 0 : dm_stage_memory(s, place);
}

static dm_status step(dm_stepper *s, double *state, double t, double h) {
    return dm_splitting_fits(s->model) ? dm_splitting_step(s, state, t, h)
                                       : dm_stage_step(s, state, t, h);
}

static dm_status advance(dm_stepper *s, double *state, double t, double h, long count, long *done) {
    return dm_splitting_fits(s->model) ? dm_splitting_advance(s, state, t, h, count, done)
                                       : dm_advance_by_step(s, state, t, h, count, done);
}

static int widen(dm_stepper *s, dm_lanes *x) {
    return dm_splitting_fits(s->model) ? dm_splitting_widen(s, x) : dm_stage_widen(s, x);
}

static void advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count) {
    if (dm_splitting_fits(s->model))
        dm_splitting_advance_lanes(s, x, t, h, count);
    else
        dm_stage_advance_lanes(s, x, t, h, count);
}

const dm_method dm_method_symplectic_euler = {
    .name = "symplectic-euler",
    .signature = "symplectic-euler[(a|b)]",
    .doc = "Symplectic Euler, order 1: a takes L at the start of the step (kick, then "
           "drift), b at its end (drift, then "
           "kick); one force a step when L = T(v) - V(q, t), else n unknowns; b is the "
           "adjoint of a (HLW I.1.9, VI.3.1).",
    .orders = "1",
    .stages = "1",
    .cost = "1 force; else n unknowns",
    .instances = "symplectic-euler(a):1:1; symplectic-euler(b):1:1",
    .traits = DM_SYMPLECTIC,
    .check = check,
    .order = order,
    .basis = basis,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .advance = advance,
    .memory = memory,
    .widen = widen,
    .advance_lanes = advance_lanes,
};
