/* kernel.c - what every backend tells of its kernels in the same way. */
#include "code/kernel.h"

int dm_kernel_report_fixed(dm_kernel *k, const dm_graph *g, const dm_node *roots, dm_arena *arena) {
    uint8_t *fixed = dm_arena_take(arena, k->outputs);
    double *constant = dm_arena_take(arena, k->outputs * sizeof *constant);
    if (!fixed || !constant) return 0;
    for (uint32_t i = 0; i < k->outputs; i++) {
        constant[i] = 0.0;
        fixed[i] = (uint8_t)dm_is_constant(g, roots[i], constant + i);
    }
    k->fixed = fixed;
    k->constant = constant;
    return 1;
}
