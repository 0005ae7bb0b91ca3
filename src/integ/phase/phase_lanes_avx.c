/* phase_lanes_avx.c - sweeps of H for four members side by side, with AVX. */
#include "integ/phase/phase_lanes.h"

#ifdef __x86_64__
#define W 4
#define HOW __attribute__((target("avx")))
#define DM_LANES_FUSED 0
#include "integ/phase/phase_lanes_step.h"

HOW uint32_t dm_phase_step_avx(const dm_phase_lanes *w, uint32_t asked) {
    return step_members(w, asked);
}
#endif
