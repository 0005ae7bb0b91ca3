/* group_bodies.c - the coordinates of a product of groups, cut into bodies. */
#include "code/loops/equal_parts.h"
#include "graph/analyse.h"
#include "mech/group_inside.h"

#include <string.h>

/* joined[d]: 1 where dtau_R mixes a coordinate with the one before it; returns whether some are */
static int join(uint8_t *joined, uint32_t d, dm_graph *pull, const dm_node *pulled) {
    uint8_t *apart = joined + d;
    int some = 0;
    memset(joined, 0, d);
    for (uint32_t a = 0; a < d; a++) {
        dm_independent(apart, pull, pulled + a, 1, 0, 2 * d);
        for (uint32_t c = 0; c < d; c++) {
            if (c == a || (apart[c] && apart[d + c])) continue;
            const uint32_t low = a < c ? a : c, high = a < c ? c : a;
            memset(joined + low + 1, 1, high - low);
            some = 1;
        }
    }
    return some;
}

/* A body begins with coordinates that are mixed; single ones belong to the body before them. Where
 * none are mixed each is a body. */
static void cut(dm_group_bodies *out, const uint8_t *joined, int some) {
    const uint32_t d = out->j->d;
    for (uint32_t a = 0; a < d; a++) {
        const int begins = !joined[a] && (!some || (a + 1 < d && joined[a + 1]));
        out->count += begins || !a;
        out->of_coordinate[a] = out->count - 1;
    }
}

/* flat coordinates move with those of the algebra */
static void find_flats(dm_group_bodies *out, uint8_t *apart) {
    const uint32_t n = out->j->n, d = out->j->d;
    const dm_chart_trace *trace = out->j->trace;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t a = 0;
        dm_independent(apart, trace->end, trace->carried + i, 1, n, d);
        while (a < d && apart[a]) a++;
        out->of_flat[i] = a < d ? out->of_coordinate[a] : DM_NO_BODY;
    }
}

dm_status dm_group_bodies_find(dm_group_bodies *out, const dm_joining *j, dm_graph *pull,
                               const dm_node *pulled) {
    uint8_t *joined = dm_arena_take(j->arena, 3 * (size_t)j->d + 1);
    *out = (dm_group_bodies){.j = j};
    out->of_flat = dm_joining_take(j, j->n);
    out->of_coordinate = dm_joining_take(j, j->d);
    if (!joined || !out->of_flat || !out->of_coordinate) return DM_NO_MEMORY;
    cut(out, joined, join(joined, j->d, pull, pulled));
    find_flats(out, joined);
    return DM_OK;
}

uint32_t *dm_group_bodies_of(const dm_group_bodies *b, uint32_t n, uint32_t times, uint32_t others,
                             uint32_t last) {
    const uint32_t d = b->j->d;
    uint32_t *out = dm_joining_take(b->j, n + times * d + others + last), *to = out;
    if (!out) return NULL;
    memcpy(to, b->of_flat, n * sizeof *to);
    to += n;
    for (uint32_t i = 0; i < times; i++, to += d) memcpy(to, b->of_coordinate, d * sizeof *to);
    for (uint32_t i = 0; i < others; i++) *to++ = DM_NO_BODY;
    memcpy(to, b->of_coordinate, last * sizeof *to);
    return out;
}
