/* constrained_memory.c - what a step leaves to the next one: h, a mark, the volumes of its rows
 * (constrained_rank.c), the state at its end [4n], the root, v1 and the impulses of the end. But
 * for the volumes another h (a step to a time between, a part of a composition) neither uses nor
 * changes it. */
#include "integ/constrained/constrained_inside.h"

#include <string.h>

enum { STEP, MARK, END = DM_CONSTRAINED_VOLUMES + DM_CROSSING_WATCHED };

/* Behind the state at the end: V, impulses, then v1 and the impulses of the end. */
static double *kept_root(const dm_constrained *g) {
    return g->memory + END + 4 * (size_t)g->n;
}

size_t dm_constrained_memory_size(uint32_t n, uint32_t unknowns, uint32_t m) {
    return END + 4 * (size_t)n + unknowns + n + m;
}

/* Nothing is there; a step of h may leave something. */
void dm_constrained_memory_clear(dm_constrained *g, double h) {
    const size_t size = dm_constrained_memory_size(g->n, dm_constrained_unknowns(g), g->k + g->l);
    memset(g->memory, 0, size * sizeof *g->memory);
    g->memory[STEP] = h;
}

/* It was left by the step that ended here, bit for bit, and was as long. */
int dm_constrained_memory_fits(const dm_constrained *g) {
    return g->memory[STEP] == g->h && g->memory[MARK] != 0.0 &&
           memcmp(g->memory + END, g->state, 4 * (size_t)g->n * sizeof *g->state) == 0;
}

const double *dm_constrained_memory_velocity(const dm_constrained *g) {
    return kept_root(g) + dm_constrained_unknowns(g);
}

/* After a step of the length that is remembered; others leave it alone. */
void dm_constrained_memory_keep(dm_constrained *g) {
    const size_t N = dm_constrained_unknowns(g), ends = g->n + g->k + g->l;
    if (g->memory[STEP] != g->h) return;
    g->memory[MARK] = 1.0;
    memcpy(g->memory + END, g->next, 4 * (size_t)g->n * sizeof *g->memory);
    memcpy(kept_root(g), g->root, N * sizeof *g->memory);
    memcpy(kept_root(g) + N, g->end, ends * sizeof *g->memory);
}

/* V_j = sum_m row_jm V_m + row_js v0 */
static void extrapolate(dm_constrained *g, const double *rows, const double *V) {
    const uint32_t n = g->n, s = g->table.s;
    for (uint32_t j = 0; j < s; j++, rows += s + 1)
        for (uint32_t i = 0; i < n; i++) {
            double sum = rows[s] * g->v0[i];
            for (uint32_t m = 0; m < s; m++) sum += rows[m] * V[m * (size_t)n + i];
            g->root[j * (size_t)n + i] = sum;
        }
}

/* Uniform motion without impulses. */
void dm_constrained_plain_guess(dm_constrained *g) {
    const size_t V = (size_t)g->table.s * g->n;
    memset(g->root, 0, dm_constrained_unknowns(g) * sizeof *g->root);
    memset(g->end + g->n, 0, (g->k + g->l) * sizeof *g->end);
    for (size_t i = 0; i < V; i++) g->root[i] = g->v0[i % g->n];
}

/* V are those of half a step: the polynomial through them goes on to the whole one. */
void dm_constrained_longer_guess(dm_constrained *g, const double *V) {
    extrapolate(g, g->longer, V);
}

int dm_constrained_guess(dm_constrained *g) {
    const size_t V = (size_t)g->table.s * g->n, N = dm_constrained_unknowns(g);
    const double *kept = kept_root(g);
    if (!g->goes_on) {
        dm_constrained_plain_guess(g);
        return 0;
    }
    extrapolate(g, g->ahead, kept);
    memcpy(g->root + V, kept + V, (N - V) * sizeof *kept);
    memcpy(g->end + g->n, kept + N + g->n, (g->k + g->l) * sizeof *kept);
    return 1;
}
