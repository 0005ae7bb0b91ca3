/* entries.h - entries of a sparse matrix as they come, in memory that grows. */
#ifndef DM_TRANSFER_ENTRIES_H
#define DM_TRANSFER_ENTRIES_H

#include "linalg/sparse/sparse.h"

typedef struct {
    dm_arena *arena;
    size_t count, room;
    int32_t *row, *column;
    double *value;
} dm_entries;

/* 0 without memory; entries that are 0 are left out. */
int dm_entries_add(dm_entries *e, uint32_t row, uint32_t column, double value);

#endif
