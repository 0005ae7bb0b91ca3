/* wave.h - a Schroedinger equation in space, i hbar psi_t = -hbar^2/2m psi_xx + (V + g |psi|^2)
 * psi, as a complex vector: on a ring by Fourier collocation or in Leok's space of trigonometric
 * polynomials (5.8), between walls by Chebyshev points.
 *
 * What is stepped are amplitudes a[n], a_j = sqrt(weight_j) psi(x_j), so that the norm, the
 * integral of |psi|^2, is sum |a_j|^2 and H is a real symmetric matrix. In Leok's space the mode
 * k = N/2 is a cosine, of half the norm of the others: there a_j are the values of the function
 * whose N/2-th coefficient is divided by sqrt(2). */
#ifndef DM_WAVE_H
#define DM_WAVE_H

#include "wave/modes.h"
#include "wave/walls.h"

typedef enum { DM_RING, DM_RING_GALERKIN, DM_WALLS } dm_wave_space;

typedef struct {
    dm_wave_space space;
    uint32_t n;              /* unknowns: points of the ring (even), inner points between walls */
    double from, to;         /* ends; the ring is closed at `to` */
    double hbar, m, g;       /* g: energy a density, times length */
    double *x, *weight;      /* [n] points of amplitudes, and what integrals weigh them by */
    const double *V;         /* [n] energy there */
    double *k;               /* ring: [n] wave numbers in the order of the transform, 0 for n/2 */
    double *slope;           /* walls: [n][n] the derivative at Chebyshev points */
    dm_walls_matrices walls; /* form is the kinetic energy, drift the slope, of amplitudes */
    double *P;               /* Leok's space: [n][n] the potential energy of amplitudes */
    dm_modes kinetic;        /* where the kinetic energy is diagonal */
    double *work[3];         /* [2 n] each, aligned to 64 */
} dm_wave;

/* Fills *w, of which space to V and, for a ring, the transforms with their kind of plan are
 * given. Leok's space and walls: n <= DM_DENSE_MODES. DM_NO_MEMORY, DM_STOPPED. */
dm_status dm_wave_open(dm_wave *w, const dm_transforms *transforms, int measure, dm_arena *arena,
                       volatile const int *stop);

/* The points of values, x[n], and what integrals weigh them by; between walls the inner ones. */
void dm_wave_points(double *x, double *weight, dm_wave_space space, double from, double to,
                    uint32_t n);

/* The points of amplitudes. DM_NO_MEMORY, DM_STOPPED. */
dm_status dm_wave_nodes(double *x, double *weight, dm_wave_space space, double from, double to,
                        uint32_t n, dm_arena *arena, volatile const int *stop);

/* H[n][n] of amplitudes: the kinetic, the potential part, or both; g is left out. */
void dm_wave_matrix(double *H, const dm_wave *w, int kinetic, int potential);

/* amplitudes of values psi(x_j), and back: a[2 n], psi[2 n] */
void dm_wave_amplitudes(double *a, const dm_wave *w, const double *psi);
void dm_wave_values(double *psi, const dm_wave *w, const double *a);

/* d/dx of values; may not be in place. */
void dm_wave_slope(double *slope, const dm_wave *w, const double *psi);

/* What is observed at a state. */
typedef struct {
    double norm;   /* integral of |psi|^2 */
    double energy; /* integral of psi* (T + V) psi + g/2 |psi|^4 */
    double x;      /* means over the norm */
    double momentum;
    double tail; /* share of the norm in the last third of the modes: aliasing */
    double edge; /* density at the ends over the largest */
} dm_wave_observed;

void dm_wave_observe(dm_wave_observed *out, const dm_wave *w, const double *a);

#endif
