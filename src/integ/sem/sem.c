/* sem.c - symplectic-energy-momentum steps as an engine with a time of its own. */
#include "base/doubles.h"
#include "integ/rules/galerkin.h"
#include "integ/sem/sem_places.h"
#include "integ/sem/sem_warm.h"
#include "linalg/solve/newton.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

static const double SHORTEST = 0.2; /* of the first step */
static const double FURTHEST = 2.0; /* times the last step, or a part of it */

/* What a step leaves to the next one: places, and what sem_warm.c keeps. */
static size_t memory_size(uint32_t n, uint32_t unknowns) {
    return DM_SEM_PLACES * dm_sem_place_size(n) + dm_sem_warm_size(unknowns);
}

/* The time decides: a force of another's making could not be told from L. */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    if (m->structure & DM_AUTONOMOUS) return NULL;
    return m->source.graph ? "L depends on time, so that the motion keeps no energy that could "
                             "choose the steps"
                           : "L is not traced, so that whether it depends on time, and keeps an "
                             "energy that could choose the steps, is not known";
}

/* Is the action that of the midpoint of a straight line? */
static int is_middle(const dm_galerkin *g) {
    return g->s == 1 && g->q.r == 1 && g->q.c[0] == 0.5L;
}

/* Are there sweeps? */
static int is_swept(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_galerkin_basis(&g, rule);
    return is_middle(&g) && dm_sem_sweep_fits(m);
}

/* The energy has a kernel of its own; the mass is for the first guess of the velocity. Sweeps need
 * the tables where they do not contract. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    const unsigned plain = DM_SEPARABLE | DM_CONSTANT_MASS;
    const unsigned swept = DM_WANT_POTENTIAL | DM_WANT_STAGE_LATER;
    return (is_swept(rule, m) ? swept : DM_WANT_STAGE) | DM_WANT_ENERGY |
           ((m->structure & plain) == plain ? 0 : (unsigned)DM_WANT_MASS);
}

/* The larger of what Newton's method for V and the Legendre transform need. */
static size_t scratch_size(const dm_model *m, size_t velocities) {
    const size_t a = dm_newton_work((uint32_t)velocities), b = dm_legendre_work(m);
    return a > b ? a : b;
}

/* In the order of `open`. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_galerkin_basis(&g, rule);
    const size_t n = m->n, K = (size_t)g.s * n + 1;
    return dm_doubles(sizeof(dm_sem)) + dm_stage_table_size((size_t)g.s, (size_t)g.q.r) + 2 * n +
           1 + 2 * n + 3 * n * n + 3 * n + n + 4 * K + 2 * K * K + n + K + scratch_size(m, K - 1) +
           memory_size(m->n, (uint32_t)K) + dm_sem_inputs(m->n) + dm_sem_outputs(m->n) +
           dm_sem_sweep_size(m);
}

/* It stands at the beginning of the workspace. */
static dm_sem *sem_of(const dm_stepper *s) {
    return (dm_sem *)(void *)s->work;
}

/* All that steps have left. */
static void forget(dm_sem *e) {
    memset(e->places, 0, memory_size(e->n, e->unknowns) * sizeof *e->places);
}

/* Of the midpoint of a straight line there may be a kernel of the whole step, or sweeps. */
static void open_written(dm_sem *e, dm_stepper *s, double *memory) {
    e->sweeps.bend.eval = NULL;
    if (dm_sem_kernel(&e->kernel, e->m, &e->by_velocity)) {
        dm_kernel_prepare(&e->kernel, e->out);
        s->report.operations = e->kernel.operations;
    } else if (dm_sem_sweep_fits(e->m)) {
        dm_sem_sweep_open(&e->sweeps, e->m, memory);
        s->report.operations = e->m->potential.operations;
    }
}

