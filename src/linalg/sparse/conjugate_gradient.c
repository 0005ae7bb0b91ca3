/* conjugate_gradient.c - sums run in the order of the unknowns, by one thread: same bits always. */
#include "linalg/sparse/conjugate_gradient.h"

#include <math.h>

/* one after the other: no reduction in lanes, which would depend on their number */
static double dot(const double *x, const double *y, int32_t n) {
    double sum = 0.0;
    for (int32_t i = 0; i < n; i++) sum += x[i] * y[i];
    return sum;
}

/* r, z = D^-1 r, p, q = A p; rho = r.z, and |b|^2 */
typedef struct {
    const dm_sparse *A;
    double *r, *inverse, *p, *q;
    double rho, size;
} iteration;

/* r.z after r has changed; z itself is not kept */
static double weigh(const iteration *it) {
    double sum = 0.0;
    for (int32_t i = 0; i < it->A->columns; i++) sum += it->r[i] * it->r[i] * it->inverse[i];
    return sum;
}

/* r = b - A x, p = D^-1 r. An unknown with a diagonal of 0 stands alone in a semidefinite matrix
 * and is left as it is. */
static dm_status begin(iteration *it, const double *x, const double *b) {
    const int32_t n = it->A->columns;
    dm_sparse_diagonal(it->inverse, it->A);
    for (int32_t i = 0; i < n; i++) {
        if (it->inverse[i] < 0.0) return DM_SINGULAR;
        it->inverse[i] = it->inverse[i] > 0.0 ? 1.0 / it->inverse[i] : 1.0;
    }
    dm_sparse_apply_transpose(it->q, it->A, x);
    for (int32_t i = 0; i < n; i++) {
        it->r[i] = b[i] - it->q[i];
        it->p[i] = it->inverse[i] * it->r[i];
    }
    it->rho = weigh(it);
    it->size = dot(b, b, n);
    if (it->size == 0.0) it->size = dot(it->r, it->r, n);
    return isfinite(it->rho) && isfinite(it->size) ? DM_OK : DM_NOT_FINITE;
}

/* Is a curvature <= 0 along p but rounding beside the largest that the diagonal tells of? Then p is
 * in the null space of a semidefinite matrix. */
static int is_flat(const iteration *it, double curvature) {
    double largest = 0.0;
    for (int32_t i = 0; i < it->A->columns; i++)
        largest = fmax(largest, it->p[i] * it->p[i] / it->inverse[i]);
    return curvature >= -1e-12 * it->A->columns * largest;
}

/* One step; *done: along p nothing is left to gain. DM_SINGULAR where A bends down along p. */
static dm_status advance(iteration *it, double *x, int *done) {
    const int32_t n = it->A->columns;
    dm_sparse_apply_transpose(it->q, it->A, it->p);
    const double curvature = dot(it->p, it->q, n);
    if (!isfinite(curvature)) return DM_NOT_FINITE;
    *done = curvature <= 0.0 && is_flat(it, curvature);
    if (*done) return DM_OK;
    if (curvature <= 0.0) return DM_SINGULAR;
    const double alpha = it->rho / curvature, before = it->rho;
    for (int32_t i = 0; i < n; i++) {
        x[i] += alpha * it->p[i];
        it->r[i] -= alpha * it->q[i];
    }
    it->rho = weigh(it);
    const double beta = it->rho / before;
    for (int32_t i = 0; i < n; i++) it->p[i] = it->inverse[i] * it->r[i] + beta * it->p[i];
    return DM_OK;
}

dm_status dm_conjugate_gradient(double *x, const dm_sparse *A, const double *b, double *work,
                                dm_cg *how) {
    const size_t n = (size_t)A->columns;
    iteration it = {.A = A, .r = work, .inverse = work + n, .p = work + 2 * n, .q = work + 3 * n};
    dm_status status = begin(&it, x, b);
    int done = 0;
    how->iterations = 0, how->residual = 0.0;
    while (status == DM_OK && !done) {
        const double left = dot(it.r, it.r, A->columns);
        how->residual = it.size > 0.0 ? sqrt(left / it.size) : 0.0;
        if (how->residual <= how->tolerance) return DM_OK;
        if (how->iterations >= how->most) return DM_NO_CONVERGENCE;
        if (how->stop && *how->stop) return DM_STOPPED;
        status = advance(&it, x, &done);
        how->iterations++;
    }
    return status;
}
