/* functions.h - elementary functions with the same bits in every backend and width, on one
 * processor level (processor.h). With fused multiply-add they are our own (functions_text.h),
 * else the C library's; angles beyond 2^30, asin, acos, atan, atan2 and pow are the C library's
 * everywhere. The sign of a zero is not kept. */
#ifndef DM_FUNCTIONS_H
#define DM_FUNCTIONS_H

#include <stdint.h>

/* x^(-1/2) and x^(-3/2), below 0.6 ulp with AVX-512: y = a table look-up to 14 bits, e = 1 - x
 * y^2 without an error of rounding, then y (1 - e)^(-1/2) and y^3 (1 - e)^(-3/2) by series, |e|
 * < 2^-13; y has 17 bits, so y^3 is exact. Elsewhere root and division. */
double dm_rsqrt(double x);
double dm_rsqrt3(double x);

/* ((1 - e)^(-1/2) - 1) / e = 1/2 + 3/8 e + 5/16 e^2; the next term, 35/128 e^3, is taken in by
 * 3/8 to a quarter (Chebyshev). Then those of the cube, to one term more. */
#define DM_ROOT_SERIES                                                                             \
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

/* 2^(j/16), j = 0 .. 7 and 8 .. 15, and what rounding left of them */
#define EXP_POWERS                                                                                 \
    0x1.0000000000000p+0, 0x1.0b5586cf9890fp+0, 0x1.172b83c7d517bp+0, 0x1.2387a6e756238p+0,        \
        0x1.306fe0a31b715p+0, 0x1.3dea64c123422p+0, 0x1.4bfdad5362a27p+0, 0x1.5ab07dd485429p+0
#define EXP_LATER_POWERS                                                                           \
    0x1.6a09e667f3bcdp+0, 0x1.7a11473eb0187p+0, 0x1.8ace5422aa0dbp+0, 0x1.9c49182a3f090p+0,        \
        0x1.ae89f995ad3adp+0, 0x1.c199bdd85529cp+0, 0x1.d5818dcfba487p+0, 0x1.ea4afa2a490dap+0
#define EXP_LOWS                                                                                   \
    0.0, 0x1.8a62e4adc610bp-54, -0x1.19041b9d78a76p-55, 0x1.9b07eb6c70573p-54,                     \
        0x1.6f46ad23182e4p-55, 0x1.ada0911f09ebcp-55, 0x1.d4397afec42e2p-56, 0x1.6324c054647adp-54
#define EXP_LATER_LOWS                                                                             \
    -0x1.bdd3413b26456p-54, -0x1.41577ee04992fp-55, 0x1.6e9f156864b27p-54, 0x1.c7c46b071f2bep-56,  \
        0x1.7a1cd345dcc81p-54, 0x1.11065895048ddp-55, 0x1.2ed02d75b3707p-55,                       \
        -0x1.e9c23179c2893p-54
extern const double dm_exp_powers[2][16];

/* e^r = 1 + r + r^2 p(r) for |r| < log(2)/32, p = c0 + c1 r + ... (Remez) */
#define EXP_0 0x1.fffffffffffb9p-2
#define EXP_1 0x1.555555548f894p-3
#define EXP_2 0x1.55555558fcc8bp-5
#define EXP_3 0x1.11123aae47b53p-7
#define EXP_4 0x1.6c14c6c99aa87p-10

/* Returns the sine; the bits of dm_sin and dm_cos. */
double dm_sincos(double x, double *cosine);

/* What a table has of every elementary function; POW and ATAN2 have two arguments, SINCOS gives
 * sine and cosine. */
typedef enum {
    DM_FUNCTION_NONE,
    DM_FUNCTION_SINCOS,
    DM_FUNCTION_EXP,
    DM_FUNCTION_LOG,
    DM_FUNCTION_SIN,
    DM_FUNCTION_COS,
    DM_FUNCTION_TAN,
    DM_FUNCTION_ASIN,
    DM_FUNCTION_ACOS,
    DM_FUNCTION_ATAN,
    DM_FUNCTION_SINH,
    DM_FUNCTION_COSH,
    DM_FUNCTION_TANH,
    DM_FUNCTION_POW,
    DM_FUNCTION_ATAN2,
    DM_FUNCTION_COUNT
} dm_function_name;

typedef void dm_function(void); /* of one of the types below */

/* What machine code calls, by the present level; NULL for NONE. For one lane double f(double),
 * double f(double, double) and, for sincos, double f(double, double *cosine). For 4 or 8 lanes
 * void f(double *d, double *d2, const double *a, const double *b), sincos: sine, cosine, angle. */
dm_function *dm_function_for(dm_function_name name, uint32_t lanes);

/* The same for one width. Our own, NULL where there is none; the C library's, called once per
 * lane. */
dm_function *dm_own_function1(dm_function_name name);
dm_function *dm_own_function4(dm_function_name name);
dm_function *dm_own_function8(dm_function_name name);
dm_function *dm_library_function1(dm_function_name name);
dm_function *dm_library_function4(dm_function_name name);
dm_function *dm_library_function8(dm_function_name name);

#endif
