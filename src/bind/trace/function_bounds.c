/* function_bounds.c - f:bounds: what a traced function can be on a box. */
#include "algebra/compact.h"
#include "bind/trace/function.h"
#include "graph/clear.h"

#include <math.h>

/* one end of the box, an argument at stack index `at`, into out[count] */
static void read_end(lua_State *L, int at, int count, const char *what, double *out) {
    if (count == DML_SCALAR_ARGUMENT) {
        if (lua_type(L, at) != LUA_TNUMBER)
            luaL_error(L, "f:bounds: %s must be a number (got %s)", what, luaL_typename(L, at));
        *out = lua_tonumber(L, at);
        return;
    }
    if (dml_length(L, at) != count)
        luaL_error(L, "f:bounds: %s must be a list or vector of %d numbers", what, count);
    for (int i = 0; i < count; i++) {
        const dml_scalar x = dml_entry(L, at, (uint32_t)i);
        if (x.kind != DML_NUMBER)
            luaL_error(L, "f:bounds: entry %d of %s is no number", i + 1, what);
        out[i] = x.as.number;
    }
}

/* all arguments of a corner of the box: the one argument at `at`, or a list of several */
static void read_corner(lua_State *L, const dml_function *f, int at, const char *what,
                        double *out) {
    if (f->s.arguments == 1) {
        read_end(L, at, f->s.length[0], what, out);
        return;
    }
    if (!lua_istable(L, at))
        luaL_error(L, "f:bounds: %s must be a list of %d arguments, as f takes them", what,
                   f->s.arguments);
    for (int k = 0; k < f->s.arguments; k++) {
        const int scalar = f->s.length[k] == DML_SCALAR_ARGUMENT;
        lua_geti(L, at, k + 1);
        const int place = lua_gettop(L);
        const char *which = lua_pushfstring(L, "argument %d of %s", k + 1, what);
        read_end(L, place, f->s.length[k], which, out);
        lua_pop(L, 2);
        out += scalar ? 1 : f->s.length[k];
    }
}

/* lo and hi from stack index 2 on */
static void read_box(lua_State *L, const dml_function *f, double *corner, dm_interval *box) {
    read_corner(L, f, 2, "lo", corner);
    read_corner(L, f, 3, "hi", corner + f->inputs);
    for (uint32_t i = 0; i < f->inputs; i++) {
        const double lo = corner[i], hi = corner[f->inputs + i];
        if (!(lo <= hi))
            luaL_error(L,
                       "f:bounds(lo, hi): lo must be at most hi, and both numbers (input %d: %f, "
                       "%f)",
                       (int)i + 1, lo, hi);
        box[i] = (dm_interval){lo, hi};
    }
}

/* a number, a list, or rows of lists */
static void push_end(lua_State *L, const dml_function *f, const dm_interval *value, int upper) {
    const dm_node *roots = f->alone_roots;
    if (f->rank == 0) {
        lua_pushnumber(L, upper ? value[roots[0]].hi : value[roots[0]].lo);
        return;
    }
    lua_createtable(L, (int)f->rows, 0);
    for (uint32_t i = 0; i < f->rows; i++) {
        if (f->rank == 2) lua_createtable(L, (int)f->columns, 0);
        for (uint32_t j = 0; j < f->columns; j++) {
            const dm_interval x = value[roots[(size_t)i * f->columns + j]];
            lua_pushnumber(L, upper ? x.hi : x.lo);
            lua_rawseti(L, -2, (lua_Integer)(f->rank == 2 ? j : i) + 1);
        }
        if (f->rank == 2) lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
}

/* dm_bounds walks over all nodes of a graph, so what the value does not need is left behind. */
void dml_function_alone(lua_State *L, dml_function *f) {
    const uint32_t m = dml_outputs(f);
    if (f->alone) return;
    dm_node *roots = dm_arena_take(f->arena, m * sizeof *roots);
    if (roots) f->alone = dm_graph_copy(f->graph, f->parts[DML_VALUE].nodes, m, roots);
    if (!f->alone) luaL_error(L, "not enough memory");
    f->alone_roots = roots;
}

/* (f, lo, hi) -> lo, hi */
int dml_function_bounds(lua_State *L) {
    dml_function *f = luaL_checkudata(L, 1, DML_FUNCTION);
    const uint32_t inputs = f->inputs;
    lua_settop(L, 3);
    double *corner = lua_newuserdatauv(L, 2 * (size_t)inputs * sizeof *corner, 0);
    dm_interval *box = lua_newuserdatauv(L, inputs * sizeof *box, 0);
    read_box(L, f, corner, box);
    dml_function_alone(L, f);
    dm_interval *value = lua_newuserdatauv(L, dm_graph_size(f->alone) * sizeof *value, 0);
    dm_bounds(f->alone, box, value);
    push_end(L, f, value, 0);
    push_end(L, f, value, 1);
    return 2;
}

/* from and to behind the list on top, or the end of its last interval */
static void add_interval(void *ud, double from, double to) {
    lua_State *L = ud;
    lua_Integer n = (lua_Integer)lua_rawlen(L, -1);
    if (n) {
        lua_rawgeti(L, -1, n);
        if (lua_tonumber(L, -1) == from) n -= 2;
        lua_pop(L, 1);
    }
    if (n == (lua_Integer)lua_rawlen(L, -1)) {
        lua_pushnumber(L, from);
        lua_rawseti(L, -2, n + 1);
    }
    lua_pushnumber(L, to);
    lua_rawseti(L, -2, n + 2);
}

/* (f, x, d, reach, fine) -> list */
int dml_function_clear(lua_State *L) {
    dml_function *f = luaL_checkudata(L, 1, DML_FUNCTION);
    const uint32_t inputs = f->inputs, m = dml_outputs(f);
    luaL_argcheck(L, f->s.arguments == 1 && f->s.length[0] != DML_SCALAR_ARGUMENT, 1,
                  "a function of one vector expected");
    lua_settop(L, 5);
    double *x = lua_newuserdatauv(L, 2 * (size_t)inputs * sizeof *x, 0);
    dml_vectorarg(L, 2, "x", x, inputs);
    dml_vectorarg(L, 3, "d", x + inputs, inputs);
    dml_function_alone(L, f);
    const size_t size = inputs + (size_t)dm_graph_size(f->alone);
    dm_interval *box = lua_newuserdatauv(L, size * sizeof *box, 0);
    dm_clear line = {.g = f->alone,
                     .roots = f->alone_roots,
                     .m = m,
                     .inputs = inputs,
                     .x = x,
                     .d = x + inputs,
                     .reach = dml_checknumber(L, 4),
                     .fine = dml_checknumber(L, 5),
                     .box = box,
                     .value = box + inputs,
                     .found = add_interval,
                     .ud = L};
    luaL_argcheck(L, line.reach > 0 && line.reach < 1e300, 4, "a finite length expected");
    luaL_argcheck(L, line.fine >= 1e-9, 5, "at least 1e-9 expected");
    line.vague = lua_newuserdatauv(L, m * sizeof *line.vague, 0);
    lua_newtable(L);
    dm_clear_line(&line);
    dml_setresult(L);
    return 1;
}
