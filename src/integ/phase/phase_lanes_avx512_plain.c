/* phase_lanes_avx512_plain.c - sweeps of H for eight members side by side as on a lesser
 * processor: products are rounded. */
#include "integ/phase/phase_lanes.h"

#ifdef __x86_64__
#define W 8
#define HOW __attribute__((target("avx512f,avx512dq")))
#define DM_LANES_FUSED 0
#include "integ/phase/phase_lanes_step.h"

HOW uint32_t dm_phase_step_avx512_plain(const dm_phase_lanes *w, uint32_t asked) {
    return step_members(w, asked);
}
#endif
