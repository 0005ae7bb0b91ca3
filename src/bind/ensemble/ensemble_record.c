/* ensemble_record.c - members of an ensemble as bytes and back, for journals: the same members are
 * the same bytes, whatever ran them. Numbers lie as the machine has them (little-endian). */
#include "bind/ensemble/bind_ensemble.h"
#include "bind/value/array.h"

#include <string.h>

/* Of a member: its length in bytes (u32, itself left out), then status (i32), rows (u32), steps
 * (i64), where members have steps of their own h (f64), steps to be made (i64), steps a row (i64),
 * then the values that vary, the state, the rows (f64 each), and why it failed (text). */
typedef struct {
    int32_t status;
    uint32_t rows;
    int64_t steps;
} head;

/* What is the same for all members of an ensemble at stack index `at`. */
typedef struct {
    dml_ensemble *e;
    size_t varied; /* values that vary */
    double *values;
    int at;
} record;

/* Of the ensemble at `at`; pushes nothing. */
static record record_of(lua_State *L, int at) {
    record r = {.e = luaL_checkudata(L, at, DML_ENSEMBLE), .at = at};
    if (lua_getiuservalue(L, at, DML_ENSEMBLE_NAMES) == LUA_TTABLE) r.varied = lua_rawlen(L, -1);
    lua_getiuservalue(L, at, DML_ENSEMBLE_VARIED);
    r.values = lua_touserdata(L, -1);
    lua_pop(L, 2);
    return r;
}

/* Bytes of a member without rows and reason. */
static size_t fixed_size(const record *r) {
    return sizeof(head) + (r->e->pace ? sizeof(dm_pace) : 0) +
           (r->varied + dm_state_size(r->e->n)) * sizeof(double);
}

/* Where the state of member i lies. */
static double *state_of(const record *r, long i) {
    return r->e->state + (size_t)i * dm_state_size(r->e->n);
}

/* Push what is known of why member i failed, or "". */
static const char *push_reason(lua_State *L, const record *r, long i, size_t *length) {
    if (!dml_ensemblereason(L, r->at, i)) lua_pushliteral(L, "");
    return lua_tolstring(L, -1, length);
}

/* Bytes behind those that are there; *to moves on. */
static void add(char **to, const void *from, size_t size) {
    if (size) memcpy(*to, from, size);
    *to += size;
}

/* Member i behind what is in the buffer. */
static void add_member(lua_State *L, luaL_Buffer *b, const record *r, long i) {
    const dml_ensemble *e = r->e;
    const size_t rows = e->rows.room ? (size_t)e->rows.count[i] : 0;
    const size_t of_rows = rows * e->rows.width * sizeof(double);
    const head h = {(int32_t)e->member[i].status, (uint32_t)rows, e->member[i].steps};
    char reason[400];
    size_t length;
    const char *text = push_reason(L, r, i, &length);
    if (length > sizeof reason) length = sizeof reason;
    memcpy(reason, text, length);
    lua_pop(L, 1); /* the buffer wants its place on top */
    const uint32_t size = (uint32_t)(fixed_size(r) + of_rows + length);
    char *to = luaL_prepbuffsize(b, size + sizeof size);
    add(&to, &size, sizeof size);
    add(&to, &h, sizeof h);
    if (e->pace) add(&to, e->pace + i, sizeof *e->pace);
    if (r->varied) add(&to, r->values + (size_t)i * r->varied, r->varied * sizeof(double));
    add(&to, state_of(r, i), dm_state_size(e->n) * sizeof(double));
    if (rows) add(&to, dm_ensemble_rows_of(&e->rows, i), of_rows);
    add(&to, reason, length);
    luaL_addsize(b, size + sizeof size);
}

/* (ensemble) -> the bytes of all of its members */
static int pack(lua_State *L) {
    const record r = record_of(L, 1);
    luaL_Buffer b;
    lua_settop(L, 1);
    luaL_buffinit(L, &b);
    for (long i = 0; i < r.e->members; i++) add_member(L, &b, &r, i);
    luaL_pushresult(&b);
    return 1;
}

/* room for steps and values of all members, as the ensemble at 1 has them */
static void make_room(lua_State *L, dml_ensemble *e, const record *like) {
    const size_t members = (size_t)e->members;
    if (like->e->pace) {
        dm_pace *pace = lua_newuserdatauv(L, members * sizeof *pace, 0);
        memset(pace, 0, members * sizeof *pace);
        e->pace = pace;
        lua_setiuservalue(L, -2, DML_ENSEMBLE_STEPS);
    }
    if (like->varied) {
        double *values = lua_newuserdatauv(L, members * like->varied * sizeof *values, 0);
        memset(values, 0, members * like->varied * sizeof *values);
        lua_setiuservalue(L, -2, DML_ENSEMBLE_VARIED);
    }
}

