/* orientation.c - the coherent orientation of the top cells, and what keeps a complex from being
 * a manifold. */
#include "dec/orientation.h"

#include <string.h>

/* the sign with which face f stands in the boundary of top cell c, before c's own sign */
static int incidence(const dm_complex *K, uint32_t c, uint32_t f) {
    const uint32_t *face = K->face[K->n] + (size_t)c * (K->n + 1);
    for (uint32_t j = 0; j <= K->n; j++)
        if (face[j] == f) return j % 2 ? -1 : 1;
    return 0;
}

/* the other top cell at a face, or UINT32_MAX at the boundary */
static uint32_t across(const dm_complex *K, uint32_t f, uint32_t c) {
    const uint32_t from = K->coface_at[K->n - 1][f], to = K->coface_at[K->n - 1][f + 1];
    const uint32_t *coface = K->coface[K->n - 1];
    if (to - from != 2) return UINT32_MAX;
    return coface[from] == c ? coface[from + 1] : coface[from];
}

/* gives all cells that hang together with `first` a sign; 0: two of them ask for both */
static int spread(const dm_complex *K, int8_t *sign, uint32_t *queue, uint32_t first,
                  int8_t begin) {
    uint32_t head = 0, tail = 0;
    sign[first] = begin;
    for (queue[tail++] = first; head < tail;) {
        const uint32_t c = queue[head++];
        for (uint32_t j = 0; j <= K->n; j++) {
            const uint32_t f = K->face[K->n][(size_t)c * (K->n + 1) + j], d = across(K, f, c);
            if (d == UINT32_MAX) continue;
            const int wanted = -sign[c] * (j % 2 ? -1 : 1) * incidence(K, d, f);
            if (sign[d] == 0) sign[d] = (int8_t)wanted, queue[tail++] = d;
            if (sign[d] != wanted) return 0;
        }
    }
    return 1;
}

uint32_t dm_complex_crowded(const dm_complex *K) {
    if (K->n == 0) return UINT32_MAX;
    const uint32_t *at = K->coface_at[K->n - 1];
    for (uint32_t f = 0; f < K->count[K->n - 1]; f++)
        if (at[f + 1] - at[f] > 2) return f;
    return UINT32_MAX;
}

dm_status dm_complex_orient(dm_complex *K, dm_arena *arena, const int8_t *wish) {
    const uint32_t count = K->count[K->n];
    dm_arena *scratch = dm_arena_scratch(arena);
    if (!scratch) return DM_NO_MEMORY;
    int8_t *sign = dm_arena_take(arena, (size_t)count + 1);
    uint32_t *queue = dm_arena_take(scratch, ((size_t)count + 1) * sizeof *queue);
    if (!sign || !queue) return DM_NO_MEMORY;
    memset(sign, K->n ? 0 : 1, (size_t)count + 1);
    K->orientation = NULL;
    if (dm_complex_crowded(K) != UINT32_MAX) return DM_OK;
    for (uint32_t c = 0; K->n && c < count; c++)
        if (sign[c] == 0 && !spread(K, sign, queue, c, wish ? wish[c] : 1)) return DM_OK;
    K->orientation = sign;
    return DM_OK;
}

/* the sign of the volume of the cell that the face and the vertex left out make, in this order */
static int side_of(const dm_complex *K, const int8_t *sign, uint32_t cell, uint32_t face) {
    const uint32_t *faces = K->face[K->n] + (size_t)cell * (K->n + 1);
    uint32_t place = 0;
    while (faces[place] != face) place++;
    return place % 2 ? -sign[cell] : sign[cell];
}

uint32_t dm_complex_folds(const dm_complex *K, const int8_t *sign, uint32_t *first) {
    uint32_t folds = 0;
    for (uint32_t f = 0; f < K->count[K->n - 1]; f++) {
        const uint32_t at = K->coface_at[K->n - 1][f];
        if (K->coface_at[K->n - 1][f + 1] - at != 2) continue;
        const uint32_t *cell = K->coface[K->n - 1] + at;
        if (side_of(K, sign, cell[0], f) != side_of(K, sign, cell[1], f)) continue;
        if (folds++ == 0) *first = f;
    }
    return folds;
}
