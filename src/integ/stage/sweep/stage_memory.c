/* stage_memory.c - what a step by sweeps leaves to the next one, see stage_sweep.h.
 * Speed: steps, J2 satellite by gauss(3): 3.1x, against Newton's method; 6.6x by gauss(6). */
#include "integ/stage/sweep/stage_sweep.h"

#include <string.h>

enum {
    EMPTY,
    FULL = DM_SWEPT_FULL,
    PATIENCE = 16
}; /* marks; steps before sweeps are tried again */

static size_t unknowns(const dm_stage *g) {
    return (size_t)g->n * g->sweeps->row->width;
}

static const double USUAL = 0.01; /* contraction, squared, where none was measured */

size_t dm_stage_memory_u(const dm_stage *g) {
    return DM_SWEPT_END + 4 * (size_t)g->n;
}

size_t dm_stage_memory_size(const dm_stage *g) {
    return dm_stage_memory_u(g) + unknowns(g) + dm_stage_kept_size(g);
}

void dm_stage_memory_clear(dm_stage *g, double h) {
    double *memory = g->sweeps->memory;
    memset(memory, 0, dm_stage_memory_size(g) * sizeof *memory);
    memory[DM_SWEPT_STEP] = h;
}

int dm_stage_memory_fits(const dm_stage *g) {
    const double *memory = g->sweeps->memory;
    return memory[DM_SWEPT_STEP] == g->weights.h && memory[DM_SWEPT_MARK] == FULL &&
           memcmp(memory + DM_SWEPT_END, g->group.state, 4 * (size_t)g->n * sizeof *memory) == 0;
}

int dm_stage_memory_is_stiff(const dm_stage *g) {
    const double *memory = g->sweeps->memory;
    return memory[DM_SWEPT_STEP] == g->weights.h && memory[DM_SWEPT_MARK] < EMPTY;
}

static void keep(dm_stage *g, double rate, const double *u) {
    double *memory = g->sweeps->memory;
    memory[DM_SWEPT_MARK] = FULL;
    memory[DM_SWEPT_RATE] = rate;
    memcpy(memory + DM_SWEPT_END + 4 * (size_t)g->n, u, unknowns(g) * sizeof *memory);
}

void dm_stage_memory_keep(dm_stage *g, double rate) {
    if (g->sweeps->memory[DM_SWEPT_STEP] != g->weights.h) return;
    keep(g, rate, dm_stage_sweeps_u(g));
    g->sweeps->row->copy(g->sweeps->memory + DM_SWEPT_END, g->group.state, g->n);
}

/* u of the stages as Newton's method found them */
static void take_root(const dm_stage *g, double *u) {
    const uint32_t n = g->n, width = g->sweeps->row->width;
    const double *push = g->m->structure & DM_DIAGONAL_MASS ? g->newton.slopes : g->points.u;
    const double *found = g->separable ? push : g->newton.root;
    for (uint32_t m = 0; m < g->table.r; m++)
        for (uint32_t k = 0; k < n; k++) u[k * width + m] = found[m * (size_t)n + k];
}

/* sweeps that failed from a straight line may do from the polynomial of this step; from there,
 * not soon again */
void dm_stage_memory_newton(dm_stage *g) {
    double *memory = g->sweeps->memory;
    if (memory[DM_SWEPT_STEP] != g->weights.h) return;
    const int linear = g->newton.linear != 0; /* how sweeps contract is a matter of h alone */
    if (!linear && memory[DM_SWEPT_MARK] < EMPTY) {
        memory[DM_SWEPT_MARK] += 1;
    } else if (linear || memory[DM_SWEPT_MARK] == FULL) {
        memory[DM_SWEPT_MARK] = -PATIENCE;
    } else {
        take_root(g, g->sweeps->u);
        keep(g, USUAL, g->sweeps->u);
        dm_stage_copy(memory + DM_SWEPT_END, g->group.next, 4 * g->n);
    }
}
