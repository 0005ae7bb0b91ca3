#include "integ/curve/curve_bundle.h"

#include "linalg/lu.h"
#include "linalg/solve/newton.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

/* The largest user: Newton's method beside a start, or a singular value decomposition. */
static size_t scratch_size(size_t n) {
    const size_t N = 2 * n, pivots = n + 1;
    return dm_newton_work((uint32_t)N) + 3 * N * N + 2 * N + pivots;
}

size_t dm_bundle_work(const dm_curve *c, const dm_model *m) {
    const size_t n = m->n;
    return dm_segment_work(c, m) + 5 * n + 4 * n * n + scratch_size(n);
}

/* An element is evaluated as a segment of the curve, whose workspace lies behind the rest. */
dm_status dm_bundle_open(dm_bundle *b, const dm_curve *c, const dm_model *m, double h,
                         double *memory) {
    const size_t n = m->n;
    *b = (dm_bundle){.curve = c, .n = m->n, .h = h, .zero = memory};
    b->some = b->zero + n;
    b->D = b->some + 4 * n;
    b->scratch = b->D + 4 * n * n;
    memset(b->zero, 0, n * sizeof *b->zero);
    return dm_segment_open(&b->segment, c, m, b->scratch + scratch_size(n));
}

static int all_finite(const double *x, size_t n) {
    for (size_t i = 0; i < n; i++)
        if (!isfinite(x[i])) return 0;
    return 1;
}

/* The segment of e, whose ends must be numbers. */
static dm_status run(dm_bundle *b, const dm_element *e) {
    const dm_segment_place at = {.q = e->q, .v = e->v, .t = e->t, .h = b->h};
    const dm_status status = dm_segment_run(&b->segment, &at);
    if (status != DM_OK) return status;
    const int fine = all_finite(b->segment.plus, b->n) && all_finite(b->segment.minus, b->n);
    return fine ? DM_OK : DM_NOT_FINITE;
}

/* The segment gives ends relative to q. */
dm_status dm_bundle_ends(dm_bundle *b, double *minus, double *plus, const dm_element *e) {
    const dm_status status = run(b, e);
    for (uint32_t i = 0; status == DM_OK && i < b->n; i++) {
        minus[i] = e->q[i] + b->segment.minus[i];
        plus[i] = e->q[i] + b->segment.plus[i];
    }
    return status;
}

/* Rows of D: d- first, then d+; the segment's tangents are those of d - q. */
dm_status dm_bundle_tangents(dm_bundle *b, double *D, const dm_element *e) {
    const size_t n = b->n, N = 2 * n;
    const dm_status status = run(b, e);
    if (status != DM_OK) return status;
    dm_segment_gradient(&b->segment, b->zero, NULL);
    dm_segment_hessian(&b->segment, 2 * b->n);
    memcpy(D, b->segment.minus_tangent, n * N * sizeof *D);
    memcpy(D + n * N, b->segment.plus_tangent, n * N * sizeof *D);
    for (size_t i = 0; i < n; i++) {
        D[i * N + i] += 1.0;
        D[(n + i) * N + i] += 1.0;
    }
    return all_finite(D, N * N) ? DM_OK : DM_NOT_FINITE;
}

/* x = A^-1 x for A[N*N], which becomes its factors */
static dm_status solve(dm_bundle *b, double *A, double *x) {
    const uint32_t N = 2 * b->n;
    uint32_t *pivot = (uint32_t *)(void *)b->scratch;
    const dm_status status = dm_lu_factor(A, pivot, N);
    if (status == DM_OK) dm_lu_solve(x, A, pivot, N);
    return status;
}

