/* test_blocks.c - the coordinates that entries join, against paths through a matrix. */
#include "check.h"
#include "linalg/blocks.h"

enum { N = 6 };

static uint32_t block_of(const dm_blocks *b, uint32_t i) {
    for (uint32_t k = 0; k < b->count; k++)
        for (uint32_t j = b->first[k]; j < b->first[k + 1]; j++)
            if (b->order[j] == i) return k;
    return UINT32_MAX;
}

/* all graphs of N points: two are in one block where some path joins them (Warshall) */
static int is_right(uint32_t edges) {
    uint32_t entries[N * N] = {0}, joined[N * N] = {0}, room[2 * N + 1];
    for (uint32_t i = 0, e = 0; i < N; i++)
        for (uint32_t j = i; j < N; j++) {
            const uint32_t is = i == j ? 1 : edges >> e++ & 1;
            entries[i * N + j] = entries[j * N + i] = is;
            joined[i * N + j] = joined[j * N + i] = is;
        }
    for (uint32_t k = 0; k < N; k++)
        for (uint32_t i = 0; i < N; i++)
            for (uint32_t j = 0; j < N; j++)
                joined[i * N + j] |= joined[i * N + k] & joined[k * N + j];
    const dm_blocks b = dm_blocks_find(entries, N, room);
    if (b.first[0] != 0 || b.first[b.count] != N) return 0;
    for (uint32_t i = 0; i < N; i++)
        for (uint32_t j = 0; j < N; j++)
            if ((block_of(&b, i) == block_of(&b, j)) != (joined[i * N + j] != 0)) return 0;
    for (uint32_t k = 0; k < b.count; k++)
        for (uint32_t j = b.first[k] + 1; j < b.first[k + 1]; j++)
            if (b.order[j - 1] >= b.order[j]) return 0;
    return 1;
}

static void finds_blocks(void) {
    for (uint32_t edges = 0; edges < 1u << N * (N - 1) / 2; edges++) CHECK(is_right(edges));
}

static void takes_all(void) {
    uint32_t room[N + 2];
    const dm_blocks whole = dm_blocks_whole(N, room);
    CHECK(whole.count == 1 && dm_block_size(&whole, 0) == N);
}

int main(void) {
    RUN(finds_blocks, "finds the blocks of all graphs of six points, each ascending");
    RUN(takes_all, "takes all as one block");
    return check_finish();
}
