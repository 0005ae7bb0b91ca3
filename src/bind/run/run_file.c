#include "bind/run/run_file.h"
#include "bind/core/new_file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* How Lua closes it where a run is left by an error. */
static int close_stream(lua_State *L) {
    luaL_Stream *s = luaL_checkudata(L, 1, LUA_FILEHANDLE);
    FILE *file = s->f;
    s->f = NULL;
    return luaL_fileresult(L, file && fclose(file) == 0, NULL);
}

/* how many names from number i on are q1, q2, ..., of one letter; 0: they are something else */
static lua_Integer count_numbered(lua_State *L, int names, lua_Integer i, lua_Integer count) {
    char wanted[32];
    lua_geti(L, names, i);
    const char letter = *lua_tostring(L, -1);
    lua_Integer k = 0;
    for (; i + k <= count; k++) {
        snprintf(wanted, sizeof wanted, "%c%lld", letter, (long long)k + 1);
        lua_geti(L, names, i + k);
        const int same = strcmp(lua_tostring(L, -1), wanted) == 0;
        lua_pop(L, 1);
        if (!same) break;
    }
    lua_pop(L, 1);
    return k;
}

/* ('q1', '<f8'), ...; with `arrays` ('q', '<f8', (2,)) in the place of q1, q2 */
static void add_fields(lua_State *L, luaL_Buffer *b, int names, int arrays) {
    const lua_Integer count = luaL_len(L, names);
    for (lua_Integer i = 1; i <= count; i++) {
        const lua_Integer many = arrays ? count_numbered(L, names, i, count) : 0;
        lua_geti(L, names, i);
        if (many > 0) {
            const char letter[2] = {*lua_tostring(L, -1), '\0'};
            lua_pop(L, 1);
            lua_pushfstring(L, "%s('%s', '<f8', (%I,))", i > 1 ? ", " : "", letter,
                            (LUAI_UACINT)many);
            luaL_addvalue(b);
            i += many - 1;
            continue;
        }
        luaL_gsub(L, lua_tostring(L, -1), "\\", "\\\\");
        luaL_gsub(L, lua_tostring(L, -1), "'", "\\'");
        lua_pushfstring(L, "%s('%s', '<f8')", i > 1 ? ", " : "", lua_tostring(L, -1));
        lua_replace(L, -4);
        lua_pop(L, 2);
        luaL_addvalue(b);
    }
}

enum { ROOM = 32 }; /* characters of the number of rows and what follows it */

/* "17,), }" and blanks: of the same length for all numbers */
static void write_count(char out[ROOM + 1], long rows) {
    const int length = snprintf(out, ROOM + 1, "%ld,), }", rows);
    memset(out + length, ' ', (size_t)(ROOM - length));
    out[ROOM] = '\0';
}

/* Push the header of version 1.0, or of 3.0 (UTF-8) with its longer size: a text of a length
 * that does not depend on the number of rows; *behind: where that stands. */
