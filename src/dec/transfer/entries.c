/* entries.c - three arrays that double when they are full. */
#include "dec/transfer/entries.h"

/* An array that has grown is kept at once: if the next one cannot, nothing is lost. */
static int grow(dm_entries *e) {
    const size_t room = e->room ? 2 * e->room : 1024;
    int32_t *row = dm_arena_grow(e->arena, e->row, e->room * sizeof *row, room * sizeof *row);
    if (row) e->row = row;
    int32_t *column =
        dm_arena_grow(e->arena, e->column, e->room * sizeof *column, room * sizeof *column);
    if (column) e->column = column;
    double *value =
        dm_arena_grow(e->arena, e->value, e->room * sizeof *value, room * sizeof *value);
    if (value) e->value = value;
    if (!row || !column || !value) return 0;
    e->room = room;
    return 1;
}

int dm_entries_add(dm_entries *e, uint32_t row, uint32_t column, double value) {
    if (value == 0.0) return 1;
    if (e->count == e->room && !grow(e)) return 0;
    e->row[e->count] = (int32_t)row;
    e->column[e->count] = (int32_t)column;
    e->value[e->count++] = value;
    return 1;
}
