/* wrong_map.c - what the class `wrong` of a stability map costs in C written for it: the maps Henon-Heiles and quartic chain of
 * tests/bench/stability.lua, by Verlet, every cell alone and 8 cells of one step side by side, first with the energy at 64 rows
 * alone, then beside the flow of its row: kahan-li(8) up to the level at which it is known, a second family as far, a look at all
 * coordinates at every due step, the polynomial through eight rows of the flow, a parabola between three looks, until the cell is
 * off. No exponents, borders or classes. Prints CPU time of both and their ratio. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { W = 8, MOST = 12, ROWS = 64, NODES = 8 };
typedef double V __attribute__((vector_size(8 * W)));

typedef struct {
    int n, rows, steps, level, looks; /* coordinates, rows, steps h, steps and looks of a flow */
    double least, largest, t;         /* steps h */
    void (*force)(V *f, const V *q, const V *k);
    void (*start)(double *q, double *p, double *k, int row);
} problem;

static void henon_force(V *f, const V *q, const V *k) {
    (void)k;
    f[0] = -q[0] - 2.0 * q[0] * q[1];
    f[1] = -q[1] - q[0] * q[0] + q[1] * q[1];
}

static void henon_start(double *q, double *p, double *k, int row) {
    q[0] = 0.0, q[1] = -0.2 + 0.5 * row / 9.0, p[0] = 0.3, p[1] = 0.0, *k = 1.0;
}

static void chain_force(V *f, const V *q, const V *k) {
    V left = q[0];
    for (int i = 0; i < 12; i++) {
        const V d = i < 11 ? q[i + 1] - q[i] : -q[i];
        const V right = i < 11 ? k[0] * d + d * d * d : d;
        f[i] = right - left;
        left = right;
    }
}

