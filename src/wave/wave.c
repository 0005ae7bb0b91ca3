/* wave.c - see wave.h. */
#include "wave/wave.h"

#include "wave/galerkin_space.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* ---- points ---- */

/* from [-1, 1] to the interval */
static void stretch(double *x, double *weight, double from, double to, uint32_t n) {
    const double half = 0.5 * (to - from), middle = from + half;
    for (uint32_t j = 0; j < n; j++) x[j] = middle + half * x[j], weight[j] *= half;
}

void dm_wave_points(double *x, double *weight, dm_wave_space space, double from, double to,
                    uint32_t n) {
    const double length = to - from;
    if (space == DM_WALLS) {
        dm_walls_points(x, weight, n);
        stretch(x, weight, from, to, n);
        return;
    }
    for (uint32_t j = 0; j < n; j++)
        x[j] = from + (double)j * length / (double)n, weight[j] = length / (double)n;
}

dm_status dm_wave_nodes(double *x, double *weight, dm_wave_space space, double from, double to,
                        uint32_t n, dm_arena *arena, volatile const int *stop) {
    if (space != DM_WALLS) {
        dm_wave_points(x, weight, space, from, to, n);
        return DM_OK;
    }
    const dm_status status = dm_walls_nodes(x, weight, n, arena, stop);
    if (status == DM_OK) stretch(x, weight, from, to, n);
    return status;
}

/* |z|^2 */
static double square(const double *z) {
    return z[0] * z[0] + z[1] * z[1];
}

/* ---- opening ---- */

/* wave numbers and hbar^2 k^2/2m, in the order of the transform; the cosine n/2 has no slope at
 * the points */
static dm_status open_ring(dm_wave *w, const dm_transforms *transforms, int measure,
                           dm_arena *arena) {
    const uint32_t n = w->n;
    const size_t size = 2 * (size_t)n * sizeof(double);
    double *energy = dm_arena_take(arena, size), *out = dm_arena_take(arena, size);
    dm_transform *forward, *backward;
    w->k = dm_arena_take(arena, size);
    if (!energy || !out || !w->k) return DM_NO_MEMORY;
    for (uint32_t j = 0; j < n; j++) {
        const double number = j <= n / 2 ? (double)j : (double)j - (double)n;
        const double k = 2.0 * PI * number / (w->to - w->from);
        w->k[j] = 2 * j == n ? 0.0 : k;
        energy[j] = w->hbar * w->hbar * k * k / (2.0 * w->m);
    }
    dm_status status = transforms->open(&forward, n, DM_FORWARD, measure, w->work[0], out, arena);
    if (status == DM_OK)
        status = transforms->open(&backward, n, DM_BACKWARD, measure, w->work[0], out, arena);
    if (status != DM_OK) return status;
    w->kinetic = (dm_modes){.n = n,
                            .energy = energy,
                            .transforms = transforms,
                            .forward = forward,
                            .backward = backward};
    return DM_OK;
}

/* T = hbar^2/2m integral of u' v', and its modes */
static dm_status open_walls(dm_wave *w, dm_arena *arena, volatile const int *stop) {
    const uint32_t n = w->n;
    const size_t entries = (size_t)n * n, size = entries * sizeof(double);
    const double half = 0.5 * (w->to - w->from), unit = w->hbar * w->hbar / (2.0 * w->m);
    double *Q = dm_arena_take(arena, size), *xi = w->work[0], *weight = w->work[1];
    w->slope = dm_arena_take(arena, size);
    if (!Q || !w->slope) return DM_NO_MEMORY;
    dm_status status = dm_walls_nodes(xi, weight, n, arena, stop);
    if (status == DM_OK) status = dm_walls_fill(&w->walls, xi, weight, n, arena);
    if (status != DM_OK) return status;
    dm_walls_slope(w->slope, n);
    for (size_t i = 0; i < entries; i++) {
        w->slope[i] /= half;
        w->walls.drift[i] /= half;
        w->walls.form[i] *= unit / (half * half);
        w->walls.values[i] /= sqrt(half);
        w->walls.amplitudes[i] *= sqrt(half);
    }
    memcpy(w->x, xi, n * sizeof *xi);
    memcpy(w->weight, weight, n * sizeof *xi);
    stretch(w->x, w->weight, w->from, w->to, n);
    memcpy(Q, w->walls.form, size);
    return dm_modes_dense(&w->kinetic, Q, n, arena, stop);
}

