#include "bind/run/run_file.h"

#include <errno.h>
#include <string.h>

static int close_stream(lua_State *L) {
    luaL_Stream *s = luaL_checkudata(L, 1, LUA_FILEHANDLE);
    FILE *file = s->f;
    s->f = NULL;
    return luaL_fileresult(L, file && fclose(file) == 0, NULL);
}

/* ('q1', '<f8'), ... */
static void add_fields(lua_State *L, luaL_Buffer *b, int names) {
    const lua_Integer count = (lua_Integer)lua_rawlen(L, names);
    for (lua_Integer i = 1; i <= count; i++) {
        lua_rawgeti(L, names, i);
        luaL_gsub(L, lua_tostring(L, -1), "\\", "\\\\");
        luaL_gsub(L, lua_tostring(L, -1), "'", "\\'");
        lua_pushfstring(L, "%s('%s', '<f8')", i > 1 ? ", " : "", lua_tostring(L, -1));
        lua_replace(L, -4);
        lua_pop(L, 2);
        luaL_addvalue(b);
    }
}

/* Push the header of version 1.0, or of 3.0 (UTF-8) with its longer size: a text of a length
 * that does not depend on the number of rows, so that it can be written again at the end. */
static void push_header(lua_State *L, int names, long rows) {
    enum { ROOM = 32, UNIT = 64 };
    luaL_Buffer b;
    char count[ROOM];
    luaL_buffinit(L, &b);
    luaL_addstring(&b, "{'descr': [");
    add_fields(L, &b, names);
    const int digits = snprintf(count, sizeof count, "%ld", rows);
    luaL_addstring(&b, "], 'fortran_order': False, 'shape': (");
    luaL_addstring(&b, count);
    luaL_addstring(&b, ",), }");
    for (int i = digits; i < ROOM; i++) luaL_addchar(&b, ' ');
    luaL_pushresult(&b);
    const int text = lua_gettop(L);
    size_t length = lua_rawlen(L, -1) + 1;
    int wide = length > 65000;
    for (const char *c = lua_tostring(L, -1); *c; c++) wide |= (*c & 0x80) != 0;
    const size_t head = wide ? 12 : 10, pad = (UNIT - (head + length) % UNIT) % UNIT;
    length += pad;
    luaL_buffinit(L, &b);
    luaL_addlstring(&b, wide ? "\x93NUMPY\3\0" : "\x93NUMPY\1\0", 8);
    for (int i = 0; i < (wide ? 4 : 2); i++) luaL_addchar(&b, (char)(length >> (8 * i) & 0xff));
    lua_pushvalue(L, text);
    luaL_addvalue(&b);
    for (size_t i = 0; i < pad; i++) luaL_addchar(&b, ' ');
    luaL_addchar(&b, '\n');
    luaL_pushresult(&b);
    lua_remove(L, text);
}

static int write_header(lua_State *L, dml_run_file *f) {
    push_header(L, f->names, f->rows);
    const size_t size = lua_rawlen(L, -1);
    const int fine = fseek(f->stream->f, 0, SEEK_SET) == 0 &&
                     fwrite(lua_tostring(L, -1), 1, size, f->stream->f) == size;
    lua_pop(L, 1);
    return fine;
}

static dm_status flush(void *ud, const double *rows, long count) {
    dml_run_file *f = ud;
    const size_t wanted = (size_t)count * f->width;
    if (fwrite(rows, sizeof *rows, wanted, f->stream->f) != wanted) return DM_NOT_WRITTEN;
    f->rows += count;
    return DM_OK;
}

void dml_file_open(lua_State *L, dml_run_file *f, int names) {
    const int one = 1;
    lua_getfield(L, 2, "file");
    if (lua_type(L, -1) != LUA_TSTRING || !strstr(lua_tostring(L, -1), ".npy"))
        luaL_error(L, "field 'file' must be the name of a .npy file (got %s)",
                   luaL_tolstring(L, -1, NULL));
    if (*(const char *)&one != 1)
        luaL_error(L, "rows are written to a file on little-endian machines only");
    f->name = lua_tostring(L, -1);
    f->stream = lua_newuserdatauv(L, sizeof *f->stream, 0);
    f->stream->closef = NULL;
    f->stream->f = NULL;
    luaL_setmetatable(L, LUA_FILEHANDLE);
    f->stream->f = fopen(f->name, "w+b");
    if (!f->stream->f) luaL_error(L, "field 'file': cannot open %s: %s", f->name, strerror(errno));
    f->stream->closef = close_stream;
    f->names = names;
    f->width = (size_t)lua_rawlen(L, names);
    f->rows = 0;
    f->outlet = (dm_outlet){.room = DML_ROWS_IN_MEMORY, .flush = flush, .ud = f};
    if (!write_header(L, f))
        luaL_error(L, "field 'file': cannot write %s: %s", f->name, strerror(errno));
}

int dml_file_close(lua_State *L, dml_run_file *f) {
    const int written = write_header(L, f);
    FILE *file = f->stream->f;
    f->stream->closef = NULL; /* closed: as io.close leaves it */
    f->stream->f = NULL;
    return (fclose(file) == 0) & written;
}
