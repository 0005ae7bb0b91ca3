/*
** stage_memory.c - what a step by sweeps leaves to the next one: h, a mark, contraction, the state at its end [4n], u[n][width].
** Another h (a step to a time between, a part of a composition) neither uses it nor changes it.
*/
#include "integ/stage_inside.h"

#include <string.h>

enum {
    EMPTY,
    FULL = DM_SWEPT_FULL,
    PATIENCE = 16
}; /* a mark below zero: steps by Newton's method before sweeps are tried again */

static size_t unknowns(const dm_stage *g) {
    return (size_t)g->n * g->sweeps.row->width;
}

static const double USUAL = 0.01; /* contraction, squared, where none was measured */

size_t dm_stage_memory_size(const dm_stage *g) {
    const size_t differences = g->table.r == 1 ? 1 + DM_WARM_TERMS * (size_t)g->n : 0;
    return DM_SWEPT_END + 4 * (size_t)g->n + unknowns(g) + differences;
}

void dm_stage_memory_clear(dm_stage *g, double h) {
    double *memory = g->sweeps.memory;
    memset(memory, 0, dm_stage_memory_size(g) * sizeof *memory);
    memory[DM_SWEPT_STEP] = h;
}

int dm_stage_memory_fits(const dm_stage *g) {
    const double *memory = g->sweeps.memory;
    return memory[DM_SWEPT_STEP] == g->h && memory[DM_SWEPT_MARK] == FULL &&
           memcmp(memory + DM_SWEPT_END, g->state, 4 * (size_t)g->n * sizeof *memory) ==
               0;
}

int dm_stage_memory_is_stiff(const dm_stage *g) {
    const double *memory = g->sweeps.memory;
    return memory[DM_SWEPT_STEP] == g->h && memory[DM_SWEPT_MARK] < EMPTY;
}

const double *dm_stage_memory_end(const dm_stage *g) {
    return g->sweeps.memory + DM_SWEPT_END;
}

double dm_stage_memory_rate(const dm_stage *g) {
    return g->sweeps.memory[DM_SWEPT_RATE];
}

const double *dm_stage_memory_guess(dm_stage *g) {
    const uint32_t n = g->n;
    const double *u = g->sweeps.memory + DM_SWEPT_END + 4 * (size_t)n, *count = u + n;
    if (!dm_stage_continues_u(g)) return u;
    dm_stage_copy(g->before, u, n);
    dm_stage_warm_add(g->before, count + 1, (int)*count - 1, n);
    return g->before;
}

/* differences with the new u, before that takes the place of the old one; not continued: there are none yet */
static void keep_differences(dm_stage *g, const double *u, int continued) {
    const uint32_t n = g->n;
    const double *old = g->sweeps.memory + DM_SWEPT_END + 4 * (size_t)n;
    double *count = g->sweeps.memory + DM_SWEPT_END + 5 * (size_t)n;
    if (!continued) *count = 0.0;
    for (uint32_t k = 0; k < n && continued; k++) g->before[k] = u[k] - old[k];
    if (continued) dm_stage_warm_renew(count + 1, g->before, (int)*count, n);
    if (*count <= DM_WARM_TERMS) *count += 1.0;
}

static void keep(dm_stage *g, double rate, const double *u, int continued) {
    double *memory = g->sweeps.memory;
    memory[DM_SWEPT_MARK] = FULL;
    memory[DM_SWEPT_RATE] = rate;
    if (dm_stage_continues_u(g)) keep_differences(g, u, continued);
    memcpy(memory + DM_SWEPT_END + 4 * (size_t)g->n, u, unknowns(g) * sizeof *memory);
}

void dm_stage_memory_keep(dm_stage *g, double rate, int continued) {
    if (g->sweeps.memory[DM_SWEPT_STEP] != g->h) return;
    keep(g, rate, dm_stage_sweeps_u(g), continued);
    g->sweeps.row->copy(g->sweeps.memory + DM_SWEPT_END, g->state, g->n);
}

/* u of the stages as Newton's method found them */
static void take_root(const dm_stage *g, double *u) {
    const uint32_t n = g->n, width = g->sweeps.row->width;
    const double *push = g->m->structure & DM_DIAGONAL_MASS ? g->slope : g->push;
    const double *found = g->separable ? push : g->root;
    for (uint32_t m = 0; m < g->table.r; m++)
        for (uint32_t k = 0; k < n; k++) u[k * width + m] = found[m * (size_t)n + k];
}

/* sweeps that failed from a straight line may do from the polynomial of this step; from there, not soon again */
void dm_stage_memory_newton(dm_stage *g) {
    double *memory = g->sweeps.memory;
    if (memory[DM_SWEPT_STEP] != g->h) return;
    if (memory[DM_SWEPT_MARK] < EMPTY) {
        memory[DM_SWEPT_MARK] += 1;
    } else if (memory[DM_SWEPT_MARK] == FULL) {
        memory[DM_SWEPT_MARK] = -PATIENCE;
    } else {
        take_root(g, g->sweeps.u);
        keep(g, USUAL, g->sweeps.u, 0);
        dm_stage_copy(memory + DM_SWEPT_END, g->next, 4 * g->n);
    }
}
