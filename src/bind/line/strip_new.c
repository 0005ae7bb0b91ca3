/* strip_new.c - making a strip: its function traced and differentiated, its maps. */
#include "bind/line/bind_strip.h"

#include "algebra/derive.h"
#include "bind/dec/bind_sparse.h"
#include "bind/trace/backend.h"
#include "bind/trace/trace.h"
#include "code/tape/tape.h"

#include <string.h>

enum { MOST_VALUES = 20, MOST_CELLS = 10000000 };

/* The strip at stack index 1. */
dml_strip *dml_checkstrip(lua_State *L) {
    return luaL_checkudata(L, 1, DML_STRIP);
}

/* What went wrong in the graph or its kernels, in words about L. */
static void check_status(lua_State *L, dm_status status) {
    if (status == DM_OK) return;
    if (status == DM_TOO_LARGE)
        luaL_error(L, "L is too large a function of a cell: it has too many values or points");
    luaL_error(L, "L: %s", dm_status_text(status));
}

/* Of the arena; raises without memory. */
static void *take(lua_State *L, dm_arena *arena, size_t size) {
    void *block = dm_arena_take(arena, size);
    if (!block) luaL_error(L, "not enough memory");
    return block;
}

/* ---- maps, each made when it is first needed ---- */

/* the map of roots[m], made now where it is not there */
dm_cell_map *dml_stripmap(lua_State *L, dml_strip *d, dm_cell_map *map, const dm_node *roots,
                          uint32_t m) {
    if (map->loop) return map;
    check_status(L, dm_graph_status(d->graph));
    check_status(L, dm_cell_map_build(map, &d->strip.layout, d->graph, roots, m, d->compile,
                                      d->arena));
    if (m <= d->largest) return map;
    const size_t size = ((size_t)m + 1) * DM_CELL_BLOCK * sizeof(double);
    d->room.buffer = take(L, d->arena, size);
    memset(d->room.buffer, 0, size);
    d->largest = m;
    return map;
}

/* Room for nodes, which stay as long as the strip. */
static dm_node *nodes_of(lua_State *L, dml_strip *d, size_t count) {
    return take(L, d->arena, count * sizeof(dm_node));
}

/* R, and R with dR/dupper */
void dml_strip_wantstep(lua_State *L, dml_strip *d) {
    const uint32_t n = d->strip.layout.values, rows = dm_strip_rows(&d->strip);
    dml_stripmap(L, d, &d->strip.equation, d->slopes, rows);
    if (d->strip.tangent.loop) return;
    dm_node *roots = nodes_of(L, d, rows + 2 * (size_t)n * rows);
    memcpy(roots, d->slopes, rows * sizeof *roots);
    dm_jacobian(d->graph, d->slopes, rows, 2 * n, 2 * n, roots + rows);
    dml_stripmap(L, d, &d->strip.tangent, roots, rows + 2 * n * rows);
}

/* S_upper */
void dml_strip_wantafter(lua_State *L, dml_strip *d) {
    const uint32_t n = d->strip.layout.values;
    dml_stripmap(L, d, &d->strip.after, d->slopes + 2 * (size_t)n, 2 * n);
}

/* -S_h, S_t; where S_t is the number 0 nothing depends on time */
static void clock_of(dml_strip *d, dm_node *energy) {
    const uint32_t first = 4 * d->strip.layout.values + d->strip.layout.columns;
    dm_node slope[DM_STRIP_SCALARS];
    dm_gradient(d->graph, *d->out, first, DM_STRIP_SCALARS, slope);
    double zero;
    d->strip.autonomous = dm_is_constant(d->graph, slope[DM_STRIP_TIME], &zero) && zero == 0.0;
    energy[0] = dm_neg(d->graph, slope[DM_STRIP_HEIGHT]);
    energy[1] = slope[DM_STRIP_TIME];
}

/* -S_h and S_t */
void dml_strip_wantenergy(lua_State *L, dml_strip *d) {
    if (d->strip.energy.loop) return;
    dm_node *energy = nodes_of(L, d, 2);
    clock_of(d, energy);
    dml_stripmap(L, d, &d->strip.energy, energy, 2);
}

/* G, G_upper, G_h, dS_lower/dh */
void dml_strip_wantclock(lua_State *L, dml_strip *d) {
    const uint32_t n = d->strip.layout.values, height = 4 * n + d->strip.layout.columns + 1;
    if (d->strip.clock.loop) return;
    dm_node energy[2], *roots = nodes_of(L, d, 2 + 4 * (size_t)n);
    clock_of(d, energy);
    roots[0] = dm_add(d->graph, energy[0], energy[1]);
    dm_gradient(d->graph, roots[0], 2 * n, 2 * n, roots + 1);
    dm_gradient(d->graph, roots[0], height, 1, roots + 1 + 2 * (size_t)n);
    dm_jacobian(d->graph, d->slopes, 2 * n, height, 1, roots + 2 + 2 * (size_t)n);
    dml_stripmap(L, d, &d->strip.clock, roots, 2 + 4 * n);
}

