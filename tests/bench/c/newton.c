#include "newton.h"

#include <math.h>
#include <string.h>

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

/* residual p0 - L_v + h/2 L_q and minus its derivative in v */
static void equation(double *r, double *J, const derivatives *d, const double *p, double h, int n) {
    const double half = 0.5 * h;
    for (int i = 0; i < n; i++) {
        r[i] = p[i] - d->Lv[i] + half * d->Lq[i];
        for (int j = 0; j < n; j++)
            J[i * n + j] = d->Lvv[i * n + j] + half * (d->Lqv[j * n + i] - d->Lqv[i * n + j]) -
                           half * half * d->Lqq[i * n + j];
    }
}

static double largest(const double *x, int n) {
    double m = 0.0;
    for (int i = 0; i < n; i++) m = fmax(m, fabs(x[i]));
    return m;
}

/* v of the step, from a guess; leaves the derivatives of the last point in d */
static int newton(double *v, derivatives *d, const double *q, const double *p,
                  const implicit_model *m, long *iterations) {
    const int n = m->n;
    double r[NEWTON_N], J[NEWTON_N * NEWTON_N], middle[NEWTON_N], before = INFINITY;
    for (int k = 0; k < 50; k++) {
        for (int i = 0; i < n; i++) middle[i] = q[i] + 0.5 * m->h * v[i];
        m->lagrangian(d, middle, v);
        equation(r, J, d, p, m->h, n);
        if (!solve(J, r, n)) return 0;
        for (int i = 0; i < n; i++) v[i] += r[i];
        ++*iterations;
        const double change = largest(r, n), size = largest(v, n);
        if (change <= 4e-15 * size || (change >= before && change < 1e-12 * size)) return 1;
        before = change;
    }
    return 0;
}

int newton_run(double *q, double *p, const implicit_model *m, long steps, long *iterations) {
    const int n = m->n;
    double v[NEWTON_N];
    derivatives d;
    memcpy(v, m->v, sizeof v);
    for (long step = 0; step < steps; step++) {
        if (!newton(v, &d, q, p, m, iterations)) return 0;
        for (int i = 0; i < n; i++) q[i] += m->h * v[i];
        for (int i = 0; i < n; i++) p[i] += m->h * d.Lq[i];
    }
    return 1;
}
