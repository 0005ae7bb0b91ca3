/* sizes - what it costs sweeps by hand that they end by every coordinate's own size: the outer
 * solar system (P3), 100 days a step, by gauss(1) = midpoint to gauss(8) to round-off from the
 * polynomial of the step before, sums compensated; W = 4: members side by side, W = 1: one alone.
 * Moves are judged by the size of all coordinates; by their own where these differ by 2^10, as
 * dmlua does (src/integ/stage/sweep), in the mean of squares or in their sum. Arguments: stages,
 * policy 0 to 2, steps: one of these, to count its instructions (callgrind, --toggle-collect=run).
 *   cc -O2 -mavx2 -mfma -DW=4 -o sizes tests/bench/c/by_hand/sizes.c -lm */
#define _DEFAULT_SOURCE
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifndef W
#define W 4
#endif
enum { BODIES = 6, N = 3 * BODIES, MOST = 8, TURNS = 40, SWEEPS = 60 };
typedef double V __attribute__((vector_size(8 * W)));
typedef long long I __attribute__((vector_size(8 * W)));

typedef enum { BY_ALL, BY_MEAN, BY_SUM, POLICIES } policy;
static const char *const names[] = {"by all", "each, mean", "each, sum"};
static const double STEP = 100.0, G = 2.95912208286e-4;
static const double LEFT = 1e-38, CLEAN = 1e-28, LEAST = 1e-4, APART = 0x1p20; /* of squares */

static const double mass[BODIES] = {1.00000597682,      0.000954786104043,  0.000285583733151,
                                    0.0000437273164546, 0.0000517759138449, 1.0 / 1.3e8};
static const double place[N] = {0.0,         0.0,         0.0,        -3.5023653,  -3.8169847,
                                -1.5507963,  9.0755314,   -3.0458353, -1.6483708,  8.3101420,
                                -16.2901086, -7.2521278,  11.4707666, -25.7294829, -10.8169456,
                                -15.5387357, -25.2225594, -3.1902382};
static const double speed[N] = {0.0,         0.0,         0.0,        0.00565429, -0.00412490,
                                -0.00190589, 0.00168318,  0.00483525, 0.00192462, 0.00354178,
                                0.00137102,  0.00055029,  0.00288930, 0.00114527, 0.00039677,
                                0.00276725,  -0.00170702, -0.00136504};

/* nodes, h^2 A^2 and h^2 b A, h b; h^2 A^2 E, E: the polynomial of the last step at the next one */
typedef struct {
    double c[MOST], AA[MOST][MOST], bA[MOST], b[MOST], ahead[MOST][MOST];
} table;

typedef struct {
    V q[N], v[N], q_low[N], v_low[N], u[MOST][N], rate;
    long sweeps, units;
} group;

static inline V same(double x) {
    return x - (V){0};
}
static inline V pick(I yes, V a, V b) {
    return (V)((yes & (I)a) | (~yes & (I)b));
}
static inline int some(I yes) {
    long long any = 0;
    for (int l = 0; l < W; l++) any |= yes[l];
    return any != 0;
}
static inline V root(V x) {
    V r;
    for (int l = 0; l < W; l++) r[l] = sqrt(x[l]);
    return r;
}