/* Nothing here depends on h or the start. */
static dm_status open(dm_stepper *s) {
    dm_sem *e = sem_of(s);
    const dm_model *m = s->model;
    const size_t n = m->n;
    double *memory = s->work + dm_doubles(sizeof *e);
    dm_galerkin g;
    dm_galerkin_basis(&g, s->rule);
    *e = (dm_sem){.m = m, .n = m->n, .velocities = (uint32_t)g.s * m->n, .pace = 1.0};
    const size_t K = e->unknowns = e->velocities + 1;
    dm_stage_table_find(&e->table, &g, m,
                        dm_take(&memory, dm_stage_table_size((size_t)g.s, (size_t)g.q.r)));
    e->x = dm_take(&memory, 2 * n + 1);
    e->at = dm_take(&memory, 2 * n + 3 * n * n);
    e->w = dm_take(&memory, 3 * n);
    e->v0 = dm_take(&memory, n);
    e->z = dm_take(&memory, K);
    e->kept = dm_take(&memory, K);
    e->R = dm_take(&memory, K);
    e->dz = dm_take(&memory, K);
    e->J = dm_take(&memory, K * K);
    e->LU = dm_take(&memory, K * K);
    e->end = dm_take(&memory, n);
    e->pivot = (uint32_t *)(void *)dm_take(&memory, K);
    e->scratch = dm_take(&memory, scratch_size(m, K - 1));
    e->places = dm_take(&memory, memory_size(m->n, e->unknowns));
    e->warm = e->places + DM_SEM_PLACES * dm_sem_place_size(m->n);
    e->in = dm_take(&memory, dm_sem_inputs(m->n));
    e->out = dm_take(&memory, dm_sem_outputs(m->n));
    forget(e);
    s->report.operations = m->stage.operations + m->energy.operations;
    if (is_middle(&g)) open_written(e, s, memory);
    return dm_sem_is_written(e) ? DM_OK : dm_sem_prepare(e);
}

/* ---- places ---- */

/* The place of a state; -1: none. */
static int find(const dm_sem *e, const double *state) {
    static const int order[] = {DM_SEM_FIRST, DM_SEM_OTHER, DM_SEM_BASE};
    for (int k = 0; k < DM_SEM_PLACES; k++)
        if (dm_sem_holds(e, order[k], state, e->n)) return order[k];
    return -1;
}

/* A state that no step led to begins with the first h. */
static void find_numbers(const dm_sem *e, double *out, const double *state) {
    const int which = find(e, state);
    memset(out, 0, DM_SEM_NUMBERS * sizeof *out);
    out[DM_SEM_LENGTH] = e->first, out[DM_SEM_ENERGY] = state[4 * (size_t)e->n + 2];
    if (which >= 0) memcpy(out, dm_sem_numbers(e, which, e->n), DM_SEM_NUMBERS * sizeof *out);
}

/* A step begins here; what others led to is forgotten, unless it is another one from the same
 * state. */
static void put_base(const dm_sem *e, const double *state, const double *numbers) {
    double *first = dm_sem_place(e, DM_SEM_FIRST, e->n),
           *other = dm_sem_place(e, DM_SEM_OTHER, e->n);
    if (!dm_sem_holds(e, DM_SEM_BASE, state, e->n)) first[0] = other[0] = 0.0;
    dm_sem_put(e, DM_SEM_BASE, state, numbers, e->n);
}

/* The step that is known as the next one at BASE led here, whole or in part. */
static void put_end(const dm_sem *e, const double *state, const double *numbers, int warm) {
    const double here[DM_SEM_NUMBERS] = {numbers[DM_SEM_NEXT_LENGTH], numbers[DM_SEM_NEXT_ENERGY],
                                         numbers[DM_SEM_NEXT_FLAG], warm};
    const int taken = *dm_sem_place(e, DM_SEM_FIRST, e->n) != 0.0;
    dm_sem_put(e, taken ? DM_SEM_OTHER : DM_SEM_FIRST, state, here, e->n);
}

/* From places and state (whose own numbers are t and the energy) a run goes on bit for bit. */
static size_t memory(dm_stepper *s, double **place) {
    const dm_sem *e = sem_of(s);
    *place = e->places;
    return memory_size(e->n, e->unknowns);
}

/* For rows: h, E_d and the flag of the step that ended at the state. */
static void parts(const dm_stepper *s, double *out, const double *state, double t, uint32_t first,
                  uint32_t count) {
    double numbers[DM_SEM_NUMBERS];
    (void)t;
    find_numbers(sem_of(s), numbers, state);
    memcpy(out, numbers + first, count * sizeof *out);
}

