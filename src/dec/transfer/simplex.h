/* simplex.h - barycentric coordinates of points in a simplex, and the part of one simplex that lies
 * in another one. */
#ifndef DM_TRANSFER_SIMPLEX_H
#define DM_TRANSFER_SIMPLEX_H

#include "dec/complex.h"

enum { DM_SIMPLEX_VERTICES = DM_DIMENSION + 1 };

/* A simplex of degree n in R^N, ready to place points: edges from its first vertex, and the
 * Cholesky factor of their products. */
typedef struct {
    uint32_t n, N;
    const double *vertex[DM_SIMPLEX_VERTICES];
    double factor[DM_DIMENSION][DM_DIMENSION];
    double size; /* the longest edge from the first vertex */
} dm_placer;

/* DM_SINGULAR: it is degenerate. */
dm_status dm_placer_make(dm_placer *p, const double *const *vertex, uint32_t n, uint32_t N);

/* lambda[n + 1] of the point of the simplex's plane that is nearest to x[N]; returns the distance
 * from that plane. */
double dm_placer_place(const dm_placer *p, double *lambda, const double *x);

/* A part of a simplex T of degree k: how much of its volume, and the mean of its points in the
 * barycentric coordinates of T. */
typedef struct {
    double share;
    double centre[DM_SIMPLEX_VERTICES];
} dm_simplex_part;

/* The part of T where all of n + 1 affine functions are >= 0, given by their values
 * value[i][vertex of T]; values below `least` in modulus count as 0. */
void dm_simplex_clip(dm_simplex_part *out, uint32_t k, uint32_t n,
                     const double value[][DM_SIMPLEX_VERTICES], double least);

/* The determinant of a matrix of `size` rows, which is changed. */
double dm_determinant(double a[][DM_SIMPLEX_VERTICES], uint32_t size);

#endif
