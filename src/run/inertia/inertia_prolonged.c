/* inertia_prolonged.c - the inertia of a prolonged L~ = L_q . u + L_v . w (tangent maps): M~ =
 * [B, M; M, 0] has as many values of each sign wherever M is regular, and B grows with the tangent
 * vector u. So M is looked at, on the velocities that the constraints of q allow: of G~ = [G, 0;
 * dG, G] the rows G. */
#include "run/inertia/inertia_values.h"

#include <math.h>
#include <string.h>

/* of the largest entry: rounding of the graph */
static const double ROUNDING = 1e-9;

int dm_inertia_is_prolonged(const double *M, uint32_t n) {
    const uint32_t half = n / 2;
    double largest = 0.0, apart = 0.0;
    if (n % 2) return 0;
    for (uint32_t i = 0; i < half; i++)
        for (uint32_t j = 0; j < half; j++) {
            const double a = M[i * n + half + j], b = M[j * n + half + i];
            if (M[(half + i) * n + half + j] != 0.0) return 0;
            largest = fmax(largest, fabs(a));
            apart = fmax(apart, fabs(a - b));
        }
    return largest > 0.0 && apart <= ROUNDING * largest;
}

/* a row by its largest entry, which is positive; 0: it has none */
static int normalize(double *row, uint32_t n) {
    double largest = 0.0;
    for (uint32_t i = 0; i < n; i++)
        if (fabs(row[i]) > fabs(largest)) largest = row[i];
    for (uint32_t i = 0; i < n && largest != 0.0; i++) row[i] /= largest;
    return largest != 0.0;
}

static int is_near(const double *a, const double *b, uint32_t n) {
    double apart = 0.0;
    for (uint32_t i = 0; i < n; i++) apart = fmax(apart, fabs(a[i] - b[i]));
    return apart <= ROUNDING;
}

/* Rows of G~, each [c, d] with d = 0 or d some other row's c: those with d = 0 come first in
 * own[], `*plain` of them; 0: they are not so. */
static int sort_rows(const double *G, uint32_t rows, uint32_t n, double *own, uint32_t *plain) {
    const uint32_t half = n / 2;
    *plain = 0;
    for (uint32_t c = 0; c < rows; c++) {
        memcpy(own + (size_t)*plain * half, G + (size_t)c * n + half, half * sizeof *own);
        if (normalize(own + (size_t)*plain * half, half)) continue;
        memcpy(own + (size_t)*plain * half, G + (size_t)c * n, half * sizeof *own);
        if (!normalize(own + (size_t)*plain * half, half)) return 0;
        ++*plain;
    }
    for (uint32_t c = 0; c < rows; c++) {
        double *d = own + (size_t)*plain * half;
        uint32_t k = 0;
        memcpy(d, G + (size_t)c * n + half, half * sizeof *d);
        if (!normalize(d, half)) continue;
        while (k < *plain && !is_near(own + (size_t)k * half, d, half)) k++;
        if (k == *plain) return 0;
    }
    return 2 * *plain == rows;
}

uint32_t dm_inertia_halve(double *A, double *G, uint32_t *rows, uint32_t n, double *work) {
    const uint32_t half = n / 2;
    uint32_t plain = 0;
    if (!dm_inertia_is_prolonged(A, n) || !sort_rows(G, *rows, n, work, &plain)) return n;
    memcpy(G, work, (size_t)plain * half * sizeof *G);
    for (uint32_t i = 0; i < half; i++)
        for (uint32_t j = 0; j < half; j++) A[i * half + j] = A[i * n + half + j];
    *rows = plain;
    return half;
}