/* ---- steps ---- */

/* A run begins. Its energy is that of a step of h, unless one is given. */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    dm_sem *e = sem_of(s);
    double *own = state + 4 * (size_t)e->n;
    forget(e);
    e->first = h, e->least = SHORTEST * h;
    s->report.sem = (dm_energy_report){.least = INFINITY};
    own[0] = t, own[1] = own[2] = 0.0;
    e->begun = DM_OK;
    if (s->energy) {
        own[2] = *s->energy;
        return DM_OK;
    }
    dm_sem_begin(e, state);
    e->begun = dm_sem_fixed(e, s, h);
    own[2] = e->begun == DM_OK ? e->energy : 0.0;
    return DM_OK;
}

/* V and h of the step from here; numbers get what is next */
static dm_status choose(dm_sem *e, dm_stepper *s, double *numbers) {
    const double h = numbers[DM_SEM_LENGTH];
    const double low = fmax(h / FURTHEST, e->least), high = FURTHEST * h;
    const int goes_on = numbers[DM_SEM_WARM] == DM_SEM_LAST;
    int flagged = 0;
    dm_status status = dm_sem_is_written(e) ? dm_sem_solve_written(e, s, h, low, high, goes_on)
                                            : dm_sem_solve(e, s, h, low, high, goes_on);
    const double rounding = status == DM_OK ? dm_sem_conditioning(e) : 0.0;
    if (status != DM_OK) status = dm_sem_fallback(e, s, h, low, high, &flagged);
    s->report.solves++;
    if (status != DM_OK) return status;
    numbers[DM_SEM_NEXT_LENGTH] = e->z[e->velocities];
    numbers[DM_SEM_NEXT_ENERGY] = e->energy;
    numbers[DM_SEM_NEXT_FLAG] = flagged;
    s->report.residual = fabs(e->energy - e->E);
    s->report.sem.conditioning = fmax(s->report.sem.conditioning, rounding);
    return DM_OK;
}

/* of a whole step */
static void tell(dm_energy_report *out, const double *numbers, double E) {
    out->energy = E;
    out->steps++;
    out->fallbacks += numbers[DM_SEM_NEXT_FLAG] != 0.0;
    out->defect = fmax(out->defect, fabs(numbers[DM_SEM_NEXT_ENERGY] - E));
    out->least = fmin(out->least, numbers[DM_SEM_NEXT_LENGTH]);
    out->largest = fmax(out->largest, numbers[DM_SEM_NEXT_LENGTH]);
}

/* NaN and infinity in what is added. */
static int is_finite(const dm_sem *e) {
    double sum = 0.0;
    for (uint32_t i = 0; i < e->unknowns; i++) sum += 0.0 * e->z[i];
    for (uint32_t i = 0; i < e->n; i++) sum += 0.0 * e->end[i];
    return sum == 0.0;
}

/* q += h sum beta_j V_j, p += h sum b_i L_q(i), t += h */
static void move(const dm_sem *e, double *state) {
    const uint32_t n = e->n;
    const double h = e->z[e->velocities];
    double *sum = e->w, *own = state + 4 * (size_t)n;
    memset(sum, 0, n * sizeof *sum);
    for (uint32_t j = 0; j < e->table.s; j++)
        dm_weighted_add(sum, e->table.beta[j], e->z + j * (size_t)n, n);
    for (uint32_t k = 0; k < n; k++) dm_sum_add(state + k, state + 2 * (size_t)n + k, h * sum[k]);
    dm_sum_add_n(state + n, state + 3 * (size_t)n, e->end, n);
    dm_sum_add(own, own + 1, h);
}

/* A whole step has been made: what is told of it and kept for the next one; returns the mark of its
 * end. A flagged step is none that others continue, and one more from the same state, for a row at
 * its end, changes nothing. */
static int go_on(dm_sem *e, dm_stepper *s, double *numbers) {
    const double mark = numbers[DM_SEM_WARM];
    const int keeps = mark != DM_SEM_GONE && numbers[DM_SEM_NEXT_FLAG] == 0.0;
    if (mark != DM_SEM_GONE) tell(&s->report.sem, numbers, e->E);
    if (keeps) dm_sem_warm_keep(e->warm, e->z, e->unknowns, mark == DM_SEM_LAST);
    numbers[DM_SEM_WARM] = DM_SEM_GONE;
    return keeps ? DM_SEM_LAST : DM_SEM_COLD;
}

