/*
** stage_warm.c - what a step of the general form by Newton's method leaves to the next one: h, how many steps are
** there, the state at the end of the last [4n], velocities of the stages, the last first. They are continued: one
** stage by the parabola through three steps, several by their own polynomial (HLW VIII.6.1). Another h neither uses
** nor changes them.
*/
#include "integ/stage_inside.h"

enum { STEP, COUNT, END };
enum {
    OF_ONE = 3,
    STAGES = 8
}; /* steps kept of one stage; stages whose polynomial may be continued */

static size_t steps(const dm_stage *g) {
    return g->table.s == 1 ? OF_ONE : 1;
}

size_t dm_stage_warm_size(size_t s, uint32_t n) {
    if (s > STAGES) return 0;
    return END + 4 * (size_t)n + (s == 1 ? OF_ONE : 1) * s * n + s * s;
}

size_t dm_stage_warm_memory(const dm_stage *g) {
    return END + 4 * (size_t)g->n + steps(g) * g->table.s * g->n;
}

void dm_stage_warm_open(dm_stage *g, const dm_galerkin *basis, double *memory) {
    const int s = basis->s;
    if (s > STAGES) return;
    g->warm = memory;
    g->ahead = memory + dm_stage_warm_memory(g);
    for (int i = 0; i < s && s > 1; i++) {
        long double value[STAGES];
        dm_lagrange_value(value, basis->node, s, 1.0L + basis->node[i]);
        for (int j = 0; j < s; j++) g->ahead[i * s + j] = (double)value[j];
    }
    memset(g->warm, 0, dm_stage_warm_memory(g) * sizeof *g->warm);
}

void dm_stage_warm_clear(dm_stage *g, double h) {
    memset(g->warm, 0, dm_stage_warm_memory(g) * sizeof *g->warm);
    g->warm[STEP] = h;
}

/* by the parabola, the line or the value of the last steps */
static void continue_one(dm_stage *g, const double *V) {
    static const double weight[OF_ONE][OF_ONE] = {{1, 0, 0}, {2, -1, 0}, {3, -3, 1}};
    const uint32_t n = g->n;
    const double *w = weight[(int)g->warm[COUNT] - 1];
    for (uint32_t k = 0; k < n; k++)
        g->root[k] = w[0] * V[k] + (w[1] * V[n + k] + w[2] * V[2 * n + k]);
}

static void continue_many(dm_stage *g, const double *V) {
    const uint32_t n = g->n, s = g->table.s;
    memset(g->root, 0, (size_t)s * n * sizeof *g->root);
    for (uint32_t i = 0; i < s; i++)
        for (uint32_t j = 0; j < s; j++)
            for (uint32_t k = 0; k < n; k++)
                g->root[i * (size_t)n + k] += g->ahead[i * s + j] * V[j * (size_t)n + k];
}

int dm_stage_warm_guess(dm_stage *g) {
    const double *memory = g->warm, *end = memory + END;
    if (memory[STEP] != g->h || memory[COUNT] == 0.0) return 0;
    for (uint32_t k = 0; k < 4 * g->n; k++)
        if (end[k] != g->state[k]) return 0;
    if (g->table.s == 1)
        continue_one(g, end + 4 * g->n);
    else
        continue_many(g, end + 4 * g->n);
    return 1;
}

void dm_stage_warm_keep(dm_stage *g) {
    const size_t size = g->table.s * (size_t)g->n, most = steps(g);
    if (g->warm[STEP] != g->h) return;
    double *end = g->warm + END, *V = end + 4 * g->n;
    const int follows = memcmp(end, g->state, 4 * g->n * sizeof *end) == 0;
    const double count = follows ? g->warm[COUNT] + 1.0 : 1.0;
    g->warm[COUNT] = count < (double)most ? count : (double)most;
    memmove(V + size, V, (most - 1) * size * sizeof *V);
    memcpy(V, g->root, size * sizeof *V);
    dm_stage_copy(end, g->next, 4 * g->n);
}
