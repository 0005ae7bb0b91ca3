/* reduced - a step of lie(1) of tests/bench/reduced.lua by hand, to round-off, of a shape beside
 * SO(2), SE(2), SO(3) or SE(3) (DIM 2 or 3, MOVES 0 or DIM): reduced, its L written in the body
 * without g; and unreduced, its L written in space, with g. A Newton step with exact derivatives,
 * SIZE at once, then chords, from the polynomial through the last five steps.
 * cc -O3 -march=native -DDIM=3 -DMOVES=3 -o reduced tests/bench/c/by_hand/reduced.c -lm */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define INLINE static inline __attribute__((always_inline))
#define TURNS (DIM == 2 ? 1 : 3)
#define SIZE (1 + MOVES + TURNS)
#define LANES (SIZE <= 2 ? 2 : SIZE <= 4 ? 4 : 8)
#define H 0.05

enum { STEPS = 100000, REPEATS = 15, KEPT = 5 };

/* momenta p[0] of the shape and the body ones behind it; g = (R, shift), which a reduced step
 * leaves alone */
typedef struct {
    double x, p[SIZE], R[DIM][DIM], shift[DIM], last[KEPT][SIZE];
    long iterations;
} state;

static double SERIES[8][12]; /* (-1)^j/(2 j + k)! */

typedef double lanes __attribute__((vector_size(8 * LANES)));

/* a number and its changes by V */
typedef struct {
    double a;
    lanes d;
} dual;

INLINE dual constant(double a) {
    return (dual){.a = a};
}

INLINE dual sum(dual x, dual y) {
    return (dual){x.a + y.a, x.d + y.d};
}

INLINE dual difference(dual x, dual y) {
    return (dual){x.a - y.a, x.d - y.d};
}

INLINE dual product(dual x, dual y) {
    return (dual){x.a * y.a, x.a * y.d + y.a * x.d};
}

INLINE dual scaled(dual x, double f) {
    return (dual){x.a * f, x.d * f};
}

INLINE dual root(dual x) {
    const double r = sqrt(x.a);
    return (dual){r, x.d * (0.5 / r)};
}

INLINE dual inverse(dual x) {
    const double i = 1.0 / x.a;
    return (dual){i, x.d * (-i * i)};
}

#define NUM double
#define NUMBER(x) (x)
#define ADD(x, y) ((x) + (y))
#define SUB(x, y) ((x) - (y))
#define MUL(x, y) ((x) * (y))
#define TIMES(x, f) ((x) * (f))
#define ROOT(x) sqrt(x)
#define OVER(x) (1.0 / (x))
#define OF(name) name##_of_numbers
#include "reduced_point.h"

#define NUM dual
#define NUMBER(x) constant(x)
#define ADD(x, y) sum(x, y)
#define SUB(x, y) difference(x, y)
#define MUL(x, y) product(x, y)
#define TIMES(x, f) scaled(x, f)
#define ROOT(x) root(x)
#define OVER(x) inverse(x)
#define OF(name) name##_of_duals
#include "reduced_point.h"

/* J = l u in place, the diagonal of u inverted; no pivots are needed near a mass matrix */
INLINE void factor(double J[SIZE][SIZE]) {
    for (int j = 0; j < SIZE; j++) {
        J[j][j] = 1.0 / J[j][j];
        for (int i = j + 1; i < SIZE; i++) {
            J[i][j] *= J[j][j];
            for (int k = j + 1; k < SIZE; k++) J[i][k] -= J[i][j] * J[j][k];
        }
    }
}

INLINE void solve(double *d, double J[SIZE][SIZE]) {
    for (int i = 1; i < SIZE; i++)
        for (int k = 0; k < i; k++) d[i] -= J[i][k] * d[k];
    for (int i = SIZE; i-- > 0;) {
        for (int k = i + 1; k < SIZE; k++) d[i] -= J[i][k] * d[k];
        d[i] *= J[i][i];
    }
}

/* the equation and its matrix at V */
INLINE void linearize(double *out, double *mu, double J[SIZE][SIZE], const double *V,
                      const state *s, int space) {
    dual at[SIZE], value[SIZE], P[SIZE];
    for (int i = 0; i < SIZE; i++) at[i] = constant(V[i]), at[i].d[i] = 1.0;
    equation_of_duals(value, P, at, s, space);
    for (int i = 0; i < SIZE; i++) {
        out[i] = value[i].a;
        mu[i] = P[i].a;
        for (int j = 0; j < SIZE; j++) J[i][j] = value[i].d[j];
    }
}

