/* sem.c - symplectic-energy-momentum steps as an engine with a time of its own. */
#include "integ/rules/galerkin.h"
#include "integ/sem/sem_inside.h"
#include "linalg/solve/newton.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

/* States that are known: where the last step began, where it led, and where a step on the side
 * from there led. Each has a mark (1: it is there), q[n], p[n], t, and numbers of its own. */
enum { BASE, FIRST, OTHER, PLACES };

/* Of the step that ended at a state, and of the one that begins there (h = 0: not known yet). */
enum { H, ENERGY, FLAG, NEXT_H, NEXT_ENERGY, NEXT_FLAG, NUMBERS, PARTS = NEXT_H };

static const double SHORTEST = 0.2; /* of the first step */
static const double FURTHEST = 2.0; /* times the last step, or a part of it */

/* Bytes as doubles, rounded up. */
static size_t doubles(size_t bytes) {
    return (bytes + sizeof(double) - 1) / sizeof(double);
}

/* Of a place. */
static size_t key_of(uint32_t n) {
    return 2 * (size_t)n + 1;
}
/* Of all of them: mark, key, numbers. */
static size_t place_size(uint32_t n) {
    return 1 + key_of(n) + NUMBERS;
}

/* The time decides: a force of another's making could not be told from L. */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return m->structure & DM_AUTONOMOUS
               ? NULL
               : "L depends on time, so that the motion keeps no energy that could choose the "
                 "steps";
}

/* The energy has a kernel of its own; the mass is for the first guess of the velocity. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    const unsigned plain = DM_SEPARABLE | DM_CONSTANT_MASS;
    (void)rule;
    return DM_WANT_STAGE | DM_WANT_ENERGY |
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
    return doubles(sizeof(dm_sem)) + dm_stage_table_size((size_t)g.s, (size_t)g.q.r) + 2 * n + 1 +
           2 * n + 3 * n * n + 3 * n + n + 4 * K + 2 * K * K + n + K + scratch_size(m, K - 1) +
           PLACES * place_size(m->n);
}

/* It stands at the beginning of the workspace. */
static dm_sem *sem_of(const dm_stepper *s) {
    return (dm_sem *)(void *)s->work;
}

/* The next block of doubles. */
static double *take(double **memory, size_t count) {
    double *block = *memory;
    *memory += count;
    return block;
}

/* Nothing here depends on h or the start. */
static dm_status open(dm_stepper *s) {
    dm_sem *e = sem_of(s);
    const dm_model *m = s->model;
    const size_t n = m->n;
    double *memory = s->work + doubles(sizeof *e);
    dm_galerkin g;
    dm_galerkin_basis(&g, s->rule);
    *e = (dm_sem){.m = m, .n = m->n, .velocities = (uint32_t)g.s * m->n, .pace = 1.0};
    const size_t K = e->unknowns = e->velocities + 1;
    dm_stage_table_find(&e->table, &g, m,
                        take(&memory, dm_stage_table_size((size_t)g.s, (size_t)g.q.r)));
    e->x = take(&memory, 2 * n + 1);
    e->at = take(&memory, 2 * n + 3 * n * n);
    e->w = take(&memory, 3 * n);
    e->v0 = take(&memory, n);
    e->z = take(&memory, K);
    e->kept = take(&memory, K);
    e->R = take(&memory, K);
    e->dz = take(&memory, K);
    e->J = take(&memory, K * K);
    e->LU = take(&memory, K * K);
    e->end = take(&memory, n);
    e->pivot = (uint32_t *)(void *)take(&memory, K);
    e->scratch = take(&memory, scratch_size(m, K - 1));
    e->places = take(&memory, PLACES * place_size(m->n));
    memset(e->places, 0, PLACES * place_size(m->n) * sizeof *e->places);
    dm_kernel_prepare(&m->stage, e->at);
    s->report.operations = m->stage.operations + m->energy.operations;
    return DM_OK;
}

/* ---- places ---- */

/* Its mark, behind which the key and the numbers stand. */
static double *place_of(const dm_sem *e, int which) {
    return e->places + (size_t)which * place_size(e->n);
}

/* H ... NEXT_FLAG of a place. */
static double *numbers_of(const dm_sem *e, int which) {
    return place_of(e, which) + 1 + key_of(e->n);
}

/* Does the place hold (q, p, t) of this state? */
static int holds(const dm_sem *e, int which, const double *state) {
    const double *place = place_of(e, which);
    return place[0] != 0.0 && memcmp(place + 1, state, 2 * e->n * sizeof *state) == 0 &&
           place[key_of(e->n)] == state[4 * (size_t)e->n];
}

/* the place of a state, the newest first; -1: none */
static int find(const dm_sem *e, const double *state) {
    for (int which = OTHER; which >= BASE; which--)
        if (holds(e, which, state)) return which;
    return -1;
}

/* A state that no step led to begins with the first h. */
static void find_numbers(const dm_sem *e, double *out, const double *state) {
    const int which = find(e, state);
    memset(out, 0, NUMBERS * sizeof *out);
    out[H] = e->first, out[ENERGY] = state[4 * (size_t)e->n + 2];
    if (which >= 0) memcpy(out, numbers_of(e, which), NUMBERS * sizeof *out);
}

/* The place takes this state and its numbers. */
static void put(const dm_sem *e, int which, const double *state, const double *numbers) {
    double *place = place_of(e, which);
    place[0] = 1.0;
    memcpy(place + 1, state, 2 * e->n * sizeof *place);
    place[key_of(e->n)] = state[4 * (size_t)e->n];
    memcpy(numbers_of(e, which), numbers, NUMBERS * sizeof *numbers);
}

