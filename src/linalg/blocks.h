/* blocks.h - which coordinates a symmetric matrix couples: those that entries beside its diagonal
 * join, directly or by others. Its signature and determinant are told block by block. */
#ifndef DM_BLOCKS_H
#define DM_BLOCKS_H

#include <stdint.h>

/* Block b has the coordinates order[first[b]], ..., order[first[b + 1] - 1], which ascend. */
typedef struct {
    uint32_t count;                /* 0: they are not known */
    const uint32_t *order, *first; /* [n], [count + 1] */
} dm_blocks;

static inline uint32_t dm_block_size(const dm_blocks *b, uint32_t i) {
    return b->first[i + 1] - b->first[i];
}

/* The blocks of a matrix whose entries[n*n] are 0 where it has none; room[2n + 1] stays in use. */
dm_blocks dm_blocks_find(const uint32_t *entries, uint32_t n, uint32_t *room);

/* All n coordinates as one block; room[n + 2] stays in use. */
dm_blocks dm_blocks_whole(uint32_t n, uint32_t *room);

#endif
