/*
** functions.h - elementary functions with the same bits in every backend and width, on one
** processor level (processor.h).
*/
#ifndef DM_FUNCTIONS_H
#define DM_FUNCTIONS_H

/*
** 1/sqrt(x), below 0.6 ulp with AVX-512: y = a table look-up to 14 bits, e = 1 - x y^2 with the rounding error of
** x y taken in, then y (1 - e)^(-1/2) = y + y e (1/2 + e (3/8 + 5/16 e)), |e| < 2^-13. Elsewhere root and
** division.
*/
double dm_rsqrt(double x);

/* 1/2, 3/8 and 5/16 of the series; the term in e^4, left out, is taken in by the second to a quarter (Chebyshev). */
#define DM_ROOT_SERIES                                                                   \
    { 0.5, 0.375 + 35.0 / 128 * 0.75 / (1 << 26), 0.3125 }

#endif
