/* code_memory.h - memory that the processor may execute; the only place that maps any. */
#ifndef DM_CODE_MEMORY_H
#define DM_CODE_MEMORY_H

#include "base/arena.h"
#include "base/status.h"

/* A copy of bytes[size] that can be executed and no longer written; unmapped when the arena is
 * released. DM_NO_NATIVE when the system refuses executable memory, DM_NO_MEMORY. */
dm_status dm_code_place(const void **code, const unsigned char *bytes, size_t size,
                        dm_arena *arena);

#endif