dm_status dm_wave_open(dm_wave *w, const dm_transforms *transforms, int measure, dm_arena *arena,
                       volatile const int *stop) {
    const size_t n = w->n;
    w->x = dm_arena_take(arena, n * sizeof(double));
    w->weight = dm_arena_take(arena, n * sizeof(double));
    for (int i = 0; i < 3; i++)
        if (!(w->work[i] = dm_arena_take(arena, 2 * n * sizeof(double)))) return DM_NO_MEMORY;
    if (!w->x || !w->weight) return DM_NO_MEMORY;
    /* the work arrays come first: plans of transforms are made on them */
    if (w->space == DM_WALLS) return open_walls(w, arena, stop);
    dm_wave_points(w->x, w->weight, w->space, w->from, w->to, w->n);
    const dm_status status = open_ring(w, transforms, measure, arena);
    if (status != DM_OK || w->space == DM_RING) return status;
    w->P = dm_arena_take(arena, n * n * sizeof(double));
    return w->P ? dm_galerkin_potential(w->P, w, arena) : DM_NO_MEMORY;
}

/* ---- H as a matrix ---- */

/* T on a ring is circulant: entry (i, j) is a function of i - j, the transform of T_k */
static void add_circulant(double *H, const dm_wave *w) {
    const uint32_t n = w->n;
    double *energy = w->work[0], *row = w->work[1];
    for (uint32_t k = 0; k < n; k++)
        energy[2 * k] = w->kinetic.energy[k] / (double)n, energy[2 * k + 1] = 0.0;
    w->kinetic.transforms->run(w->kinetic.backward, row, energy);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) H[(size_t)i * n + j] += row[2 * ((i + n - j) % n)];
}

void dm_wave_matrix(double *H, const dm_wave *w, int kinetic, int potential) {
    const size_t n = w->n;
    for (size_t i = 0; i < n * n; i++)
        H[i] = (kinetic && w->walls.form ? w->walls.form[i] : 0.0) +
               (potential && w->P ? w->P[i] : 0.0);
    if (kinetic && !w->walls.form) add_circulant(H, w);
    for (size_t i = 0; potential && !w->P && i < n; i++) H[i * n + i] += w->V[i];
}

/* ---- amplitudes and values ---- */

/* out = A in, A[n][n] real */
static void multiply(double *out, const double *A, const double *in, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) {
        const double *row = A + (size_t)i * n;
        double re = 0.0, im = 0.0;
        for (uint32_t j = 0; j < n; j++) re += row[j] * in[2 * j], im += row[j] * in[2 * j + 1];
        out[2 * i] = re, out[2 * i + 1] = im;
    }
}

/* out = factor in on a ring, but for the mode n/2 in Leok's space, whose factor is `cosine` times
 * that */
static void rescale(double *out, const dm_wave *w, const double *in, double factor, double cosine) {
    const uint32_t n = w->n;
    double share[2] = {0.0, 0.0};
    for (uint32_t i = 0; w->space == DM_RING_GALERKIN && i < 2 * n; i++)
        share[i % 2] += (i / 2 % 2 ? -1.0 : 1.0) * in[i] / (double)n;
    for (uint32_t i = 0; i < 2 * n; i++)
        out[i] = factor * (in[i] + (i / 2 % 2 ? 1.0 - cosine : cosine - 1.0) * share[i % 2]);
}

/* Both directions are linear; on a ring nothing but a factor, and the cosine of Leok's space. */
void dm_wave_amplitudes(double *a, const dm_wave *w, const double *psi) {
    if (w->space == DM_WALLS)
        multiply(a, w->walls.amplitudes, psi, w->n);
    else
        rescale(a, w, psi, sqrt(w->weight[0]), sqrt(0.5));
}

