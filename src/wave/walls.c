/* walls.c - see walls.h. */
#include "wave/walls.h"

#include "linalg/sparse/symmetric_eigen.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* ---- Chebyshev points ---- */

/* x_i, i = 0 .. last, odd about the middle to the last bit */
static double point(uint32_t i, uint32_t last) {
    return sin(PI * (2.0 * (double)i - (double)last) / (2.0 * (double)last));
}

/* 2/N (1 - sum' 2 cos(2 k t)/(4 k^2 - 1)), t = i pi/N, the last term halved for even N */
static double weight_of(uint32_t i, uint32_t last) {
    const double N = (double)last, t = PI * (double)i / N;
    double sum = 1.0;
    for (uint32_t k = 1; 2 * k <= last; k++) {
        const double kk = (double)k, share = 2 * k == last ? 1.0 : 2.0;
        sum -= share * cos(2.0 * kk * t) / (4.0 * kk * kk - 1.0);
    }
    return 2.0 / N * sum;
}

void dm_walls_points(double *x, double *weight, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) {
        x[i] = point(i + 1, n + 1);
        weight[i] = weight_of(i + 1, n + 1);
    }
}

/* x_i - x_j as a product of sines, exact to rounding */
static double gap(uint32_t i, uint32_t j, uint32_t last) {
    const double a = PI * (double)i / (double)last, b = PI * (double)j / (double)last;
    return 2.0 * sin(0.5 * (a + b)) * sin(0.5 * (a - b));
}

/* l_j'(x_i), i != j, j not an end: (c_i/c_j) (-1)^(i + j)/(x_i - x_j), c = 2 at the ends, else 1 */
static double cardinal_slope(uint32_t i, uint32_t j, uint32_t last) {
    const double ends = j == 0 || j == last ? 0.5 : 1.0;
    return ((i + j) % 2 ? -ends : ends) / gap(i, j, last);
}

void dm_walls_slope(double *slope, uint32_t n) {
    const uint32_t last = n + 1;
    for (uint32_t i = 0; i < n; i++) {
        double own = 0.0; /* the slope of a constant is 0 */
        for (uint32_t j = 0; j <= last; j++) {
            if (j == i + 1) continue;
            const double s = cardinal_slope(i + 1, j, last);
            own -= s;
            if (j > 0 && j < last) slope[(size_t)i * n + j - 1] = s;
        }
        slope[(size_t)i * n + i] = own;
    }
}

/* Weights +1, -1, ..., halved at the ends (Berrut & Trefethen 2004); share[n + 2] of the values in
 * the one at x. */
static void shares(double *share, double x, uint32_t n) {
    const uint32_t last = n + 1;
    double sum = 0.0;
    for (uint32_t j = 0; j <= last; j++) {
        const double off = x - point(j, last);
        const double end = j == 0 || j == last ? 0.5 : 1.0;
        if (off == 0.0) {
            memset(share, 0, ((size_t)last + 1) * sizeof *share);
            share[j] = 1.0;
            return;
        }
        share[j] = (j % 2 ? -end : end) / off;
        sum += share[j];
    }
    for (uint32_t j = 0; j <= last; j++) share[j] /= sum;
}

void dm_walls_interpolate(double *out, const double *x, uint32_t rows, const double *values,
                          uint32_t n) {
    for (uint32_t i = 0; i < rows; i++) {
        double above = 0.0, below = 0.0;
        out[i] = NAN;
        for (uint32_t j = 0; j <= n + 1; j++) {
            const double off = x[i] - point(j, n + 1), end = j == 0 || j == n + 1 ? 0.5 : 1.0;
            if (off == 0.0) {
                above = values[j], below = 1.0;
                break;
            }
            const double share = (j % 2 ? -end : end) / off;
            above += share * values[j], below += share;
        }
        out[i] = above / below;
    }
}

/* ---- nodes of amplitudes ---- */

/* p_(k+1) = (x p_k - off_k p_(k-1))/off_(k+1): the recurrence of the weight (1 - x^2)^2 */
static double off_diagonal(uint32_t k) {
    const double a = (double)k;
    return sqrt(a * (a + 4.0) / ((2.0 * a + 3.0) * (2.0 * a + 5.0)));
}

/* p[n] at x */
static void polynomials(double *p, double x, uint32_t n) {
    double before = 0.0, now = sqrt(15.0 / 16.0); /* the integral of the weight is 16/15 */
    for (uint32_t k = 0; k < n; k++) {
        p[k] = now;
        const double next = (x * now - (k ? off_diagonal(k) : 0.0) * before) / off_diagonal(k + 1);
        before = now, now = next;
    }
}

/* Golub and Welsch 1969: eigenvalues are the points; weights by the sum of squares, which is good
 * to rounding, over (1 - x^2)^2 */
dm_status dm_walls_nodes(double *xi, double *weight, uint32_t n, dm_arena *arena,
                         volatile const int *stop) {
    dm_arena *scratch = dm_arena_scratch(arena);
    double *A = scratch ? dm_arena_take(scratch, (size_t)n * n * sizeof *A) : NULL;
    if (!A) return DM_NO_MEMORY;
    memset(A, 0, (size_t)n * n * sizeof *A);
    for (uint32_t k = 1; k < n; k++)
        A[(size_t)k * n + k - 1] = A[(size_t)(k - 1) * n + k] = off_diagonal(k);
    const dm_status status = dm_symmetric_eigen(A, xi, weight, n, stop);
    for (uint32_t q = 0; status == DM_OK && 2 * q < n; q++) {
        const double x = 0.5 * (xi[n - 1 - q] - xi[q]); /* symmetric to the last bit */
        xi[q] = -x, xi[n - 1 - q] = x;
    }
    for (uint32_t q = 0; status == DM_OK && q < n; q++) {
        double sum = 0.0;
        polynomials(A, xi[q], n);
        for (uint32_t k = 0; k < n; k++) sum += A[k] * A[k];
        weight[q] = 1.0 / (sum * pow(1.0 - xi[q] * xi[q], 2));
    }
    dm_arena_reset(scratch);
    return status;
}

