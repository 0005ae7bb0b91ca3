/* gauss.c - Gauss collocation of any stage number. */
#include "integ/method/hamilton.h"
#include "integ/method/cache.h"
#include "integ/stage/lanes/stage_lanes.h"
#include "integ/stage/sweep/sweep.h"
#include "integ/constrained/constrained.h"

#include <math.h>
#include <string.h>

static int stages(const dm_rule *rule) {
    return (int)rule->arg[0].number;
}

/* sweeps a step, 0: to round-off */
static int sweeps(const dm_rule *rule) {
    return rule->count > 1 ? (int)rule->arg[1].number : 0;
}

static int is_count(double number, int most) {
    return number >= 1 && number <= most && number == floor(number);
}

static const char *check(const dm_rule *rule) {
    enum { SWEEPS = 50 };
    if (rule->count < 1 || rule->count > 2 || rule->arg[0].rule ||
        !is_count(rule->arg[0].number, DM_QUADRATURE_NODES))
        return "gauss takes one whole number of stages from 1 to 32";
    if (rule->count == 2 && (rule->arg[1].rule || !is_count(rule->arg[1].number, SWEEPS)))
        return "the second argument of gauss is a whole number of sweeps from 1 to 50";
    return NULL;
}

static const char *fits(const dm_rule *rule, const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    if (!sweeps(rule)) return NULL;
    if (m->constraints) return "a number of sweeps is for systems without constraints; leave it out";
    if (rule->arg[0].number > DM_SWEEP_WIDTH) return "a number of sweeps is for 8 stages at most";
    if (m->structure & DM_LOOPS && m->n <= DM_MODEL_DENSE)
        return NULL; /* separable, and written out for this rule */
    if (m->source.graph && ((m->structure & simple) == simple || dm_hamilton_fits(m))) return NULL;
    return "a number of sweeps needs a traced L quadratic in v, of 16 coordinates at "
           "most where the mass "
           "varies; leave it out";
}

static int order(const dm_rule *rule) {
    return 2 * stages(rule);
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t s = (size_t)stages(rule);
    return dm_stage_work(s, s, m);
}

static void basis(dm_galerkin *g, const dm_rule *rule) {
    dm_quadrature q;
    dm_quadrature_gauss(&q, stages(rule));
    dm_galerkin_collocation(g, &q);
    g->sweeps = sweeps(rule);
}

/* zeros of a polynomial are dear next to a few steps: they stay with the model */
static dm_status open(dm_stepper *s) {
    static const char maker;
    const double key = stages(s->rule);
    dm_galerkin g;
    const double *kept = dm_cache_numbers(s->model, &maker, &key, 1);
    if (!kept) {
        basis(&g, s->rule);
        dm_cache_leave(s->model, &maker, &key, 1, (const double *)(const void *)&g.q,
                      sizeof g.q / sizeof(double));
        return dm_stage_open(s, &g);
    }
    dm_quadrature q;
    memcpy(&q, kept, sizeof q);
    dm_galerkin_collocation(&g, &q);
    g.sweeps = sweeps(s->rule);
    return dm_stage_open(s, &g);
}

const dm_method dm_method_gauss = {
    .name = "gauss",
    .signature = "gauss(s [, sweeps])",
    .doc = "Gauss collocation with s stages, order 2 s; implicit, s n unknowns a step "
           "(HLW II.1.3; variational: HLW VI.6.4, Leok 2.4). The step equation is solved "
           "to round-off; a "
           "number of sweeps, as in gauss(8, 4), ends the fixed-point iteration there: "
           "cheaper, symplectic "
           "and symmetric only up to the error left. Constraints, rolling, forces: s "
           "multipliers each, same order (Jay 2007, 2009).",
    .orders = "2 s",
    .stages = "s",
    .cost = "s n unknowns",
    .instances = "gauss(1):1:0; gauss(2):2:0; gauss(3):3:0; gauss(4):4:0; gauss(5):5:0; gauss(6):6:0; gauss(7):7:0; gauss(8):8:0",
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC | DM_KEEPS | DM_CONSTRAINTS,
    .check = check,
    .fits = fits,
    .order = order,
    .basis = basis,
    .wants = dm_stage_wants,
    .work = work,
    .open = open,
    .start = dm_stage_start,
    .step = dm_stage_step,
    .memory = dm_stage_memory,
    .impulses = dm_constrained_impulses,
    .widen = dm_stage_widen,
    .advance_lanes = dm_stage_advance_lanes,
};
