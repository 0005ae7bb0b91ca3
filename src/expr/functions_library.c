/* the C library's functions, lane by lane, as machine code calls them */
#define _GNU_SOURCE /* sincos */
#include "expr/functions.h"

#include <math.h>

#define CALLS(X)                                                                         \
    X(EXP, exp)                                                                          \
    X(LOG, log)                                                                          \
    X(SIN, sin)                                                                          \
    X(COS, cos)                                                                          \
    X(TAN, tan)                                                                          \
    X(ASIN, asin)                                                                        \
    X(ACOS, acos) X(ATAN, atan) X(SINH, sinh) X(COSH, cosh) X(TANH, tanh)

static double sine_and_cosine(double x, double *cosine) {
    double sine;
    sincos(x, &sine, cosine);
    return sine;
}

dm_function *dm_library_function1(int op) {
#define X(name, f) [DM_OP_##name] = (dm_function *)f,
    static dm_function *const table[DM_OP_COUNT] = {[DM_OP_CONSTANT] =
                                                        (dm_function *)sine_and_cosine,
                                                    [DM_OP_POW] = (dm_function *)pow,
                                                    [DM_OP_ATAN2] = (dm_function *)atan2,
                                                    CALLS(X)};
#undef X
    return table[op];
}

#if defined(__x86_64__)

typedef double real4 __attribute__((vector_size(32)));
typedef double real8 __attribute__((vector_size(64)));

#define ONE(real, n, isa, f)                                                             \
    __attribute__((target(isa))) static real f##_in_##n(real x) {                        \
        for (int i = 0; i < n; i++) x[i] = f(x[i]);                                      \
        return x;                                                                        \
    }
#define TWO(real, n, isa, f)                                                             \
    __attribute__((target(isa))) static real f##_in_##n(real x, real y) {                \
        for (int i = 0; i < n; i++) x[i] = f(x[i], y[i]);                                \
        return x;                                                                        \
    }
#define BOTH(real, n, isa)                                                               \
    __attribute__((target(isa))) static real sincos_in_##n(real x, real *cosine) {       \
        double s[n], c[n];                                                               \
        for (int i = 0; i < n; i++) s[i] = sine_and_cosine(x[i], c + i);                 \
        for (int i = 0; i < n; i++) x[i] = s[i], (*cosine)[i] = c[i];                    \
        return x;                                                                        \
    }
#define X(name, f) ONE(real4, 4, "avx", f) ONE(real8, 8, "avx512f", f)
CALLS(X)
#undef X
TWO(real4, 4, "avx", pow)
TWO(real8, 8, "avx512f", pow)
TWO(real4, 4, "avx", atan2)
TWO(real8, 8, "avx512f", atan2)
BOTH(real4, 4, "avx")
BOTH(real8, 8, "avx512f")

dm_function *dm_library_function4(int op) {
#define X(name, f) [DM_OP_##name] = (dm_function *)f##_in_4,
    static dm_function *const table[DM_OP_COUNT] = {
        [DM_OP_CONSTANT] = (dm_function *)sincos_in_4,
        [DM_OP_POW] = (dm_function *)pow_in_4,
        [DM_OP_ATAN2] = (dm_function *)atan2_in_4,
        CALLS(X)};
#undef X
    return table[op];
}

dm_function *dm_library_function8(int op) {
#define X(name, f) [DM_OP_##name] = (dm_function *)f##_in_8,
    static dm_function *const table[DM_OP_COUNT] = {
        [DM_OP_CONSTANT] = (dm_function *)sincos_in_8,
        [DM_OP_POW] = (dm_function *)pow_in_8,
        [DM_OP_ATAN2] = (dm_function *)atan2_in_8,
        CALLS(X)};
#undef X
    return table[op];
}

#else

dm_function *dm_library_function4(int op) {
    (void)op;
    return 0;
}

dm_function *dm_library_function8(int op) {
    (void)op;
    return 0;
}

#endif
