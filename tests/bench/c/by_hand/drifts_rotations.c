/* drifts_rotations.c - how the vertical momentum of a heavy top, J = (R mu)_3, drifts in the steps
 * that a good programmer writes of rotations(2): half turns about two axes, a whole one about the
 * third, and back, between half kicks; gains in compensated sums. A row of
 * docs/benchmarks/drifts.md. Slope per unit of time of ten starts, mean and standard error by their
 * spread. Arguments: steps a start, h.
 *   gcc -O2 -o build/drifts_rotations tests/bench/c/by_hand/drifts_rotations.c -lm
 *   build/drifts_rotations 1e6 0.05
 *   sees the rest   turns take along what rounding left of the first kick */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STARTS = 10, ROWS = 1000 };
static const double I[3] = {1.0, 1.2, 0.6};

/* rows 0 to 2: R, 3: mu; a turn about a body axis takes all rows alike */
typedef struct {
    double high[4][3], low[4][3];
} state;

static void add(double *high, double *low, double x) {
    const double a = *high, e = *low + x, sum = a + e;
    *low = e + (a - sum);
    *high = sum;
}

/* x becomes x exp(xi e_a); what it gains is added to `gain` */
static void turn(double x[4][3], double gain[4][3], int a, double xi) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const double half = sin(0.5 * xi), s = sin(xi), k = -2.0 * half * half;
    for (int i = 0; i < 4; i++) {
        const double more = k * x[i][b] + s * x[i][c], other = k * x[i][c] - s * x[i][b];
        x[i][b] += more, x[i][c] += other;
        gain[i][b] += more, gain[i][c] += other;
    }
}

/* mu += w torque of V = R_33, which is added to `gain`; what rounding left of it */
static void kick(double x[4][3], double gain[4][3], double rest[4][3], double w) {
    const double more[2] = {w * x[2][1], -w * x[2][0]};
    for (int i = 0; i < 2; i++) {
        const double before = x[3][i];
        x[3][i] += more[i];
        gain[3][i] += more[i];
        rest[3][i] = more[i] - (x[3][i] - before);
    }
}

static void step(state *s, double h, int sees_rest) {
    static const int axis[5] = {0, 1, 2, 1, 0};
    double x[4][3], rest[4][3] = {{0.0}}, gain[4][3] = {{0.0}};
    memcpy(x, s->high, sizeof x);
    kick(x, gain, rest, 0.5 * h);
    for (int k = 0; k < 5; k++) {
        const int a = axis[k];
        const double xi = (a == 2 ? h : 0.5 * h) * x[3][a] / I[a];
        turn(x, gain, a, xi);
        if (sees_rest) turn(rest, gain, a, xi);
    }
    kick(x, gain, rest, 0.5 * h);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) add(&s->high[i][k], &s->low[i][k], gain[i][k]);
}

static double uniform(void) {
    return rand() / (RAND_MAX + 1.0);
}

static void start(state *s) {
    *s = (state){.high = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    double none[4][3] = {{0.0}};
    for (int k = 0; k < 9; k++) turn(s->high, none, k % 3, 2.0 * uniform() - 1.0);
    for (int a = 0; a < 3; a++) s->high[3][a] = (a == 2) + uniform();
}

/* slope by least squares of J over ROWS rows */
static double slope(double steps, double h, int sees_rest) {
    state s;
    start(&s);
    const long every = (long)(steps / ROWS);
    double first = 0.0, t_J = 0.0, t_t = 0.0;
    for (int k = 0; k <= ROWS; k++) {
        double J = 0.0;
        for (int i = 0; i < 3; i++) J += s.high[2][i] * s.high[3][i];
        if (k == 0) first = J;
        const double t = (k - 0.5 * ROWS) * (double)every * h;
        t_J += t * (J - first), t_t += t * t;
        for (long i = 0; k < ROWS && i < every; i++) step(&s, h, sees_rest);
    }
    return t_J / t_t;
}

int main(int argc, char **argv) {
    const double steps = argc > 1 ? atof(argv[1]) : 1e6, h = argc > 2 ? atof(argv[2]) : 0.05;
    for (int sees_rest = 0; sees_rest < 2; sees_rest++) {
        double J[STARTS], mean = 0.0, square = 0.0;
        srand(1);
        for (int i = 0; i < STARTS; i++) mean += (J[i] = slope(steps, h, sees_rest)) / STARTS;
        for (int i = 0; i < STARTS; i++) square += (J[i] - mean) * (J[i] - mean);
        printf("rotations(2), by hand%-15s J %9.2e +- %8.2e\n", sees_rest ? ", sees the rest" : "",
               mean, sqrt(square / (STARTS * (STARTS - 1))));
    }
    return 0;
}
