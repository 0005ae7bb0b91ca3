#include "numbers/processor.h"

static dm_processor_level limit = DM_AVX512;

void dm_processor_limit(dm_processor_level level) {
    limit = level;
}

#if defined(__x86_64__)

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
