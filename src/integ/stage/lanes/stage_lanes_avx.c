/* stage_lanes_avx.c - steps of four members side by side for processors with AVX. */
#include "integ/stage/lanes/stage_lanes.h"

#ifdef __x86_64__
#define W 4
#define HOW __attribute__((target("avx")))
#define DM_LANES_FUSED 0
#include "integ/stage/lanes/stage_lanes_newton.h"
#include "integ/stage/lanes/stage_lanes_one_point.h"
#include "integ/stage/lanes/stage_lanes_sweep.h"

HOW uint32_t dm_stage_sweep_avx(const dm_stage_lanes *w, uint32_t asked) {
    return step_by_sweeps(w, asked);
}

HOW uint32_t dm_stage_newton_avx(const dm_stage_lanes *w, uint32_t asked) {
    return step_by_newton(w, asked);
}

HOW uint32_t dm_one_point_avx(const dm_stage_lanes *w, uint32_t asked) {
    return step_by_one_point(w, asked);
}
#endif
