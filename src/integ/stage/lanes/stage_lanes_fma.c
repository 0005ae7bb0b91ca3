/* stage_lanes_fma.c - sweeps of four members side by side, with fused products. */
#include "integ/stage/lanes/stage_lanes.h"

#ifdef __x86_64__
#define W 4
#define HOW __attribute__((target("avx,fma")))
#define DM_LANES_FUSED 1
#include "integ/stage/lanes/stage_lanes_sweep.h"

HOW uint32_t dm_stage_sweep_fma(const dm_stage_lanes *w, uint32_t asked) {
    return step_by_sweeps(w, asked);
}
#endif
