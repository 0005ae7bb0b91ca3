/* arena.c - chunks of memory that double in size, each with a header. `used` of `room` bytes of
 * the newest chunk are taken; older chunks are full as far as anybody cares. Large blocks have
 * chunks of their own, so that nothing is held in reserve for arrays of 10^6 entries. Nothing is
 * given back but all at once, so a Lua error or a refusal halfway through a computation leaks
 * nothing.
 *
 * A scratch arena keeps its chunks when it is emptied: they wait in `spare`, the newest and
 * largest first, and the next computation works in the same pages, which are in the caches. */
#include "base/arena.h"

#include <stdint.h>
#include <string.h>

enum { ALIGNMENT = 64, FIRST_CHUNK = 16384, LARGE = 1 << 18, LARGEST_STEP = 1 << 24 };

/* the head of a block from the allocator; its data begin at the next multiple of ALIGNMENT */
struct dm_arena_chunk {
    dm_arena_chunk *next;
    size_t size; /* bytes of the whole block, header included */
};

/* what is to be called when the arena is released */
struct dm_arena_cleanup {
    dm_arena_cleanup *next;
    dm_giveback *give_back;
    void *thing;
    size_t size;
};

void dm_arena_init(dm_arena *arena, dm_allocator *allocate, void *ud) {
    *arena = (dm_arena){.allocate = allocate, .ud = ud};
}

/* the first aligned byte behind the header */
static unsigned char *chunk_data(dm_arena_chunk *chunk) {
    const uintptr_t raw = (uintptr_t)(chunk + 1);
    return (unsigned char *)((raw + ALIGNMENT - 1) & ~(uintptr_t)(ALIGNMENT - 1));
}

/* whole cache lines */
static size_t rounded(size_t size) {
    return (size + ALIGNMENT - 1) & ~(size_t)(ALIGNMENT - 1);
}

/* one of those kept from before that is large enough, or NULL */
static dm_arena_chunk *reuse(dm_arena *arena, size_t size) {
    for (dm_arena_chunk **at = &arena->spare; *at; at = &(*at)->next) {
        dm_arena_chunk *chunk = *at;
        if (chunk->size < size) continue;
        *at = chunk->next;
        return chunk;
    }
    return NULL;
}

/* for so many bytes; NULL: refused */
static dm_arena_chunk *new_chunk(dm_arena *arena, size_t room) {
    const size_t whole = room + sizeof(dm_arena_chunk) + ALIGNMENT;
    dm_arena_chunk *chunk = arena->allocate(arena->ud, NULL, 0, whole);
    if (!chunk) return NULL;
    *chunk = (dm_arena_chunk){.size = whole};
    arena->total += whole;
    return chunk;
}

/* chunks double, so that their number stays logarithmic */
static int add_chunk(dm_arena *arena, size_t size) {
    const size_t around = sizeof(dm_arena_chunk) + ALIGNMENT;
    size_t room = arena->room < FIRST_CHUNK ? FIRST_CHUNK : 2 * arena->room;
    if (room > LARGEST_STEP) room = LARGEST_STEP;
    if (room < size || arena->exact) room = size;
    dm_arena_chunk *chunk = reuse(arena, size + around);
    if (!chunk) chunk = new_chunk(arena, room);
    if (!chunk) return 0;
    chunk->next = arena->chunks;
    arena->chunks = chunk;
    arena->used = 0;
    arena->room = chunk->size - around;
    return 1;
}

/* a block in a chunk of its own, behind the newest */
static void *take_alone(dm_arena *arena, size_t size) {
    dm_arena_chunk *chunk = reuse(arena, size + sizeof *chunk + ALIGNMENT);
    if (!chunk) chunk = new_chunk(arena, size);
    if (!chunk) return NULL;
    chunk->next = arena->chunks->next;
    arena->chunks->next = chunk;
    return chunk_data(chunk);
}

/* A request for nothing gets a line of its own, so that pointers differ. */
void *dm_arena_take(dm_arena *arena, size_t size) {
    if (size > SIZE_MAX / 2) return NULL;
    size = rounded(size ? size : 1);
    if (arena->room - arena->used < size) {
        if (size >= LARGE && arena->chunks) return take_alone(arena, size);
        if (!add_chunk(arena, size)) return NULL;
    }
    unsigned char *block = chunk_data(arena->chunks) + arena->used;
    arena->used += size;
    return block;
}

/* in place where the block is the newest and there is room, else a copy; the old one stays
 * taken */
void *dm_arena_grow(dm_arena *arena, void *old, size_t old_size, size_t new_size) {
    if (new_size > SIZE_MAX / 2) return NULL;
    const size_t held = rounded(old_size ? old_size : 1), want = rounded(new_size);
    if (old && want <= held) return old;
    if (old && arena->chunks) {
        const unsigned char *end = chunk_data(arena->chunks) + arena->used;
        const int newest = (const unsigned char *)old + held == end;
        if (newest && arena->room - arena->used >= want - held) {
            arena->used += want - held;
            return old;
        }
    }
    void *block = dm_arena_take(arena, new_size);
    if (block && old) memcpy(block, old, old_size);
    return block;
}

/* by the owner of the memory where it has asked for that, else when the arena goes */
int dm_arena_on_release(dm_arena *arena, dm_giveback *give_back, void *thing, size_t size) {
    if (arena->keep) return arena->keep(arena->ud, give_back, thing, size);
    dm_arena_cleanup *c = dm_arena_take(arena, sizeof *c);
    if (!c) return 0;
    *c = (dm_arena_cleanup){arena->cleanups, give_back, thing, size};
    arena->cleanups = c;
    return 1;
}

/* a list of chunks back to the allocator */
static void release_chunks(dm_arena *arena, dm_arena_chunk *chunk) {
    for (dm_arena_chunk *next; chunk; chunk = next) {
        next = chunk->next;
        arena->total -= chunk->size;
        arena->allocate(arena->ud, chunk, chunk->size, 0);
    }
}

/* all chunks to the spare ones, the newest and largest first */
static void set_aside(dm_arena *arena) {
    dm_arena_chunk **end = &arena->chunks;
    while (*end) end = &(*end)->next;
    *end = arena->spare;
    arena->spare = arena->chunks;
    arena->chunks = NULL;
    arena->used = arena->room = 0;
}

dm_arena *dm_arena_scratch(dm_arena *arena) {
    if (arena->scratch) {
        set_aside(arena->scratch);
    } else {
        arena->scratch = dm_arena_take(arena, sizeof *arena->scratch);
        if (arena->scratch) dm_arena_init(arena->scratch, arena->allocate, arena->ud);
    }
    return arena->scratch;
}

static void release_scratch(dm_arena *arena) {
    if (arena->scratch) dm_arena_release(arena->scratch);
    arena->scratch = NULL;
}

/* one chunk stays: the newest */
void dm_arena_reset(dm_arena *arena) {
    release_scratch(arena);
    if (!arena->chunks) return;
    release_chunks(arena, arena->chunks->next);
    arena->chunks->next = NULL;
    arena->used = 0;
}

/* things outside first: they may need what is in the arena */
void dm_arena_release(dm_arena *arena) {
    release_scratch(arena);
    for (const dm_arena_cleanup *c = arena->cleanups; c; c = c->next)
        c->give_back(c->thing, c->size);
    release_chunks(arena, arena->chunks);
    release_chunks(arena, arena->spare);
    dm_arena_init(arena, arena->allocate, arena->ud);
}