/* symmetric where it is that of S: the same node at (i, j) and (j, i) */
void dml_strip_wanthessian(lua_State *L, dml_strip *d) {
    const uint32_t n = 4 * d->strip.layout.values, rows = d->strip.boxes ? n / 4 : n;
    if (d->strip.hessian.loop) return;
    dm_node *roots = nodes_of(L, d, (size_t)rows * n), *slopes = nodes_of(L, d, n);
    if (d->strip.boxes)
        dm_jacobian(d->graph, d->out, rows, 0, n, roots);
    else
        dm_hessian(d->graph, *d->out, 0, n, slopes, roots);
    dml_stripmap(L, d, &d->strip.hessian, roots, rows * n);
}

/* ---- making one ---- */

/* A whole number of the options at 2, which may not be left out. */
static uint32_t count_of(lua_State *L, const char *key, long least, long most) {
    const long n = dml_count(L, 2, key, least, least - 1);
    if (n > most) luaL_error(L, "option '%s' must be at most %d", key, (int)most);
    return (uint32_t)n;
}

/* option `key`, a vector of count numbers, in the arena */
static double *numbers_of(lua_State *L, dml_strip *d, const char *key, uint32_t count) {
    double *x = take(L, d->arena, (count + 1) * sizeof *x);
    const int top = lua_gettop(L);
    lua_getfield(L, 2, key);
    memcpy(x, dml_numbersat(L, top + 1, key, (int32_t)count), count * sizeof *x);
    lua_settop(L, top);
    return x;
}

/* what the options say, without the function */
static void read_shape(lua_State *L, dml_strip *d) {
    dm_strip *s = &d->strip;
    s->cells = count_of(L, "cells", 1, MOST_CELLS);
    s->nodes = s->cells + !dml_flag(L, 2, "ring", 0);
    s->boxes = dml_flag(L, 2, "boxes", 0);
    s->layout = (dm_cell_layout){.values = count_of(L, "values", 1, MOST_VALUES),
                                 .columns = 1,
                                 .scalars = DM_STRIP_SCALARS,
                                 .stride = dm_strip_stride(s->cells)};
    s->moving = (uint32_t)dml_count(L, 2, "moving", 0, 0);
    s->width = dml_number(L, 2, "width", 0.0);
    const uint32_t n = dm_strip_unknowns(s);
    const double *held = numbers_of(L, d, "held", n);
    uint8_t *marks = take(L, d->arena, n);
    for (uint32_t i = 0; i < n; i++) marks[i] = held[i] != 0.0;
    s->held = marks;
    const double *absorbs = numbers_of(L, d, "absorbs", 2);
    s->absorbs[0] = absorbs[0], s->absorbs[1] = absorbs[1];
}

/* what the traced function takes and gives */
static dml_signature signature_of(const dml_strip *d) {
    const int n = (int)d->strip.layout.values;
    return (dml_signature){.what = d->strip.boxes ? "S" : "L",
                           .arguments = 4,
                           .length = {2 * n, 2 * n, 1, DM_STRIP_SCALARS},
                           .outputs = d->strip.boxes ? n : DML_SCALAR_ARGUMENT};
}

/* trace the function at 1, compare it with plain calls, differentiate it */
static void trace(lua_State *L, dml_strip *d) {
    const int n = (int)d->strip.layout.values;
    const dml_signature signature = signature_of(d);
    dm_kernel plain;
    dml_retrace(L, 1, &signature, d->arena, NULL, &d->trace);
    const dml_traced t = d->trace;
    check_status(L, dm_tape_build(&plain, t.graph, t.out, t.outputs, d->arena));
    dml_trace_check(L, 1, &signature, &plain, NULL);
    d->graph = t.graph;
    d->out = t.out;
    d->slopes = nodes_of(L, d, 4 * (size_t)n);
    if (d->strip.boxes)
        memcpy(d->slopes, t.out, (size_t)n * sizeof *t.out);
    else
        dm_gradient(t.graph, *t.out, 0, 4 * (uint32_t)n, d->slopes);
    check_status(L, dm_graph_status(t.graph));
}

int dml_strip_follows(lua_State *L, const dml_strip *d) {
    const dml_signature signature = signature_of(d);
    dml_traced now;
    dml_retrace(L, 2, &signature, dml_pusharena(L), &d->trace, &now);
    const int same = now.graph == d->trace.graph;
    if (same) dml_sparearena(L, lua_gettop(L));
    return same;
}

/* core.strip(f, options) */
int dml_strip_new(lua_State *L) {
    static const char *const known[] = {"values", "cells",   "ring",   "boxes", "held",
                                        "place",  "absorbs", "moving", "width", NULL};
    luaL_checktype(L, 2, LUA_TTABLE);
    lua_settop(L, 2);
    dml_options(L, 2, known);
    dml_strip *d = lua_newuserdatauv(L, sizeof *d, 2);
    *d = (dml_strip){.compile = dml_findbackend(L, NULL)->compile};
    d->arena = dml_pusharena(L);
    lua_setiuservalue(L, 3, 1);
    read_shape(L, d);
    trace(L, d);
    d->large = dml_pusharena(L);
    d->large->exact = 1;
    lua_setiuservalue(L, 3, 2);
    if (!dm_strip_open(&d->room, &d->strip, d->large)) luaL_error(L, "not enough memory");
    lua_getfield(L, 2, "place");
    memcpy(d->room.memory + dm_cell_column(&d->strip.layout, 0),
           dml_numbersat(L, 4, "place", (int32_t)d->strip.cells), d->strip.cells * sizeof(double));
    lua_settop(L, 3);
    luaL_setmetatable(L, DML_STRIP);
    return 1;
}
