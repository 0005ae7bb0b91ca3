/* lie_lanes_avx512.c - steps of eight members side by side for processors with AVX-512. */
#include "integ/lie/lie_lanes.h"

#ifdef __x86_64__
#define W 8
#define HOW __attribute__((target("avx512f,avx512dq")))
#define DM_LANES_FUSED 0
#include "integ/lie/lie_lanes_step.h"

HOW uint32_t dm_lie_step_avx512(const dm_lie_lanes *w, uint32_t asked) {
    return step_in_lanes(w, asked);
}
#endif