/* D^T (-p0, p1) = dLd, a square system, since the tangents span the space of ends. */
dm_status dm_bundle_momenta(dm_bundle *b, double *p0, double *p1, double *action,
                            const dm_element *e) {
    const size_t n = b->n, N = 2 * n;
    double *x = b->some, *slope = x + N;
    dm_status status = dm_bundle_tangents(b, b->D, e);
    if (status != DM_OK) return status;
    *action = dm_segment_action(&b->segment);
    memcpy(slope, b->segment.slope, N * sizeof *x);
    for (size_t i = 0; i < N; i++)
        for (size_t j = 0; j < i; j++) {
            const double swap = b->D[i * N + j];
            b->D[i * N + j] = b->D[j * N + i];
            b->D[j * N + i] = swap;
        }
    memcpy(x, slope, N * sizeof *x);
    status = solve(b, b->D, x);
    for (size_t i = 0; status == DM_OK && i < n; i++) {
        p0[i] = -x[i];
        p1[i] = x[n + i];
    }
    if (status == DM_OK && !(isfinite(*action) && all_finite(x, N))) return DM_NOT_FINITE;
    return status;
}

/* D y = (minus, plus). */
dm_status dm_bundle_lift(dm_bundle *b, double *y, const double *minus, const double *plus,
                         const dm_element *e) {
    const size_t n = b->n;
    dm_status status = dm_bundle_tangents(b, b->D, e);
    if (status != DM_OK) return status;
    memcpy(y, minus, n * sizeof *y);
    memcpy(y + n, plus, n * sizeof *y);
    status = solve(b, b->D, y);
    return status == DM_OK && !all_finite(y, 2 * n) ? DM_NOT_FINITE : status;
}

/* ---- from ends to an element ---- */

typedef struct {
    dm_bundle *b;
    const double *start, *q0, *q1;
    double t;
} search;

/* z = ((q - start)/h, v): r = ((d- - q0)/h, (d+ - q1)/h) */
static dm_status ends_apart(void *ctx, double *r, double *J, const double *z) {
    const search *s = ctx;
    dm_bundle *b = s->b;
    const size_t n = b->n, N = 2 * n;
    double *q = b->some;
    for (size_t i = 0; i < n; i++) q[i] = s->start[i] + b->h * z[i];
    const dm_element e = {q, z + n, s->t};
    const dm_status status = J ? dm_bundle_tangents(b, J, &e) : run(b, &e);
    if (status != DM_OK) return status;
    for (size_t i = 0; i < n; i++) {
        r[i] = (q[i] - s->q0[i] + b->segment.minus[i]) / b->h;
        r[n + i] = (q[i] - s->q1[i] + b->segment.plus[i]) / b->h;
    }
    for (size_t i = 0; J && i < N; i++)
        for (size_t j = n; j < N; j++) J[i * N + j] /= b->h;
    return DM_OK;
}

/* From the point of the straight line where the bias puts q, with its velocity; unknowns are of the
 * size of velocities, so are the residuals. */
dm_status dm_bundle_find(dm_bundle *b, double *q, double *v, const double *ends[2], double t) {
    const size_t n = b->n;
    double *start = b->some + n, *z = b->scratch + dm_newton_work(2 * b->n);
    search s = {.b = b, .start = start, .q0 = ends[0], .q1 = ends[1], .t = t};
    double size = 0.0;
    dm_newton_report report;
    for (size_t i = 0; i < n; i++) {
        start[i] = ends[0][i] + (1.0 - b->curve->bias) * (ends[1][i] - ends[0][i]);
        z[i] = 0.0;
        z[n + i] = (ends[1][i] - ends[0][i]) / b->h;
        size = fmax(size, (fabs(ends[0][i]) + fabs(ends[1][i])) / b->h);
    }
    const dm_newton_problem problem = {.m = 2 * b->n,
                                       .equation = ends_apart,
                                       .ctx = &s,
                                       .size = &size,
                                       .tolerance = 4e-15,
                                       .max_iterations = 100};
    const dm_status status = dm_newton(z, &problem, b->scratch, &report);
    for (size_t i = 0; status == DM_OK && i < n; i++) {
        q[i] = start[i] + b->h * z[i];
        v[i] = z[n + i];
    }
    return status;
}

