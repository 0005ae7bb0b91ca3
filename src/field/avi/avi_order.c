/* avi_order.c - neighbours of cells, and who comes before whom. */
#include "field/avi/avi_inside.h"

#include <string.h>

/* the cells of every entry that moves: list[start[i]] .. list[start[i + 1] - 1], ascending */
typedef struct {
    uint32_t *start, *list;
} meetings;

/* one pass over the entries of all cells: counts, or lists */
static void pass(const dm_avi *a, meetings *m, int fill) {
    for (uint32_t k = 0; k < a->sums; k++) {
        const dm_avi_sum *s = a->sum + k;
        const size_t all = (size_t)s->sum->bodies * s->reads;
        for (size_t j = 0; j < all; j++) {
            const uint32_t entry = s->entry[j];
            if (a->w[entry] == 0.0) continue;
            if (fill)
                m->list[m->start[entry + 1]++] = s->first + (uint32_t)(j / s->reads);
            else
                m->start[entry + 2]++;
        }
    }
}

static dm_status find_meetings(const dm_avi *a, meetings *m, dm_arena *arena) {
    size_t all = 0;
    for (uint32_t k = 0; k < a->sums; k++) all += (size_t)a->sum[k].sum->bodies * a->sum[k].reads;
    if (all > UINT32_MAX) return DM_TOO_LARGE;
    m->start = dm_arena_take(arena, ((size_t)a->n + 2) * sizeof *m->start);
    m->list = dm_arena_take(arena, (all + 1) * sizeof *m->list);
    if (!m->start || !m->list) return DM_NO_MEMORY;
    memset(m->start, 0, ((size_t)a->n + 2) * sizeof *m->start);
    pass(a, m, 0);
    for (uint32_t i = 1; i <= a->n; i++) m->start[i + 1] += m->start[i];
    pass(a, m, 1);
    return DM_OK;
}

/* the cells around cell k to `out` (NULL: they are counted), each once; seen[cell] = k + 1 */
static uint32_t near_of(const dm_avi *a, const meetings *m, uint32_t k, uint32_t *seen,
                        uint32_t *out) {
    const dm_avi_sum *s = dm_avi_sum_of(a, k);
    const uint32_t *entry = s->entry + (size_t)(k - s->first) * s->reads;
    uint32_t count = 0;
    seen[k] = k + 1;
    for (uint32_t r = 0; r < s->reads; r++)
        for (uint32_t j = m->start[entry[r]]; j < m->start[entry[r] + 1]; j++) {
            const uint32_t other = m->list[j];
            if (seen[other] == k + 1) continue;
            seen[other] = k + 1;
            if (out) out[count] = other;
            count++;
        }
    return count;
}

dm_status dm_avi_find_near(dm_avi *a, dm_arena *arena) {
    meetings m;
    size_t all = 0;
    dm_status status = find_meetings(a, &m, arena);
    uint32_t *seen = dm_arena_take(arena, ((size_t)a->cells + 1) * sizeof *seen);
    a->near_start = dm_arena_take(arena, ((size_t)a->cells + 1) * sizeof *a->near_start);
    if (status == DM_OK && (!seen || !a->near_start)) status = DM_NO_MEMORY;
    if (status != DM_OK) return status;
    memset(seen, 0, ((size_t)a->cells + 1) * sizeof *seen);
    for (uint32_t k = 0; k < a->cells; k++) {
        a->near_start[k] = (uint32_t)all;
        all += near_of(a, &m, k, seen, NULL);
    }
    if (all > UINT32_MAX) return DM_TOO_LARGE;
    a->near_start[a->cells] = (uint32_t)all;
    a->near = dm_arena_take(arena, (all + 1) * sizeof *a->near);
    if (!a->near) return DM_NO_MEMORY;
    memset(seen, 0, ((size_t)a->cells + 1) * sizeof *seen);
    for (uint32_t k = 0; k < a->cells; k++) near_of(a, &m, k, seen, a->near + a->near_start[k]);
    return DM_OK;
}

/* the first cells come first */
void dm_avi_order(dm_avi *a) {
    a->readies = 0;
    for (uint32_t k = a->cells; k-- > 0;) {
        a->cell[k].blocked = 0;
        for (uint32_t j = a->near_start[k]; j < a->near_start[k + 1]; j++)
            a->cell[k].blocked += (uint32_t)dm_avi_is_before(a->cell, a->near[j], k);
        if (!a->cell[k].blocked) a->ready[a->readies++] = k;
    }
}
