#include "mech/group_map.h"

#include "algebra/derive.h"
#include "code/native/jit.h"
#include "graph/analyse.h"

#include <string.h>

enum { MANY = 2048 }; /* operations of the values from which the matrix is made by rows */

/* ---- making ---- */

static dm_status make_whole(dm_group_map *out, dm_graph *g, const dm_node *f, uint32_t first,
                            dm_compile *compile, dm_arena *arena) {
    const size_t matrix = (size_t)out->values * out->columns, all = out->values + matrix;
    dm_node *roots = dm_arena_take(arena, all * sizeof *roots);
    if (!roots) return DM_NO_MEMORY;
    memcpy(roots, f, out->values * sizeof *roots);
    dm_jacobian(g, f, out->values, first, out->columns, roots + out->values);
    dm_status status = dm_graph_status(g);
    if (status == DM_OK) status = compile(&out->plain, g, f, out->values, arena);
    return status == DM_OK ? compile(&out->whole, g, roots, (uint32_t)all, arena) : status;
}

/* Rows side by side, where the kernel of one member is native. */
static dm_status compile_row(dm_group_map *out, dm_graph *g, const dm_node *row,
                             dm_compile *compile, dm_arena *arena) {
    const uint32_t lanes = dm_jit_lanes();
    out->lanes = lanes;
    if (compile == dm_native_build && lanes > 1 &&
        dm_jit_build_lanes(&out->row, g, row, out->columns, lanes, arena) == DM_OK)
        return DM_OK;
    out->lanes = 1;
    return compile(&out->row, g, row, out->columns, arena);
}

/* d(w . f), by one reverse sweep */
static dm_status make_row(dm_group_map *out, dm_graph *from, const dm_node *f, uint32_t first,
                          dm_compile *compile, dm_arena *arena) {
    const uint32_t inputs = out->inputs, values = out->values;
    dm_graph *g = dm_graph_new(arena, inputs + values);
    dm_node *with = dm_arena_take(arena, (inputs + 1) * sizeof *with), sum = 0;
    dm_node *here = dm_arena_take(arena, values * sizeof *here);
    dm_node *row = dm_arena_take(arena, out->columns * sizeof *row);
    if (!g || !with || !here || !row) return DM_NO_MEMORY;
    dm_inputs(g, with, 0, inputs);
    dm_transplant(g, from, f, values, with, here);
    for (uint32_t i = 0; i < values; i++)
        sum = dm_add(g, sum, dm_mul(g, dm_input(g, inputs + i), here[i]));
    dm_gradient(g, sum, first, out->columns, row);
    const dm_status status = dm_graph_status(g);
    return status == DM_OK ? compile_row(out, g, row, compile, arena) : status;
}

dm_status dm_group_map_make(dm_group_map *out, dm_graph *g, const dm_node *f, uint32_t values,
                            uint32_t first, uint32_t columns, dm_compile *compile,
                            dm_arena *arena) {
    *out = (dm_group_map){.inputs = dm_graph_inputs(g), .values = values, .columns = columns};
    if (dm_graph_status(g) != DM_OK) return dm_graph_status(g);
    if (dm_operations(g, f, values) <= MANY) return make_whole(out, g, f, first, compile, arena);
    const dm_status status = compile(&out->plain, g, f, values, arena);
    return status == DM_OK ? make_row(out, g, f, first, compile, arena) : status;
}

/* ---- evaluating ---- */

static void prepare(const dm_kernel *k, uint32_t width, double *out) {
    if (width > 1)
        dm_kernel_prepare_lanes(k, width, out);
    else
        dm_kernel_prepare(k, out);
}

void dm_group_map_prepare(const dm_group_map *m, uint32_t members, double *out) {
    prepare(m->whole.outputs ? &m->whole : &m->plain, members, out);
}

/* what a call of `row` works on: members in its lanes, or rows of one member */
typedef struct {
    uint32_t members, width, rows; /* lanes, and rows a call */
    double *in, *weight, *row;     /* [inputs][width], [values][width], [columns][width] */
} calls;

static calls calls_of(const dm_group_map *m, uint32_t members, double *room) {
    calls c = {.members = members, .width = m->lanes, .rows = m->lanes, .in = room};
    if (members > 1) c.width = members, c.rows = 1;
    c.weight = c.in + (size_t)m->inputs * c.width;
    c.row = c.weight + (size_t)m->values * c.width;
    return c;
}

/* of one member into all lanes */
static void place_inputs(const dm_group_map *m, const calls *c, const double *in) {
    for (size_t i = 0; i < m->inputs; i++)
        for (size_t l = 0; l < c->width; l++)
            c->in[i * c->width + l] = c->members > 1 ? in[i * c->width + l] : in[i];
}

/* 1 for the values whose rows are asked for, from `first` on */
static void weigh(const dm_group_map *m, const calls *c, uint32_t first) {
    memset(c->weight, 0, (size_t)m->values * c->width * sizeof *c->weight);
    for (uint32_t l = 0; l < c->width; l++) {
        const uint32_t i = first + (c->rows > 1 ? l : 0);
        if (i < m->values) c->weight[(size_t)i * c->width + l] = 1.0;
    }
}

/* into the matrix, row by row */
static void take_rows(const dm_group_map *m, const calls *c, uint32_t first, double *matrix) {
    const size_t columns = m->columns, size = columns * c->members;
    if (c->rows == 1) {
        memcpy(matrix + first * size, c->row, size * sizeof *matrix);
        return;
    }
    for (uint32_t l = 0; l < c->rows && first + l < m->values; l++)
        for (size_t k = 0; k < columns; k++)
            matrix[(first + l) * columns + k] = c->row[k * c->width + l];
}

void dm_group_map_eval(const dm_group_map *m, const double *in, double *out, uint32_t members,
                       double *room) {
    const calls c = calls_of(m, members, room);
    if (m->whole.outputs) {
        dm_kernel_eval(&m->whole, in, out);
        return;
    }
    dm_kernel_eval(&m->plain, in, out);
    place_inputs(m, &c, in);
    prepare(&m->row, c.width, c.row);
    for (uint32_t first = 0; first < m->values; first += c.rows) {
        weigh(m, &c, first);
        dm_kernel_eval(&m->row, c.in, c.row);
        take_rows(m, &c, first, out + (size_t)m->values * members);
    }
}
