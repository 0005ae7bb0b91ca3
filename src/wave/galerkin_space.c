/* galerkin_space.c - P between the orthonormal functions exp(i k x)/sqrt(L), |k| < N/2, and
 * sqrt(2/L) cos(N x/2), then transformed to the points from both sides. Leok prints the rows of the
 * cosine without their factors of one half (5.8). */
#include "wave/galerkin_space.h"

#include <math.h>
#include <string.h>

/* Coefficients of V, and k by its place in the order of the transform. */
typedef struct {
    uint32_t n;
    const double *V; /* [n] complex */
} spectrum;

/* the wave number at a place; that of the cosine is n/2 */
static int number(const spectrum *s, uint32_t place) {
    return place <= s->n / 2 ? (int)place : (int)place - (int)s->n;
}

/* V_d, d from -n to n, times factor, added */
static void add(double out[2], const spectrum *s, int d, double factor) {
    const int half = (int)s->n / 2;
    if (d > half || d < -half) return;
    if (d == half || d == -half) factor *= 0.5;
    const double *v = s->V + 2 * (size_t)((d + (int)s->n) % (int)s->n);
    out[0] += factor * v[0], out[1] += factor * v[1];
}

/* The cosine is the sum of exp(i N x/2) and its conjugate, over sqrt(2). */
static void entry(double out[2], const spectrum *s, uint32_t row, uint32_t column) {
    const int half = (int)s->n / 2, k = number(s, row), l = number(s, column);
    const int twice = k == half && l == half;
    out[0] = out[1] = 0.0;
    if (k != half && l != half) {
        add(out, s, k - l, 1.0);
    } else if (twice) {
        add(out, s, 0, 1.0);
    } else {
        add(out, s, k - l, sqrt(0.5));
        add(out, s, k == half ? -half - l : k + half, sqrt(0.5));
    }
}

/* rows become sum_l row[l] exp(-i x l)/sqrt(n), by the forward transform */
static void transform_rows(double *P, const dm_wave *w) {
    const uint32_t n = w->n;
    double *line = w->work[0], *out = w->work[1];
    for (uint32_t i = 0; i < n; i++) {
        double *row = P + 2 * (size_t)i * n;
        memcpy(line, row, 2 * (size_t)n * sizeof *line);
        dm_to_modes(out, &w->kinetic, line);
        memcpy(row, out, 2 * (size_t)n * sizeof *line);
    }
}

/* columns back to points; what is left is real */
static void transform_columns(double *real, const double *P, const dm_wave *w) {
    const size_t n = w->n;
    double *line = w->work[0], *out = w->work[1];
    for (size_t j = 0; j < n; j++) {
        for (size_t i = 0; i < n; i++)
            line[2 * i] = P[2 * (i * n + j)], line[2 * i + 1] = P[2 * (i * n + j) + 1];
        dm_from_modes(out, &w->kinetic, line);
        for (size_t i = 0; i < n; i++) real[i * n + j] = out[2 * i];
    }
}

/* both halves alike to the last bit, as eigenvectors want them */
static void make_symmetric(double *P, size_t n) {
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++)
            P[i * n + j] = P[j * n + i] = 0.5 * (P[i * n + j] + P[j * n + i]);
}

dm_status dm_galerkin_potential(double *P, const dm_wave *w, dm_arena *arena) {
    const size_t n = w->n;
    dm_arena *scratch = dm_arena_scratch(arena);
    double *full = scratch ? dm_arena_take(scratch, 2 * n * n * sizeof *full) : NULL;
    if (!full) return DM_NO_MEMORY;
    double *line = w->work[0], *V = w->work[2];
    for (size_t j = 0; j < n; j++) line[2 * j] = w->V[j] / (double)n, line[2 * j + 1] = 0.0;
    w->kinetic.transforms->run(w->kinetic.forward, V, line);
    const spectrum s = {.n = w->n, .V = V};
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) entry(full + 2 * (i * n + j), &s, i, j);
    transform_rows(full, w);
    transform_columns(P, full, w);
    make_symmetric(P, n);
    dm_arena_reset(scratch);
    return DM_OK;
}