void dm_wave_values(double *psi, const dm_wave *w, const double *a) {
    if (w->space == DM_WALLS)
        multiply(psi, w->walls.values, a, w->n);
    else
        rescale(psi, w, a, 1.0 / sqrt(w->weight[0]), sqrt(2.0));
}

void dm_wave_slope(double *slope, const dm_wave *w, const double *psi) {
    const uint32_t n = w->n;
    const size_t size = 2 * (size_t)n * sizeof(double);
    double *in = w->work[0], *c = w->work[2];
    if (w->space == DM_WALLS) {
        multiply(slope, w->slope, psi, n);
        return;
    }
    memcpy(in, psi, size); /* aligned, as psi and slope may not be */
    w->kinetic.transforms->run(w->kinetic.forward, c, in);
    for (uint32_t j = 0; j < n; j++) {
        const double k = w->k[j] / (double)n, re = c[2 * j];
        c[2 * j] = -k * c[2 * j + 1], c[2 * j + 1] = k * re;
    }
    w->kinetic.transforms->run(w->kinetic.backward, in, c);
    memcpy(slope, in, size);
}

/* ---- what is observed ---- */

/* is mode i among the last third? */
static int is_last_third(const dm_wave *w, uint32_t i) {
    const uint32_t n = w->n, number = w->kinetic.Q ? i : 2 * (i <= n / 2 ? i : n - i);
    return 3 * (uint64_t)number >= 2 * (uint64_t)n;
}

/* the part of the energy that the modes have, their momentum, and the tail */
static void observe_modes(dm_wave_observed *out, const dm_wave *w, const double *c) {
    for (uint32_t i = 0; i < w->n; i++) {
        const double share = square(c + 2 * i);
        out->norm += share;
        out->energy += w->kinetic.energy[i] * share;
        if (w->k) out->momentum += w->hbar * w->k[i] * share;
        if (is_last_third(w, i)) out->tail += share;
    }
}

/* a . P a, P real symmetric */
static double quadratic(const double *P, const double *a, uint32_t n) {
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        double re = 0.0, im = 0.0;
        const double *row = P + (size_t)i * n;
        for (uint32_t j = 0; j < n; j++) re += row[j] * a[2 * j], im += row[j] * a[2 * j + 1];
        sum += a[2 * i] * re + a[2 * i + 1] * im;
    }
    return sum;
}

/* hbar Im integral of psi* psi' */
static double momentum_between_walls(const dm_wave *w, const double *a) {
    double sum = 0.0, *slope = w->work[0];
    multiply(slope, w->walls.drift, a, w->n);
    for (uint32_t i = 0; i < w->n; i++)
        sum += a[2 * i] * slope[2 * i + 1] - a[2 * i + 1] * slope[2 * i];
    return w->hbar * sum;
}

/* at the points of amplitudes: the mean of x, the potential and the nonlinear energy, the edge */
static void observe_points(dm_wave_observed *out, const dm_wave *w, const double *a) {
    const uint32_t n = w->n;
    double largest = 0.0, sum = 0.0;
    for (uint32_t j = 0; j < n; j++) {
        const double share = square(a + 2 * j), density = share / w->weight[j];
        out->x += w->x[j] * share, sum += share;
        if (!w->P) out->energy += w->V[j] * share;
        out->energy += 0.5 * w->g * density * share;
        largest = fmax(largest, density);
    }
    out->x /= sum;
    out->edge = fmax(square(a) / w->weight[0], square(a + 2 * ((size_t)n - 1)) / w->weight[n - 1]) /
                largest;
}

void dm_wave_observe(dm_wave_observed *out, const dm_wave *w, const double *a) {
    double *c = w->work[0];
    *out = (dm_wave_observed){.norm = 0.0};
    dm_to_modes(c, &w->kinetic, a);
    observe_modes(out, w, c);
    observe_points(out, w, a);
    if (w->P) out->energy += quadratic(w->P, a, w->n);
    if (w->space == DM_WALLS) out->momentum = momentum_between_walls(w, a);
    out->momentum /= out->norm;
    out->tail /= out->norm;
}
