/* stage_warm.c - what a step of the general form by Newton's method leaves to the next one: h,
 * how many steps are there, the state at the end of the last [4n], velocities of its stages, and
 * differences. Velocities are continued by their own polynomial (HLW VIII.6.1; of one stage: a
 * constant, and then at least the parabola). What that has missed so far is continued, too: with
 * D, D', D'' of the last steps the guess is the polynomial's + D + (D - D') + (D - 2 D' + D'') +
 * ..., as long as the differences get much smaller: on rough motion a guess further out than the
 * polynomial may lead to another root. Another h neither uses nor changes them. */
#include "base/largest.h"
#include "base/written_out.h"
#include "integ/stage/stage_inside.h"

#include <math.h>

enum { STAGES = 8 }; /* whose polynomial may be continued */

size_t dm_stage_warm_size(size_t s, uint32_t n) {
    if (s > STAGES) return 0;
    return DM_WARM_END + 4 * (size_t)n + (1 + DM_WARM_TERMS) * s * n + s * s;
}

size_t dm_stage_warm_memory(const dm_stage *g) {
    return DM_WARM_END + 4 * (size_t)g->n + (1 + DM_WARM_TERMS) * g->table.s * g->n;
}

void dm_stage_warm_open(dm_stage *g, const dm_galerkin *basis, double *memory) {
    const int s = basis->s;
    if (s > STAGES) return;
    g->warm = memory;
    g->ahead = memory + dm_stage_warm_memory(g);
    for (int i = 0; i < s; i++) {
        long double value[STAGES];
        dm_lagrange_value(value, basis->node, s, 1.0L + basis->node[i]);
        for (int j = 0; j < s; j++) g->ahead[i * s + j] = (double)value[j];
    }
    memset(g->warm, 0, dm_stage_warm_memory(g) * sizeof *g->warm);
}

void dm_stage_warm_clear(dm_stage *g, double h) {
    memset(g->warm, 0, dm_stage_warm_memory(g) * sizeof *g->warm);
    g->warm[DM_WARM_STEP] = h;
}

/* to[s][n] = V of the next step by the polynomial of the last one */
static void continue_polynomial(const dm_stage *g, double *to, const double *V) {
    const uint32_t n = g->n, s = g->table.s;
    if (s == 1) {
        dm_stage_copy(to, V, n);
        return;
    }
    memset(to, 0, (size_t)s * n * sizeof *to);
    for (uint32_t i = 0; i < s; i++)
        for (uint32_t j = 0; j < s; j++)
            for (uint32_t k = 0; k < n; k++)
                to[i * (size_t)n + k] += g->ahead[i * s + j] * V[j * (size_t)n + k];
}

/* to += D of differences [count][size]: so many in any case, then as long as adding one would
 * have brought the last step much nearer. What was missing then is the difference behind it */
DM_WRITTEN_OUT void add_missed(double *to, const double *D, int count, int at_least, size_t size) {
    double missing = count > 0 ? dm_largest_of(D, size) : 0.0;
    for (int i = 0; i < count; i++, D += size) {
        const double left = i + 1 < count ? dm_largest_of(D + size, size) : missing;
        if (i >= at_least && !(left <= DM_WARM_NEARER * missing)) return;
#pragma GCC unroll 4
        for (size_t k = 0; k < size; k++) to[k] += D[k];
        missing = left;
    }
}

/* the last step ended where this one begins */
DM_WRITTEN_OUT int continues(const double *end, const double *state, uint32_t n) {
    int differs = 0;
#pragma GCC unroll 16
    for (uint32_t k = 0; k < 4 * n; k++) differs |= end[k] != state[k];
    return !differs;
}

DM_WRITTEN_OUT int guess(dm_stage *g, uint32_t s, uint32_t n) {
    const double *memory = g->warm, *end = memory + DM_WARM_END, *V = end + 4 * n;
    const double count = memory[DM_WARM_COUNT]; /* 0, or what stands in a checkpoint */
    if (memory[DM_WARM_STEP] != g->h || !(count >= 1.0 && count <= DM_WARM_TERMS + 1)) return 0;
    if (!continues(end, g->state, n)) return 0;
    continue_polynomial(g, g->root, V);
    add_missed(g->root, V + (size_t)s * n, (int)count - 1, s == 1 ? DM_WARM_PARABOLA : 0,
               (size_t)s * n);
    return 1;
}

int dm_stage_warm_guess(dm_stage *g) {
    const uint32_t s = g->table.s;
    switch (s == 1 ? g->n : 0) {
    case 1:
        return guess(g, 1, 1);
    case 2:
        return guess(g, 1, 2);
    case 3:
        return guess(g, 1, 3);
    case 4:
        return guess(g, 1, 4);
    default:
        return guess(g, s, g->n);
    }
}

/* D[count][size] of a step more, which has missed by `missed`; that is overwritten */
DM_WRITTEN_OUT void renew_differences(double *D, double *missed, int count, size_t size) {
    for (int i = 0; i < count; i++, D += size)
#pragma GCC unroll 4
        for (size_t k = 0; k < size; k++) {
            const double now = missed[k];
            missed[k] -= D[k];
            D[k] = now;
        }
}

DM_WRITTEN_OUT void keep(dm_stage *g, uint32_t s, uint32_t n) {
    const size_t size = (size_t)s * n;
    if (g->warm[DM_WARM_STEP] != g->h) return;
    double *end = g->warm + DM_WARM_END, *V = end + 4 * n, *missed = g->before;
    const double kept = g->warm[DM_WARM_COUNT];
    const int whole = kept >= 1.0 && kept <= DM_WARM_TERMS + 1 ? (int)kept : 0;
    const int count = continues(end, g->state, n) ? whole : 0;
    if (count > 0) {
        continue_polynomial(g, missed, V);
        for (size_t k = 0; k < size; k++) missed[k] = g->root[k] - missed[k];
        renew_differences(V + size, missed, count < DM_WARM_TERMS ? count : DM_WARM_TERMS, size);
    }
    g->warm[DM_WARM_COUNT] = count <= DM_WARM_TERMS ? count + 1 : DM_WARM_TERMS + 1;
    dm_stage_copy(V, g->root, (uint32_t)size);
    dm_stage_copy(end, g->next, 4 * n);
}

void dm_stage_warm_keep(dm_stage *g) {
    const uint32_t s = g->table.s;
    switch (s == 1 ? g->n : 0) {
    case 1:
        keep(g, 1, 1);
        break;
    case 2:
        keep(g, 1, 2);
        break;
    case 3:
        keep(g, 1, 3);
        break;
    case 4:
        keep(g, 1, 4);
        break;
    default:
        keep(g, s, g->n);
    }
}
