/* steps - nanoseconds per step in C: leapfrog of one Kepler orbit, the same for 64 orbits in
 * lanes, implicit midpoint of three models and of one with a constraint, RATTLE. Lines: step
 * SIDE WHAT METHOD NS ITERATIONS, where the side is C for the plain text and bound for the same
 * with reciprocal roots steps FILE: where the implicit models are after 500 steps goes to FILE. */
#include "lanes.h"
#include "newton.h"
#include "rattle.h"
#include "search.h"
#include "tied.h"
#include <stdio.h>
#include <string.h>

enum { ORBITS = 64, GROUPS = ORBITS / 8, STEPS = 200000, REPEATS = 15 };

static double plain_cube(double r2) {
    return 1.0 / (r2 * sqrt(r2));
}

/* steps of h = 0.01 from q = (0.4, 0), v = (0, 2); the sum keeps the loop from vanishing */
#define LEAPFROG(name, cube)                                                                       \
    static double name(long steps) {                                                               \
        double x = 0.4, y = 0.0, u = 0.0, v = 2.0;                                                 \
        double w = cube(x * x + y * y);                                                            \
        const double h = 0.01;                                                                     \
        u -= 0.5 * h * w * x, v -= 0.5 * h * w * y;                                                \
        for (long k = 0; k < steps; k++) {                                                         \
            x += h * u, y += h * v;                                                                \
            w = h * cube(x * x + y * y);                                                           \
            u -= w * x, v -= w * y;                                                                \
        }                                                                                          \
        return x + y + u + v;                                                                      \
    }
LEAPFROG(leapfrog_divide, plain_cube)
LEAPFROG(leapfrog_reciprocal, inverse_cube)

/* h^2 x^(-3/2): the factor is part of the series */
INLINE v8 scaled_cube8(v8 x, double h2) {
#ifdef __AVX512VL__
    const v8 y = seed8(x), y2 = y * y, e = 1.0 - x * y2, e2 = e * e;
    return (y2 * y) * ((h2 + e * (1.5 * h2)) +
                       e2 * ((1.875 * h2 + e * (2.1875 * h2)) + e2 * (2.4609375 * h2)));
#else
    return h2 * inverse_cube8(x);
#endif
}

/* u and v hold velocity times h */
static double leapfrog_lanes(long steps) {
    v8 x[GROUPS], y[GROUPS], u[GROUPS], v[GROUPS];
    const double h = 0.01, h2 = h * h;
    for (int g = 0; g < GROUPS; g++)
        for (int i = 0; i < 8; i++) {
            x[g][i] = 0.4 + 1e-3 * (8 * g + i), y[g][i] = 0.0;
            u[g][i] = 0.0, v[g][i] = 2.0 * h;
        }
    for (long k = 0; k < steps; k++)
#pragma GCC unroll 8
        for (int g = 0; g < GROUPS; g++) {
            x[g] += u[g], y[g] += v[g];
            const v8 w = scaled_cube8(x[g] * x[g] + y[g] * y[g], h2);
            u[g] -= w * x[g], v[g] -= w * y[g];
        }
    v8 sum = {0};
    for (int g = 0; g < GROUPS; g++) sum += x[g] + y[g] + u[g] + v[g];
    return sum8(sum);
}

static double best(double run(long steps), long steps) {
    double least = INFINITY;
    volatile double kept;
    for (int k = 0; k < REPEATS; k++) {
        const double t = bench_now();
        kept = run(steps);
        least = fmin(least, bench_now() - t);
    }
    (void)kept;
    return least;
}

/* where 500 steps lead, for the check against dmlua */
static void write_end(FILE *file, const implicit_model *m) {
    double q[NEWTON_N], p[NEWTON_N];
    long iterations = 0;
    derivatives d;
    m->lagrangian(&d, m->q, m->v);
    memcpy(q, m->q, sizeof q);
    memcpy(p, d.Lv, sizeof p);
    newton_run(q, p, m, 500, &iterations);
    fprintf(file, "%s", m->name);
    for (int i = 0; i < m->n; i++) fprintf(file, "\t%.17g", q[i]);
    fprintf(file, "\n");
}