static void chain_start(double *q, double *p, double *k, int row) {
    memset(q, 0, 12 * sizeof *q), memset(p, 0, 12 * sizeof *p);
    q[0] = 1.0, *k = pow(10.0, row / 5.0);
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* kahan-li(8): symmetric composition of 17 stages (Kahan & Li 1997) */
static const double half[9] = {0.13020248308889008088,  0.56116298177510838456,
                               -0.38947496264484728641, 0.15884190655515560089,
                               -0.39590389413323757734, 0.18453964097831570709,
                               0.25837438768632204729,  0.29501172360931029887,
                               -0.60550853383003451170};

static void steps_of(const problem *x, V *q, V *p, const V *k, double h, int stages, int count) {
    V f[MOST];
    x->force(f, q, k);
    for (int s = 0; s < count; s++)
        for (int g = 0; g < stages; g++) {
            const double hg = stages == 1 ? h : h * half[g < 9 ? g : 16 - g];
            for (int i = 0; i < x->n; i++) p[i] += 0.5 * hg * f[i], q[i] += hg * p[i];
            x->force(f, q, k);
            for (int i = 0; i < x->n; i++) p[i] += 0.5 * hg * f[i];
        }
}

static void fill(const problem *x, V *q, V *p, V *k, int row) {
    double a[MOST], b[MOST], c;
    for (int l = 0; l < W; l++) {
        x->start(a, b, &c, row + l < x->rows ? row + l : x->rows - 1);
        for (int i = 0; i < x->n; i++) q[i][l] = a[i], p[i][l] = b[i];
        (*k)[l] = c;
    }
}

/* flow[step][n] of W rows of the map: levels of twice the steps up to the one that is known, that again in place of a second
 * family, whose steps cost no less */
static void make_flows(const problem *x, V *flow, int row) {
    V q[MOST], p[MOST], k;
    for (int level = 64; level <= 2 * x->level; level *= 2) {
        const int steps = level <= x->level ? level : x->level;
        fill(x, q, p, &k, row);
        for (int s = 0; s <= steps; s++) {
            memcpy(flow + s * x->n, q, (size_t)x->n * sizeof *q);
            steps_of(x, q, p, &k, x->t / steps, 17, 1);
        }
    }
}

typedef struct {
    V most[MOST], last[MOST], before[MOST];
    double bound[MOST];
    int off;
} looks;

static V magnitude(V x) {
    V y;
    for (int l = 0; l < W; l++) y[l] = fabs(x[l]);
    return y;
}

/* all W members at one time, since their steps are equal */
static void look(const problem *x, looks *s, const V *flow, const V *q, double t, int seen) {
    const double place = t / x->t * x->level;
    int first = (int)place - 3, all = 1;
    first = first < 0 ? 0 : first > x->level - 7 ? x->level - 7 : first;
    double weight[NODES], left = 1.0, right = 1.0;
    static const double below[NODES] = {-1.0 / 5040.0, 1.0 / 720.0, -1.0 / 240.0, 1.0 / 144.0,
                                        -1.0 / 144.0,  1.0 / 240.0, -1.0 / 720.0, 1.0 / 5040.0};
    for (int i = 0; i < NODES; i++) weight[i] = left * below[i], left *= place - first - i;
    for (int i = NODES; i-- > 0;) weight[i] *= right, right *= place - first - i;
    for (int i = 0; i < x->n; i++) {
        V here = q[i];
        for (int m = 0; m < NODES; m++) here -= weight[m] * flow[(first + m) * x->n + i];
        const V bend = s->before[i] - 2.0 * s->last[i] + here, rise = 0.5 * (here - s->before[i]);
        const V top = magnitude(s->last[i] - 0.5 * rise * rise / bend), size = magnitude(here);
        const V turns = (s->last[i] - s->before[i]) * (here - s->last[i]);
        for (int l = 0; l < W; l++) {
            double most = size[l] > s->most[i][l] ? size[l] : s->most[i][l];
            if (seen > 1 && turns[l] < 0.0 && top[l] > most) most = top[l];
            s->most[i][l] = most;
        }
        s->before[i] = s->last[i], s->last[i] = here;
    }
    for (int l = 0; l < W; l++) {
        int off = 0;
        for (int i = 0; i < x->n; i++) off |= !(s->most[i][l] <= s->bound[i]);
        all &= off;
    }
    s->off = all;
}

/* W cells of one step: energies at 64 rows, and looks until all of them are off; the sum of what was found */
static double run(const problem *x, double h, int row, const V *flow) {
    const int steps = (int)(x->t / h), every = steps / ROWS > 0 ? steps / ROWS : 1;
    const int dense = steps > x->looks ? (steps - 1) / x->looks + 1 : 1;
    V q[MOST], p[MOST], k, energy = {0.0};
    looks s = {.off = flow == NULL};
    for (int i = 0; i < x->n; i++) s.bound[i] = 0.01 * (x->n == 2 ? 0.7 : 1.5);
    fill(x, q, p, &k, row);
    for (int done = 0, next, seen = 0; done < steps; done = next) {
        next = done - done % every + every;
        if (!s.off && done - done % dense + dense < next) next = done - done % dense + dense;
        if (next > steps) next = steps;
        steps_of(x, q, p, &k, h, 1, next - done);
        if (next % every == 0)
            for (int i = 0; i < x->n; i++) energy += 0.5 * (p[i] * p[i] + q[i] * q[i]);
        if (!s.off && next % dense == 0) look(x, &s, flow, q, next * h, seen++);
    }
    double sum = 0.0;
    for (int l = 0; l < W; l++) sum += energy[l] + s.most[0][l];
    return sum;
}

static double map(const problem *x, int beside) {
    double sum = 0.0;
    for (int row = 0; row < x->rows; row += W) {
        V *flow =
            beside ? aligned_alloc(64, (size_t)(x->level + 1) * (size_t)x->n * sizeof *flow) : NULL;
        if (flow) make_flows(x, flow, row);
        for (int c = 0; c < x->steps; c++)
            sum += run(x, x->least * pow(x->largest / x->least, c / (x->steps - 1.0)), row, flow);
        free(flow);
    }
    return sum;
}

int main(void) {
    const struct {
        const char *name;
        problem x;
    } all[] = {{"Henon-Heiles",
                {2, 10, 160, 1024, 512, 0.01, 2.5, 200.0, henon_force, henon_start}},
               {"quartic chain of 12",
                {12, 6, 120, 1024, 512, 0.005, 0.3, 60.0, chain_force, chain_start}}};
    volatile double sink = 0.0;
    for (int i = 0; i < 2; i++) {
        double best[2] = {INFINITY, INFINITY};
        for (int k = 0; k < 20; k++) {
            const double start = now();
            sink += map(&all[i].x, k % 2);
            best[k % 2] = fmin(best[k % 2], now() - start);
        }
        printf("%-28s by hand in C: %.2f -> %.2f ms, %.2f times\n", all[i].name, 1e3 * best[0],
               1e3 * best[1], best[1] / best[0]);
    }
    return 0;
}