/* nodes and weights of Gauss on [0, 1] */
static void gauss(int s, double *c, double *b) {
    for (int i = 0; i < s; i++) {
        double x = cos(M_PI * (i + 0.75) / (s + 0.5)), slope = 1.0;
        for (int n = 0; n < 100; n++) {
            double p = 1.0, before = 0.0;
            for (int k = 0; k < s; k++) {
                const double next = ((2 * k + 1) * x * p - k * before) / (k + 1);
                before = p, p = next;
            }
            slope = s * (before - x * p) / (1.0 - x * x);
            x -= p / slope;
        }
        c[s - 1 - i] = 0.5 + 0.5 * x;
        b[s - 1 - i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
}

/* Lagrange's polynomial j of the nodes at x */
static double lagrange(int s, const double *c, int j, double x) {
    double out = 1.0;
    for (int i = 0; i < s; i++)
        if (i != j) out *= (x - c[i]) / (c[j] - c[i]);
    return out;
}

static table table_of(int s) {
    const double h = STEP;
    double A[MOST][MOST] = {{0}}, b[MOST];
    table t = {.c = {0}};
    gauss(s, t.c, b);
    for (int i = 0; i < s; i++)
        for (int j = 0; j < s; j++)
            for (int k = 0; k < s; k++)
                A[i][j] += t.c[i] * b[k] * lagrange(s, t.c, j, t.c[i] * t.c[k]);
    for (int i = 0; i < s; i++) {
        t.b[i] = h * b[i];
        for (int k = 0; k < s; k++) {
            t.bA[i] += h * h * b[k] * A[k][i];
            for (int j = 0; j < s; j++) t.AA[i][j] += h * h * A[i][k] * A[k][j];
        }
    }
    for (int i = 0; i < s; i++)
        for (int j = 0; j < s; j++)
            for (int m = 0; m < s; m++)
                t.ahead[i][m] += t.AA[i][j] * lagrange(s, t.c, m, 1.0 + t.c[j]);
    return t;
}

/* accelerations */
static inline void pull(V *u, const V *x) {
    for (int k = 0; k < N; k++) u[k] = (V){0};
    for (int a = 1; a < BODIES; a++)
        for (int b = 0; b < a; b++) {
            V d[3], r2 = {0};
            for (int k = 0; k < 3; k++) d[k] = x[3 * a + k] - x[3 * b + k], r2 += d[k] * d[k];
            const V f = G / (r2 * root(r2));
            for (int k = 0; k < 3; k++) {
                u[3 * a + k] -= f * mass[b] * d[k];
                u[3 * b + k] += f * mass[a] * d[k];
            }
        }
}

/* the sum of squares of the start and of the last stage; unit where some are far apart */
static inline V measure(const group *g, const V *x, V *unit, int *apart, policy how) {
    V size = {0}, least = same(INFINITY), own[N];
    for (int k = 0; k < N; k++) {
        own[k] = g->q[k] * g->q[k] + x[k] * x[k];
        size += own[k];
        least = pick((own[k] > 0.0) & (own[k] < least), own[k], least);
    }
    *apart = how != BY_ALL && some(APART * least < size);
    if (!*apart) return size;
    const V mean = how == BY_SUM ? size : size / (double)N;
    for (int k = 0; k < N; k++) unit[k] = pick(own[k] > 0.0, mean / own[k], same(1.0));
    return size;
}

/* new places of the stages; the sum of squares of the moves */
static inline __attribute__((always_inline)) V move(const group *g, const table *t, V x[][N],
                                                    V base[][N], int stages, const V *unit) {
    V moved = {0};
    for (int k = 0; k < N; k++)
        for (int i = 0; i < stages; i++) {
            V sum = base[i][k];
            for (int j = 0; j < stages; j++) sum += t->AA[i][j] * g->u[j][k];
            const V now = g->q[k] + sum, d = now - x[i][k];
            moved += unit ? d * unit[k] * d : d * d;
            x[i][k] = now;
        }
    return moved;
}

/* the first stages, by the forces of the step before */
static inline __attribute__((always_inline)) void set_off(const group *g, const table *t, V x[][N],
                                                          V base[][N], int stages, int warm) {
    for (int i = 0; i < stages; i++)
        for (int k = 0; k < N; k++) {
            V sum = base[i][k] = g->q_low[k] + STEP * t->c[i] * g->v[k];
            for (int j = 0; j < stages && warm; j++) sum += t->ahead[i][j] * g->u[j][k];
            x[i][k] = g->q[k] + sum;
        }
}

/* sweeps until what the last one leaves is round-off in all members */
static inline __attribute__((always_inline)) int iterate(group *g, const table *t, int stages,
                                                         policy how, int warm) {
    V x[MOST][N], base[MOST][N], unit[N], change = same(1.0);
    I open = ~(I){0}, rated = {0};
    int apart;
    set_off(g, t, x, base, stages, warm);
    V rate = warm ? pick(4.0 * g->rate > LEAST, 4.0 * g->rate, same(LEAST)) : same(0.1225);
    const V scale = 1.0 / measure(g, x[stages - 1], unit, &apart, how);
    g->units += apart;
    for (int i = 0; i < stages; i++) pull(g->u[i], x[i]);
    for (int n = 0; n < SWEEPS; n++) {
        const V before = change;
        change =
            scale * (apart ? move(g, t, x, base, stages, unit) : move(g, t, x, base, stages, NULL));
        for (int i = 0; i < stages; i++) pull(g->u[i], x[i]);
        g->sweeps++;
        const I clean = (before <= CLEAN) & (change <= 100.0 * CLEAN);
        if (n) rate = pick(clean, rate, change / before), rated |= ~clean;
        change = pick(clean, rate * before, change);
        open &= ~(rate * change <= LEFT);
        if (!some(open)) return g->rate = pick(rated, rate, g->rate), 1;
    }
    return 0;
}

static inline void add(V *high, V *low, V d) {
    const V old = *high, e = *low + d;
    *high = old + e;
    *low = e + (old - *high);
}

static inline __attribute__((always_inline)) int step(group *g, const table *t, int stages,
                                                      policy how, int warm) {
    if (!iterate(g, t, stages, how, warm)) return 0;
    for (int k = 0; k < N; k++) {
        V dq = STEP * g->v[k], dv = {0};
        for (int j = 0; j < stages; j++) dq += t->bA[j] * g->u[j][k], dv += t->b[j] * g->u[j][k];
        add(g->q + k, g->q_low + k, dq);
        add(g->v + k, g->v_low + k, dv);
    }
    return 1;
}

/* from its start, members 1e-3 of Jupiter's place apart */
static inline __attribute__((always_inline)) double steps_of(group *g, int stages, policy how,
                                                             long steps) {
    const table t = table_of(stages);
    *g = (group){.rate = same(0.01)};
    for (int k = 0; k < N; k++) g->q[k] = same(place[k]), g->v[k] = same(speed[k]);
    for (int l = 0; l < W; l++) g->q[3][l] *= 1.0 + 1e-3 * l;
    for (long k = 0; k < steps; k++)
        if (!step(g, &t, stages, how, k > 0)) return NAN;
    return g->q[3][0];
}

__attribute__((noinline)) static double run(group *g, int stages, policy how, long steps) {
    switch (stages) { /* a copy of the code for each */
    case 1:
        return steps_of(g, 1, how, steps);
    case 2:
        return steps_of(g, 2, how, steps);
    case 3:
        return steps_of(g, 3, how, steps);
    case 4:
        return steps_of(g, 4, how, steps);
    case 6:
        return steps_of(g, 6, how, steps);
    default:
        return steps_of(g, 8, how, steps);
    }
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

int main(int count, char **argument) {
    static group g[POLICIES];
    if (count > 3) {
        printf("%.17g\n", run(g, atoi(argument[1]), (policy)atoi(argument[2]), atol(argument[3])));
        return 0;
    }
    static const int all[] = {1, 2, 3, 4, 6, 8};
    for (int a = 0; a < 6; a++) {
        const int stages = all[a];
        const long steps = 400;
        double best[POLICIES] = {INFINITY, INFINITY, INFINITY};
        for (int turn = 0; turn < TURNS; turn++)
            for (int how = 0; how < POLICIES; how++) {
                const double t = now();
                if (!isfinite(run(g + how, stages, (policy)how, steps))) return 1;
                best[how] = fmin(best[how], now() - t);
            }
        for (int how = 0; how < POLICIES; how++)
            printf("%d stage(s), W = %d, %-11s %7.1f ns a step %6.3f  sweeps %.2f  units %.2f\n",
                   stages, W, names[how], best[how] / (double)(steps * W), best[how] / best[0],
                   (double)g[how].sweeps / (double)steps, (double)g[how].units / (double)steps);
    }
    return 0;
}
