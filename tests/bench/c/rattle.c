#include "rattle.h"

#include <math.h>

#ifdef BENCH_WIDE
#define RUN rattle_run_wide
#else
#define RUN rattle_run
const double rattle_h = 0.01;
const double rattle_q[6] = {0.6, 0.0, -0.8, 0.6, 0.6, -1.6};
const double rattle_v[6] = {0.0, 1.0, 0.0, 0.5, 1.0, 0.0};
#endif

static const double GRAVITY = 9.81;

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* rods: the first from the pivot, the second from mass to mass */
static void rods(double *a, double *b, const double *q) {
    for (int i = 0; i < 3; i++) a[i] = q[i], b[i] = q[3 + i] - q[i];
}

/* x of the 2 x 2 system by Cramer's rule */
static void solve(double *x, const double *A, const double *b) {
    const double inverse = 1.0 / (A[0] * A[3] - A[1] * A[2]);
    x[0] = (A[3] * b[0] - A[1] * b[1]) * inverse;
    x[1] = (A[0] * b[1] - A[2] * b[0]) * inverse;
}

/* v + M^-1 G^T l, G = (a, 0; -b, b) */
static void push(double *out, const double *v, const double *a, const double *b, const double *l) {
    for (int i = 0; i < 3; i++) {
        out[i] = v[i] + a[i] * l[0] - b[i] * l[1];
        out[3 + i] = v[3 + i] + b[i] * l[1];
    }
}

/* q1 = q + h (v + M^-1 G^T l) with g(q1) = 0; the new rods come back in a1, b1 */
static int drift(double *q, double *v, double *l, double h, const double *a, const double *b,
                 double *a1, double *b1, long *iterations) {
    double y[6], u[6];
    for (int k = 0; k < 50; k++) {
        push(u, v, a, b, l);
        for (int i = 0; i < 6; i++) y[i] = q[i] + h * u[i];
        rods(a1, b1, y);
        const double g[2] = {0.5 * (1.0 - dot(a1, a1)), 0.5 * (1.0 - dot(b1, b1))};
        if (fmax(fabs(g[0]), fabs(g[1])) <= 4e-16) {
            for (int i = 0; i < 6; i++) q[i] = y[i], v[i] = u[i];
            return 1;
        }
        const double ab = dot(a1, b), ba = dot(b1, a);
        const double J[4] = {h * dot(a1, a), -h * ab, -h * ba, 2.0 * h * dot(b1, b)};
        double d[2];
        solve(d, J, g);
        l[0] += d[0], l[1] += d[1];
        ++*iterations;
    }
    return 0;
}

/* v + M^-1 G^T l with G v = 0 */
static void tangent(double *v, double *l, const double *a, const double *b) {
    double relative[3];
    for (int i = 0; i < 3; i++) relative[i] = v[3 + i] - v[i];
    const double ab = dot(a, b);
    const double A[4] = {dot(a, a), -ab, -ab, 2.0 * dot(b, b)};
    const double r[2] = {-dot(a, v), -dot(b, relative)};
    solve(l, A, r);
    push(v, v, a, b, l);
}

int RUN(double *q, double *v, double h, long steps, long *iterations) {
    double a[3], b[3], a1[3], b1[3], l[2] = {0.0, 0.0};
    rods(a, b, q);
    for (long step = 0; step < steps; step++) {
        v[2] -= 0.5 * h * GRAVITY, v[5] -= 0.5 * h * GRAVITY;
        if (!drift(q, v, l, h, a, b, a1, b1, iterations)) return 0;
        v[2] -= 0.5 * h * GRAVITY, v[5] -= 0.5 * h * GRAVITY;
        for (int i = 0; i < 3; i++) a[i] = a1[i], b[i] = b1[i];
        tangent(v, l, a, b);
    }
    return 1;
}
