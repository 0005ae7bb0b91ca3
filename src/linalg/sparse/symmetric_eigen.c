/* symmetric_eigen.c - the matrix is held by rows, and so is the product of all reflections and
 * rotations: row i of it ends as eigenvector i. */
#include "linalg/sparse/symmetric_eigen.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

static double dot(const double *x, const double *y, uint32_t n) {
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) sum += x[i] * y[i];
    return sum;
}

static void add(double *y, double factor, const double *x, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) y[i] += factor * x[i];
}

/* p = (A u) / h for the leading i rows of A, of which the lower triangle stands; p[i] */
static void symmetric_times(double *p, const double *A, const double *u, double h, uint32_t i,
                            uint32_t n) {
    for (uint32_t j = 0; j < i; j++) p[j] = 0.0;
    for (uint32_t j = 0; j < i; j++) {
        const double *row = A + (size_t)j * n;
        p[j] += dot(row, u, j + 1);
        add(p, u[j], row, j);
    }
    for (uint32_t j = 0; j < i; j++) p[j] /= h;
}

/* Row i < n of A is reflected to its last entry, off[i]; the vector of the reflection stays in row
 * i, half its square in d[i] (0: there was nothing to do). */
static void reflect(double *A, double *d, double *off, uint32_t i, uint32_t n) {
    double *u = A + (size_t)i * n, scale = 0.0;
    for (uint32_t k = 0; k < i; k++) scale += fabs(u[k]);
    d[i] = 0.0;
    off[i] = i ? u[i - 1] : 0.0;
    if (i < 2 || scale - fabs(u[i - 1]) == 0.0) return;
    for (uint32_t k = 0; k < i; k++) u[k] /= scale;
    double h = dot(u, u, i);
    const double f = u[i - 1], g = f > 0.0 ? -sqrt(h) : sqrt(h);
    off[i] = scale * g;
    h -= f * g;
    u[i - 1] = f - g;
    symmetric_times(off, A, u, h, i, n);
    const double K = dot(u, off, i) / (h + h);
    add(off, -K, u, i);
    for (uint32_t j = 0; j < i; j++) {
        double *row = A + (size_t)j * n;
        add(row, -u[j], off, j + 1);
        add(row, -off[j], u, j + 1);
    }
    d[i] = h;
}

/* d[n], off[n]: diagonal and what stands below it (off[i] between i - 1 and i); A: the rotation Q^T
 * by rows, A_before = Q T Q^T */
static dm_status tridiagonal(double *A, double *d, double *off, uint32_t n,
                             volatile const int *stop) {
    for (uint32_t i = n; i-- > 0;) {
        /* off[0 .. i - 1] is scratch of reflect; off[i] stays */
        reflect(A, d, off, i, n);
        if (stop && *stop) return DM_STOPPED;
    }
    for (uint32_t i = 0; i < n; i++) {
        double *u = A + (size_t)i * n;
        const double h = d[i], diagonal = u[i];
        /* leading block B (rows are columns of Q): B -= (B u) u^T / h, as B^T by rows */
        if (h != 0.0)
            for (uint32_t j = 0; j < i; j++) {
                double *row = A + (size_t)j * n;
                add(row, -dot(row, u, i) / h, u, i);
            }
        d[i] = diagonal;
        for (uint32_t k = 0; k < i; k++) u[k] = A[(size_t)k * n + i] = 0.0;
        u[i] = 1.0;
        if (stop && *stop) return DM_STOPPED;
    }
    return DM_OK;
}

/* rows i and i + 1 of V turned by (c, s) */
static void turn(double *V, uint32_t i, double c, double s, uint32_t n) {
    double *a = V + (size_t)i * n, *b = a + n;
    for (uint32_t k = 0; k < n; k++) {
        const double x = a[k], y = b[k];
        b[k] = s * x + c * y;
        a[k] = c * x - s * y;
    }
}

/* one implicit QL step on l .. m; e[i] stands between i and i + 1 */
static void step(double *V, double *d, double *e, uint32_t l, uint32_t m, uint32_t n) {
    double g = (d[l + 1] - d[l]) / (2.0 * e[l]), r = hypot(g, 1.0), s = 1.0, c = 1.0, p = 0.0;
    g = d[m] - d[l] + e[l] / (g + copysign(r, g));
    for (uint32_t i = m; i-- > l;) {
        const double f = s * e[i], b = c * e[i];
        r = hypot(f, g);
        e[i + 1] = r;
        if (r == 0.0) { /* the matrix falls apart early */
            d[i + 1] -= p;
            e[m] = 0.0;
            return;
        }
        s = f / r, c = g / r;
        g = d[i + 1] - p;
        r = (d[i] - g) * s + 2.0 * c * b;
        p = s * r;
        d[i + 1] = g + p;
        g = c * r - b;
        turn(V, i, c, s, n);
    }
    d[l] -= p;
    e[l] = g;
    e[m] = 0.0;
}

/* Off-diagonal entries that are rounding beside their neighbours are 0, and the matrix falls in
 * two; 60 steps for one eigenvalue are far more than ever were needed. */
static dm_status diagonal(double *V, double *d, double *e, uint32_t n, volatile const int *stop) {
    for (uint32_t i = 1; i < n; i++) e[i - 1] = e[i];
    e[n - 1] = 0.0;
    for (uint32_t l = 0; l < n; l++)
        for (uint32_t tries = 0;; tries++) {
            uint32_t m = l;
            while (m + 1 < n && fabs(e[m]) > DBL_EPSILON * (fabs(d[m]) + fabs(d[m + 1]))) m++;
            if (m == l) break;
            if (tries == 60) return DM_NO_CONVERGENCE;
            if (stop && *stop) return DM_STOPPED;
            step(V, d, e, l, m, n);
        }
    return DM_OK;
}

/* by choice of the least */
/* vectors change places with their values; the comparisons are nothing beside n^3 rotations;
 * equal values stay as they come */
static void sort(double *V, double *d, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) {
        uint32_t least = i;
        for (uint32_t j = i + 1; j < n; j++)
            if (d[j] < d[least]) least = j;
        if (least == i) continue;
        const double value = d[i];
        d[i] = d[least], d[least] = value;
        for (uint32_t k = 0; k < n; k++) {
            const double x = V[(size_t)i * n + k];
            V[(size_t)i * n + k] = V[(size_t)least * n + k];
            V[(size_t)least * n + k] = x;
        }
    }
}

dm_status dm_symmetric_eigen(double *A, double *value, double *work, uint32_t n,
                             volatile const int *stop) {
    if (n == 0) return DM_OK;
    for (size_t i = 0; i < (size_t)n * n; i++)
        if (!isfinite(A[i])) return DM_NOT_FINITE;
    dm_status status = tridiagonal(A, value, work, n, stop);
    if (status == DM_OK) status = diagonal(A, value, work, n, stop);
    if (status == DM_OK) sort(A, value, n);
    return status;
}
