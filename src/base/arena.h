/* arena.h - memory that is given back all at once; the caller brings the allocator. */
#ifndef DM_ARENA_H
#define DM_ARENA_H

#include <stddef.h>

/* Same contract as lua_Alloc: new_size = 0 frees, NULL on failure. */
typedef void *dm_allocator(void *ud, void *block, size_t old_size, size_t new_size);

typedef struct dm_arena_chunk dm_arena_chunk;
typedef struct dm_arena_cleanup dm_arena_cleanup;

/* How a thing outside of the arena (pages, a shared object) is given back. */
typedef void dm_giveback(void *thing, size_t size);

typedef struct dm_arena {
    dm_allocator *allocate;
    void *ud;
    int (*keep)(void *ud, dm_giveback *give_back, void *thing, size_t size); /* or NULL */
    dm_arena_chunk *chunks;                                                  /* newest first */
    size_t used, room;          /* of the newest chunk, bytes */
    size_t total;               /* bytes held */
    int exact;                  /* blocks as large as what is asked for: for few large ones */
    dm_arena_cleanup *cleanups; /* newest first */
    struct dm_arena *scratch;   /* dm_arena_scratch, NULL before the first */
    dm_arena_chunk *spare;      /* of a scratch arena: to be used again */
} dm_arena;

void dm_arena_init(dm_arena *arena, dm_allocator *allocate, void *ud);

/* `size` bytes aligned to 64, not cleared; NULL when the allocator refuses. */
void *dm_arena_take(dm_arena *arena, size_t size);

/* Grow the array `old` of old_size bytes: the newest block grows in place, else it is copied. */
void *dm_arena_grow(dm_arena *arena, void *old, size_t old_size, size_t new_size);

/* An arena beside this one, from the same allocator and released with it, for what is not needed
 * for long: it is empty after every call, but keeps its memory, so that one computation after
 * the other works in the same pages. NULL without memory. */
dm_arena *dm_arena_scratch(dm_arena *arena);

/* Call give_back(thing, size) when the arena is released, or when the owner of its memory says
 * so (`keep`, if it has set that). 0 without memory for it: the caller then gives it back
 * itself. */
int dm_arena_on_release(dm_arena *arena, dm_giveback *give_back, void *thing, size_t size);

/* Forget what was taken, for new use; the newest block stays, the others are given back. Not
 * for an arena that something is to be called for on release. */
void dm_arena_reset(dm_arena *arena);

/* Give everything back; the arena is empty and can be used again. */
void dm_arena_release(dm_arena *arena);

#endif
