/* signature.h - signs of the values of a symmetric matrix, without the values. */
#ifndef DM_SIGNATURE_H
#define DM_SIGNATURE_H

#include <stdint.h>

/* How many values of A[n*n] are negative, by elimination with symmetric pivots (Bunch & Parlett
 * 1971: Sylvester's law of inertia keeps the signs), the least size of a pivot, which goes to zero
 * with a value, and in `all` the size of the product of all values; of more than four, over the
 * (n - 1)th power of what the diagonal has in common, the number nearest to 1 of its sizes and all
 * between them. With values that all move alike that moves as one of them does, not n times as
 * fast; it is the product as long as some entry of the diagonal is 1. A is overwritten; values that
 * are zero to round-off may count as either. */
uint32_t dm_negative_values(double *A, uint32_t n, double *least, double *all);

/* Are all values of A[n*n] positive by far? With the pivots, the least of them and `all` that
 * dm_negative_values finds for such a matrix. 0 where one is not above `far`. A is overwritten. */
int dm_all_positive(double *A, uint32_t n, double far, double *least, double *all);

/* Are all values positive, by far, of every symmetric matrix whose diagonal entries are at least
 * those of A[n*n], and whose others are within radius[n*n] of theirs? 0: it is not told. n of
 * DM_SURELY_MOST at most; both are overwritten. */
enum { DM_SURELY_MOST = 24 };
int dm_surely_positive(double *A, double *radius, uint32_t n);

/* The form A[n*n] on the vectors that all rows of G[k*n] leave at zero, as a matrix of the order
 * that is returned, n less the rank of G, in the first entries of A. Its values move with A and G;
 * pivots of [A, G^T; G, 0] jump. By reflections; G and work[n] are overwritten. */
uint32_t dm_restrict(double *A, uint32_t n, double *G, uint32_t k, double *work);

#endif
