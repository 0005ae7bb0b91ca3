/* functions_library.c - the C library's functions, lane by lane, as machine code calls them:
 * for processors without fused multiply-add, and for the functions that we do not have. Results
 * of several lanes go to memory, since how vectors travel in registers depends on the compiler. */
#define _GNU_SOURCE /* sincos */
#include "numbers/functions.h"

#include <math.h>

/* functions of one argument: name in the table, name in the library */
#define CALLS(X)                                                                                   \
    X(EXP, exp)                                                                                    \
    X(LOG, log)                                                                                    \
    X(SIN, sin)                                                                                    \
    X(COS, cos)                                                                                    \
    X(TAN, tan)                                                                                    \
    X(ASIN, asin)                                                                                  \
    X(ACOS, acos) X(ATAN, atan) X(SINH, sinh) X(COSH, cosh) X(TANH, tanh)

/* both, as machine code for one lane wants them */
static double sine_and_cosine(double x, double *cosine) {
    double sine;
    sincos(x, &sine, cosine);
    return sine;
}

/* the function itself */
dm_function *dm_library_function1(dm_function_name name) {
#define X(which, f) [DM_FUNCTION_##which] = (dm_function *)f,
    static dm_function *const table[DM_FUNCTION_COUNT] = {[DM_FUNCTION_SINCOS] =
                                                              (dm_function *)sine_and_cosine,
                                                          [DM_FUNCTION_POW] = (dm_function *)pow,
                                                          [DM_FUNCTION_ATAN2] =
                                                              (dm_function *)atan2,
                                                          CALLS(X)};
#undef X
    return table[name];
}

/* the same for n lanes; a macro for each kind of arguments */
#define ONE(n, f)                                                                                  \
    static void f##_in_##n(double *d, double *d2, const double *a, const double *b) {              \
        (void)d2, (void)b;                                                                         \
        for (int i = 0; i < n; i++) d[i] = f(a[i]);                                                \
    }
#define TWO(n, f)                                                                                  \
    static void f##_in_##n(double *d, double *d2, const double *a, const double *b) {              \
        (void)d2;                                                                                  \
        for (int i = 0; i < n; i++) d[i] = f(a[i], b[i]);                                          \
    }
#define BOTH(n)                                                                                    \
    static void sincos_in_##n(double *s, double *c, const double *a, const double *b) {            \
        (void)b;                                                                                   \
        for (int i = 0; i < n; i++) sincos(a[i], s + i, c + i);                                    \
    }
#define X(name, f) ONE(4, f) ONE(8, f)
CALLS(X)
#undef X
TWO(4, pow)
TWO(8, pow)
TWO(4, atan2)
TWO(8, atan2)
BOTH(4)
BOTH(8)

/* of 4 lanes, then of 8 */
dm_function *dm_library_function4(dm_function_name name) {
#define X(which, f) [DM_FUNCTION_##which] = (dm_function *)f##_in_4,
    static dm_function *const table[DM_FUNCTION_COUNT] = {[DM_FUNCTION_SINCOS] =
                                                              (dm_function *)sincos_in_4,
                                                          [DM_FUNCTION_POW] =
                                                              (dm_function *)pow_in_4,
                                                          [DM_FUNCTION_ATAN2] =
                                                              (dm_function *)atan2_in_4,
                                                          CALLS(X)};
#undef X
    return table[name];
}

dm_function *dm_library_function8(dm_function_name name) {
#define X(which, f) [DM_FUNCTION_##which] = (dm_function *)f##_in_8,
    static dm_function *const table[DM_FUNCTION_COUNT] = {[DM_FUNCTION_SINCOS] =
                                                              (dm_function *)sincos_in_8,
                                                          [DM_FUNCTION_POW] =
                                                              (dm_function *)pow_in_8,
                                                          [DM_FUNCTION_ATAN2] =
                                                              (dm_function *)atan2_in_8,
                                                          CALLS(X)};
#undef X
    return table[name];
}
