/*
** functions.h - elementary functions with the same bits in every backend and width, on one processor level
** (processor.h). With fused multiply-add they are our own (functions_text.h), else the C library's; angles beyond
** 2^30, asin, acos, atan, atan2 and pow are the C library's everywhere. The sign of a zero is not kept.
*/
#ifndef DM_FUNCTIONS_H
#define DM_FUNCTIONS_H

#include "expr/graph.h"

/*
** x^(-1/2) and x^(-3/2), below 0.6 ulp with AVX-512: y = a table look-up to 14 bits, e = 1 - x y^2 without an error of
** rounding, then y (1 - e)^(-1/2) and y^3 (1 - e)^(-3/2) by series, |e| < 2^-13; y has 17 bits, so y^3 is exact. Elsewhere
** root and division.
*/
double dm_rsqrt(double x);
double dm_rsqrt3(double x);

/* ((1 - e)^(-1/2) - 1) / e = 1/2 + 3/8 e + 5/16 e^2; the next term, 35/128 e^3, is taken in by 3/8 to a quarter
** (Chebyshev). Then those of the cube, to one term more. */
#define DM_ROOT_SERIES                                                                   \
    { 0.5, 0.375 + 35.0 / 128 * 0.75 / (1 << 26), 0.3125, 1.5, 1.875, 2.1875, 2.4609375 }

/* Below 1 ulp: exp, log, sin, cos, tan, sinh, cosh, tanh. */
double dm_exp(double x);
double dm_log(double x);
double dm_sin(double x);
double dm_cos(double x);
double dm_tan(double x);
double dm_sinh(double x);
double dm_cosh(double x);
double dm_tanh(double x);

/* Returns the sine; the bits of dm_sin and dm_cos. */
double dm_sincos(double x, double *cosine);

typedef void dm_function(void); /* of one of the types below */

/*
** What machine code calls for an operation, by the present level; DM_OP_CONSTANT stands for sincos. For one lane double
** f(double), double f(double, double) and, for sincos, double f(double, double *cosine). For 4 or 8 lanes
** void f(double *d, double *d2, const double *a, const double *b), sincos: sine, cosine, angle.
*/
dm_function *dm_function_for(int op, uint32_t lanes);

/* The same for one width. Our own, NULL where there is none; the C library's, called once per lane. */
dm_function *dm_own_function1(int op);
dm_function *dm_own_function4(int op);
dm_function *dm_own_function8(int op);
dm_function *dm_library_function1(int op);
dm_function *dm_library_function4(int op);
dm_function *dm_library_function8(int op);

#endif