/* ---- matrices ---- */

/* values[n] and slopes[n] of the basis at x: f_k = (1 - x^2) p_k, and (1 - x^2) f_k' =
 * -(k + 2) x f_k + (2 k + 5) off_k f_(k-1), as for P_l^m (l = k + 2, m = 2) */
static void basis(double *value, double *slope, double x, uint32_t n) {
    const double room = 1.0 - x * x;
    polynomials(value, x, n);
    for (uint32_t k = 0; k < n; k++) {
        const double a = (double)k;
        const double last = k ? off_diagonal(k) * value[k - 1] : 0.0;
        slope[k] = -(a + 2.0) * x * value[k] + (2.0 * a + 5.0) * last;
    }
    for (uint32_t k = 0; k < n; k++) value[k] *= room;
}

/* x and weight of point i of `count` Legendre points on [-1, 1], by Newton's method */
static void legendre(double *x, double *weight, uint32_t i, uint32_t count) {
    const double m = (double)count;
    double at = -cos(PI * ((double)i + 0.75) / (m + 0.5)), slope = 1.0;
    for (int round = 0; round < 6; round++) {
        double before = 1.0, now = at;
        for (uint32_t k = 1; k < count; k++) {
            const double next = ((2.0 * k + 1.0) * at * now - (double)k * before) / (k + 1.0);
            before = now, now = next;
        }
        slope = m * (before - at * now) / (1.0 - at * at);
        at -= now / slope;
    }
    *x = at;
    *weight = 2.0 / ((1.0 - at * at) * slope * slope);
}

/* out += weight x y^T */
static void add_outer(double *out, double weight, const double *x, const double *y, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) {
        const double wx = weight * x[i];
        for (uint32_t j = 0; j < n; j++) out[(size_t)i * n + j] += wx * y[j];
    }
}

/* A becomes C^T A C, C[k][q] orthogonal; B is scratch */
static void congruence(double *A, double *B, const double *C, uint32_t n) {
    memset(B, 0, (size_t)n * n * sizeof *B);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < n; k++) {
            const double a = A[(size_t)i * n + k], *row = C + (size_t)k * n;
            for (uint32_t q = 0; q < n; q++) B[(size_t)i * n + q] += a * row[q];
        }
    memset(A, 0, (size_t)n * n * sizeof *A);
    for (uint32_t k = 0; k < n; k++) add_outer(A, 1.0, C + (size_t)k * n, B + (size_t)k * n, n);
}

/* values at the Chebyshev points of amplitudes, sum_k f_k(x_i) C_kq, and back by interpolation */
static void fill_values(dm_walls_matrices *out, const double *xi, const double *weight,
                        const double *C, double *line, uint32_t n) {
    memset(out->values, 0, (size_t)n * n * sizeof *line);
    for (uint32_t i = 0; i < n; i++) {
        double *row = out->values + (size_t)i * n;
        basis(line, line + n, point(i + 1, n + 1), n);
        for (uint32_t k = 0; k < n; k++)
            for (uint32_t q = 0; q < n; q++) row[q] += line[k] * C[(size_t)k * n + q];
    }
    for (uint32_t q = 0; q < n; q++) {
        shares(line, xi[q], n);
        for (uint32_t i = 0; i < n; i++)
            out->amplitudes[(size_t)q * n + i] = sqrt(weight[q]) * line[i + 1];
    }
}

dm_status dm_walls_fill(dm_walls_matrices *out, const double *xi, const double *weight, uint32_t n,
                        dm_arena *arena) {
    const size_t size = (size_t)n * n * sizeof(double);
    double **const matrix[] = {&out->values, &out->amplitudes, &out->form, &out->drift};
    for (int i = 0; i < 4; i++)
        if (!(*matrix[i] = dm_arena_take(arena, size))) return DM_NO_MEMORY;
    dm_arena *scratch = dm_arena_scratch(arena);
    double *C =
        scratch ? dm_arena_take(scratch, 2 * size + 4 * ((size_t)n + 2) * sizeof(double)) : NULL;
    if (!C) return DM_NO_MEMORY;
    double *B = C + (size_t)n * n, *line = B + (size_t)n * n;
    for (uint32_t q = 0; q < n; q++) {
        basis(line, line + n, xi[q], n);
        for (uint32_t k = 0; k < n; k++) C[(size_t)k * n + q] = sqrt(weight[q]) * line[k];
    }
    memset(out->form, 0, size);
    memset(out->drift, 0, size);
    for (uint32_t i = 0; i < n + 2; i++) {
        double x, w;
        legendre(&x, &w, i, n + 2);
        basis(line, line + n, x, n);
        add_outer(out->form, w, line + n, line + n, n);
        add_outer(out->drift, w, line, line + n, n);
    }
    congruence(out->form, B, C, n);
    congruence(out->drift, B, C, n);
    fill_values(out, xi, weight, C, line, n);
    dm_arena_reset(scratch);
    return DM_OK;
}
