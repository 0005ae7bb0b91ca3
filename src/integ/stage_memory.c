/*
** stage_memory.c - what a step by sweeps leaves to the next one: h, a mark, contraction, the state at its end [4n], u[rows][width].
** Another h (a step to a time between, a part of a composition) neither uses it nor changes it.
*/
#include "integ/stage_inside.h"

#include <string.h>

enum { STEP, MARK, RATE, END };
enum {
    EMPTY,
    FULL,
    PATIENCE = 16
}; /* a mark below zero: steps by Newton's method before sweeps are tried again */

static size_t unknowns(const dm_stage *g) {
    return (size_t)g->sweeps.rows * g->sweeps.row->width;
}

size_t dm_stage_memory_size(const dm_stage *g) {
    return END + 4 * (size_t)g->n + unknowns(g);
}

void dm_stage_memory_clear(dm_stage *g, double h) {
    double *memory = g->sweeps.memory;
    memset(memory, 0, dm_stage_memory_size(g) * sizeof *memory);
    memory[STEP] = h;
}

int dm_stage_memory_fits(const dm_stage *g) {
    const double *memory = g->sweeps.memory;
    return memory[STEP] == g->h && memory[MARK] == FULL &&
           memcmp(memory + END, g->state, 4 * (size_t)g->n * sizeof *memory) == 0;
}

int dm_stage_memory_is_stiff(const dm_stage *g) {
    const double *memory = g->sweeps.memory;
    return memory[STEP] == g->h && memory[MARK] < EMPTY;
}

double dm_stage_memory_rate(const dm_stage *g) {
    return g->sweeps.memory[RATE];
}

void dm_stage_memory_keep(dm_stage *g, double rate) {
    double *memory = g->sweeps.memory;
    const size_t n = g->n;
    if (memory[STEP] != g->h) return;
    memory[MARK] = FULL;
    memory[RATE] = rate;
    memcpy(memory + END, g->next, 4 * n * sizeof *memory);
    memcpy(memory + END + 4 * n, g->sweeps.u, unknowns(g) * sizeof *memory);
}

void dm_stage_memory_newton(dm_stage *g) {
    double *memory = g->sweeps.memory;
    if (memory[STEP] != g->h) return;
    memory[MARK] = memory[MARK] < EMPTY ? memory[MARK] + 1 : -PATIENCE;
}