/* (ensemble, members) -> one like it of so many members, of which none was run */
static int like(lua_State *L) {
    static const int kept[] = {DML_ENSEMBLE_SOLVER, DML_ENSEMBLE_NAMES, DML_ENSEMBLE_COLUMNS,
                               DML_ENSEMBLE_MODEL, DML_ENSEMBLE_PARAMS};
    const record r = record_of(L, 1);
    const lua_Integer members = dml_checkinteger(L, 2);
    luaL_argcheck(L, members > 0, 2, "must be > 0");
    dml_ensemble *e = dml_pushensemble(L, (long)members, r.e->n, &r.e->rows);
    e->t = r.e->t, e->h = r.e->h, e->t0 = r.e->t0;
    e->lanes = r.e->lanes, e->systems = r.e->systems;
    for (size_t k = 0; k < sizeof kept / sizeof *kept; k++) {
        lua_getiuservalue(L, 1, kept[k]);
        lua_setiuservalue(L, -2, kept[k]);
    }
    make_room(L, e, &r);
    return 1;
}

/* Member i failed, as the text says; "" is no reason. */
static void keep_reason(lua_State *L, const record *r, long i, const char *text, size_t length) {
    if (length == 0) return;
    dml_ensemblemessages(L, r->at);
    lua_pushlstring(L, text, length);
    lua_rawseti(L, -2, i + 1);
    lua_pop(L, 1);
}

/* The other way. */
static void take(const char **from, void *to, size_t size) {
    if (size) memcpy(to, *from, size);
    *from += size;
}

/* The bytes of member i; 0: they are those of another ensemble. */
static int take_member(lua_State *L, const record *r, long i, const char *from, size_t size) {
    dml_ensemble *e = r->e;
    const char *end = from + size;
    head h;
    if (size < fixed_size(r)) return 0;
    take(&from, &h, sizeof h);
    const size_t rest = size - fixed_size(r), row = e->rows.width * sizeof(double);
    if (h.status < 0 || h.status >= DM_STATUSES || h.steps < 0) return 0;
    if (h.rows && (h.rows > (uint64_t)e->rows.room || h.rows > rest / row)) return 0;
    e->member[i] = (dm_member){.status = (dm_status)h.status, .steps = (long)h.steps};
    if (e->pace) take(&from, (dm_pace *)e->pace + i, sizeof *e->pace);
    if (r->varied) take(&from, r->values + (size_t)i * r->varied, r->varied * sizeof(double));
    take(&from, state_of(r, i), dm_state_size(e->n) * sizeof(double));
    if (e->rows.room) e->rows.count[i] = (long)h.rows;
    if (h.rows) take(&from, dm_ensemble_rows_of(&e->rows, i), h.rows * row);
    keep_reason(L, r, i, from, (size_t)(end - from));
    return 1;
}

/* (ensemble, first, count, bytes) -> are they those of members first ...? */
static int unpack(lua_State *L) {
    const record r = record_of(L, 1);
    const lua_Integer first = dml_checkinteger(L, 2), count = dml_checkinteger(L, 3);
    size_t left, length;
    const char *from = luaL_checklstring(L, 4, &left);
    luaL_argcheck(L, first >= 1 && count >= 0 && count <= r.e->members - (first - 1), 2,
                  "no such members");
    for (lua_Integer i = 0; i < count; i++, from += length, left -= length) {
        uint32_t size;
        if (left < sizeof size) break;
        memcpy(&size, from, sizeof size);
        length = size + sizeof size;
        if (left < length) break;
        if (!take_member(L, &r, (long)(first - 1 + i), from + sizeof size, size)) break;
        if (i == count - 1) return lua_pushboolean(L, left == length), 1;
    }
    lua_pushboolean(L, count == 0 && left == 0);
    return 1;
}

/* (matrix, first, count) -> rows first ... as a matrix; nil: not a matrix of numbers */
static int rows_of(lua_State *L) {
    const dml_array *a = dml_toarray(L, 1, 2);
    const double *from = a ? dml_numbersof(a) : NULL;
    const lua_Integer first = dml_checkinteger(L, 2), count = dml_checkinteger(L, 3);
    if (!from) return 0;
    luaL_argcheck(L, first >= 1 && count >= 0 && count <= (lua_Integer)a->rows - (first - 1), 2,
                  "no such rows");
    double *out = dml_pushmatrix(L, (uint32_t)count, a->columns);
    memcpy(out, from + (size_t)(first - 1) * a->columns, (size_t)count * a->columns * sizeof *out);
    return 1;
}

static const dml_row functions[] =
    {{"ensemble_pack", pack,
      "core.ensemble_pack(ensemble) -> string\n"
      "The members of an ensemble as bytes, for dm.sweep.ensemble."},
     {"ensemble_like", like,
      "core.ensemble_like(ensemble, members) -> dm.ensemble\n"
      "One of the same solver and columns with so many members, of which none was run."},
     {"ensemble_unpack", unpack,
      "core.ensemble_unpack(ensemble, first, count, bytes) -> boolean\n"
      "Put members first ... first + count - 1 back, as core.ensemble_pack gave them; false where "
      "the bytes are those of another ensemble."},
     {"matrix_rows", rows_of,
      "core.matrix_rows(matrix, first, count) -> dm.matrix or nil\n"
      "Rows first ... first + count - 1; nil of what is no matrix of numbers."},
     {NULL, NULL, NULL}};

const dml_class dml_class_record = {
    .functions = functions,
};
