/* anderson.c - least squares over the differences of the last residuals, by modified Gram-Schmidt
 * in the product of the weights. */
#include "field/flow/anderson.h"

#include <math.h>
#include <string.h>

enum { MOST = DM_ANDERSON_MEMORY };

/* x, y, f, g, and three sets of vectors: both differences and an orthonormal basis */
size_t dm_anderson_work(uint32_t n) {
    return (size_t)(2 * MOST + 4) * n + (size_t)MOST * n;
}

void dm_anderson_begin(dm_anderson *a, double *work, uint32_t n, const double *weight, double **x,
                       double **y) {
    *a = (dm_anderson){.n = n, .weight = weight};
    a->x = work, a->y = work + n, a->f = work + 2 * (size_t)n, a->g = work + 3 * (size_t)n;
    a->df = work + 4 * (size_t)n, a->dg = a->df + (size_t)MOST * n;
    memset(a->x, 0, n * sizeof *a->x);
    *x = a->x;
    *y = a->y;
}

/* the product of the weights */
static double dot(const dm_anderson *a, const double *u, const double *v) {
    double sum = 0.0;
    for (uint32_t i = 0; i < a->n; i++) sum += a->weight[i] * u[i] * v[i];
    return sum;
}

static void subtract(double *u, double factor, const double *v, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) u[i] -= factor * v[i];
}

/* The differences to the last point take the oldest place; f and g become those of this point. */
static void keep(dm_anderson *a) {
    const size_t at = (size_t)a->next * a->n;
    for (uint32_t i = 0; i < a->n; i++) {
        const double f = a->y[i] - a->x[i];
        if (a->begun) a->df[at + i] = f - a->f[i], a->dg[at + i] = a->y[i] - a->g[i];
        a->f[i] = f;
        a->g[i] = a->y[i];
    }
    if (a->begun) {
        a->next = (a->next + 1) % MOST;
        a->kept += a->kept < MOST;
    }
    a->begun = 1;
}

/* gamma[kept] with f - sum gamma_j df_j least, newest pairs first; those that hardly leave the
 * span of the others count for nothing */
static void solve(const dm_anderson *a, double *gamma, double *q, double *rest) {
    double R[MOST][MOST] = {{0.0}}, c[MOST];
    const uint32_t n = a->n;
    for (uint32_t k = 0; k < a->kept; k++) {
        double *column = q + (size_t)k * n;
        const uint32_t from = (a->next + MOST - 1 - k) % MOST;
        memcpy(column, a->df + (size_t)from * n, n * sizeof *column);
        const double size = sqrt(dot(a, column, column));
        for (uint32_t j = 0; j < k; j++) {
            R[j][k] = dot(a, q + (size_t)j * n, column);
            subtract(column, R[j][k], q + (size_t)j * n, n);
        }
        R[k][k] = sqrt(dot(a, column, column));
        if (!(R[k][k] > 1e-10 * size)) R[k][k] = 0.0;
        for (uint32_t i = 0; i < n; i++) column[i] = R[k][k] > 0.0 ? column[i] / R[k][k] : 0.0;
        c[k] = dot(a, column, rest);
        subtract(rest, c[k], column, n);
    }
    for (uint32_t k = a->kept; k-- > 0;) {
        double sum = c[k];
        for (uint32_t j = k + 1; j < a->kept; j++) sum -= R[k][j] * gamma[j];
        gamma[k] = R[k][k] > 0.0 ? sum / R[k][k] : 0.0;
    }
}

/* x = g - sum gamma_j dg_j; the residual is worked on where the next x will stand */
void dm_anderson_next(dm_anderson *a) {
    double gamma[MOST] = {0.0};
    double *q = a->dg + (size_t)MOST * a->n;
    keep(a);
    memcpy(a->x, a->f, a->n * sizeof *a->x);
    solve(a, gamma, q, a->x);
    memcpy(a->x, a->g, a->n * sizeof *a->x);
    for (uint32_t k = 0; k < a->kept; k++) {
        const uint32_t from = (a->next + MOST - 1 - k) % MOST;
        subtract(a->x, gamma[k], a->dg + (size_t)from * a->n, a->n);
    }
}
