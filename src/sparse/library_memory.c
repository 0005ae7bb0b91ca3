/* library_memory.c - memory of SuiteSparse from an allocator that is told sizes: every block has
 * its size in front of it. Some allocators align to 8 bytes only, blocks here to 64. */
#include "sparse/factor.h"

#include <stdint.h>
#include <string.h>
#include <suitesparse/SuiteSparse_config.h>

enum { ALIGNMENT = 64 };

struct dm_library_block {
    dm_library_block *previous, *next;
    void *raw;    /* what the allocator gave */
    size_t whole; /* its bytes */
    size_t size;  /* bytes that were asked for */
};

/* SuiteSparse's functions have no argument for whom they work */
static _Thread_local dm_factor *owner;
static _Thread_local struct SuiteSparse_config_struct before;

/* of OpenMP, where CHOLMOD was built with it */
__attribute__((weak)) int omp_get_max_active_levels(void);
__attribute__((weak)) void omp_set_max_active_levels(int levels);
static _Thread_local int levels;

/* No threads of OpenMP: a process that is forked later has none of them and would wait for them.
 * They are for sums between calls of BLAS only, a few parts in a hundred of the time. */
static void be_alone(void) {
    if (!omp_get_max_active_levels || !omp_set_max_active_levels) return;
    levels = omp_get_max_active_levels();
    omp_set_max_active_levels(0);
}

/* a block of the owner, or NULL: no memory */
static void *give(size_t size) {
    const size_t head = sizeof(dm_library_block) + ALIGNMENT;
    if (size > SIZE_MAX - head) return NULL;
    unsigned char *raw = owner->arena->allocate(owner->arena->ud, NULL, 0, size + head);
    if (!raw) return NULL;
    const uintptr_t at = ((uintptr_t)raw + head) & ~(uintptr_t)(ALIGNMENT - 1);
    dm_library_block *block = (dm_library_block *)(at - sizeof *block);
    *block = (dm_library_block){NULL, owner->blocks, raw, size + head, size};
    if (owner->blocks) owner->blocks->previous = block;
    owner->blocks = block;
    return block + 1;
}

static void *give_cleared(size_t count, size_t size) {
    if (size && count > SIZE_MAX / size) return NULL;
    void *memory = give(count * size);
    return memory ? memset(memory, 0, count * size) : NULL;
}

/* out of the list, back to the allocator */
static void take_back(void *memory) {
    if (!memory) return;
    dm_library_block *block = (dm_library_block *)memory - 1;
    if (block->previous)
        block->previous->next = block->next;
    else
        owner->blocks = block->next;
    if (block->next) block->next->previous = block->previous;
    owner->arena->allocate(owner->arena->ud, block->raw, block->whole, 0);
}

/* allocators of a collector resize nothing: always a new block */
static void *resize(void *memory, size_t size) {
    void *now = give(size);
    if (!now || !memory) return now;
    const size_t old = ((dm_library_block *)memory - 1)->size;
    memcpy(now, memory, old < size ? old : size);
    take_back(memory);
    return now;
}

void dm_library_enter(dm_factor *f) {
    owner = f;
    be_alone();
    before = SuiteSparse_config;
    SuiteSparse_config.malloc_func = give;
    SuiteSparse_config.calloc_func = give_cleared;
    SuiteSparse_config.realloc_func = resize;
    SuiteSparse_config.free_func = take_back;
}

void dm_library_leave(void) {
    SuiteSparse_config = before;
    if (omp_set_max_active_levels) omp_set_max_active_levels(levels);
    owner = NULL;
}

void dm_library_release(dm_factor *f) {
    while (f->blocks) {
        dm_library_block *block = f->blocks;
        f->blocks = block->next;
        f->arena->allocate(f->arena->ud, block->raw, block->whole, 0);
    }
}
