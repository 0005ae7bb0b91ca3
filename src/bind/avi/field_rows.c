#include "bind/avi/field_rows.h"

#include <string.h>

/* is option `file` of the table at 2 there? */
static int is_filed(lua_State *L) {
    const int there = lua_getfield(L, 2, "file") != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

dml_path *dml_field_rows_open(lua_State *L, dml_field_rows *r, int system, uint32_t n, long rows,
                              double from) {
    *r = (dml_field_rows){.is_filed = is_filed(L)};
    r->room = r->is_filed && rows > DML_ROWS_IN_MEMORY ? DML_ROWS_IN_MEMORY : rows;
    r->path = dml_pushpath(L, system, n, r->room + r->is_filed, 2 * n + 1);
    if (!r->is_filed) return r->path;
    const int at = lua_gettop(L);
    lua_getfield(L, at, "columns");
    const dml_file_start start = {.t = from, .missing = dml_count(L, 2, "missing", 0, 0)};
    dml_file_open(L, &r->file, at + 1, 1, &start);
    lua_pushstring(L, r->file.name);
    lua_setiuservalue(L, at, DML_PATH_FILE);
    lua_pushvalue(L, at);
    return r->path;
}

/* rows of the path that are not there yet go to the file, or stay */
static dm_status flush(dml_field_rows *r) {
    const dm_status status =
        r->held ? r->file.outlet.flush(r->file.outlet.ud, r->path->data, r->held) : DM_OK;
    if (status == DM_OK) r->held = 0;
    return status;
}

/* the row where that fails is kept behind the block */
dm_status dml_field_rows_next(dml_field_rows *r, double **row) {
    dm_status status = DM_OK;
    if (r->is_filed && r->held == r->room) status = flush(r);
    *row = r->path->data + (size_t)r->held * r->path->width;
    r->path->rows = ++r->held;
    r->rows++;
    return status;
}

dm_status dml_field_rows_close(lua_State *L, dml_field_rows *r, dm_status status) {
    if (!r->is_filed) return status;
    const dm_status flushed = flush(r);
    const int closed = dml_file_close(L, &r->file);
    dml_file_keep(&r->file, r->path, r->rows);
    return status == DM_OK && (flushed != DM_OK || !closed) ? DM_NOT_WRITTEN : status;
}

const char *dml_field_rows_why(lua_State *L, const dml_field_rows *r) {
    return lua_pushfstring(L, "cannot write %s: %s; the path so far is in failure.path",
                           r->file.name, strerror(r->file.why));
}