/* h other than that of the run: as large a part of the step that is chosen */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    dm_sem *e = sem_of(s);
    const int whole = h == e->first;
    double numbers[DM_SEM_NUMBERS];
    (void)t;
    if (whole && dm_sem_is_written(e) && dm_sem_go_on(e, s, state)) return DM_OK;
    find_numbers(e, numbers, state);
    if (e->begun != DM_OK && find(e, state) < 0) return e->begun;
    e->E = state[4 * (size_t)e->n + 2];
    e->evaluations = 0;
    dm_status status = DM_OK;
    dm_sem_begin(e, state);
    if (whole || numbers[DM_SEM_NEXT_LENGTH] == 0.0) status = choose(e, s, numbers);
    e->pace = numbers[DM_SEM_NEXT_LENGTH] / e->first;
    if (status == DM_OK && !whole) status = dm_sem_fixed(e, s, h * e->pace);
    s->report.evaluations += e->evaluations;
    if (status != DM_OK) return status;
    if (!is_finite(e)) return DM_NOT_FINITE;
    const int warm = whole ? go_on(e, s, numbers) : DM_SEM_COLD;
    put_base(e, state, numbers);
    move(e, state);
    put_end(e, state, numbers, warm);
    return DM_OK;
}

/* The part of a step and its time are proportional. */
static double pace(const dm_stepper *s, const double *state) {
    const dm_sem *e = sem_of(s);
    double numbers[DM_SEM_NUMBERS];
    find_numbers(e, numbers, state);
    return numbers[DM_SEM_NEXT_LENGTH] > 0.0 ? numbers[DM_SEM_NEXT_LENGTH] / e->first : e->pace;
}

/* A step that nobody takes. */
dm_status dm_sem_energy(dm_stepper *s, const double *state, double h, double *energy) {
    dm_sem *e = sem_of(s);
    dm_sem_begin(e, state);
    const dm_status status = dm_sem_fixed(e, s, h);
    *energy = e->energy;
    return status;
}

/* The first step, or any other. */
static const char *why(dm_stepper *s, const double *state, dm_status status) {
    const dm_sem *e = sem_of(s);
    (void)status;
    if (e->begun != DM_OK && find(e, state) < 0)
        return "the step whose energy all others are to have cannot be solved: take a smaller h";
    return "no step from half the last one to twice as much can be solved: begin with a smaller h";
}

const dm_engine dm_engine_sem = {
    .keyed = 1,
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .pace = pace,
    .step = step,
    .memory = memory,
    .parts = parts,
    .why = why,
};

/* ---- the rule ---- */

/* A degree and a quadrature, as galerkin takes them. */
static const char *check(const dm_rule *rule) {
    const char *usage = "sem takes the degree of its curves and a quadrature, as in sem(1, "
                        "gauss(1))";
    return dm_galerkin_check(rule, usage);
}

/* That of the curves and their quadrature with steps of one length. */
static int order(const dm_rule *rule) {
    dm_galerkin g;
    dm_galerkin_basis(&g, rule);
    return dm_galerkin_order(&g);
}

const dm_method dm_method_sem = {
    .name = "sem",
    .signature = "sem(s, quadrature(r))",
    .doc = "Symplectic-energy-momentum steps: curves of degree s, the action by r nodes, and the "
           "length of each step chosen such that its discrete energy is that of the first step, "
           "whose h is the solver's, or run{energy=}. Columns h, E_d, fallback; path.sem. Where no "
           "h in reach has the energy the step is flagged: solver:solvability says where. For L "
           "without time, forces and constraints. Kane, Marsden & Ortiz 1999; Leok 5.5.",
    .orders = "that of galerkin(s, quadrature(r))",
    .stages = "r",
    .cost = "s n + 1 unknowns",
    .instances = "",
    .traits = DM_OWN_TIME | DM_BY_ENERGY,
    .parts = "h E_d fallback",
    .check = check,
    .order = order,
    .engine = &dm_engine_sem,
};
