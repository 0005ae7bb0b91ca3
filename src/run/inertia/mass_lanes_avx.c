/* mass_lanes_avx.c - pivots and quiet looks, four side by side, for processors with AVX. */
#include "run/inertia/mass_lanes.h"

#ifdef __x86_64__
#define W 4
#define HOW __attribute__((target("avx")))
#define DM_LANES_FUSED 0
#include "run/inertia/mass_lanes_text.h"

HOW uint32_t dm_mass_pivots_avx(const dm_mass_lanes *w, const double *scale, double far,
                                uint32_t asked) {
    return find_pivots_of_mass(w, scale, far, asked);
}

HOW uint32_t dm_mass_quiet_avx(const dm_mass_lanes *w, dm_inertia_seen *seen,
                               const dm_mass_found *f, long done, uint32_t asked) {
    return look_quietly(w, seen, f, done, asked);
}
#endif
