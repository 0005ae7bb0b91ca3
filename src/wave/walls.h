/* walls.h - polynomials of degree n + 1 on [-1, 1] that are 0 at both ends, of dimension n.
 *
 * They are given and shown by their values at the n inner Chebyshev points. Integrals are those of
 * Gauss and Jacobi for the weight (1 - x^2)^2, exact for products of two of them: at its n points
 * xi_q amplitudes a_q = psi(xi_q) sqrt(weight_q) have sum |a_q|^2 = integral of |psi|^2, and what
 * multiplies psi is diagonal. The orthonormal basis (1 - x^2) p_k, p_k the polynomials of that
 * weight, are the associated Legendre functions P_(k+2)^2. */
#ifndef DM_WALLS_H
#define DM_WALLS_H

#include "base/arena.h"
#include "base/status.h"

#include <stdint.h>

/* The inner points -cos(i pi/(n + 1)), i = 1 .. n, and their weights of Clenshaw and Curtis. */
void dm_walls_points(double *x, double *weight, uint32_t n);

/* The points and weights of amplitudes. DM_NO_MEMORY, DM_STOPPED, DM_NO_CONVERGENCE. */
dm_status dm_walls_nodes(double *xi, double *weight, uint32_t n, dm_arena *arena,
                         volatile const int *stop);

/* Matrices [n][n] from xi and weight. values: psi at the Chebyshev points of amplitudes;
 * amplitudes: its inverse; form: integrals of the products of two slopes; drift: of one function
 * with the slope of another (row function, column slope); both of amplitudes. DM_NO_MEMORY. */
typedef struct {
    double *values, *amplitudes, *form, *drift;
} dm_walls_matrices;
dm_status dm_walls_fill(dm_walls_matrices *out, const double *xi, const double *weight, uint32_t n,
                        dm_arena *arena);

/* out[rows]: at x[rows] the polynomial of degree n + 1 with these values at all n + 2 Chebyshev
 * points. */
void dm_walls_interpolate(double *out, const double *x, uint32_t rows, const double *values,
                          uint32_t n);

/* slope[n][n]: derivatives at the inner Chebyshev points of values there. */
void dm_walls_slope(double *slope, uint32_t n);

#endif
