/* line_cells.c - a sine-Gordon step on bilinear cells by 2 x 2 Gauss points, as one writes it in C: one
 * loop over cells for the residual, sin and cos of the library, Newton's method with the matrix of
 * the guess (a parabola) kept, Thomas's elimination of the tridiagonal matrix, increments to
 * round-off. Argument: cells. Prints ns a cell and step, best of many. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { STEPS = 40, REPEATS = 15, MOST = 20 };
static const double G[2] = {0.21132486540518711775, 0.78867513459481288225};

typedef struct {
    int cells;
    double dx, h;
    double *u, *v, *w, *before, *older, *p; /* lower, upper, work; levels before; momenta */
    double *r, *d, *e, *l;                  /* residual, diagonal, off-diagonal, factors */
} line;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* dS/d(lower) into r (from p); with matrix also d2S/dlower dupper */
static void residual(line *s, const double *v, int matrix) {
    const double dx = s->dx, h = s->h, area = 0.25 * dx * h;
    for (int i = 0; i <= s->cells; i++) s->r[i] = s->p[i];
    if (matrix) {
        memset(s->d, 0, (size_t)(s->cells + 1) * sizeof *s->d);
        memset(s->e, 0, (size_t)(s->cells + 1) * sizeof *s->e);
    }
    for (int c = 0; c < s->cells; c++) {
        const double a = s->u[c], b = s->u[c + 1], f = v[c], g = v[c + 1];
        double left = 0.0, right = 0.0, ll = 0.0, lr = 0.0, rr = 0.0;
        for (int j = 0; j < 2; j++) {
            const double t = G[j], low = 1.0 - t, x = (low * (b - a) + t * (g - f)) / dx;
            for (int i = 0; i < 2; i++) {
                const double y = G[i], m = 1.0 - y;
                const double z = m * (low * a + t * f) + y * (low * b + t * g);
                const double k = (m * (f - a) + y * (g - b)) / h, force = sin(z);
                left += -k * m / h + x * low / dx - force * m * low;
                right += -k * y / h - x * low / dx - force * y * low;
                if (!matrix) continue;
                const double q = cos(z) * low * t, K = 1.0 / (h * h), X = low * t / (dx * dx);
                ll += -m * m * K - X - q * m * m;
                lr += -m * y * K + X - q * m * y;
                rr += -y * y * K - X - q * y * y;
            }
        }
        s->r[c] += area * left, s->r[c + 1] += area * right;
        if (!matrix) continue;
        s->d[c] += area * ll, s->d[c + 1] += area * rr, s->e[c] += area * lr;
    }
    s->r[0] = s->r[s->cells] = 0.0; /* fixed ends */
}

static void factor(line *s) {
    s->d[0] = s->d[s->cells] = 1.0;
    s->e[0] = s->e[s->cells - 1] = 0.0;
    s->d[0] = 1.0;
    for (int i = 1; i <= s->cells; i++) {
        s->l[i] = s->e[i - 1] * s->d[i - 1];
        s->d[i] = 1.0 / (s->d[i] - s->l[i] * s->e[i - 1]);
    }
}

static void solve(line *s, double *x) {
    for (int i = 1; i <= s->cells; i++) x[i] -= s->l[i] * x[i - 1];
    x[s->cells] *= s->d[s->cells];
    for (int i = s->cells; i-- > 0;) x[i] = (x[i] - s->e[i] * x[i + 1]) * s->d[i];
}

/* momenta of the upper level */
static void momenta(line *s, const double *v) {
    const double dx = s->dx, h = s->h, area = 0.25 * dx * h;
    memset(s->p, 0, (size_t)(s->cells + 1) * sizeof *s->p);
    for (int c = 0; c < s->cells; c++) {
        const double a = s->u[c], b = s->u[c + 1], f = v[c], g = v[c + 1];
        double left = 0.0, right = 0.0;
        for (int j = 0; j < 2; j++) {
            const double t = G[j], low = 1.0 - t, x = (low * (b - a) + t * (g - f)) / dx;
            for (int i = 0; i < 2; i++) {
                const double y = G[i], m = 1.0 - y;
                const double z = m * (low * a + t * f) + y * (low * b + t * g);
                const double k = (m * (f - a) + y * (g - b)) / h, force = sin(z);
                left += k * m / h + x * t / dx - force * m * t;
                right += k * y / h - x * t / dx - force * y * t;
            }
        }
        s->p[c] += area * left, s->p[c + 1] += area * right;
    }
}

static int step(line *s, int known) {
    const int n = s->cells + 1;
    double last = INFINITY;
    for (int i = 0; i < n; i++)
        s->v[i] = known > 2   ? 3.0 * (s->u[i] - s->before[i]) + s->older[i]
                  : known > 1 ? 2.0 * s->u[i] - s->before[i]
                              : s->u[i];
    s->v[0] = s->u[0], s->v[n - 1] = s->u[n - 1];
    for (int k = 0; k < MOST; k++) {
        double change = 0.0, size = 0.0;
        residual(s, s->v, k == 0);
        if (k == 0) factor(s);
        solve(s, s->r);
        for (int i = 0; i < n; i++) {
            s->v[i] -= s->r[i];
            change = fmax(change, fabs(s->r[i]));
            size = fmax(size, fabs(s->v[i]));
        }
        change /= size;
        if (change <= 4e-15 || (k && change / last * change <= 1e-17)) break;
        last = change;
    }
    momenta(s, s->v);
    double *old = s->older;
    s->older = s->before, s->before = s->u, s->u = s->v, s->v = old;
    return 0;
}

static double *array(int n) {
    return calloc((size_t)n, sizeof(double));
}

int main(int argc, char **argv) {
    const int cells = argc > 1 ? atoi(argv[1]) : 1000, n = cells + 1;
    line s = {.cells = cells, .dx = 30.0 / cells, .h = 15.0 / cells};
    const double g = 1.0 / sqrt(0.75);
    double best = INFINITY, check = 0.0;
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        s.u = array(n), s.v = array(n), s.before = array(n), s.older = array(n), s.p = array(n);
        s.r = array(n), s.d = array(n), s.e = array(n), s.l = array(n);
        for (int i = 0; i < n; i++) {
            const double x = -15.0 + s.dx * i;
            s.u[i] = 4.0 * atan(exp(g * x));
            s.p[i] = -g / cosh(g * x) * s.dx; /* lumped: the start does not count here */
        }
        const double start = now();
        for (int k = 0; k < STEPS; k++) step(&s, k + 1);
        best = fmin(best, now() - start);
        check = s.u[cells / 2];
    }
    printf("%-28s by hand in C        %9.1f ns a cell   (%d cells, u = %.6f)\n",
           "sine-Gordon cell step", best / STEPS / cells * 1e9, cells, check);
    return 0;
}
