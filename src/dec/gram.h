/* gram.h - Gram matrices of simplices from squares of lengths: volumes and circumcentres. Inline,
 * so that degrees that are constants leave straight code. */
#ifndef DM_GRAM_H
#define DM_GRAM_H

#include "dec/complex.h"

#include <math.h>

/* Where a cell counts as flat: up to degree 3, (k! volume)^2 against the longest edge to the power
 * 2 k; above, where that product of squares of heights is small in any cell, the least of these
 * against the square of the edge. Lengths in doubles leave an error of some 1e-16 in either. */
#define DM_FLAT 1e-14

/* of a triangle by its points */
#define DM_FLAT_POINTS 1e-22

typedef double dm_squares[DM_DIMENSION + 1]; /* a row of squares of lengths between vertices */

/* G_ij = e_i . e_j, e_i from the first of the vertices v[k + 1] to the others; Cholesky's factor
 * takes its place. Returns det G = (k! volume)^2, not positive where there is no such simplex. */
static inline double dm_gram_factor(double G[DM_DIMENSION][DM_DIMENSION], const dm_squares *l,
                                    const uint32_t *v, const uint32_t k) {
    double det = 1.0;
    for (uint32_t i = 0; i < k; i++)
        for (uint32_t j = 0; j <= i; j++) {
            double sum = (l[v[0]][v[i + 1]] + l[v[0]][v[j + 1]] - l[v[i + 1]][v[j + 1]]) / 2.0;
            for (uint32_t m = 0; m < j; m++) sum -= G[i][m] * G[j][m];
            if (i == j) {
                det *= sum;
                if (!(sum > 0.0)) return det < 0.0 ? det : 0.0;
                G[i][i] = sqrt(sum);
            } else {
                G[i][j] = sum / G[j][j];
            }
        }
    return det;
}

/* The least square of a height of the simplex with the factor G, each over the vertices before. */
static inline double dm_gram_least(double G[DM_DIMENSION][DM_DIMENSION], const uint32_t k) {
    double least = INFINITY;
    for (uint32_t i = 0; i < k; i++) least = fmin(least, G[i][i] * G[i][i]);
    return least;
}

/* Barycentric coordinates lambda[k + 1] of the circumcentre, by the factor of G: 2 G mu = diagonal
 * of G, lambda_0 = 1 - sum mu. */
static inline void dm_gram_centre(double *lambda, double G[DM_DIMENSION][DM_DIMENSION],
                                  const dm_squares *l, const uint32_t *v, const uint32_t k) {
    double *mu = lambda + 1;
    lambda[0] = 1.0;
    for (uint32_t i = 0; i < k; i++) {
        mu[i] = l[v[0]][v[i + 1]] / 2.0;
        for (uint32_t m = 0; m < i; m++) mu[i] -= G[i][m] * mu[m];
        mu[i] /= G[i][i];
    }
    for (uint32_t i = k; i-- > 0;) {
        for (uint32_t m = i + 1; m < k; m++) mu[i] -= G[m][i] * mu[m];
        mu[i] /= G[i][i];
        lambda[0] -= mu[i];
    }
}

/* Where (2 area)^2 of a triangle is below this part of its longest edge to the power 4, squares of
 * lengths leave an error of 1e-12 in it, and the area is found in another way. */
#define DM_SLENDER 1e-4

/* (4 area)^2 of a triangle with squared edges a, b, c. */
static inline double dm_area4_squared(double a, double b, double c) {
    const double mixed = a + b - c;
    return 4.0 * a * b - mixed * mixed;
}

#endif
