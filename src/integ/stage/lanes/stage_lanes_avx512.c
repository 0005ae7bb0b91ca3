/* stage_lanes_avx512.c - steps of eight members side by side for processors with AVX-512. */
#include "integ/stage/lanes/stage_lanes.h"

#ifdef __x86_64__
#define W 8
#define HOW __attribute__((target("avx512f,avx512dq,fma")))
#define DM_LANES_FUSED 1
#include "integ/stage/lanes/stage_lanes_newton.h"
#include "integ/stage/lanes/stage_lanes_one_point.h"
#include "integ/stage/lanes/stage_lanes_sweep.h"

HOW uint32_t dm_stage_sweep_avx512(const dm_stage_lanes *w, uint32_t asked) {
    return step_by_sweeps(w, asked);
}

HOW uint32_t dm_stage_newton_avx512(const dm_stage_lanes *w, uint32_t asked) {
    return step_by_newton(w, asked);
}

HOW uint32_t dm_one_point_avx512(const dm_stage_lanes *w, uint32_t asked) {
    return step_by_one_point(w, asked);
}
#endif
