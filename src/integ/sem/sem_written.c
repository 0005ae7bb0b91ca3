/* sem_written.c - steps of one point by their kernel, or by sweeps. */
#include "integ/sem/sem_places.h"
#include "integ/sem/sem_warm.h"
#include "numbers/compensated.h"

#include <float.h>
#include <math.h>

#define INLINE static inline __attribute__((always_inline))

static const double ROUND = 4 * DBL_EPSILON; /* of the terms: what is left is round-off */
static const double SMALL = 3e-14;           /* of the terms: may be round-off, if it stays */
enum { CALLS = 8 };                          /* of the kernel, each two iterations */

INLINE double larger(double a, double b) {
    return a > b ? a : b;
}

/* The arguments, with z for v and h. */
INLINE void place(const dm_sem *e, const double *state, const double *z, uint32_t n) {
    double *in = e->in;
#pragma GCC unroll 8
    for (uint32_t k = 0; k < n; k++) {
        in[k] = state[k];
        in[n + k] = state[2 * n + k];
        in[2 * n + k] = state[n + k];
    }
#pragma GCC unroll 8
    for (uint32_t k = 0; k <= n; k++) in[3 * n + k] = z[k];
    in[4 * n + 1] = e->E;
}

/* What is left of R and of the energy equation, and the size of their terms. */
typedef struct {
    double momentum, size, energy, size_of;
} rest_of_step;

/* E_d on the way. */
INLINE rest_of_step left(dm_sem *e, uint32_t n) {
    const double *v = e->out, *force = v + n + 1, *R = force + n, *p0 = e->in + 2 * n;
    const double half = 0.5 * v[n], twice = R[n];
    rest_of_step of = {0.0, 0.0, fabs(R[n + 1] - e->E), fabs(twice) + fabs(twice - R[n + 1])};
#pragma GCC unroll 8
    for (uint32_t k = 0; k < n; k++) {
        const double pull = fabs(half * force[k]);
        of.size = larger(of.size, e->by_velocity ? fabs(v[k]) : larger(fabs(p0[k]), pull));
        of.momentum = larger(of.momentum, fabs(R[k]));
    }
    e->energy = R[n + 1], e->size_of = of.size_of;
    return of;
}

/* Is all of it round-off? Not where it is NaN. What velocities are off by the last correction still
 * takes away. */
INLINE int is_round_off(const rest_of_step *of, int by_velocity) {
    const double of_momentum = by_velocity ? 4 * ROUND : ROUND;
    return of->momentum <= of_momentum * of->size && of->energy <= ROUND * of->size_of;
}

/* From v and h that are placed; ends as Newton's method of sem_solve.c does. */
INLINE int iterate(dm_sem *e, dm_stepper *s, uint32_t n) {
    double last = INFINITY;
    s->report.iterations = 0;
    for (int k = 0; k < CALLS; k++) {
        dm_kernel_eval(&e->kernel, e->in, e->out);
        e->evaluations += 3, s->report.newton += 2, s->report.iterations += 2;
        const rest_of_step of = left(e, n);
        if (!(e->out[n] > 0.0)) return 0;
        if (is_round_off(&of, e->by_velocity)) return 1;
        const double rest = larger(of.momentum / of.size, of.energy / of.size_of);
        if (!(rest < INFINITY)) return 0;
        if (rest >= 0.5 * last && rest <= SMALL) return 1;
        last = rest;
#pragma GCC unroll 8
        for (uint32_t i = 0; i <= n; i++) e->in[3 * n + i] = e->out[i];
    }
    return 0;
}

/* By sweeps. */
static int sweep(dm_sem *e, dm_stepper *s, const double *z, int moves) {
    e->sweeps.E = e->E;
    const int count = dm_sem_sweep(&e->sweeps, e->state, z, e->out, moves);
    const double twice = e->out[3 * e->n + 1];
    e->evaluations += count, s->report.newton += count, s->report.iterations = count;
    e->energy = e->out[3 * e->n + 2];
    e->size_of = fabs(twice) + fabs(twice - e->energy);
    return count > 0;
}

/* Where the kernel for n coordinates, or sweeps, lead from z in [low, high]; n is a constant where
 * this is called. */
INLINE int solve(dm_sem *e, dm_stepper *s, const double *z, double low, double high, uint32_t n) {
    if (e->kernel.eval) {
        place(e, e->state, z, n);
        if (!iterate(e, s, n)) return 0;
    } else if (!sweep(e, s, z, 1)) {
        return 0;
    }
    return e->out[n] >= low && e->out[n] <= high;
}

/* The root, and the gain of momentum. */
INLINE void take(dm_sem *e, uint32_t n) {
    e->factored = 0, e->slope = e->out[3 * n + 3];
#pragma GCC unroll 8
    for (uint32_t k = 0; k <= n; k++) e->z[k] = e->out[k];
#pragma GCC unroll 8
    for (uint32_t k = 0; k < n; k++) e->end[k] = e->out[n] * e->out[n + 1 + k];
}

