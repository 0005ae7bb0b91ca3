/* stage_engine.c - rules of stages: the row has a basis, the rest is here. */
#include "integ/constrained/constrained.h"
#include "integ/method/hamilton.h"
#include "integ/phase/phase.h"
#include "integ/split/splitting.h"
#include "integ/stage/lanes/stage_lanes.h"
#include "integ/stage/stage.h"
#include "integ/stage/stage_sparse.h"
#include "integ/stage/stage_worked.h"
#include "integ/stage/sweep/sweep.h"

static const dm_engine *choose(const dm_rule *rule, const dm_model *m) {
    if (m->structure & DM_HAMILTONIAN) return dm_phase_choose(rule, m);
    if (dm_splitting_steps(rule, m)) return &dm_engine_splitting;
    if (m->worked) return &dm_engine_stage_worked;
    if (m->structure & DM_CELLS) return &dm_engine_stage_sparse;
    return m->constraints ? &dm_engine_constrained : &dm_engine_stage;
}

/* a number of sweeps leaves no way back to Newton's method: they must be there */
static const char *fits_sweeps(const dm_galerkin *g, const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    if (g->s > DM_SWEEP_WIDTH) return "a number of sweeps is for 8 stages at most";
    if (m->structure & DM_LOOPS && m->n <= DM_MODEL_DENSE)
        return NULL; /* separable, and written out for this rule */
    if (m->source.graph && ((m->structure & simple) == simple || dm_hamilton_fits(m))) return NULL;
    return "a number of sweeps needs a traced L quadratic in v, of 16 coordinates at most where "
           "the mass varies; leave it out";
}

static const char *fits(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_stage_basis(&g, rule, m);
    if (!g.s)
        return "b and B of this pair differ (or a weight is zero), so it is symplectic for L = "
               "T(v) - V(q, t) with constant mass alone";
    return g.sweeps ? fits_sweeps(&g, m) : NULL;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_stage_basis(&g, rule, m);
    return dm_stage_work((size_t)g.s, (size_t)g.q.r, m);
}

static dm_status open(dm_stepper *s) {
    dm_galerkin g;
    dm_stage_basis(&g, s->rule, s->model);
    return dm_stage_open(s, &g);
}

const dm_engine dm_engine_stage = {
    .choose = choose,
    .fits = fits,
    .wants = dm_stage_wants,
    .work = work,
    .open = open,
    .start = dm_stage_start,
    .step = dm_stage_step,
    .memory = dm_stage_memory,
    .widen = dm_stage_widen,
    .advance_lanes = dm_stage_advance_lanes,
};
