#include "linalg/blocks.h"

#include <stddef.h>

/* Behind order[from .. to - 1], which are of one block, the coordinates that they are joined with
 * and that are at order[to] or later change places with what is there; where the block ends. */
static uint32_t gather_block(const uint32_t *entries, uint32_t n, uint32_t *order, uint32_t from) {
    uint32_t to = from + 1;
    for (uint32_t k = from; k < to; k++)
        for (uint32_t i = to; i < n; i++) {
            const size_t a = order[k], b = order[i];
            if (!entries[a * n + b] && !entries[b * n + a]) continue;
            order[i] = order[to];
            order[to++] = (uint32_t)b;
        }
    return to;
}

/* by insertion, since parts of them ascend already */
static void sort(uint32_t *x, uint32_t count) {
    for (uint32_t i = 1; i < count; i++)
        for (uint32_t k = i; k > 0 && x[k] < x[k - 1]; k--) {
            const uint32_t least = x[k];
            x[k] = x[k - 1];
            x[k - 1] = least;
        }
}

dm_blocks dm_blocks_find(const uint32_t *entries, uint32_t n, uint32_t *room) {
    uint32_t *order = room, *first = room + n, count = 0;
    for (uint32_t i = 0; i < n; i++) order[i] = i;
    for (uint32_t from = 0; from < n; from = first[++count]) {
        sort(order + from, n - from);
        first[count] = from;
        first[count + 1] = gather_block(entries, n, order, from);
        sort(order + from, first[count + 1] - from);
    }
    return (dm_blocks){.count = count, .order = order, .first = first};
}

dm_blocks dm_blocks_whole(uint32_t n, uint32_t *room) {
    for (uint32_t i = 0; i < n; i++) room[i] = i;
    room[n] = 0, room[n + 1] = n;
    return (dm_blocks){.count = 1, .order = room, .first = room + n};
}
