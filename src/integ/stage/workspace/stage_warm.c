/* stage_warm.c - the memory of stage_warm.h, and the continuation of velocities by one step. */
#include "integ/stage/workspace/stage_warm.h"

#include <string.h>

enum { STAGES = 8 }; /* whose polynomial may be continued */

size_t dm_stage_warm_size(size_t s, uint32_t n) {
    if (s > STAGES) return 0;
    return DM_WARM_END + 4 * (size_t)n + (1 + DM_WARM_TERMS) * s * n + s * s;
}

size_t dm_stage_warm_memory(const dm_stage *g) {
    return DM_WARM_END + 4 * (size_t)g->n + (1 + DM_WARM_TERMS) * g->table.s * g->n;
}

/* row i of `ahead`: the polynomial through the velocities of a step at node i of the next one */
void dm_stage_warm_open(dm_stage *g, const dm_galerkin *basis, double *memory) {
    const int s = basis->s;
    if (s > STAGES) return;
    g->group.memory = memory;
    g->ahead = memory + dm_stage_warm_memory(g);
    for (int i = 0; i < s; i++) {
        long double value[STAGES];
        dm_lagrange_value(value, basis->node, s, 1.0L + basis->node[i]);
        for (int j = 0; j < s; j++) g->ahead[i * s + j] = (double)value[j];
    }
    dm_stage_warm_clear(g, 0.0);
}

/* count 0: nothing else in the memory is read until a step of this h has ended */
void dm_stage_warm_clear(dm_stage *g, double h) {
    memset(g->group.memory, 0, dm_stage_warm_memory(g) * sizeof *g->group.memory);
    g->group.memory[DM_WARM_STEP] = h;
}