/* ns per step and iterations per step */
static int implicit(const implicit_model *m, FILE *ends) {
    double q[NEWTON_N], p[NEWTON_N], least = INFINITY;
    const long steps = 20000;
    long iterations = 0;
    derivatives d;
    for (int k = 0; k < REPEATS; k++) {
        iterations = 0;
        m->lagrangian(&d, m->q, m->v);
        memcpy(q, m->q, sizeof q);
        memcpy(p, d.Lv, sizeof p);
        const double t = bench_now();
        if (!newton_run(q, p, m, steps, &iterations)) return 0;
        least = fmin(least, bench_now() - t);
    }
    printf("step\tC\tmidpoint, %s\tgeneric C -O2\t%.2f\t%.2f\n", m->name, least / (double)steps,
           (double)iterations / (double)steps);
    if (ends) write_end(ends, m);
    return 1;
}

/* the same with a multiplier */
static int tied(const tied_model *m, FILE *ends) {
    double q[NEWTON_N], p[NEWTON_N], least = INFINITY;
    const long steps = 20000;
    long iterations = 0;
    derivatives d;
    for (int k = 0; k <= REPEATS; k++) { /* the last one short, for the check */
        const long count = k < REPEATS ? steps : 500;
        long made = 0;
        m->model.lagrangian(&d, m->model.q, m->model.v);
        memcpy(q, m->model.q, sizeof q);
        memcpy(p, d.Lv, sizeof p);
        const double t = bench_now();
        if (!tied_run(q, p, m, count, &made)) return 0;
        if (k == REPEATS) break;
        least = fmin(least, bench_now() - t);
        iterations = made;
    }
    printf("step\tC\tmidpoint, %s\tgeneric C -O2\t%.2f\t%.2f\n", m->model.name,
           least / (double)steps, (double)iterations / (double)steps);
    if (!ends) return 1;
    fprintf(ends, "%s", m->model.name);
    for (int i = 0; i < m->model.n; i++) fprintf(ends, "\t%.17g", q[i]);
    fprintf(ends, "\n");
    return 1;
}

/* RATTLE of the double spherical pendulum in R^6 */
static int constrained(int run(double *, double *, double, long, long *), const char *side,
                       const char *text, FILE *ends) {
    double q[6], v[6], least = INFINITY;
    const long steps = 50000;
    long iterations = 0;
    for (int k = 0; k <= REPEATS; k++) { /* the last one short, for the check */
        long made = 0;
        memcpy(q, rattle_q, sizeof q);
        memcpy(v, rattle_v, sizeof v);
        const double t = bench_now();
        if (!run(q, v, rattle_h, k < REPEATS ? steps : 500, &made)) return 0;
        if (k == REPEATS) break;
        least = fmin(least, bench_now() - t);
        iterations = made;
    }
    printf("step\t%s\trattle, double spherical pendulum in R^6\t%s\t%.2f\t%.2f\n", side, text,
           least / (double)steps, (double)iterations / (double)steps);
    if (!ends) return 1;
    fprintf(ends, "double spherical pendulum in R^6");
    for (int i = 0; i < 6; i++) fprintf(ends, "\t%.17g", q[i]);
    fprintf(ends, "\n");
    return 1;
}

int main(int argc, char **argv) {
    const char *const leapfrog = "leapfrog, one Kepler orbit";
    printf("step\tC\t%s\troot and division\t%.2f\t0\n", leapfrog,
           best(leapfrog_divide, STEPS) / STEPS);
    printf("step\tbound\t%s\treciprocal root\t%.2f\t0\n", leapfrog,
           best(leapfrog_reciprocal, STEPS) / STEPS);
    printf("step\tC\tleapfrog, ensemble of Kepler orbits\t64 in lanes\t%.3f\t0\n",
           best(leapfrog_lanes, STEPS / 10) / (STEPS / 10 * ORBITS));
    printf("step\tC\trotations(2), ensemble of heavy tops\t64 in lanes\t%.3f\t0\n",
           best(turns_lanes, STEPS / 50) / (STEPS / 50 * 8 * TURNS_GROUPS));
    FILE *ends = argc > 1 ? fopen(argv[1], "w") : NULL;
    const int fine = implicit(&newton_satellite, ends) && implicit(&newton_pendulum, ends) &&
                     implicit(&newton_bodies, ends) && tied(&tied_sphere, ends) &&
                     tied(&tied_double, ends) &&
                     constrained(rattle_run, "C", "by hand, -O2", ends) &&
                     constrained(rattle_run_wide, "C", "by hand, -O3 native", NULL);
    if (ends) fclose(ends);
    if (!fine) fprintf(stderr, "steps: an implicit step did not converge\n");
    return !fine;
}
