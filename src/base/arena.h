/* arena.h - memory that is given back all at once; the caller brings the allocator. */
#ifndef DM_ARENA_H
#define DM_ARENA_H

#include <stddef.h>

/* Same contract as lua_Alloc: new_size = 0 frees, NULL on failure. */
typedef void *dm_allocator(void *ud, void *block, size_t old_size, size_t new_size);

typedef struct dm_arena_chunk dm_arena_chunk;
typedef struct dm_arena_cleanup dm_arena_cleanup;

typedef struct {
    dm_allocator *allocate;
    void *ud;
    dm_arena_chunk *chunks;     /* newest first */
    size_t used, room;          /* of the newest chunk, bytes */
    size_t total;               /* bytes held */
    dm_arena_cleanup *cleanups; /* newest first */
} dm_arena;

void dm_arena_init(dm_arena *arena, dm_allocator *allocate, void *ud);

/* `size` bytes aligned to 64, not cleared; NULL when the allocator refuses. */
void *dm_arena_take(dm_arena *arena, size_t size);

/* Grow the array `old` of old_size bytes: the newest block grows in place, else it is copied. */
void *dm_arena_grow(dm_arena *arena, void *old, size_t old_size, size_t new_size);

/* Call release(ud) before the memory is given back; 0 (and no call) without memory for that. */
int dm_arena_on_release(dm_arena *arena, void (*release)(void *ud), void *ud);

/* Forget what was taken, for new use; the newest block stays, the others are given back. Not
** for an arena that something is to be called for on release. */
void dm_arena_reset(dm_arena *arena);

/* Give everything back; the arena is empty and can be used again. */
void dm_arena_release(dm_arena *arena);

#endif
