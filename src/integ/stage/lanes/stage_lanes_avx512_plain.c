/* stage_lanes_avx512_plain.c - sweeps of eight members side by side as on a lesser processor:
 * products are rounded. */
#include "integ/stage/lanes/stage_lanes.h"

#ifdef __x86_64__
#define W 8
#define HOW __attribute__((target("avx512f,avx512dq")))
#define DM_LANES_FUSED 0
#include "integ/stage/lanes/stage_lanes_sweep.h"

HOW uint32_t dm_stage_sweep_avx512_plain(const dm_stage_lanes *w, uint32_t asked) {
    return step_by_sweeps(w, asked);
}
#endif
