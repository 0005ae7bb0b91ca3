/* stage_lanes_fma.c - steps of four members side by side for processors with fused multiply-add. */
#include "integ/stage_lanes.h"

#ifdef __x86_64__
#define W 4
#define HOW __attribute__((target("avx,fma")))
#define DM_LANES_FUSED
#include "integ/stage_lanes_newton.h"
#include "integ/stage_lanes_sweep.h"

HOW uint32_t dm_stage_sweep_fma(const dm_stage_lanes *w, uint32_t asked) {
    return step_by_sweeps(w, asked, 0);
}

HOW uint32_t dm_stage_sweep_fma_fused(const dm_stage_lanes *w, uint32_t asked) {
    return step_by_sweeps(w, asked, 1);
}

HOW uint32_t dm_stage_newton_fma(const dm_stage_lanes *w, uint32_t asked) {
    return step_by_newton(w, asked);
}
#endif
