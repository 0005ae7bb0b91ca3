/* fma.c - one meaning of a b + c for the whole process: what the tape computes here, native
 * code does by an instruction where dm_fma_is_fused says so, and by two elsewhere. */
#include "numbers/fma.h"

/* as tests have set it; the processor is asked besides */
static int allowed = 1;

void dm_fma_allow(int fused) {
    allowed = fused;
}

#if defined(__x86_64__)

/* asked of the processor every time: the answer is in a table of the compiler's library */
int dm_fma_is_fused(void) {
    return allowed && __builtin_cpu_supports("fma");
}

/* one instruction, whatever the rest of the program was compiled for */
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

/* rounded once or twice, by the level of this process */
double dm_fma(double a, double b, double c) {
    return dm_fma_is_fused() ? fused(a, b, c) : a * b + c;
}