/* x1, (p1, mu1) = Ad*_f P, and unreduced g1 = g0 f, with f = exp(h V) */
INLINE void finish(state *s, const double *V, const double *mu, int space) {
    double f[DIM][DIM], R[DIM][DIM];
    vec_of_numbers force, moment;
    turn_of_numbers(f, V, H);
    s->x += H * V[0];
    s->p[0] = mu[0];
    (void)force, (void)moment;
#if DIM == 3
    for (int i = 0; i < 3; i++) moment.x[i] = mu[1 + MOVES + i];
#endif
#if MOVES /* f moves by phi(h V) h v: mu is f^T times (force, moment - shift x force) */
    double c[6], t = 0, w[TURNS];
    vec_of_numbers v, once, twice, shift;
    for (int i = 0; i < TURNS; i++) w[i] = H * V[1 + MOVES + i], t += w[i] * w[i];
    stumpff_of_numbers(c, t);
    for (int i = 0; i < DIM; i++) v.x[i] = H * V[1 + i], force.x[i] = mu[1 + i];
    once = spin_of_numbers(w, &v);
    twice = spin_of_numbers(w, &once);
    for (int i = 0; i < DIM; i++) shift.x[i] = v.x[i] + c[2] * once.x[i] + c[3] * twice.x[i];
#if DIM == 2
    s->p[3] = mu[3] - (shift.x[0] * force.x[1] - shift.x[1] * force.x[0]);
#else
    const vec_of_numbers across = spin_of_numbers(shift.x, &force);
    for (int i = 0; i < 3; i++) moment.x[i] -= across.x[i];
#endif
    const vec_of_numbers back = rotate_back_of_numbers(f, &force);
    for (int i = 0; i < DIM; i++) s->p[1 + i] = back.x[i];
    if (space) {
        const vec_of_numbers far = rotate_of_numbers(s->R, &shift);
        for (int i = 0; i < DIM; i++) s->shift[i] += far.x[i];
    }
#elif DIM == 2
    s->p[1] = mu[1];
#endif
#if DIM == 3
    moment = rotate_back_of_numbers(f, &moment);
    for (int i = 0; i < 3; i++) s->p[1 + MOVES + i] = moment.x[i];
#endif
    if (!space) return;
    for (int i = 0; i < DIM; i++)
        for (int j = 0; j < DIM; j++) {
            R[i][j] = 0;
            for (int k = 0; k < DIM; k++) R[i][j] += s->R[i][k] * f[k][j];
        }
    memcpy(s->R, R, sizeof R);
}

/* what is left does not count, or is round-off that stays */
INLINE int is_last(double now, double before) {
    return now <= 4e-15 || now / before * now <= 4e-20 || (now < 1e-13 && 4.0 * now > before);
}

INLINE void step(state *s, int space) {
    static const double weights[KEPT] = {5, -10, 10, -5, 1};
    double V[SIZE], d[SIZE], mu[SIZE], J[SIZE][SIZE], before = 0;
    for (int k = 0; k < SIZE; k++) {
        V[k] = 0;
        for (int i = 0; i < KEPT; i++) V[k] += weights[i] * s->last[i][k];
    }
    for (int i = 0; i < 20; i++) {
        if (i == 0) {
            linearize(d, mu, J, V, s, space);
            factor(J);
        } else {
            equation_of_numbers(d, mu, V, s, space);
        }
        solve(d, J);
        double now = 0;
        for (int k = 0; k < SIZE; k++) now = fmax(now, fabs(d[k])), V[k] -= d[k];
        s->iterations++;
        if (is_last(now, i ? before : 10.0 * now)) break;
        before = now;
    }
    memmove(s->last + 1, s->last, (KEPT - 1) * sizeof s->last[0]);
    memcpy(s->last, V, sizeof V);
    finish(s, V, mu, space);
}

/* at x = 0.4 with p = 0.1, mu = 0.9/i, from rest in V */
static state start(void) {
    state s = {.x = 0.4, .p = {0.1}};
    for (int i = 1; i < SIZE; i++) s.p[i] = 0.9 / i;
    for (int i = 0; i < DIM; i++) s.R[i][i] = 1;
    double V[SIZE] = {0}, d[SIZE], mu[SIZE], J[SIZE][SIZE];
    for (int i = 0; i < 20; i++) {
        linearize(d, mu, J, V, &s, 0);
        factor(J);
        solve(d, J);
        for (int k = 0; k < SIZE; k++) V[k] -= d[k];
    }
    for (int i = 0; i < KEPT; i++) memcpy(s.last[i], V, sizeof V);
    return s;
}

static state run(long steps, int space) {
    state s = start();
    if (space)
        for (long k = 0; k < steps; k++) step(&s, 1);
    else
        for (long k = 0; k < steps; k++) step(&s, 0);
    return s;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

int main(void) {
    double best[2] = {INFINITY, INFINITY};
    state end[2];
    for (int k = 0; k < 8; k++) {
        SERIES[k][0] = 1.0;
        for (int i = 2; i <= k; i++) SERIES[k][0] /= i;
        for (int j = 1; j < 12; j++)
            SERIES[k][j] = -SERIES[k][j - 1] / ((2 * j + k - 1.0) * (2 * j + k));
    }
    for (int i = 0; i < REPEATS; i++)
        for (int space = 0; space < 2; space++) {
            const double from = now();
            end[space] = run(STEPS, space);
            best[space] = fmin(best[space], (now() - from) / STEPS);
        }
    const state a = run(200, 0), b = run(200, 1);
    printf("by hand, a shape and %s(%d): %.0f ns a step reduced, %.0f unreduced (%.2f); %.2f and "
           "%.2f "
           "iterations; x = %.13f, %.13f after 200\n",
           MOVES ? "SE" : "SO", DIM, best[0], best[1], best[0] / best[1],
           (double)end[0].iterations / STEPS, (double)end[1].iterations / STEPS, a.x, b.x);
    return 0;
}
