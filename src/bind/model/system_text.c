/* system_text.c - a system as text: what tostring says of it, and L for graphviz. */
#include "bind/model/model_constraints.h"
#include "bind/model/named.h"
#include "graph/analyse.h"

static void put(void *ud, const char *text, size_t length) {
    luaL_addlstring(ud, text, length);
}

/* names of the inputs of L for a listing: q, v by their coordinates, then t */
static const char *const *input_names(lua_State *L, const dml_system *s) {
    const char **names = lua_newuserdatauv(L, (2 * (size_t)s->n + 1) * sizeof *names, 1);
    lua_newtable(L); /* keeps the strings */
    for (uint32_t i = 0; i < s->n; i++) {
        names[i] = dml_coordinate(L, 1, i);
        lua_rawseti(L, -2, 2 * (lua_Integer)i + 1);
        names[s->n + i] = lua_pushfstring(L, "%s%s", s->hamiltonian ? "p_" : "d", names[i]);
        lua_rawseti(L, -2, 2 * (lua_Integer)i + 2);
    }
    lua_setiuservalue(L, -2, 1);
    names[2 * s->n] = "t";
    return names;
}

/* L in the language of graphviz. */
int dml_system_graph(lua_State *L) {
    const dml_system *s = luaL_checkudata(L, 1, DML_SYSTEM);
    const char *const *names = input_names(L, s);
    dml_model *m = dml_pushmodel(L, 1);
    luaL_Buffer b;
    dml_writeout(L, m);
    if (!m->graph) return luaL_error(L, "this system runs on hyper-dual numbers: it has no graph");
    luaL_buffinit(L, &b);
    dm_print(m->graph, &m->lagrangian, 1, names, put, &b);
    luaL_pushresult(&b);
    return 1;
}

/* "2 constraints", with a comma where something stands before it. */
static void add_count(lua_State *L, luaL_Buffer *b, uint32_t count, const char *what) {
    if (!count) return;
    lua_pushfstring(L, ", %d %s%s", (int)count, what, count > 1 ? "s" : "");
    luaL_addvalue(b);
}

/* "2 constraints, 1 rolling constraint, a force" */
static void describe_constraints(lua_State *L, luaL_Buffer *b, const dml_model *m) {
    add_count(L, b, m->constraints.holonomic, "constraint");
    add_count(L, b, m->constraints.rolling, "rolling constraint");
    if (m->constraints.forced || m->model.worked) luaL_addstring(b, ", a force");
    add_count(L, b, m->constraints.controls, "control");
}

/* (system) -> the structure of L and its constraints in words; raises what L raises */
static int model_text(lua_State *L) {
    const dml_system *s = luaL_checkudata(L, 1, DML_SYSTEM);
    luaL_Buffer b;
    dml_model *m = dml_pushmodel(L, 1);
    dml_asgiven(L, m);
    const unsigned bits = m->model.structure;
    luaL_buffinit(L, &b);
    if (s->hyperdual)
        luaL_addstring(&b, "L on hyper-dual numbers");
    else {
        luaL_addstring(&b, s->hamiltonian          ? "H as it stands, "
                           : bits & DM_NO_VELOCITY ? "no velocity in L, "
                           : bits & DM_LINEAR_IN_V ? "linear in v, "
                           : bits & DM_SEPARABLE   ? "separable, "
                                                   : "not separable, ");
        if (!(bits & (DM_LINEAR_IN_V | DM_HAMILTONIAN)))
            luaL_addstring(&b, bits & DM_CONSTANT_MASS ? "constant mass, "
                                                       : "mass depends on the state, ");
        if (!(bits & DM_AUTONOMOUS)) luaL_addstring(&b, "depends on time, ");
        lua_pushfstring(L, "%d operations, derivatives exact", (int)m->model.operations);
        luaL_addvalue(&b);
    }
    describe_constraints(L, &b, m);
    luaL_pushresult(&b);
    return 1;
}

/* Name, space, and how many constraints; or why its functions fail now, when a global of theirs is
 * gone, say: printing does not raise. */
int dml_system_tostring(lua_State *L) {
    const dml_system *s = luaL_checkudata(L, 1, DML_SYSTEM);
    dml_systemfield(L, 1, "name");
    const char *name = lua_tostring(L, -1);
    dml_systemfield(L, 1, "Q");
    const char *Q = luaL_tolstring(L, -1, NULL);
    if (s->stand_in) {
        lua_pushfstring(L, name ? "discrete Lagrangian '%s' on %s" : "discrete Lagrangian%s on %s",
                        name ? name : "", Q);
        return 1;
    }
    if (name)
        lua_pushfstring(L, "system '%s' on %s: ", name, Q);
    else
        lua_pushfstring(L, "system on %s: ", Q);
    lua_pushcfunction(L, model_text);
    lua_pushvalue(L, 1);
    if (!dml_try(L, 1, 1)) {
        const char *why = lua_tostring(L, -1);
        lua_pushfstring(L, "its functions fail now: %s", why ? why : "an error that is no text");
        lua_remove(L, -2);
    }
    lua_concat(L, 2);
    return 1;
}
