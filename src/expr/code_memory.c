#define _GNU_SOURCE /* MAP_ANONYMOUS */
#include "expr/code_memory.h"

#include <string.h>
#include <sys/mman.h>

typedef struct {
    void *at;
    size_t size;
} mapping;

static void unmap(void *ud) {
    const mapping *m = ud;
    if (m->at) munmap(m->at, m->size);
}

dm_status dm_code_place(const void **code, const unsigned char *bytes, size_t size,
                        dm_arena *arena) {
    mapping *m = dm_arena_take(arena, sizeof *m);
    if (!m) return DM_NO_MEMORY;
    *m = (mapping){NULL, size};
    if (!dm_arena_on_release(arena, unmap, m)) return DM_NO_MEMORY;
    void *at =
        mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (at == MAP_FAILED) return DM_NO_NATIVE;
    m->at = at;
    memcpy(at, bytes, size);
    if (mprotect(at, size, PROT_READ | PROT_EXEC) != 0) return DM_NO_NATIVE;
    *code = at;
    return DM_OK;
}
