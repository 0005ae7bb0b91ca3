/* kdv.c - steps of a field as one writes them in C. KdV's soliton by Preissman's box,
 * u alone on a ring (the other components eliminated by hand): the twelve-point scheme of Ascher and
 * McLachlan (2004), with Newton's method and a cyclic band of five, to round-off. Argument: nodes.
 * Prints ns a node and step, best of many. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { STEPS = 50, REPEATS = 9, MOST = 20, BAND = 3 };

static int n;
static double h, dx, *u, *v, *r, *A, *before, *older;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double at(const double *x, int i) {
    return x[(i + 2 * n) % n];
}

/* u_t + 6 u u_x + u_xxx = 0 on boxes: (D_t M^3 u) + D_x M_t M (3 ubar^2) + D_x^3 M_t u = 0 at four
 * nodes i - 1 .. i + 2, ubar the mean over a box */
static void residual(int matrix) {
    if (matrix) memset(A, 0, (size_t)n * 4 * sizeof *A);
    for (int i = 0; i < n; i++) {
        const double a[4] = {at(u, i - 1), u[i], at(u, i + 1), at(u, i + 2)};
        const double b[4] = {at(v, i - 1), v[i], at(v, i + 1), at(v, i + 2)};
        double m[3];
        for (int k = 0; k < 3; k++) m[k] = 0.25 * (a[k] + a[k + 1] + b[k] + b[k + 1]);
        const double time = 0.125 / h;
        static const double mean[4] = {1, 3, 3, 1}, third[4] = {-1, 3, -3, 1};
        double sum = 3.0 * (m[2] * m[2] - m[0] * m[0]) / (2.0 * dx);
        for (int k = 0; k < 4; k++)
            sum += time * mean[k] * (b[k] - a[k]) + 0.5 * third[k] * (a[k] + b[k]) / (dx * dx * dx);
        r[i] = sum;
        if (!matrix) continue;
        for (int k = 0; k < 4; k++) A[4 * i + k] = time * mean[k] + 0.5 * third[k] / (dx * dx * dx);
        A[4 * i] -= 3.0 * 0.5 * m[0] / (2.0 * dx), A[4 * i + 1] -= 3.0 * 0.5 * m[0] / (2.0 * dx);
        A[4 * i + 2] += 3.0 * 0.5 * m[2] / (2.0 * dx);
        A[4 * i + 3] += 3.0 * 0.5 * m[2] / (2.0 * dx);
    }
}

/* The ring folded: unknown i at place 2 i or 2 (n - 1 - i) + 1, a band of width 2 BAND each way, by
 * Gauss's elimination with exchanges of rows. */
enum { W = 2 * BAND, ROW = 3 * W + 1 };
static double *band;
static int *place;

static void factor_and_solve(double *x) {
    memset(band, 0, (size_t)n * ROW * sizeof *band);
    double *y = r;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < 4; k++) {
            const int row = place[i], column = place[(i - 1 + k + n) % n];
            band[row * ROW + column - row + W] += A[4 * i + k];
        }
    for (int i = 0; i < n; i++) x[place[i]] = y[i];
    for (int j = 0; j < n; j++) {
        int best = j;
        const int last = j + W < n - 1 ? j + W : n - 1;
        for (int i = j + 1; i <= last; i++)
            if (fabs(band[i * ROW + j - i + W]) > fabs(band[best * ROW + j - best + W])) best = i;
        const int right = j + 2 * W < n - 1 ? j + 2 * W : n - 1;
        if (best != j) {
            for (int k = j; k <= right; k++) {
                const double t = band[j * ROW + k - j + W];
                band[j * ROW + k - j + W] = band[best * ROW + k - best + W];
                band[best * ROW + k - best + W] = t;
            }
            const double t = x[j];
            x[j] = x[best], x[best] = t;
        }
        for (int i = j + 1; i <= last; i++) {
            const double f = band[i * ROW + j - i + W] / band[j * ROW + W];
            if (f == 0.0) continue;
            for (int k = j; k <= right; k++)
                band[i * ROW + k - i + W] -= f * band[j * ROW + k - j + W];
            x[i] -= f * x[j];
        }
    }
    for (int j = n; j-- > 0;) {
        const int right = j + 2 * W < n - 1 ? j + 2 * W : n - 1;
        for (int k = j + 1; k <= right; k++) x[j] -= band[j * ROW + k - j + W] * x[k];
        x[j] /= band[j * ROW + W];
    }
}

static void step(int known, double *x) {
    double last = INFINITY;
    for (int i = 0; i < n; i++)
        v[i] = known > 2   ? 3.0 * (u[i] - before[i]) + older[i]
               : known > 1 ? 2.0 * u[i] - before[i]
                           : u[i];
    for (int k = 0; k < MOST; k++) {
        double change = 0.0;
        residual(1);
        factor_and_solve(x);
        for (int i = 0; i < n; i++) {
            v[i] -= x[place[i]];
            change = fmax(change, fabs(x[place[i]]));
        }
        if (change <= 4e-15 || (k && change / last * change <= 1e-17)) break;
        last = change;
    }
    memcpy(older, before, (size_t)n * sizeof *u);
    memcpy(before, u, (size_t)n * sizeof *u);
    memcpy(u, v, (size_t)n * sizeof *u);
}

int main(int argc, char **argv) {
    n = argc > 1 ? atoi(argv[1]) : 513;
    h = 0.02 * 129 / n, dx = 40.0 / n;
    double best = INFINITY, *x = calloc((size_t)n, sizeof *x), check = 0.0;
    u = calloc((size_t)n, sizeof *u), v = calloc((size_t)n, sizeof *v);
    r = calloc((size_t)n, sizeof *r), A = calloc((size_t)n * 4, sizeof *A);
    before = calloc((size_t)n, sizeof *u), older = calloc((size_t)n, sizeof *u);
    band = calloc((size_t)n * ROW, sizeof *band), place = calloc((size_t)n, sizeof *place);
    for (int i = 0; i < n; i++) place[i] = 2 * i < n ? 2 * i : 2 * (n - 1 - i) + 1;
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        for (int i = 0; i < n; i++) u[i] = 2.0 / (cosh(-20.0 + i * dx) * cosh(-20.0 + i * dx));
        const double began = now();
        for (int k = 0; k < STEPS; k++) step(k + 1, x);
        best = fmin(best, now() - began);
        check = u[n / 2];
    }
    printf("%-28s by hand in C        %9.1f ns a node   (%d nodes, u = %.6f)\n", "KdV by boxes",
           best / STEPS / n * 1e9, n, check);
    return 0;
}
