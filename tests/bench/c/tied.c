#include "tied.h"

#include <math.h>
#include <string.h>

enum { MOST = NEWTON_N + TIED_M };

/* solve A x = b in place, A row by row, partial pivoting; 0 when singular */
static int solve(double *A, double *b, int n) {
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(A[i * n + k]) > fabs(A[pivot * n + k])) pivot = i;
        if (A[pivot * n + k] == 0.0) return 0;
        if (pivot != k) {
            for (int j = k; j < n; j++) {
                const double x = A[k * n + j];
                A[k * n + j] = A[pivot * n + j], A[pivot * n + j] = x;
            }
            const double x = b[k];
            b[k] = b[pivot], b[pivot] = x;
        }
        const double inverse = 1.0 / A[k * n + k];
        for (int i = k + 1; i < n; i++) {
            const double f = A[i * n + k] * inverse;
            for (int j = k + 1; j < n; j++) A[i * n + j] -= f * A[k * n + j];
            b[i] -= f * b[k];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int j = i + 1; j < n; j++) b[i] -= A[i * n + j] * b[j];
        b[i] /= A[i * n + i];
    }
    return 1;
}

/* minus the residual, and its derivative in (v, I); the ties divided by h */
static void equation(double *r, double *J, const derivatives *d, const constraints *start,
                     const constraints *end, const double *p, const double *z,
                     const tied_model *m) {
    const int n = m->model.n, l = m->ties, N = n + l;
    const double half = 0.5 * m->model.h;
    for (int i = 0; i < n; i++) {
        r[i] = p[i] - d->Lv[i] + half * d->Lq[i];
        for (int c = 0; c < l; c++) r[i] += start->G[c * n + i] * z[n + c];
        for (int j = 0; j < n; j++)
            J[i * N + j] = d->Lvv[i * n + j] + half * (d->Lqv[j * n + i] - d->Lqv[i * n + j]) -
                           half * half * d->Lqq[i * n + j];
        for (int c = 0; c < l; c++) J[i * N + n + c] = -start->G[c * n + i];
    }
    for (int c = 0; c < l; c++) {
        r[n + c] = -end->g[c] / m->model.h;
        for (int j = 0; j < n; j++) J[(n + c) * N + j] = end->G[c * n + j];
        for (int j = 0; j < l; j++) J[(n + c) * N + n + j] = 0.0;
    }
}

static double largest(const double *x, int n) {
    double m = 0.0;
    for (int i = 0; i < n; i++) m = fmax(m, fabs(x[i]));
    return m;
}

/* (v, I) of the step from a guess; leaves the derivatives of the last point in d */
static int newton(double *z, derivatives *d, const constraints *start, const double *q,
                  const double *p, const tied_model *m, long *iterations) {
    const int n = m->model.n, N = n + m->ties;
    double r[MOST], J[MOST * MOST], middle[NEWTON_N], ahead[NEWTON_N], before = INFINITY;
    constraints end;
    for (int k = 0; k < 50; k++) {
        for (int i = 0; i < n; i++) {
            middle[i] = q[i] + 0.5 * m->model.h * z[i];
            ahead[i] = q[i] + m->model.h * z[i];
        }
        m->model.lagrangian(d, middle, z);
        m->constrain(&end, ahead);
        equation(r, J, d, start, &end, p, z, m);
        if (!solve(J, r, N)) return 0;
        for (int i = 0; i < N; i++) z[i] += r[i];
        ++*iterations;
        const double change = largest(r, n), size = largest(z, n);
        if (change <= 4e-15 * size || (change >= before && change < 1e-12 * size)) return 1;
        before = change;
    }
    return 0;
}

/* p += G^T mu with G v(p) = 0: [L_vv, -G^T; G, 0] (v, mu) = (p, 0), for L quadratic in v */
static int project(double *p, derivatives *d, const constraints *at, const double *q,
                   const double *v, const tied_model *m) {
    const int n = m->model.n, l = m->ties, N = n + l;
    double A[MOST * MOST], b[MOST];
    m->model.lagrangian(d, q, v);
    memset(A, 0, sizeof A);
    for (int i = 0; i < n; i++) {
        b[i] = p[i] - d->Lv[i];
        for (int j = 0; j < n; j++) {
            b[i] += d->Lvv[i * n + j] * v[j];
            A[i * N + j] = d->Lvv[i * n + j];
        }
        for (int c = 0; c < l; c++) {
            A[i * N + n + c] = -at->G[c * n + i];
            A[(n + c) * N + i] = at->G[c * n + i];
        }
    }
    for (int c = 0; c < l; c++) b[n + c] = 0.0;
    if (!solve(A, b, N)) return 0;
    for (int c = 0; c < l; c++)
        for (int i = 0; i < n; i++) p[i] += at->G[c * n + i] * b[n + c];
    return 1;
}

int tied_run(double *q, double *p, const tied_model *m, long steps, long *iterations) {
    const int n = m->model.n, l = m->ties;
    double z[MOST] = {0};
    derivatives d;
    constraints here;
    memcpy(z, m->model.v, (size_t)n * sizeof *z);
    m->constrain(&here, q);
    for (long step = 0; step < steps; step++) {
        if (!newton(z, &d, &here, q, p, m, iterations)) return 0;
        for (int i = 0; i < n; i++) {
            q[i] += m->model.h * z[i];
            p[i] += m->model.h * d.Lq[i];
            for (int c = 0; c < l; c++) p[i] += here.G[c * n + i] * z[n + c];
        }
        m->constrain(&here, q);
        if (!project(p, &d, &here, q, z, m)) return 0;
    }
    return 1;
}

/* ---- spherical pendulum in space: L = v.v/2 - z, |q|^2 = 1 ---- */

static void pendulum(derivatives *d, const double *q, const double *v) {
    (void)q;
    memset(d, 0, sizeof *d);
    for (int i = 0; i < 3; i++) d->Lv[i] = v[i], d->Lvv[4 * i] = 1.0;
    d->Lq[2] = -1.0;
}

static void sphere(constraints *c, const double *q) {
    c->g[0] = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] - 1.0;
    for (int i = 0; i < 3; i++) c->G[i] = 2.0 * q[i];
}

const tied_model tied_sphere =
    {{"spherical pendulum in space", 3, 0.02, {0.6, 0.0, -0.8}, {0.0, 1.0, 0.0}, pendulum},
     1,
     sphere};

/* ---- double spherical pendulum in space: two unit masses, |q1| = |q2 - q1| = 1, g = 9.81 ---- */

static void pendulum_twice(derivatives *d, const double *q, const double *v) {
    (void)q;
    memset(d, 0, sizeof *d);
    for (int i = 0; i < 6; i++) d->Lv[i] = v[i], d->Lvv[7 * i] = 1.0;
    d->Lq[2] = d->Lq[5] = -9.81;
}

static void rods(constraints *c, const double *q) {
    c->g[0] = c->g[1] = -1.0;
    for (int i = 0; i < 3; i++) {
        const double x = q[i], y = q[3 + i] - q[i];
        c->g[0] += x * x, c->g[1] += y * y;
        c->G[i] = 2.0 * x, c->G[3 + i] = 0.0;
        c->G[6 + i] = -2.0 * y, c->G[9 + i] = 2.0 * y;
    }
}

const tied_model tied_double = {{"double spherical pendulum in space",
                                 6,
                                 0.01,
                                 {0.6, 0.0, -0.8, 0.6, 0.6, -1.6},
                                 {0.0, 1.0, 0.0, 1.0, 1.0, 0.0},
                                 pendulum_twice},
                                2,
                                rods};