/* ---- definition 2 and proposition 1 ---- */

/* the smallest singular value of A[rows*columns], rows >= columns, which is lost */
static double least_singular_value(double *A, size_t rows, size_t columns, double *work) {
    gsl_matrix_view a = gsl_matrix_view_array(A, rows, columns);
    gsl_matrix_view Q = gsl_matrix_view_array(work, columns, columns);
    gsl_vector_view s = gsl_vector_view_array(work + columns * columns, columns);
    gsl_set_error_handler_off();
    if (gsl_linalg_SV_decomp_jacobi(&a.matrix, &Q.matrix, &s.vector)) return 0.0;
    return work[columns * columns + columns - 1];
}

/* The transpose of the half, since the decomposition wants no fewer rows than columns. */
double dm_bundle_submersion(dm_bundle *b, const double *half) {
    const size_t n = b->n, N = 2 * n;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < N; j++) b->D[j * n + i] = half[i * N + j];
    return least_singular_value(b->D, N, n, b->scratch);
}

/* D becomes the mean of both tangents and their difference by h; returns the distance from the
 * identity */
static double desingularize(const dm_bundle *b, double *D) {
    const size_t n = b->n, N = 2 * n;
    double furthest = 0.0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < N; j++) {
            const double minus = D[i * N + j], plus = D[(n + i) * N + j];
            D[i * N + j] = 0.5 * (plus + minus);
            D[(n + i) * N + j] = (plus - minus) / b->h;
        }
    for (size_t i = 0; i < N; i++)
        for (size_t j = 0; j < N; j++) furthest = fmax(furthest, fabs(D[i * N + j] - (i == j)));
    return furthest;
}

/* Both tangents tend to the same map as h -> 0; their mean and their difference by h do not become
 * singular. */
dm_status dm_bundle_transversality(dm_bundle *b, double *least, double *limit,
                                   const dm_element *e) {
    const dm_status status = dm_bundle_tangents(b, b->D, e);
    if (status != DM_OK) return status;
    const double distance = desingularize(b, b->D);
    if (limit) *limit = distance;
    *least = least_singular_value(b->D, 2 * (size_t)b->n, 2 * (size_t)b->n, b->scratch);
    return DM_OK;
}

/* the same for a step h; infinite where a segment cannot be had */
static double transversality_at(dm_bundle *b, const dm_element *e, double h) {
    const double own = b->h;
    double least = INFINITY;
    b->h = h;
    if (dm_bundle_transversality(b, &least, NULL, e) != DM_OK) least = INFINITY;
    b->h = own;
    return least;
}

/* a minimum between low and high by golden sections; it goes to zero linearly, so that places
 * are exact */
static double refine(dm_bundle *b, const dm_element *e, double low, double high) {
    const double golden = 0.61803398874989485;
    for (int i = 0; i < 80; i++) {
        const double left = high - golden * (high - low), right = low + golden * (high - low);
        if (transversality_at(b, e, left) < transversality_at(b, e, right))
            high = right;
        else
            low = left;
    }
    return 0.5 * (low + high);
}

/* The least singular value is followed from small steps up; a minimum that is zero is where the
 * ends cease to be coordinates. 0: none was found. */
double dm_bundle_largest_step(dm_bundle *b, const dm_element *e) {
    const double factor = 1.02, zero = 1e-6;
    double h = 0.01 * b->h, before = INFINITY, here = transversality_at(b, e, h);
    while (h < 1000.0 * b->h && isfinite(here)) {
        const double next = transversality_at(b, e, factor * h);
        if (here < before && here <= next) {
            const double place = refine(b, e, h / factor, factor * h);
            if (transversality_at(b, e, place) < zero) return place;
        }
        before = here;
        here = next;
        h *= factor;
    }
    return 0.0;
}
