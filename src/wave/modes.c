/* modes.c - see modes.h. */
#include "wave/modes.h"

#include "linalg/sparse/symmetric_eigen.h"

#include <math.h>
#include <string.h>

dm_status dm_modes_dense(dm_modes *out, double *A, uint32_t n, dm_arena *arena,
                         volatile const int *stop) {
    double *energy = dm_arena_take(arena, 2 * (size_t)n * sizeof *energy);
    if (!energy) return DM_NO_MEMORY;
    *out = (dm_modes){.n = n, .energy = energy, .Q = A};
    return dm_symmetric_eigen(A, energy, energy + n, n, stop);
}

static void scale(double *z, double factor, size_t n) {
    for (size_t i = 0; i < 2 * n; i++) z[i] *= factor;
}

/* sum_j q[j] a[j], q real */
static void project(double c[2], const double *q, const double *a, uint32_t n) {
    double re = 0.0, im = 0.0;
    for (uint32_t j = 0; j < n; j++) re += q[j] * a[2 * j], im += q[j] * a[2 * j + 1];
    c[0] = re, c[1] = im;
}

void dm_to_modes(double *c, const dm_modes *modes, const double *a) {
    const uint32_t n = modes->n;
    if (!modes->Q) {
        modes->transforms->run(modes->forward, c, a);
        scale(c, 1.0 / sqrt(n), n);
        return;
    }
    for (uint32_t k = 0; k < n; k++) project(c + 2 * k, modes->Q + (size_t)k * n, a, n);
}

void dm_from_modes(double *a, const dm_modes *modes, const double *c) {
    const uint32_t n = modes->n;
    if (!modes->Q) {
        modes->transforms->run(modes->backward, a, c);
        scale(a, 1.0 / sqrt(n), n);
        return;
    }
    memset(a, 0, 2 * (size_t)n * sizeof *a);
    for (uint32_t k = 0; k < n; k++) {
        const double *q = modes->Q + (size_t)k * n, re = c[2 * k], im = c[2 * k + 1];
        for (uint32_t j = 0; j < n; j++) a[2 * j] += q[j] * re, a[2 * j + 1] += q[j] * im;
    }
}
