#include "numbers/fma.h"

static int allowed = 1;

void dm_fma_allow(int fused) {
    allowed = fused;
}

#if defined(__x86_64__)

int dm_fma_is_fused(void) {
    return allowed && __builtin_cpu_supports("fma");
}

__attribute__((target("fma"))) static double fused(double a, double b, double c) {
    return __builtin_fma(a, b, c);
}

#else

#include <math.h>

int dm_fma_is_fused(void) {
    return allowed;
}

static double fused(double a, double b, double c) {
    return fma(a, b, c);
}

#endif

double dm_fma(double a, double b, double c) {
    return dm_fma_is_fused() ? fused(a, b, c) : a * b + c;
}
