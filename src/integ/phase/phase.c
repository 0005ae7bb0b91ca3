/* phase.c - a step of stages on H: which road, its end, and what it leaves to the next one. */
#include "integ/phase/phase.h"

#include "integ/method/cache.h"
#include "integ/phase/phase_lanes.h"
#include "integ/split/splitting.h"
#include "numbers/compensated.h"
#include "numbers/small_copy.h"

#include <math.h>
#include <string.h>

enum { EMPTY, FULL = DM_SWEPT_FULL, PATIENCE = 16, MOST_UNKNOWNS = 4000 };

static const double USUAL = 0.01; /* contraction, squared, where none was measured */

/* ---- the memory: see stage_sweep.h ---- */

int dm_phase_memory_fits(const dm_phase *g) {
    const double *memory = g->memory;
    return memory[DM_SWEPT_STEP] == g->h && memory[DM_SWEPT_MARK] == FULL &&
           memcmp(memory + DM_SWEPT_END, g->state, 4 * (size_t)g->n * sizeof *memory) == 0;
}

/* sweeps failed not long ago */
static int is_stiff(const dm_phase *g) {
    return g->memory[DM_SWEPT_STEP] == g->h && g->memory[DM_SWEPT_MARK] < EMPTY;
}

/* after a step, whose end is in the state; a step by Newton's method makes sweeps wait where they
 * failed from its predecessor */
static void keep(dm_phase *g, int swept) {
    double *memory = g->memory;
    const size_t n = g->n;
    if (memory[DM_SWEPT_STEP] != g->h) return;
    if (!swept && g->field.lanes) {
        if (memory[DM_SWEPT_MARK] < EMPTY)
            memory[DM_SWEPT_MARK] += 1;
        else if (memory[DM_SWEPT_MARK] == FULL)
            memory[DM_SWEPT_MARK] = -PATIENCE;
        if (memory[DM_SWEPT_MARK] < EMPTY) return;
        memory[DM_SWEPT_RATE] = USUAL;
    }
    memory[DM_SWEPT_MARK] = FULL;
    memcpy(memory + DM_SWEPT_END, g->state, 4 * n * sizeof *memory);
    memcpy(memory + DM_SWEPT_END + 4 * n, g->u, 2 * n * g->width * sizeof *memory);
}

/* From the first mark to u of the last stage. */
static size_t memory_of(dm_stepper *stepper, double **place) {
    dm_phase *g = dm_phase_of(stepper);
    *place = g->memory;
    return dm_phase_memory_size(g);
}

/* of h alone: the first step continues nothing, whatever the state is */
static dm_status start(dm_stepper *stepper, double *state, double t, double h) {
    dm_phase *g = dm_phase_of(stepper);
    (void)state, (void)t;
    memset(g->memory, 0, dm_phase_memory_size(g) * sizeof *g->memory);
    g->memory[DM_SWEPT_STEP] = h;
    return DM_OK;
}

/* ---- the step ---- */

/* state += h sum_j b_j u_j, with compensation; 0 or NaN */
static double add_stages(dm_phase *g) {
    const uint32_t n2 = 2 * g->n;
    double bad = 0.0;
    for (uint32_t k = 0; k < n2; k++) {
        double sum = 0.0;
        for (uint32_t j = 0; j < g->r; j++)
            sum += dm_weighted(g->hb[j], g->u[(size_t)k * g->width + j]);
        dm_sum_add(g->state + k, g->state + n2 + k, sum);
        bad += 0.0 * g->state[k];
    }
    return bad;
}

/* the state is in place: what it was comes back where its end is not finite */
static dm_status finish(dm_phase *g) {
    g->end.state = g->state;
    dm_small_copy(g->before, g->state, 4 * g->n);
    if ((g->row ? g->row->finish(&g->end) : add_stages(g)) == 0.0) return DM_OK;
    memcpy(g->state, g->before, 4 * (size_t)g->n * sizeof *g->state);
    return DM_NOT_FINITE;
}

