#include "linalg/complex_lu.h"

#include <math.h>
#include <stddef.h>

static void exchange(double *a, double *b, uint32_t n) {
    for (uint32_t j = 0; j < n; j++) {
        const double x = a[j];
        a[j] = b[j];
        b[j] = x;
    }
}

/* row of the largest entry of column k at or below the diagonal, by |re| + |im| */
static uint32_t find_pivot(const double *re, const double *im, uint32_t k, uint32_t n) {
    uint32_t best = k;
    double largest = -1.0;
    for (uint32_t i = k; i < n; i++) {
        const size_t at = i * (size_t)n + k;
        const double size = fabs(re[at]) + fabs(im[at]);
        if (size > largest || isnan(size)) {
            largest = size;
            best = i;
        }
    }
    return best;
}

/* (x, y) -= (a, b) (u, v), rows of complex numbers */
static void subtract(double *restrict x, double *restrict y, double a, double b,
                     const double *restrict u, const double *restrict v, uint32_t n) {
    for (uint32_t j = 0; j < n; j++) {
        x[j] -= a * u[j] - b * v[j];
        y[j] -= a * v[j] + b * u[j];
    }
}

/* entry `at` becomes its reciprocal */
static dm_status invert(double *re, double *im, size_t at) {
    const double a = re[at], b = im[at], scale = fabs(a) + fabs(b);
    if (!isfinite(scale)) return DM_NOT_FINITE;
    if (scale == 0.0) return DM_SINGULAR;
    const double c = a / scale, d = b / scale, size = (c * c + d * d) * scale;
    re[at] = c / size;
    im[at] = -d / size;
    return DM_OK;
}

dm_status dm_complex_lu_factor(double *re, double *im, uint32_t *pivot, uint32_t n) {
    for (uint32_t k = 0; k < n; k++) {
        const size_t row = k * (size_t)n;
        const size_t best = (pivot[k] = find_pivot(re, im, k, n)) * (size_t)n;
        if (best != row) {
            exchange(re + row, re + best, n);
            exchange(im + row, im + best, n);
        }
        const dm_status status = invert(re, im, row + k);
        if (status != DM_OK) return status;
        for (uint32_t i = k + 1; i < n; i++) {
            const size_t below = i * (size_t)n;
            const double a = re[below + k], b = im[below + k];
            const double c = re[row + k], d = im[row + k];
            const double fr = a * c - b * d, fi = a * d + b * c;
            re[below + k] = fr;
            im[below + k] = fi;
            subtract(re + below + k + 1, im + below + k + 1, fr, fi, re + row + k + 1,
                     im + row + k + 1, n - k - 1);
        }
    }
    return DM_OK;
}

/* entry i of (x, y) less the entries first .. last - 1 times those of its row */
static void reduce(double *x, double *y, const double *re, const double *im, uint32_t i,
                   uint32_t first, uint32_t last) {
    double u = x[i], v = y[i];
    for (uint32_t j = first; j < last; j++) {
        u -= re[j] * x[j] - im[j] * y[j];
        v -= re[j] * y[j] + im[j] * x[j];
    }
    x[i] = u;
    y[i] = v;
}

void dm_complex_lu_solve(double *x, double *y, const double *re, const double *im,
                         const uint32_t *pivot, uint32_t n) {
    for (uint32_t k = 0; k < n; k++) {
        exchange(x + k, x + pivot[k], 1);
        exchange(y + k, y + pivot[k], 1);
    }
    for (uint32_t i = 0; i < n; i++) reduce(x, y, re + i * (size_t)n, im + i * (size_t)n, i, 0, i);
    for (uint32_t i = n; i-- > 0;) {
        const double *row = re + i * (size_t)n, *row_im = im + i * (size_t)n;
        reduce(x, y, row, row_im, i, i + 1, n);
        const double u = x[i], v = y[i];
        x[i] = u * row[i] - v * row_im[i];
        y[i] = u * row_im[i] + v * row[i];
    }
}
