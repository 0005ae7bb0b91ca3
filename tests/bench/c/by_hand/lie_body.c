/* lie_body - lie(1) of a rigid body by hand, to round-off, beside `dmlua tests/bench/lie_body.lua`:
 * unit quaternion and body momentum, the exponential chart, Newton's method for the velocity V of
 * the step, sums of the state compensated. Two designs, on a free body and on a heavy top:
 *   full   the exact 3 x 3 matrix in every iteration, sines and cosines of the C library, a linear
 *          guess
 *   chord  the matrix once a step, series in |h V|^2 in place of sines, a guess of fourth order
 * The step: with xi = h V, m = xi/2, g(m) = g0 exp(m), tau the torque -U_g at g(m),
 *   I V + h/2 dexp(-m)^T tau = dexp(xi)^T (p0 + h Ad*(m) tau),
 *   g1 = g0 exp(xi), p1 = exp(xi)^T (p0 + h Ad*(m) tau).
 * cc -O3 -march=native -fno-math-errno -fno-trapping-math -o lie_body
 *     tests/bench/c/by_hand/lie_body.c -lm */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct {
    double I[3], h, weight; /* moments, step, of the potential weight R33 */
    double q[4], p[3], q_low[4], p_low[3];
    double last[5][3]; /* V of the last steps, newest first */
    int known;
    long iterations;
} body;

typedef struct {
    double R[3], J[3][3], mu[3]; /* residual, its matrix, p0 + P */
} equation;

typedef struct {
    double c0, c1, c2, c3, c4, c5; /* (x = sqrt t) cos x, sin x / x, (1 - cos x)/x^2, ... */
} series;

static inline void cross(double *out, const double *a, const double *b) {
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
    out[0] = x;
    out[1] = y;
}

static inline double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void add(double *high, double *low, double d) {
    const double e = *low + d, sum = *high + e;
    *low = e + (*high - sum);
    *high = sum;
}

/* Stumpff's functions at t < 1, by the two last ones */
static inline series by_series(double t) {
    series c;
    c.c4 = 1 / 24.0 +
           t * (-1 / 720.0 +
                t * (1 / 40320.0 + t * (-1 / 3628800.0 +
                                        t * (1 / 479001600.0 + t * (-1 / 87178291200.0 +
                                                                    t * (1 / 20922789888000.0))))));
    c.c5 =
        1 / 120.0 +
        t * (-1 / 5040.0 +
             t * (1 / 362880.0 + t * (-1 / 39916800.0 +
                                      t * (1 / 6227020800.0 + t * (-1 / 1307674368000.0 +
                                                                   t * (1 / 355687428096000.0))))));
    c.c3 = 1 / 6.0 - t * c.c5;
    c.c2 = 0.5 - t * c.c4;
    c.c1 = 1 - t * c.c3;
    c.c0 = 1 - t * c.c2;
    return c;
}

/* the same by sines and cosines, the last ones by series where digits cancel */
static inline series by_sines(double t) {
    if (t < 1) return by_series(t);
    series c;
    const double x = sqrt(t);
    c.c0 = cos(x), c.c1 = sin(x) / x;
    c.c2 = (1 - c.c0) / t, c.c3 = (1 - c.c1) / t;
    c.c4 = (0.5 - c.c2) / t, c.c5 = (1 / 6.0 - c.c3) / t;
    return c;
}

static int library = 1; /* sines and cosines of the C library (full), or series alone */

static inline series stumpff(double t) {
    return library ? by_sines(t) : by_series(t);
}

/* out = y + a x X y + b x X (x X y) */
static inline void turned(double *out, const double *x, const double *y, double a, double b) {
    double u[3], w[3];
    cross(u, x, y);
    cross(w, x, u);
    for (int k = 0; k < 3; k++) out[k] = y[k] + a * u[k] + b * w[k];
}