/* by sweeps, and what they leave by Newton's method; u of the stages is in g->u then */
static dm_status step(dm_stepper *stepper, double *state, double t, double h) {
    dm_phase *g = dm_phase_of(stepper);
    dm_status status = DM_NO_CONVERGENCE;
    g->state = state;
    g->t = t;
    g->evaluations = 0;
    if (g->h != h) dm_phase_scale(g, h);
    const int tried = g->field.lanes && !is_stiff(g);
    if (tried) status = dm_phase_sweep(g, stepper);
    const int swept = status == DM_OK;
    if (!swept) status = dm_phase_newton(g, stepper);
    stepper->report.solves++;
    stepper->report.newton += stepper->report.iterations;
    stepper->report.evaluations += g->evaluations;
    if (status == DM_OK) status = finish(g);
    if (status == DM_OK) keep(g, swept);
    return status;
}

/* ---- the engine ---- */

/* Symplectic Euler, verlet and what has a table of kicks and drifts split an H that separates. */
const dm_engine *dm_phase_choose(const dm_rule *rule, const dm_model *m) {
    const dm_method *method = rule->method;
    const int splits = method->splitting && method->splitting(NULL, rule);
    return splits && m->structure & DM_SEPARABLE ? &dm_engine_phase_split : &dm_engine_phase;
}

/* velocities at the points themselves */
static int is_collocated(const dm_galerkin *g) {
    if (g->s != g->q.r) return 0;
    for (int j = 0; j < g->s && g->s > 1 && !g->tableau; j++)
        if (g->node[j] != g->q.c[j]) return 0;
    return 1;
}

/* Pairs with two sets of weights, points without a velocity, and what is too large. */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_stage_basis(&g, rule, m);
    if (!g.s)
        return "b and B of this pair differ (or a weight is zero), so it is symplectic for L = "
               "T(v) - V(q, t) with constant mass alone";
    if (!is_collocated(&g))
        return "it has more points than velocities, which needs a Lagrangian, and this H has none "
               "(d2H/dp2 is singular, or H is not quadratic in p); take gauss(s) or lobatto(s)";
    if (g.sweeps && g.q.r > DM_SWEEP_WIDTH) return "a number of sweeps is for 8 stages at most";
    if (2.0 * m->n * g.q.r > MOST_UNKNOWNS)
        return "2 n s unknowns a step are more than 4000, too many for its dense equations; take "
               "fewer stages, or an explicit rule";
    return NULL;
}

/* b_i a_ij + b_j a_ji = b_i b_j for all stages */
static int is_quadratic(const dm_galerkin *g) {
    static const long double SAME = 1e-15L;
    long double beta[DM_QUADRATURE_NODES], d[DM_QUADRATURE_NODES],
        a[DM_QUADRATURE_NODES][DM_QUADRATURE_NODES];
    dm_lagrange(d, beta, g->node, g->s, 1.0L);
    for (int i = 0; i < g->s && !g->tableau; i++) dm_lagrange(d, a[i], g->node, g->s, g->q.c[i]);
    for (int i = 0; i < g->s; i++)
        for (int j = 0; j < g->s; j++) {
            const long double aij = g->tableau ? g->a[i][j] : a[i][j],
                              aji = g->tableau ? g->a[j][i] : a[j][i];
            const long double left = g->q.b[i] * aij + g->q.b[j] * aji;
            if (fabsl(left - g->q.b[i] * g->q.b[j]) > SAME) return 0;
        }
    return 1;
}

/* So that q and p have the same coefficients: Gauss collocation. The model keeps the answer. */
static int keeps_quadratic(const dm_rule *rule, const dm_model *m) {
    static const char maker;
    dm_galerkin g;
    double key[DM_STAGE_KEY];
    dm_stage_basis(&g, rule, m);
    if (!is_collocated(&g)) return 0;
    if (g.tableau) return is_quadratic(&g);
    const uint32_t keys = dm_stage_key(key, &g);
    const double *kept = dm_cache_numbers(m, &maker, key, keys);
    if (kept) return *kept != 0.0;
    const double answer = is_quadratic(&g);
    dm_cache_leave(m, &maker, key, keys, &answer, 1);
    return answer != 0.0;
}

/* The curve is for Newton's method alone. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return DM_WANT_FIELD | DM_WANT_FIELD_CURVE;
}

const dm_engine dm_engine_phase = {
    .hamiltonian = 1,
    .fits = fits,
    .keeps_quadratic = keeps_quadratic,
    .wants = wants,
    .work = dm_phase_work,
    .open = dm_phase_open,
    .start = start,
    .step = step,
    .memory = memory_of,
    .widen = dm_phase_widen,
    .advance_lanes = dm_phase_advance_lanes,
};
