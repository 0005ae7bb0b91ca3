#include "dec/parts.h"

#include <string.h>

static uint32_t sum_of(const uint8_t *mark, uint32_t count) {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < count; i++) sum += mark[i];
    return sum;
}

/* marks of degree d + 1 become those of their faces */
static void mark_faces(uint8_t *out, const uint8_t *mark, const dm_complex *K, uint32_t d) {
    memset(out, 0, K->count[d]);
    for (uint32_t i = 0; i < K->count[d + 1]; i++)
        for (uint32_t j = 0; mark[i] && j < d + 2; j++)
            out[K->face[d + 1][(size_t)i * (d + 2) + j]] = 1;
}

uint32_t dm_parts_boundary(uint8_t *mark, uint8_t *work, const dm_complex *K, uint32_t k) {
    const uint32_t n = K->n;
    if (n == 0 || k == n) return 0;
    uint8_t *now = (n - 1 - k) % 2 ? work : mark, *then = now == mark ? work : mark;
    const uint32_t *at = K->coface_at[n - 1];
    for (uint32_t f = 0; f < K->count[n - 1]; f++) now[f] = at[f + 1] - at[f] == 1;
    for (uint32_t d = n - 1; d-- > k;) {
        mark_faces(then, now, K, d);
        uint8_t *swapped = now;
        now = then, then = swapped;
    }
    return sum_of(mark, K->count[k]);
}

uint32_t dm_parts_star(uint8_t *mark, uint8_t *work, const dm_complex *K, uint32_t k,
                       uint32_t cell, uint32_t d) {
    uint8_t *now = (d - k) % 2 ? work : mark, *then = now == mark ? work : mark;
    memset(now, 0, K->count[k]);
    now[cell] = 1;
    for (uint32_t above = k + 1; above <= d; above++) {
        memset(then, 0, K->count[above]);
        for (uint32_t i = 0; i < K->count[above]; i++)
            for (uint32_t j = 0; j <= above; j++)
                then[i] |= now[K->face[above][(size_t)i * (above + 1) + j]];
        uint8_t *swapped = now;
        now = then, then = swapped;
    }
    return sum_of(mark, K->count[d]);
}
