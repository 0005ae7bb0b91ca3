/* wave_modes.c - the modes in which rules that solve for a step work: those of H as far as they can
 * be had, else those of T, about the mean of V. */
#include "wave/wave_stepper.h"

#include <math.h>

/* in doubles: a constant V moves all energies alike, and the Fourier basis has all of H */
static int is_constant(const double *V, uint32_t n) {
    for (uint32_t j = 1; j < n; j++)
        if (V[j] != V[0]) return 0;
    return 1;
}

/* Fourier modes with energies T_k + mean */
static dm_status fourier(dm_modes *out, double mean, const dm_wave *w, dm_arena *arena) {
    double *energy = dm_arena_take(arena, w->n * sizeof *energy);
    if (!energy) return DM_NO_MEMORY;
    for (uint32_t k = 0; k < w->n; k++) energy[k] = w->kinetic.energy[k] + mean;
    *out = w->kinetic;
    out->energy = energy;
    return DM_OK;
}

/* Eigenvectors of the whole linear H. */
static dm_status dense(dm_modes *out, const dm_wave *w, dm_arena *arena, volatile const int *stop) {
    double *H = dm_arena_take(arena, (size_t)w->n * w->n * sizeof *H);
    if (!H) return DM_NO_MEMORY;
    dm_wave_matrix(H, w, 1, 1);
    return dm_modes_dense(out, H, w->n, arena, stop);
}

dm_status dm_wave_modes(dm_modes *out, const double **rest, const dm_wave *w, dm_arena *arena,
                        volatile const int *stop) {
    double least = INFINITY, most = -INFINITY;
    *rest = NULL;
    if (w->space != DM_WALLS && is_constant(w->V, w->n)) return fourier(out, w->V[0], w, arena);
    if (w->n <= DM_DENSE_MODES) return dense(out, w, arena, stop);
    for (uint32_t j = 0; j < w->n; j++) {
        least = fmin(least, w->V[j]);
        most = fmax(most, w->V[j]);
    }
    const double mean = 0.5 * (least + most);
    double *left = dm_arena_take(arena, w->n * sizeof *left);
    if (!left) return DM_NO_MEMORY;
    for (uint32_t j = 0; j < w->n; j++) left[j] = w->V[j] - mean;
    *rest = left;
    return fourier(out, mean, w, arena);
}
