/* processor.c - the level of the processor, which results depend on: asked of the machine,
 * lowered on request. */
#include "numbers/processor.h"

/* by dm_processor_limit */
static dm_processor_level limit = DM_AVX512;

void dm_processor_limit(dm_processor_level level) {
    limit = level;
}

#if defined(__x86_64__)

/* what is there; AVX-512 counts with the parts F, DQ and VL that kernels use */
static dm_processor_level own(void) {
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return DM_PLAIN;
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                   __builtin_cpu_supports("avx512vl")
               ? DM_AVX512
               : DM_FMA;
}

#else

static dm_processor_level own(void) {
    return DM_PLAIN;
}

#endif

dm_processor_level dm_processor(void) {
    const dm_processor_level here = own();
    return here < limit ? here : limit;
}
