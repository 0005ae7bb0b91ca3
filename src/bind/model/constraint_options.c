/* constraint_options.c - the functions that constrain a system or act on it, as options of a
 * script: their names, what they take, what they return as one list. */
#include "bind/model/model_constraints.h"

#include "bind/value/array.h"

static const char *const keys[] = {"constraint", "rolling", "control", "force",
                                   "reaction",   "map",     NULL};

/* constraint(q, t); force(q, v, t, u) where there are controls; map(q, p); all others (q, v, t);
 * rolling, force and reaction of a discrete Lagrangian (q0, q1), with h and params bound */
dml_signature dml_function_signature(const dml_model *m, int pair, int which) {
    const int n = (int)m->n;
    if (pair && which != DML_CONSTRAINT)
        return (
            dml_signature){.what = keys[which], .arguments = 2, .length = {n, n}, .may_grow = 1};
    if (which == DML_CONSTRAINT)
        return (dml_signature){.what = keys[which],
                               .arguments = 2,
                               .length = {n, DML_SCALAR_ARGUMENT},
                               .may_grow = 1};
    const int controls = (int)m->constraint[DML_CONTROL].outputs;
    return (dml_signature){.what = keys[which],
                           .arguments = which == DML_FORCE && controls ? 4 : 3,
                           .length = {n, n, DML_SCALAR_ARGUMENT, controls},
                           .may_grow = 1};
}

/* Is it given, of the system at arg? */
static int has_field(lua_State *L, int arg, const char *key) {
    const int there = dml_systemfield(L, arg, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

int dml_has_function(lua_State *L, int arg, int which) {
    return has_field(L, arg, keys[which]);
}

/* Forces and controls count, too. Options of a system stay as they are. */
int dml_isconstrained(lua_State *L, int arg) {
    dml_system *s = dml_checksystem(L, arg);
    for (const char *const *key = keys; !s->asked && *key; key++)
        s->constrained |= has_field(L, arg, *key);
    s->asked = 1;
    return s->constrained;
}

void dml_check_functions(lua_State *L, int hyperdual, int pair) {
    static const char *const of_pair[] =
        {"function(q) that returns what shall be zero",
         "function(q0, q1) or function(q0, q1, h) that returns what shall be zero",
         "",
         "function of (q0, q1 [, h]) that returns { F1, F2 }, the forces at q0 and at q1",
         "function(q0, q1) or function(q0, q1, h) that returns a row for every rolling one",
         "function of (q, p) at the start of a step that returns q, p at its end as one list"};
    static const char *const of_system[] =
        {"function(q) or function(q, t) that returns what shall be zero",
         "function(q, v) or function(q, v, t) that returns what shall be zero",
         "function(q, v) or function(q, v, t) that returns the controls u of a step",
         "function of (q, v [, t [, u]]), u the controls, that returns dim Q numbers",
         "function(q, v) or function(q, v, t) that returns a row for every rolling one",
         "function of (q, p) at the start of a step that returns q, p at its end as one list"};
    const char *const *forms = pair ? of_pair : of_system;
    for (int i = 0; keys[i]; i++, lua_pop(L, 1)) {
        const int type = lua_getfield(L, 1, keys[i]);
        if (type == LUA_TNIL) continue;
        if (type != LUA_TFUNCTION)
            luaL_error(L, "field '%s' must be a %s (got %s)", keys[i], forms[i],
                       luaL_typename(L, -1));
        if (hyperdual)
            luaL_error(L,
                       "field '%s': a system with constraints or a force needs their derivatives "
                       "as expressions; leave out derivatives = \"hyperdual\" and use dm.where, "
                       "dm.abs, dm.max to branch",
                       keys[i]);
    }
    const int control = lua_getfield(L, 1, "control") != LUA_TNIL;
    const int force = lua_getfield(L, 1, "force") != LUA_TNIL;
    lua_pop(L, 2);
    if (control && !force)
        luaL_error(L, "field 'control' gives what force(q, v, t, u) gets as u, and there is no "
                      "'force'");
    const int reaction = lua_getfield(L, 1, "reaction") != LUA_TNIL;
    const int rolling = lua_getfield(L, 1, "rolling") != LUA_TNIL;
    lua_pop(L, 2);
    if (pair && rolling && !reaction)
        luaL_error(L,
                   "field 'reaction' is missing: the rows that span the annihilator of E_d at q0, "
                   "in whose directions 'rolling' constraints of a discrete Lagrangian react");
    if (reaction && !rolling)
        luaL_error(L, "field 'reaction' gives the directions in which 'rolling' constraints react, "
                      "and there are none");
}

const char *dml_functionname(int which) {
    return keys[which];
}

/* entries of row i, on top of the stack: 1 of a number; raises where the first row has others */
static lua_Integer row_length(lua_State *L, lua_Integer i, lua_Integer first) {
    dml_scalar x;
    const int single = dml_toscalar(L, -1, &x) || dml_length(L, -1) < 0;
    const lua_Integer columns = single ? 1 : luaL_len(L, -1);
    if (i > 1 && columns != first)
        luaL_error(L, "rows of different lengths were returned: row 1 has %d entr%s, row %d has %d",
                   (int)first, first == 1 ? "y" : "ies", (int)i, (int)columns);
    return single ? 0 : columns;
}

/* f(...) with a matrix or a table of rows as one table of numbers */
static int flat_call(lua_State *L) {
    lua_Integer count = 0, first = 0;
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
    if (lua_gettop(L) != 1) return lua_gettop(L);
    if (!lua_istable(L, 1) && !dml_toarray(L, 1, 0)) return 1; /* no list: told by who asked */
    const lua_Integer rows = luaL_len(L, 1);
    const char *more = dml_surplus(L, 1, rows);
    if (more) dml_refuse_surplus(L, "the list that was returned", more, rows);
    lua_newtable(L);
    for (lua_Integer i = 1; i <= rows; i++, lua_pop(L, 1)) {
        lua_geti(L, 1, i);
        const lua_Integer columns = row_length(L, i, first);
        if (i == 1) first = columns ? columns : 1;
        if (!columns) {
            lua_pushvalue(L, -1);
            lua_rawseti(L, 2, ++count);
        }
        for (lua_Integer j = 1; j <= columns; j++) {
            lua_geti(L, -1, j);
            lua_rawseti(L, 2, ++count);
        }
    }
    return 1;
}

/* That of number `which`, with params bound, its result flattened to a list. */
void dml_push_constraint_function(lua_State *L, int arg, int which) {
    const int pair = dml_checksystem(L, arg)->pair;
    if (pair && which != DML_CONSTRAINT && which != DML_MAP)
        dml_pushboundpair(L, arg, keys[which]);
    else
        dml_pushbound(L, arg, keys[which]);
    if (which == DML_REACTION || (pair && which == DML_FORCE)) lua_pushcclosure(L, flat_call, 1);
}