/* A step begins here; what others led to is forgotten, unless it is another one from the same
 * state. */
static void put_base(const dm_sem *e, const double *state, const double *numbers) {
    if (!holds(e, BASE, state)) place_of(e, FIRST)[0] = place_of(e, OTHER)[0] = 0.0;
    put(e, BASE, state, numbers);
}

/* The step that is known as the next one at BASE led here, whole or in part. */
static void put_end(const dm_sem *e, const double *state, const double *numbers) {
    const double here[NUMBERS] = {numbers[NEXT_H], numbers[NEXT_ENERGY], numbers[NEXT_FLAG]};
    put(e, place_of(e, FIRST)[0] != 0.0 ? OTHER : FIRST, state, here);
}

/* From places and state (whose own numbers are t and the energy) a run goes on bit for bit. */
static size_t memory(dm_stepper *s, double **place) {
    *place = sem_of(s)->places;
    return PLACES * place_size(s->model->n);
}

/* For rows: h, E_d and the flag of the step that ended at the state. */
static void parts(const dm_stepper *s, double *out, const double *state, double t, uint32_t first,
                  uint32_t count) {
    double numbers[NUMBERS];
    (void)t;
    find_numbers(sem_of(s), numbers, state);
    memcpy(out, numbers + first, count * sizeof *out);
}

/* ---- steps ---- */

/* where a step begins: the state, and its velocity as a first guess */
static dm_status begin(dm_sem *e, const double *state) {
    e->state = state;
    memset(e->v0, 0, e->n * sizeof *e->v0);
    return dm_legendre_inverse(e->m, e->v0, state, state + e->n, 0.0, e->scratch);
}

/* A run begins. Its energy is that of a step of h, unless one is given. */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    dm_sem *e = sem_of(s);
    double *own = state + 4 * (size_t)e->n;
    memset(e->places, 0, PLACES * place_size(e->n) * sizeof *e->places);
    e->first = h, e->least = SHORTEST * h;
    s->report.sem = (dm_energy_report){.least = INFINITY};
    own[0] = t, own[1] = own[2] = 0.0;
    e->begun = DM_OK;
    if (s->energy) {
        own[2] = *s->energy;
        return DM_OK;
    }
    e->begun = begin(e, state);
    if (e->begun == DM_OK) e->begun = dm_sem_fixed(e, s, h);
    own[2] = e->begun == DM_OK ? e->energy : 0.0;
    return DM_OK;
}

/* V and h of the step from here; numbers get what is next */
static dm_status choose(dm_sem *e, dm_stepper *s, double *numbers) {
    const double h = numbers[H];
    const double low = fmax(h / FURTHEST, e->least), high = FURTHEST * h;
    int flagged = 0;
    dm_status status = dm_sem_solve(e, s, h, low, high);
    const double rounding = status == DM_OK ? dm_sem_conditioning(e) : 0.0;
    if (status != DM_OK) status = dm_sem_fallback(e, s, h, low, high, &flagged);
    s->report.solves++;
    if (status != DM_OK) return status;
    numbers[NEXT_H] = e->z[e->velocities];
    numbers[NEXT_ENERGY] = e->energy;
    numbers[NEXT_FLAG] = flagged;
    s->report.residual = fabs(e->energy - e->E);
    s->report.sem.conditioning = fmax(s->report.sem.conditioning, rounding);
    return DM_OK;
}

/* of a whole step */
static void tell(dm_energy_report *out, const double *numbers, double E) {
    out->energy = E;
    out->steps++;
    out->fallbacks += numbers[NEXT_FLAG] != 0.0;
    out->defect = fmax(out->defect, fabs(numbers[NEXT_ENERGY] - E));
    out->least = fmin(out->least, numbers[NEXT_H]);
    out->largest = fmax(out->largest, numbers[NEXT_H]);
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

/* h other than that of the run: as large a part of the step that is chosen */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    dm_sem *e = sem_of(s);
    const int whole = h == e->first;
    double numbers[NUMBERS];
    (void)t;
    find_numbers(e, numbers, state);
    if (e->begun != DM_OK && find(e, state) < 0) return e->begun;
    e->E = state[4 * (size_t)e->n + 2];
    e->evaluations = 0;
    dm_status status = begin(e, state);
    if (status == DM_OK && (whole || numbers[NEXT_H] == 0.0)) status = choose(e, s, numbers);
    e->pace = numbers[NEXT_H] / e->first;
    if (status == DM_OK && !whole) status = dm_sem_fixed(e, s, h * e->pace);
    s->report.evaluations += e->evaluations;
    if (status != DM_OK) return status;
    if (!is_finite(e)) return DM_NOT_FINITE;
    if (whole) tell(&s->report.sem, numbers, e->E);
    put_base(e, state, numbers);
    move(e, state);
    put_end(e, state, numbers);
    return DM_OK;
}

/* The part of a step and its time are proportional. */
static double pace(const dm_stepper *s, const double *state) {
    const dm_sem *e = sem_of(s);
    double numbers[NUMBERS];
    find_numbers(e, numbers, state);
    return numbers[NEXT_H] > 0.0 ? numbers[NEXT_H] / e->first : e->pace;
}

/* A step that nobody takes. */
dm_status dm_sem_energy(dm_stepper *s, const double *state, double h, double *energy) {
    dm_sem *e = sem_of(s);
    dm_status status = begin(e, state);
    if (status == DM_OK) status = dm_sem_fixed(e, s, h);
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
