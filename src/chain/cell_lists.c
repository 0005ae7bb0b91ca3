/* cell_lists.c - which slopes an entry of a gradient adds up, and threads that do it. */
#include "chain/cell_lists.h"

#include <string.h>

enum { BLOCK = DM_CELL_BLOCK };

/* ---- lists ---- */

/* one pass over all shares, sum by sum, cell by cell: counts (list NULL), or lists */
static void pass(const dm_cells *c, uint32_t *start, uint32_t *list) {
    const dm_cell_lists *l = c->lists;
    for (uint32_t k = 0; k < c->sums; k++) {
        const dm_cell_slopes *d = c->sum + k;
        const uint32_t cells = d->shares ? d->loop.sum->bodies : 0;
        for (uint32_t i = 0; i < cells; i++)
            for (const dm_cell_share *s = d->share; s < d->share + d->shares; s++) {
                const size_t entry = dm_cell_share_entry(s, i);
                const size_t at = l->width[k] * ((size_t)s->output * cells + i) + (s->sign < 0.0);
                if (list)
                    list[start[entry + 1]++] = (uint32_t)(l->slot[k] + at);
                else
                    start[entry + 2]++;
            }
    }
}

/* where slopes stand: *slots in all; *all: how many entries add up */
static dm_status place_slopes(const dm_cells *c, size_t *slots, size_t *all, dm_arena *arena) {
    dm_cell_lists *l = c->lists;
    l->slot = dm_arena_take(arena, (c->sums + 1) * sizeof *l->slot);
    l->width = dm_arena_take(arena, c->sums + 1);
    if (!l->slot || !l->width) return DM_NO_MEMORY;
    *slots = *all = 0;
    for (uint32_t k = 0; k < c->sums; k++) {
        const dm_cell_slopes *d = c->sum + k;
        l->slot[k] = *slots;
        l->width[k] = 1;
        for (uint32_t j = 0; j < d->shares; j++)
            if (d->share[j].sign < 0.0) l->width[k] = 2;
        *slots += (size_t)l->width[k] * d->loop.outputs * d->loop.sum->bodies;
        *all += (size_t)d->shares * d->loop.sum->bodies;
    }
    return *slots > UINT32_MAX || *all > UINT32_MAX ? DM_TOO_LARGE : DM_OK;
}

/* in nearly all blocks edges of a surface have two terms each, vertices six */
static void find_alike(const dm_cell_lists *l, uint32_t m) {
    for (uint32_t first = 0; first < m; first += BLOCK) {
        const uint32_t *start = l->start + first, terms = start[1] - start[0];
        const uint32_t count = m - first < BLOCK ? m - first : BLOCK;
        uint32_t i = 1;
        while (i < count && start[i + 1] - start[i] == terms) i++;
        l->alike[first / BLOCK] = i == count && terms < UINT8_MAX ? (uint8_t)terms : 0;
    }
}

/* by counting: while lists are filled start[i + 1] is the next place of entry i */
dm_status dm_cell_lists_make(const dm_cells *c, dm_arena *arena) {
    dm_cell_lists *l = c->lists;
    size_t slots, all;
    if (l->slope) return DM_OK;
    const dm_status status = place_slopes(c, &slots, &all, arena);
    if (status != DM_OK) return status;
    l->start = dm_arena_take(arena, ((size_t)c->m + 2) * sizeof *l->start);
    l->list = dm_arena_take(arena, (all + 1) * sizeof *l->list);
    double *slope = dm_arena_take(arena, (slots + 1) * sizeof *slope);
    l->alike = dm_arena_take(arena, c->m / BLOCK + 1);
    if (!l->start || !l->list || !slope || !l->alike) return DM_NO_MEMORY;
    memset(l->start, 0, ((size_t)c->m + 2) * sizeof *l->start);
    pass(c, l->start, NULL);
    for (uint32_t i = 1; i <= c->m; i++) l->start[i + 1] += l->start[i];
    pass(c, l->start, l->list);
    find_alike(l, c->m);
    l->slope = slope;
    return DM_OK;
}

/* ---- slopes, and what they add up to ---- */

/* slopes of the cells [from, to) of one sum, whole blocks of them, so that lanes are those of one
 * thread */
static void find_slopes(const dm_cells *c, uint32_t k, double factor, const double *x, double *work,
                        uint32_t from, uint32_t to) {
    const dm_cell_loop *l = &c->sum[k].loop;
    const uint32_t cells = l->sum->bodies, width = c->lists->width[k];
    double *slope = c->lists->slope + c->lists->slot[k];
    for (uint32_t j = 0; l->linear && j < l->outputs; j++)
        dm_cell_linear_run(l->linear + j, slope + width * ((size_t)j * cells + from), width, x,
                           from, to - from, factor);
    for (uint32_t first = from; !l->linear && first < to; first += BLOCK) {
        const uint32_t count = to - first < BLOCK ? to - first : BLOCK;
        dm_cell_loop_run(l, work, BLOCK, x, first, count, work + (size_t)l->outputs * BLOCK);
        for (uint32_t j = 0; j < l->outputs; j++) {
            const double *y = work + (size_t)j * BLOCK;
            double *out = slope + width * ((size_t)j * cells + first);
            for (uint32_t i = 0; width == 1 && i < count; i++) out[i] = factor * y[i];
            for (uint32_t i = 0; width == 2 && i < count; i++) {
                out[2 * i] = factor * y[i];
                out[2 * i + 1] = -(factor * y[i]);
            }
        }
    }
}

void dm_cell_lists_slopes(const dm_cells *c, const double *factor, const double *x, double *work,
                          uint32_t part, uint32_t parts) {
    for (uint32_t k = 0; k < c->sums; k++) {
        const uint32_t cells = c->sum[k].loop.outputs ? c->sum[k].loop.sum->bodies : 0;
        const uint32_t blocks = (cells + BLOCK - 1) / BLOCK;
        const uint32_t from = (uint32_t)((uint64_t)blocks * part / parts) * BLOCK;
        const uint32_t to = (uint32_t)((uint64_t)blocks * (part + 1) / parts) * BLOCK;
        if (from < cells) find_slopes(c, k, factor[k], x, work, from, to < cells ? to : cells);
    }
}

/* entries [from, to), which have so many terms each (a constant where this is called) or, 0, as
 * many as they have */
__attribute__((always_inline)) static inline void add_up(const dm_cell_lists *l, double *out,
                                                         uint32_t from, uint32_t to,
                                                         const uint32_t terms) {
    const double *restrict slope = l->slope;
    const uint32_t *restrict list = l->list + l->start[from];
    for (uint32_t i = from; i < to; i++) {
        const uint32_t count = terms ? terms : l->start[i + 1] - l->start[i];
        double sum = 0.0;
#pragma GCC unroll 6
        for (uint32_t k = 0; k < count; k++) sum += slope[list[k]];
        out[i] = sum;
        list += count;
    }
}

void dm_cell_lists_entries(const dm_cells *c, double *out, uint32_t from, uint32_t to) {
    const dm_cell_lists *l = c->lists;
    for (uint32_t i = from, end; i < to; i = end) {
        end = (i / BLOCK + 1) * BLOCK < to ? (i / BLOCK + 1) * BLOCK : to;
        if (l->alike[i / BLOCK] == 2)
            add_up(l, out, i, end, 2);
        else if (l->alike[i / BLOCK] == 6)
            add_up(l, out, i, end, 6);
        else
            add_up(l, out, i, end, 0);
    }
    dm_cells_hold(c, out, from, to);
}
