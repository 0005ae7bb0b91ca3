/* cell_map.c - drafts of array loops over the cells of a line.
 * Outputs of one loop share what they have in common; those of two loops compute it twice. */
#include "field/line/cell_map.h"

#include "algebra/derive.h"

/* where input k of a cell stands, relative to the arrays at its number */
static dm_array_ref place_of(const dm_cell_layout *l, uint32_t k) {
    const uint32_t n = l->values;
    if (k < 4 * n) {
        const uint32_t right = k / n % 2, value = k % n;
        const size_t at = k < 2 * n ? dm_cell_lower(l, value) : dm_cell_upper(l, value);
        return (dm_array_ref){DM_ARRAY_MAIN, (int64_t)at + right};
    }
    if (k < 4 * n + l->columns)
        return (dm_array_ref){DM_ARRAY_MAIN, (int64_t)dm_cell_column(l, k - 4 * n)};
    return (dm_array_ref){DM_ARRAY_SCALAR, k - 4 * n - l->columns};
}

/* roots[m], which stand behind `before` others in the buffer */
static dm_status build_loop(dm_array_loop *out, const dm_cell_layout *l, dm_graph *g,
                            const dm_node *roots, uint32_t before, uint32_t m, dm_compile *compile,
                            dm_arena *arena) {
    dm_array_loop_draft d;
    dm_node with[DM_ARRAY_LOOP_MOST], node[DM_CELL_MOST];
    const uint32_t inputs = dm_cell_inputs(l);
    if (!dm_array_loop_begin(&d, arena)) return DM_NO_MEMORY;
    if (inputs > DM_ARRAY_LOOP_MOST) return DM_TOO_LARGE;
    for (uint32_t k = 0; k < inputs; k++) with[k] = dm_array_loop_read(&d, place_of(l, k));
    dm_transplant(d.g, g, roots, m, with, node);
    for (uint32_t k = 0; k < m; k++)
        dm_array_loop_write(&d,
                            (dm_array_ref){DM_ARRAY_BUFFER, (int64_t)(before + k) * DM_CELL_BLOCK},
                            node[k]);
    return dm_array_loop_end(out, &d, compile, arena);
}

/* The same inputs in every loop. */
dm_status dm_cell_map_build(dm_cell_map *out, const dm_cell_layout *layout, dm_graph *g,
                            const dm_node *roots, uint32_t m, dm_compile *compile,
                            dm_arena *arena) {
    const uint32_t loops = (m + DM_CELL_MOST - 1) / DM_CELL_MOST;
    if (loops > DM_CELL_LOOPS) return DM_TOO_LARGE;
    dm_array_loop *loop = dm_arena_take(arena, (loops + 1) * sizeof *loop);
    if (!loop) return DM_NO_MEMORY;
    for (uint32_t k = 0; k < loops; k++) {
        const uint32_t before = k * DM_CELL_MOST, left = m - before;
        const uint32_t part = left < DM_CELL_MOST ? left : DM_CELL_MOST;
        const dm_status status =
            build_loop(loop + k, layout, g, roots + before, before, part, compile, arena);
        if (status != DM_OK) return status;
    }
    *out = (dm_cell_map){loop, loops, m};
    return DM_OK;
}

/* A block of outputs stays in the first cache for whoever reads it next. */
void dm_cell_map_run(const dm_cell_map *f, double *memory, const double *scalars, double *buffer,
                     uint32_t first, uint32_t count) {
    const dm_array_bases at = {.main = memory + first, .buffer = buffer, .scalars = scalars};
    for (uint32_t k = 0; k < f->loops; k++) dm_array_loop_run(f->loop + k, at, count);
}