static void push_header(lua_State *L, int names, int arrays, long rows, long *behind) {
    enum { UNIT = 64 };
    luaL_Buffer b;
    char count[ROOM + 1];
    luaL_buffinit(L, &b);
    luaL_addstring(&b, "{'descr': [");
    add_fields(L, &b, names, arrays);
    luaL_addstring(&b, "], 'fortran_order': False, 'shape': (");
    write_count(count, rows);
    luaL_addstring(&b, count);
    luaL_pushresult(&b);
    const int text = lua_gettop(L);
    size_t length = lua_rawlen(L, -1) + 1;
    int wide = length > 65000;
    for (const char *c = lua_tostring(L, -1); *c; c++) wide |= (*c & 0x80) != 0;
    const size_t head = wide ? 12 : 10, pad = (UNIT - (head + length) % UNIT) % UNIT;
    *behind = (long)(head + length - 1 - ROOM);
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

/* ---- rows ---- */

/* the header counts the rows that are in the file; Lua is not asked, whose errors would pass an
 * open stepper */
static int count_rows(dml_run_file *f, long rows) {
    char count[ROOM + 1];
    FILE *file = f->stream->f;
    write_count(count, rows);
    if (fseek(file, f->behind, SEEK_SET) != 0 || fwrite(count, 1, ROOM, file) != ROOM) return 0;
    f->rows = rows;
    return 1;
}

/* Rows are in the file before its header counts them: a run that is killed between both leaves
 * rows that nobody counts, never a count of rows that are not there. The stream has no buffer, and
 * the place is that of the count: a part of a block that did not fit is written over by the next
 * try. */
static dm_status flush(void *ud, const double *rows, long count) {
    dml_run_file *f = ud;
    const size_t wanted = (size_t)count * f->width;
    FILE *file = f->stream->f;
    const long place = f->size + f->rows * (long)(f->width * sizeof *rows);
    if (fseek(file, place, SEEK_SET) == 0 && fwrite(rows, sizeof *rows, wanted, file) == wanted &&
        count_rows(f, f->rows + count)) {
        f->last = count;
        return DM_OK;
    }
    f->why = errno;
    return DM_NOT_WRITTEN;
}

/* ---- a file that is there ---- */

/* Of a row of the file, from 0; NaN where it cannot be read. */
static double time_of(const dml_run_file *f, long row) {
    double t = NAN;
    const long at = f->size + row * (long)(f->width * sizeof t);
    if (fseek(f->stream->f, at, SEEK_SET) != 0 || fread(&t, sizeof t, 1, f->stream->f) != 1)
        return NAN;
    return t;
}

/* How far q in row `row`, from 0, is from that which a run of this file goes on from, beside the
 * largest entry of both: 0 where its time is another one, or where it cannot be read. */
static double row_apart(lua_State *L, const dml_run_file *f, long row, const dml_file_start *from) {
    double apart = 0.0, size = 0.0;
    if (!from->n || time_of(f, row) != from->t) return 0.0;
    double *there = lua_newuserdatauv(L, from->n * sizeof *there, 0);
    if (fread(there, sizeof *there, from->n, f->stream->f) == from->n)
        for (size_t i = 0; i < from->n; i++) {
            size = fmax(size, fmax(fabs(there[i]), fabs(from->state[i])));
            apart = fmax(apart, fabs(there[i] - from->state[i]));
        }
    lua_pop(L, 1);
    return apart > 0.0 ? apart / size : 0.0;
}

/* Its rows before the time of `from` stay, the rest is cut off. 0: it is not a file of these
 * columns; `header` is on top of the stack. */
static int keep_rows(lua_State *L, dml_run_file *f, const dml_file_start *from) {
    static const double OTHER = 1e-6; /* rows at times may be states in between, to an order */
    const size_t size = lua_rawlen(L, -1);
    const char *header = lua_tostring(L, -1);
    char *there = lua_newuserdatauv(L, size, 0);
    FILE *file = f->stream->f;
    if (fread(there, 1, size, file) != size) return 0;
    const size_t behind = (size_t)f->behind;
    if (memcmp(there, header, behind) != 0 ||
        memcmp(there + behind + ROOM, header + behind + ROOM, size - behind - ROOM) != 0)
        return 0;
    there[behind + ROOM] = '\0';
    long least = 0, most = strtol(there + behind, NULL, 10);
    while (least < most) { /* rows before `least` are earlier, those from `most` on are not */
        const long middle = least + (most - least) / 2;
        if (time_of(f, middle) < from->t)
            least = middle + 1;
        else
            most = middle;
    }
    f->before = least;
    if (row_apart(L, f, least, from) > OTHER)
        luaL_error(L,
                   "field 'file': %s has rows of another run: the one at t = %f, where this run "
                   "goes "
                   "on, is another state; give a new name",
                   f->name, from->t);
    return ftruncate(fileno(file), (off_t)size + least * (off_t)(f->width * sizeof(double))) == 0 &&
           count_rows(f, least);
}

/* Open for reading and writing: the file as it is, or (fresh) emptied. It is locked before, since
 * rows of two processes in one file are those of neither; where there are no locks it goes
 * without. */
static void open_stream(lua_State *L, dml_run_file *f, int fresh) {
    f->stream = lua_newuserdatauv(L, sizeof *f->stream, 0);
    f->stream->closef = NULL;
    f->stream->f = NULL;
    luaL_setmetatable(L, LUA_FILEHANDLE);
    const int fd = open(dml_issilent() ? "/dev/null" : f->name, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    f->stream->f = fd < 0 ? NULL : fdopen(fd, "r+b");
    if (!f->stream->f) luaL_error(L, "field 'file': cannot open %s: %s", f->name, strerror(errno));
    f->stream->closef = close_stream;
    const char *why = dml_issilent() ? NULL : dml_lockfile(L, fd);
    if (why && errno == EAGAIN)
        luaL_error(L, "field 'file': %s is %s; give another name", f->name, why);
    if (fresh && ftruncate(fd, 0) != 0 && errno != EINVAL) /* a device has no length */
        luaL_error(L, "field 'file': cannot empty %s: %s", f->name, strerror(errno));
    setvbuf(f->stream->f, NULL, _IONBF, 0);
}

/* Not empty: what is there is not to be overwritten by a run that goes on. */
static int is_there(const char *name) {
    FILE *file = fopen(name, "rb");
    const int there = file && fgetc(file) != EOF;
    if (file) fclose(file);
    return there;
}

/* The header is as long for any number of rows, so that it can be counted up in its place. */
void dml_file_open(lua_State *L, dml_run_file *f, int names, int arrays,
                   const dml_file_start *from) {
    const int one = 1;
    lua_getfield(L, 2, "file");
    if (lua_type(L, -1) != LUA_TSTRING || !strstr(lua_tostring(L, -1), ".npy"))
        luaL_error(L, "field 'file' must be the name of a .npy file (got %s)",
                   luaL_tolstring(L, -1, NULL));
    if (*(const char *)&one != 1)
        luaL_error(L, "rows are written to a file on little-endian machines only");
    f->name = lua_tostring(L, -1);
    f->names = names;
    f->width = (size_t)luaL_len(L, names);
    f->rows = f->before = f->last = 0;
    f->why = 0;
    f->outlet = (dm_outlet){.room = DML_ROWS_IN_MEMORY, .flush = flush, .ud = f};
    const int goes_on = !isnan(from->t) && is_there(f->name);
    if (goes_on && from->missing)
        luaL_error(L,
                   "field 'file': %d rows before t = %f are missing in %s, which its disk did not "
                   "take (they are in failure.path): give a new name",
                   (int)from->missing, from->t, f->name);
    open_stream(L, f, !goes_on);
    push_header(L, names, arrays, 0, &f->behind);
    f->size = (long)lua_rawlen(L, -1);
    if (goes_on) {
        if (!keep_rows(L, f, from))
            luaL_error(L,
                       "field 'file': %s holds no rows of this run (other columns, or another kind "
                       "of file): a run that goes on adds to its own; give a new name",
                       f->name);
    } else if (fwrite(lua_tostring(L, -1), 1, lua_rawlen(L, -1), f->stream->f) !=
               lua_rawlen(L, -1)) {
        luaL_error(L, "field 'file': cannot write %s: %s", f->name, strerror(errno));
    }
}

/* The stream is left closed for Lua, whatever came of it. */
int dml_file_close(lua_State *L, dml_run_file *f) {
    (void)L;
    FILE *file = f->stream->f;
    f->stream->closef = NULL; /* closed: as io.close leaves it */
    f->stream->f = NULL;
    if (fclose(file) != 0) f->why = errno;
    return f->why == 0;
}

void dml_file_keep(const dml_run_file *f, dml_path *path, long rows) {
    path->rows = path->unfiled = rows - (f->rows - f->before);
    if (path->unfiled || !rows) return;
    const double *last = path->data + (size_t)(f->last - 1) * f->width;
    memmove(path->data, last, f->width * sizeof *last);
    path->rows = 1;
}
