/* path_new.c - what paths say of themselves; dm.path{...}: one from columns computed elsewhere. */
#include "bind/run/stepping.h"

#include <string.h>

/* column c (from 0) of the list at `list` into the rows of p */
static void read_column(lua_State *L, int list, uint32_t c, dml_path *p, double *column) {
    const char *what = lua_pushfstring(L, "column %d", (int)c + 1);
    lua_geti(L, list, (lua_Integer)c + 1);
    if (dml_length(L, -1) != p->rows)
        luaL_error(L, "%s must have one number for each of the %d times", what, (int)p->rows);
    dml_vectorarg(L, lua_gettop(L), what, column, (uint32_t)p->rows);
    for (long i = 0; i < p->rows; i++) p->data[(size_t)i * p->width + c] = column[i];
    lua_pop(L, 2);
}

/* the list of columns at the top: t, then q and p; the number of rows */
static long check_columns(lua_State *L, uint32_t states) {
    const lua_Integer count = lua_istable(L, -1) ? luaL_len(L, -1) : -1;
    if (count != (lua_Integer)states + 1)
        luaL_error(L, "field 'columns' must be a list of %d columns: t, the q, the p",
                   (int)states + 1);
    lua_geti(L, -1, 1);
    const long rows = dml_length(L, -1);
    if (rows < 1) luaL_error(L, "field 'columns': the first must be a vector of times");
    lua_pop(L, 1);
    return rows;
}

/* The rule is a text of the user's, kept by the path; the path is on top. */
static void describe(lua_State *L, dml_path *p, const char *rule, long steps) {
    p->h = dml_positive(L, 1, "h", 0);
    p->t0 = p->data[0];
    p->t = p->data[(size_t)(p->rows - 1) * p->width];
    p->steps = steps;
    lua_pushstring(L, rule);
    p->rule = lua_tostring(L, -1);
    lua_setiuservalue(L, -2, DML_PATH_RULE);
}

/* (options) -> path, whose rows are copies of the columns */
int dml_path_new(lua_State *L) {
    static const char *const known[] = {"system", "h", "rule", "steps", "columns", NULL};
    lua_settop(L, 1);
    luaL_checktype(L, 1, LUA_TTABLE);
    dml_options(L, 1, known);
    lua_getfield(L, 1, "system");
    if (!luaL_testudata(L, 2, DML_SYSTEM))
        luaL_error(L, "field 'system' must be a dm.system (got %s)", luaL_typename(L, 2));
    lua_getfield(L, 1, "rule");
    const char *rule = luaL_optstring(L, 3, "columns");
    const uint32_t n = dml_checksystem(L, 2)->n, states = n + dml_checksystem(L, 2)->momenta;
    lua_getfield(L, 1, "columns");
    const long rows = check_columns(L, states), steps = dml_count(L, 1, "steps", 0, rows - 1);
    dml_path *p = dml_pushpath(L, 2, n, rows, states + 1);
    double *column = lua_newuserdatauv(L, (size_t)rows * sizeof *column, 0);
    p->rows = rows;
    for (uint32_t c = 0; c < p->width; c++) read_column(L, 4, c, p, column);
    for (long i = 1; i < rows; i++)
        if (!(p->data[(size_t)i * p->width] > p->data[(size_t)(i - 1) * p->width]))
            luaL_error(L, "field 'columns': the times must grow (they do not at row %d)",
                       (int)i + 1);
    lua_settop(L, 5);
    describe(L, p, rule, steps);
    dml_pushmodel(L, 2);
    lua_setiuservalue(L, -2, DML_PATH_MODEL);
    return 1;
}

/* Before the first step; what a run finds out is filled in when it ends. */
void dml_stepping_describe(lua_State *L, const dml_stepping *r, dml_path *path) {
    path->h = r->solver->h;
    path->t0 = r->t0;
    lua_getiuservalue(L, 1, DML_SOLVER_RULE);
    path->rule = lua_tostring(L, -1);
    lua_setiuservalue(L, -2, DML_PATH_RULE);
    lua_pushvalue(L, r->model_at);
    lua_setiuservalue(L, -2, DML_PATH_MODEL);
}
