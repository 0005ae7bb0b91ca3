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

uint32_t dm_parts_star(uint8_t *mark, uint8_t *work, const dm_complex *K, uint32_t k, uint32_t cell,
                       uint32_t d) {
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

/* ---- manifolds ---- */

static uint32_t size_of(uint32_t set) {
    uint32_t count = 0;
    for (; set; set &= set - 1) count++;
    return count;
}

/* every cell lies in a top cell, and at most two of them meet in a facet */
static int is_pure_and_thin(const dm_complex *K) {
    const uint32_t *at = K->coface_at[K->n - 1];
    for (uint32_t f = 0; f < K->count[K->n - 1]; f++)
        if (at[f + 1] - at[f] > 2) return 0;
    return K->pure;
}

/* euler[count[k]]: of the link of every cell of degree k, sum of (-1)^(d - k - 1) over cofaces */
static void link_euler(int32_t *euler, const dm_complex *K, uint32_t k) {
    memset(euler, 0, K->count[k] * sizeof *euler);
    for (uint32_t d = k + 1; d <= K->n; d++)
        for (uint32_t i = 0; i < K->count[d]; i++)
            for (uint32_t set = 1; set < 2u << d; set++)
                if (size_of(set) == k + 1)
                    euler[dm_complex_face(K, d, i, set)] += (d - k) % 2 ? 1 : -1;
}

/* of union-find; paths are halved on the way */
static uint32_t root_of(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* A top cell around a cell is a pair of the two, number top 2^(n+1) + set. Two of them hang
 * together where the tops share a facet that has the cell. The pairs of one cell have one root? */
static int links_connected(const dm_complex *K, uint32_t k, uint32_t *parent, uint32_t *first) {
    const uint32_t n = K->n, sets = 2u << n;
    for (uint32_t i = 0; i < K->count[n] * sets; i++) parent[i] = i;
    for (uint32_t i = 0; i < K->count[k]; i++) first[i] = UINT32_MAX;
    /* the pairs of one facet: found by the cell, in both of its top cells */
    for (uint32_t f = 0; f < K->count[n - 1]; f++) {
        const uint32_t at = K->coface_at[n - 1][f];
        if (K->coface_at[n - 1][f + 1] - at != 2) continue;
        const uint32_t a = K->coface[n - 1][at], b = K->coface[n - 1][at + 1];
        for (uint32_t s = 1; s < sets; s++) {
            if (size_of(s) != k + 1) continue;
            for (uint32_t t = 1; t < sets; t++)
                if (size_of(t) == k + 1 &&
                    dm_complex_face(K, n, a, s) == dm_complex_face(K, n, b, t))
                    parent[root_of(parent, a * sets + s)] = root_of(parent, b * sets + t);
        }
    }
    for (uint32_t c = 0; c < K->count[n]; c++)
        for (uint32_t s = 1; s < sets; s++) {
            if (size_of(s) != k + 1) continue;
            const uint32_t cell = dm_complex_face(K, n, c, s), root = root_of(parent, c * sets + s);
            if (first[cell] == UINT32_MAX) first[cell] = root;
            if (first[cell] != root) return 0;
        }
    return 1;
}

int dm_parts_manifold(const dm_complex *K, dm_arena *scratch) {
    const uint32_t n = K->n;
    uint32_t most = 0;
    if (n == 0) return 1;
    if (!is_pure_and_thin(K)) return 0;
    for (uint32_t k = 0; k <= n; k++) most = K->count[k] > most ? K->count[k] : most;
    if ((double)K->count[n] * (2u << n) >= UINT32_MAX) return -1;
    uint32_t *parent = dm_arena_take(scratch, (size_t)K->count[n] * (2u << n) * sizeof *parent);
    uint32_t *first = dm_arena_take(scratch, (most + 1) * sizeof *first);
    int32_t *euler = dm_arena_take(scratch, (most + 1) * sizeof *euler);
    uint8_t *mark = dm_arena_take(scratch, most + 1), *work = dm_arena_take(scratch, most + 1);
    if (!parent || !first || !euler || !mark || !work) return -1;
    for (uint32_t k = 0; k + 1 < n; k++) {
        link_euler(euler, K, k);
        dm_parts_boundary(mark, work, K, k);
        const int32_t sphere = (n - k - 1) % 2 ? 0 : 2;
        for (uint32_t i = 0; i < K->count[k]; i++)
            if (euler[i] != (mark[i] ? 1 : sphere)) return 0;
        if (!links_connected(K, k, parent, first)) return 0;
    }
    return 1;
}
