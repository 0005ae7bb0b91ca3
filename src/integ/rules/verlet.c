/* verlet.c - Stoermer-Verlet: explicit when L = T(v) - V(q, t), else Lobatto IIIA-IIIB of 2
 * stages. */
#include "integ/split/splitting.h"
#include "integ/stage/lanes/stage_lanes.h"

static const char *check(const dm_rule *rule) {
    return rule->count ? "verlet takes no argument" : NULL;
}

static int order(const dm_rule *rule) {
    (void)rule;
    return 2;
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    return dm_splitting_fits(m) ? DM_WANT_FORCE : dm_stage_wants(rule, m);
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return dm_splitting_fits(m) ? dm_splitting_work(m) : dm_stage_work(2, 2, m);
}

static void basis(dm_galerkin *g, const dm_rule *rule) {
    dm_quadrature q;
    (void)rule;
    dm_quadrature_lobatto(&q, 2);
    dm_galerkin_collocation(g, &q);
}

static dm_status open_implicit(dm_stepper *s) {
    dm_galerkin g;
    basis(&g, s->rule);
    return dm_stage_open(s, &g);
}

static dm_status open(dm_stepper *s) {
    static const double one = 1.0;
    dm_splitting table;
    if (!dm_splitting_fits(s->model)) return open_implicit(s);
    dm_splitting_compose(&table, &one, 1);
    dm_splitting_open(s, &table);
    return DM_OK;
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

const dm_method dm_method_verlet = {
    .name = "verlet",
    .signature = "verlet",
    .doc = "Stoermer-Verlet, kick-drift-kick, order 2; explicit, one force a step, when "
           "L = T(v) - V(q, t) with constant mass, else the implicit Lobatto IIIA-IIIB "
           "pair of 2 "
           "stages (HLW I.1.4, VI.6.2).",
    .orders = "2",
    .stages = "2",
    .cost = "1 force; else 2 n unknowns",
    .instances = "verlet:2:1",
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC | DM_KEEPS,
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