INLINE int solve_and_take(dm_sem *e, dm_stepper *s, const double *z, double low, double high,
                          uint32_t n) {
    if (!solve(e, s, z, low, high, n)) return 0;
    take(e, n);
    return 1;
}

static int solve_from(dm_sem *e, dm_stepper *s, const double *z, double low, double high) {
    switch (e->n) {
    case 1:
        return solve_and_take(e, s, z, low, high, 1);
    case 2:
        return solve_and_take(e, s, z, low, high, 2);
    case 3:
        return solve_and_take(e, s, z, low, high, 3);
    case 4:
        return solve_and_take(e, s, z, low, high, 4);
    default:
        return solve_and_take(e, s, z, low, high, e->n);
    }
}

/* Where the steps before do not lead to a root, the velocity at the start does, or the tables of
 * any degree. */
dm_status dm_sem_solve_written(dm_sem *e, dm_stepper *s, double h, double low, double high,
                               int goes_on) {
    if (goes_on && solve_from(e, s, e->warm + DM_SEM_NEXT, low, high)) return DM_OK;
    if (dm_sem_guess(e, h) == DM_OK && solve_from(e, s, e->z, low, high)) return DM_OK;
    return dm_sem_solve(e, s, h, low, high, 0);
}

int dm_sem_fixed_swept(dm_sem *e, dm_stepper *s) {
    if (!sweep(e, s, e->z, 0)) return 0;
    take(e, e->n);
    return isfinite(e->energy);
}

/* ---- steps that go on ---- */

/* Of all that is added. */
INLINE int is_finite(const dm_sem *e, uint32_t n) {
    double sum = 0.0;
#pragma GCC unroll 8
    for (uint32_t i = 0; i <= 2 * n; i++) sum += 0.0 * e->out[i];
    return sum == 0.0;
}

/* q += h v, p += h L_q, t += h */
INLINE void move(const dm_sem *e, double *state, uint32_t n) {
    const double *v = e->out, *force = e->out + n + 1, h = e->out[n];
    double *own = state + 4 * n;
#pragma GCC unroll 8
    for (uint32_t k = 0; k < n; k++) {
        dm_sum_add(state + k, state + 2 * n + k, h * v[k]);
        dm_sum_add(state + n + k, state + 3 * n + k, h * force[k]);
    }
    dm_sum_add(own, own + 1, h);
}

INLINE void tell(const dm_sem *e, dm_stepper *s, uint32_t n) {
    dm_energy_report *out = &s->report.sem;
    const double h = e->out[n], defect = fabs(e->energy - e->E);
    const double rounding = 0.5 * DBL_EPSILON * e->size_of * fabs(e->out[3 * n + 3]);
    s->report.solves++;
    s->report.residual = defect;
    out->energy = e->E;
    out->steps++;
    out->defect = larger(out->defect, defect);
    out->conditioning = larger(out->conditioning, rounding);
    out->least = h < out->least ? h : out->least;
    out->largest = larger(out->largest, h);
}

/* From FIRST, which becomes BASE, to a new FIRST. */
INLINE int go_on(dm_sem *e, dm_stepper *s, double *state, uint32_t n) {
    const double *numbers = dm_sem_numbers(e, DM_SEM_FIRST, n);
    if (numbers[DM_SEM_WARM] != DM_SEM_LAST || !dm_sem_holds(e, DM_SEM_FIRST, state, n)) return 0;
    const double last = numbers[DM_SEM_LENGTH], half = 0.5 * last;
    double of[DM_SEM_NUMBERS];
#pragma GCC unroll 8
    for (int k = 0; k < DM_SEM_NUMBERS; k++) of[k] = numbers[k];
    e->E = state[4 * n + 2], e->evaluations = 0, e->state = state;
    const int found = solve(e, s, e->warm + DM_SEM_NEXT, larger(half, e->least), 2.0 * last, n);
    s->report.evaluations += e->evaluations;
    if (!found || !is_finite(e, n)) return 0;
    tell(e, s, n);
    dm_sem_warm_keep(e->warm, e->out, n + 1, 1);
    const double h = of[DM_SEM_NEXT_LENGTH] = e->out[n];
    const double here[DM_SEM_NUMBERS] = {h, e->energy, 0.0, DM_SEM_LAST};
    of[DM_SEM_NEXT_ENERGY] = e->energy, of[DM_SEM_WARM] = DM_SEM_GONE;
    dm_sem_put(e, DM_SEM_BASE, state, of, n);
    move(e, state, n);
    dm_sem_put(e, DM_SEM_FIRST, state, here, n);
    *dm_sem_place(e, DM_SEM_OTHER, n) = 0.0;
    e->pace = h / e->first;
    return 1;
}

/* The same with n a constant. */
int dm_sem_go_on(dm_sem *e, dm_stepper *s, double *state) {
    switch (e->n) {
    case 1:
        return go_on(e, s, state, 1);
    case 2:
        return go_on(e, s, state, 2);
    case 3:
        return go_on(e, s, state, 3);
    case 4:
        return go_on(e, s, state, 4);
    default:
        return go_on(e, s, state, e->n);
    }
}