/* columns of d/dx [y + a(t) x X y + b(t) x X (x X y)], t = x.x, a' and b' their slopes in t */
static inline void slope(double J[3][3], const double *x, const double *y, double a, double b,
                         double da, double db) {
    double u[3], w[3];
    cross(u, x, y);
    cross(w, x, u);
    const double xy = dot(x, y);
    /* d(x X y) = -y X e; x X (x X y) = x (x.y) - y (x.x) */
    const double Y[3][3] = {{0, y[2], -y[1]}, {-y[2], 0, y[0]}, {y[1], -y[0], 0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            J[i][j] = a * Y[i][j] + b * ((i == j ? xy : 0) + x[i] * y[j] - 2 * y[i] * x[j]) +
                      2 * (da * u[i] + db * w[i]) * x[j];
}

/* the third row of R(q): where the vertical is in the body */
static inline void vertical(double *z, const double *q) {
    z[0] = 2 * (q[1] * q[3] - q[0] * q[2]);
    z[1] = 2 * (q[2] * q[3] + q[0] * q[1]);
    z[2] = q[0] * q[0] - q[1] * q[1] - q[2] * q[2] + q[3] * q[3];
}

/* what the potential adds: force = h/2 dexp(-m)^T tau, P = h exp(m) tau, and derivatives in V */
static inline void add_potential(equation *e, const body *b, const double *V, double *force,
                                 double F[3][3], double M[3][3], int exact) {
    const double h = b->h, half = 0.5 * h;
    double m[3], z0[3], z[3], tau[3];
    for (int k = 0; k < 3; k++) m[k] = half * V[k];
    const series c = stumpff(dot(m, m));
    vertical(z0, b->q);
    turned(z, m, z0, -c.c1, c.c2); /* exp(-m) z0 */
    tau[0] = b->weight * z[1], tau[1] = -b->weight * z[0], tau[2] = 0;
    turned(force, m, tau, c.c2, c.c3);
    double P[3];
    turned(P, m, tau, c.c1, c.c2);
    for (int k = 0; k < 3; k++) force[k] *= half, e->mu[k] += h * P[k];
    if (!exact) return;
    /* of c_k in t: (k c_(k+2) - c_(k+1))/2 */
    const double d1 = (c.c3 - c.c2) / 2, d2 = (2 * c.c4 - c.c3) / 2, d3 = (3 * c.c5 - c.c4) / 2;
    double Z[3][3], T[3][3], A[3][3];
    slope(Z, m, z0, -c.c1, c.c2, -d1, d2);
    for (int j = 0; j < 3; j++)
        T[0][j] = b->weight * Z[1][j], T[1][j] = -b->weight * Z[0][j], T[2][j] = 0;
    slope(A, m, tau, c.c2, c.c3, d2, d3);
    for (int j = 0; j < 3; j++) {
        const double t[3] = {T[0][j], T[1][j], T[2][j]};
        double w[3];
        turned(w, m, t, c.c2, c.c3);
        for (int i = 0; i < 3; i++) F[i][j] = half * half * (A[i][j] + w[i]);
    }
    slope(A, m, tau, c.c1, c.c2, d1, d2);
    for (int j = 0; j < 3; j++) {
        const double t[3] = {T[0][j], T[1][j], T[2][j]};
        double w[3];
        turned(w, m, t, c.c1, c.c2);
        for (int i = 0; i < 3; i++) M[i][j] = h * half * (A[i][j] + w[i]);
    }
}

static inline void evaluate(equation *e, const body *b, const double *V, int heavy, int exact) {
    double xi[3], pulled[3], force[3] = {0}, F[3][3] = {{0}}, M[3][3] = {{0}};
    for (int k = 0; k < 3; k++) xi[k] = b->h * V[k], e->mu[k] = b->p[k] + b->p_low[k];
    if (heavy) add_potential(e, b, V, force, F, M, exact);
    const series c = stumpff(dot(xi, xi));
    turned(pulled, xi, e->mu, -c.c2, c.c3);
    for (int k = 0; k < 3; k++) e->R[k] = b->I[k] * V[k] + force[k] - pulled[k];
    if (!exact) return;
    double A[3][3];
    slope(A, xi, e->mu, -c.c2, c.c3, -(2 * c.c4 - c.c3) / 2, (3 * c.c5 - c.c4) / 2);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            e->J[i][j] = (i == j ? b->I[i] : 0) - b->h * A[i][j] + (heavy ? F[i][j] : 0);
    if (!heavy) return;
    for (int j = 0; j < 3; j++) {
        const double t[3] = {M[0][j], M[1][j], M[2][j]};
        double w[3];
        turned(w, xi, t, -c.c2, c.c3);
        for (int i = 0; i < 3; i++) e->J[i][j] -= w[i];
    }
}

/* inverse by cofactors */
static inline void invert(double B[3][3], double A[3][3]) {
    double x[3], y[3], z[3];
    cross(x, A[1], A[2]);
    cross(y, A[2], A[0]);
    cross(z, A[0], A[1]);
    const double w = 1 / dot(A[0], x);
    for (int i = 0; i < 3; i++) B[i][0] = w * x[i], B[i][1] = w * y[i], B[i][2] = w * z[i];
}

/* V -= B R; the largest entry of the change */
static inline double improve(double *V, double B[3][3], const double *R) {
    double most = 0;
    for (int i = 0; i < 3; i++) {
        const double d = dot(B[i], R);
        V[i] -= d;
        most = fmax(most, fabs(d));
    }
    return most;
}

static inline void finish(body *b, const double *V, const double *mu) {
    double xi[3], v[3], out[3];
    for (int k = 0; k < 3; k++) xi[k] = b->h * V[k];
    const double t = dot(xi, xi);
    const series c = stumpff(t), s = stumpff(0.25 * t);
    const double w = -0.25 * t * s.c2, *q = b->q; /* cos - 1, of half of the angle */
    for (int k = 0; k < 3; k++) v[k] = 0.5 * s.c1 * xi[k];
    const double d[4] = {q[0] * w - q[1] * v[0] - q[2] * v[1] - q[3] * v[2],
                         q[1] * w + q[0] * v[0] + q[2] * v[2] - q[3] * v[1],
                         q[2] * w + q[0] * v[1] + q[3] * v[0] - q[1] * v[2],
                         q[3] * w + q[0] * v[2] + q[1] * v[1] - q[2] * v[0]};
    double u[3], uu[3];
    cross(u, xi, mu);
    cross(uu, xi, u);
    for (int k = 0; k < 3; k++)
        out[k] = (mu[k] - (b->p[k] + b->p_low[k])) - c.c1 * u[k] + c.c2 * uu[k];
    for (int k = 0; k < 4; k++) add(&b->q[k], &b->q_low[k], d[k]);
    for (int k = 0; k < 3; k++) add(&b->p[k], &b->p_low[k], out[k]);
}

static inline void remember(body *b, const double *V) {
    memmove(b->last[1], b->last[0], 4 * sizeof b->last[0]);
    memcpy(b->last[0], V, sizeof b->last[0]);
    if (b->known < 5) b->known++;
}

static inline void guess(double *V, const body *b, int most) {
    static const double ahead[5][5] = {{1},
                                       {2, -1},
                                       {3, -3, 1},
                                       {4, -6, 4, -1},
                                       {5, -10, 10, -5, 1}};
    const int known = b->known < most ? b->known : most;
    for (int k = 0; k < 3; k++) {
        V[k] = known ? 0 : b->p[k] / b->I[k];
        for (int i = 0; i < known; i++) V[k] += ahead[known - 1][i] * b->last[i][k];
    }
}

static inline double size_of(const double *V) {
    return fmax(fabs(V[0]), fmax(fabs(V[1]), fabs(V[2])));
}

/* Newton's method; what is left after a change of d is d^2 and less than round-off */
static inline void step_full(body *b, int heavy) {
    double V[3], B[3][3], d;
    equation e;
    guess(V, b, 2);
    do {
        evaluate(&e, b, V, heavy, 1);
        invert(B, e.J);
        d = improve(V, B, e.R);
        b->iterations++;
    } while (d > 1e-9 * size_of(V));
    evaluate(&e, b, V, heavy, 0);
    finish(b, V, e.mu);
    remember(b, V);
}

/* one matrix a step; changes shrink by the ratio of two */
static inline void step_chord(body *b, int heavy) {
    double V[3], B[3][3], d, ratio = 1;
    equation e;
    guess(V, b, 5);
    evaluate(&e, b, V, heavy, 1);
    invert(B, e.J);
    d = improve(V, B, e.R);
    b->iterations++;
    while (d * ratio > 1e-16 * size_of(V) && d > 4e-16 * size_of(V)) {
        const double before = d;
        evaluate(&e, b, V, heavy, 0);
        d = improve(V, B, e.R);
        ratio = fmin(1, d / before);
        b->iterations++;
    }
    evaluate(&e, b, V, heavy, 0);
    finish(b, V, e.mu);
    remember(b, V);
}

__attribute__((noinline)) static void free_full(body *b, long n) {
    while (n--) step_full(b, 0);
}
__attribute__((noinline)) static void free_chord(body *b, long n) {
    while (n--) step_chord(b, 0);
}
__attribute__((noinline)) static void top_full(body *b, long n) {
    while (n--) step_full(b, 1);
}
__attribute__((noinline)) static void top_chord(body *b, long n) {
    while (n--) step_chord(b, 1);
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static void measure(const char *name, void (*run)(body *, long), const body *start) {
    const long n = 20000;
    double least = INFINITY;
    body b;
    for (int turn = 0; turn < 60; turn++) {
        b = *start;
        const double t = now();
        run(&b, n);
        least = fmin(least, (now() - t) / (double)n);
    }
    printf("%s: %.0f ns a step, %.2f iterations; ends at %.15f %.15f %.15f\n", name, least,
           (double)b.iterations / (double)n, b.p[0], b.p[1], b.p[2]);
}

int main(void) {
    body spin = {.I = {1, 2, 3}, .h = 0.05, .q = {1}, .p = {0.3, 1, 3}};
    body top = {.I = {1, 1.2, 0.6}, .h = 0.05, .weight = 1, .p = {0.2, 0.1, 1.5}};
    top.q[0] = cos(0.2), top.q[1] = sin(0.2);
    measure("free body, full", free_full, &spin);
    measure("heavy top, full", top_full, &top);
    library = 0;
    measure("free body, chord", free_chord, &spin);
    measure("heavy top, chord", top_chord, &top);
    return 0;
}
