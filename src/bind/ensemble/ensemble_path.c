/* ensemble_path.c - the rows of a member of an ensemble as a dm.path. */
#include "bind/ensemble/bind_ensemble.h"
#include "bind/run/bind_path.h"

#include <string.h>

/* (solver, names, values, params) -> the solver with these values, on a stack of its own */
static int vary(lua_State *L) {
    dml_vary_solver(L, lua_touserdata(L, 3), 2, 4);
    lua_settop(L, 1);
    return 1;
}

/* push the solver that member i (from 0) ran with */
static dml_solver *push_solver(lua_State *L, long i) {
    const int top = lua_gettop(L);
    lua_pushcfunction(L, vary);
    lua_getiuservalue(L, 1, DML_ENSEMBLE_SOLVER);
    if (lua_getiuservalue(L, 1, DML_ENSEMBLE_NAMES) == LUA_TNIL) {
        lua_pop(L, 1);
        lua_remove(L, top + 1);
        return lua_touserdata(L, -1);
    }
    const size_t count = lua_rawlen(L, -1);
    lua_getiuservalue(L, 1, DML_ENSEMBLE_VARIED);
    const double *values = lua_touserdata(L, -1);
    lua_pop(L, 1);
    lua_pushlightuserdata(L, (void *)(values + (size_t)i * count));
    lua_getiuservalue(L, 1, DML_ENSEMBLE_PARAMS);
    lua_call(L, 4, 1);
    return lua_touserdata(L, -1);
}

/* push the model that the member ran with: that of all of them, as it was, or of the values that it
 * has for itself; the solver is at index `at` */
static void push_model(lua_State *L, int at) {
    const int own = lua_getiuservalue(L, 1, DML_ENSEMBLE_NAMES) != LUA_TNIL;
    const int kept = lua_getiuservalue(L, 1, DML_ENSEMBLE_MODEL) != LUA_TNIL;
    lua_remove(L, -2);
    if (kept && !own) return;
    lua_pop(L, 1);
    lua_getiuservalue(L, at, DML_SOLVER_SYSTEM);
    dml_pushmodel(L, lua_gettop(L));
    lua_remove(L, -2);
}

/* what a path says of itself; the solver is at index `at` */
static void describe(lua_State *L, int at, dml_path *path, const dml_ensemble *e, long i) {
    lua_getiuservalue(L, at, DML_SOLVER_RULE);
    path->h = e->pace ? e->pace[i].h : e->h, path->t0 = e->t0;
    path->rule = lua_tostring(L, -1);
    lua_setiuservalue(L, -2, DML_PATH_RULE);
    push_model(L, at);
    lua_setiuservalue(L, -2, DML_PATH_MODEL);
    lua_getiuservalue(L, 1, DML_ENSEMBLE_COLUMNS);
    path->watched = !lua_isnil(L, -1) && !e->rows.beside;
    lua_setiuservalue(L, -2, DML_PATH_NAMES);
}

int dml_ensemble_path(lua_State *L) {
    const dml_ensemble *e = luaL_checkudata(L, 1, DML_ENSEMBLE);
    const lua_Integer member = dml_checkinteger(L, 2);
    lua_settop(L, 2);
    if (member < 1 || member > e->members)
        luaL_error(L, "ensemble:path: there are members 1 to %I (got %I)", (LUAI_UACINT)e->members,
                   (LUAI_UACINT)member);
    const long i = (long)member - 1;
    if (!e->rows.room)
        luaL_error(L, "this ensemble kept only the ends: ask for rows with every = or watch = { "
                      "... }");
    push_solver(L, (long)i);
    lua_getiuservalue(L, 3, DML_SOLVER_SYSTEM);
    const long rows = e->rows.count[i];
    const uint32_t width = e->rows.width;
    dml_path *path = dml_pushpath(L, 4, e->n, rows, width);
    describe(L, 3, path, e, (long)i);
    memcpy(path->data, dm_ensemble_rows_of(&e->rows, (long)i),
           (size_t)rows * width * sizeof(double));
    path->rows = rows;
    path->steps = e->member[i].steps;
    path->t = rows ? path->data[(size_t)(rows - 1) * width] : e->t0;
    return 1;
}
