/* array.c - storage of vectors and matrices. */
#include "bind/value/array.h"
#include "bind/core/missing_key.h"
#include "bind/value/trace_log.h"

#include <math.h>
#include <string.h>

enum { LARGEST = 1 << 28 }; /* entries */

static size_t entry_size(dml_kind kind) {
    static const size_t size[] = {sizeof(double), sizeof(dm_node), sizeof(dml_hyperdual)};
    return size[kind];
}

/* Entries stand behind the header in one block, zero: nothing is to be released, the collector
 * takes all. */
dml_array *dml_newarray(lua_State *L, int rank, uint32_t rows, uint32_t columns,
                        const dml_scalar *like) {
    const uint64_t n = (uint64_t)rows * columns;
    if (n > LARGEST)
        luaL_error(L, "%d x %d entries are too many: at most %d", (int)rows, (int)columns, LARGEST);
    if (rank == 2 && n == 0) luaL_error(L, "a matrix needs at least one row and one column");
    luaL_checkstack(L, 4, NULL);
    const size_t size = sizeof(dml_array) + (size_t)n * entry_size(like->kind);
    dml_array *a = dml_newvalue(L, rank == 1 ? DML_CLASS_VECTOR : DML_CLASS_MATRIX, size, 1);
    *a = (dml_array){.rows = rows,
                     .columns = columns,
                     .rank = rank,
                     .kind = like->kind,
                     .serial = like->kind == DML_SYMBOL ? like->serial : 0,
                     .entries = a + 1};
    return a;
}

/* The class is told by the address of the metatable: no look-up of a name. */
dml_array *dml_toarray(lua_State *L, int arg, int rank) {
    const int class = dml_classof(L, arg);
    return class == (rank == 1 ? DML_CLASS_VECTOR : DML_CLASS_MATRIX) ? lua_touserdata(L, arg)
                                                                      : NULL;
}

dml_array *dml_checkarray(lua_State *L, int arg, int rank) {
    dml_array *a = dml_toarray(L, arg, rank);
    if (!a) dml_typeerror(L, arg, rank == 1 ? "dm.vector" : "dm.matrix");
    return a;
}

/* A table is copied into a vector which takes its place on the stack, so that it stays alive as
 * long as the argument. */
const dml_array *dml_vectorat(lua_State *L, int arg) {
    static const dml_scalar zero = {.kind = DML_NUMBER};
    arg = lua_absindex(L, arg);
    dml_array *a = dml_toarray(L, arg, 1);
    if (a) return a;
    if (!dml_islist(L, arg)) dml_typeerror(L, arg, "dm.vector or table of numbers");
    const long n = dml_length(L, arg);
    if (n < 0) luaL_argerror(L, arg, "a vector or table of numbers expected");
    a = dml_newarray(L, 1, (uint32_t)n, 1, &zero);
    const int made = lua_gettop(L);
    for (uint32_t i = dml_readplain(L, arg, a->entries, (uint32_t)n); i < (uint32_t)n; i++) {
        const dml_scalar x = dml_entry(L, arg, i);
        dml_assign(L, made, i, &x);
    }
    lua_replace(L, arg);
    return a;
}

/* A view: user value 1 holds the matrix, and entries are read where they are then, should the
 * matrix move them. */
void dml_pushrow(lua_State *L, int arg, uint32_t i) {
    arg = lua_absindex(L, arg);
    dml_array *m = lua_touserdata(L, arg);
    dml_array *a = dml_newvalue(L, DML_CLASS_VECTOR, sizeof *a, 1);
    *a = (dml_array){.rows = m->columns,
                     .columns = 1,
                     .rank = 1,
                     .offset = i * m->columns,
                     .is_copy = m->is_copy,
                     .owner = m};
    lua_pushvalue(L, arg);
    lua_setiuservalue(L, -2, 1);
}

/* ---- entries ---- */

void dml_mark_copy(lua_State *L) {
    if (lua_istable(L, -1)) /* an element of a product */
        for (lua_Integer i = luaL_len(L, -1); i > 0; i--, lua_pop(L, 1))
            lua_geti(L, -1, i), dml_mark_copy(L);
    for (int rank = 1; rank <= 2; rank++) {
        dml_array *a = dml_toarray(L, -1, rank);
        if (a) a->is_copy = 1;
    }
}

void dml_check_own(lua_State *L, const dml_array *a) {
    const char *kind = a->rank == 2 || a->owner ? "matrix" : "vector";
    if (a->is_copy)
        luaL_error(L,
                   "a row or column that is read from an object cannot be set, since it is a copy: "
                   "change a %s of its own, local %c = dm.%s(row)",
                   kind, *kind, kind);
}

static const dml_array *holder(const dml_array *a) {
    return a->owner ? a->owner : a;
}

dml_scalar dml_kindof(const dml_array *a) {
    const dml_array *h = holder(a);
    return (dml_scalar){.kind = h->kind, .serial = h->serial};
}

double *dml_numbersof(const dml_array *a) {
    const dml_array *h = holder(a);
    return h->kind == DML_NUMBER ? (double *)h->entries + a->offset : NULL;
}

const dm_node *dml_nodesof(const dml_array *a) {
    const dml_array *h = holder(a);
    return h->kind == DML_SYMBOL ? (const dm_node *)h->entries + a->offset : NULL;
}

/* Entry i as a scalar of the kind of the array. */
dml_scalar dml_get(const dml_array *a, uint32_t i) {
    dml_scalar x = dml_kindof(a);
    const void *entries = holder(a)->entries;
    i += a->offset;
    if (x.kind == DML_NUMBER)
        x.as.number = ((const double *)entries)[i];
    else if (x.kind == DML_SYMBOL)
        x.as.node = ((const dm_node *)entries)[i];
    else
        x.as.hyper = ((const dml_hyperdual *)entries)[i];
    return x;
}

/* The array keeps its kind: numbers are lifted to it; dml_assign is for entries of another kind. */
void dml_put(lua_State *L, dml_array *a, uint32_t i, const dml_scalar *x) {
    const dml_scalar kind = dml_kindof(a), y = dml_lift(L, x, &kind);
    void *entries = holder(a)->entries;
    i += a->offset;
    if (kind.kind == DML_NUMBER)
        ((double *)entries)[i] = y.as.number;
    else if (kind.kind == DML_SYMBOL)
        ((dm_node *)entries)[i] = y.as.node;
    else
        ((dml_hyperdual *)entries)[i] = y.as.hyper;
}

/* the holder of entries on top of the stack gets entries of another kind, in a block
 * of their own */
static void change_kind(lua_State *L, dml_array *h, const dml_scalar *kind) {
    const uint32_t n = dml_size(h);
    dml_array old = *h, fresh = *h;
    fresh.kind = kind->kind;
    fresh.serial = kind->serial;
    fresh.entries = lua_newuserdatauv(L, (size_t)n * entry_size(kind->kind), 0);
    for (uint32_t i = 0; i < n; i++) {
        const dml_scalar x = dml_get(&old, i);
        dml_put(L, &fresh, i, &x);
    }
    lua_pushvalue(L, -1);
    lua_setiuservalue(L, -3, 1);
    *h = fresh;
    lua_pop(L, 1);
}

/* entries that belong to a trace that has ended become NaN: a scratch vector of a
 * traced function is filled anew by every call, and what was not filled is found */
static void forget_symbols(lua_State *L, dml_array *h) {
    const uint32_t n = dml_size(h);
    double *entries = lua_newuserdatauv(L, (size_t)n * sizeof *entries, 0);
    for (uint32_t i = 0; i < n; i++) entries[i] = NAN;
    lua_setiuservalue(L, -2, 1);
    h->kind = DML_NUMBER;
    h->serial = 0;
    h->entries = entries;
}

static int holds_dead_symbols(lua_State *L, const dml_array *h) {
    return h->kind == DML_SYMBOL && !dml_findframe(L, h->serial);
}

/* give the array on top (or its owner) the kind that holds its entries and x */
static void make_room_for(lua_State *L, dml_array *a, const dml_scalar *x) {
    dml_array *h = a->owner ? a->owner : a;
    if (a->owner) lua_getiuservalue(L, -1, 1), lua_remove(L, -2);
    if (holds_dead_symbols(L, h)) forget_symbols(L, h);
    const dml_scalar kind = dml_kindof(h), common = dml_common(L, &kind, x);
    if (common.kind != kind.kind) change_kind(L, h, &common);
}

/* An entry of a higher kind makes all others of that kind first: the new block is user value 1. */
void dml_assign(lua_State *L, int arg, uint32_t i, const dml_scalar *x) {
    dml_array *a = lua_touserdata(L, arg);
    const dml_scalar kind = dml_kindof(a);
    if (x->kind != kind.kind || x->serial != kind.serial) {
        luaL_checkstack(L, 6, NULL);
        lua_pushvalue(L, arg);
        make_room_for(L, a, x);
        lua_pop(L, 1);
    }
    dml_put(L, a, i, x);
}

/* ---- sums of products ---- */

/* Strides da, db: rows and columns of a matrix alike. */
static double inner_numbers(const double *a, uint32_t da, const double *b, uint32_t db,
                            uint32_t n) {
    double sum = 0;
    for (uint32_t k = 0; k < n; k++) sum += a[(size_t)k * da] * b[(size_t)k * db];
    return sum;
}

/* a and b hold symbols of one trace */
static dml_scalar inner_symbols(lua_State *L, dml_run a, dml_run b, uint32_t n) {
    dml_frame *frame = dml_findframe(L, dml_kindof(a.array).serial);
    const dm_node *x = dml_nodesof(a.array) + a.first, *y = dml_nodesof(b.array) + b.first;
    dm_node sum = 0;
    for (uint32_t k = 0; k < n; k++) {
        const dm_node product =
            dml_operation(L, frame, DM_OP_MUL, x[(size_t)k * a.step], y[(size_t)k * b.step], 0);
        sum = k ? dml_operation(L, frame, DM_OP_ADD, sum, product, 0) : product;
    }
    dml_checkgraph(L, frame);
    return (dml_scalar){.kind = DML_SYMBOL, .serial = frame->serial, .as.node = sum};
}

static int are_symbols(lua_State *L, const dml_array *a, const dml_array *b) {
    const dml_scalar x = dml_kindof(a), y = dml_kindof(b);
    return x.kind == DML_SYMBOL && y.kind == DML_SYMBOL && x.serial == y.serial &&
           dml_findframe(L, x.serial);
}

/* sum_i a_i b_i from the first entry on, in every kind in the same order, so that a trace rounds
 * as plain calls do. */
dml_scalar dml_inner(lua_State *L, dml_run a, dml_run b, uint32_t n) {
    const double *x = dml_numbersof(a.array), *y = dml_numbersof(b.array);
    dml_scalar sum = {.kind = DML_NUMBER, .as.number = 0};
    if (x && y) {
        sum.as.number = inner_numbers(x + a.first, a.step, y + b.first, b.step, n);
        return sum;
    }
    if (n && are_symbols(L, a.array, b.array)) return inner_symbols(L, a, b, n);
    for (uint32_t k = 0; k < n; k++) {
        const dml_scalar p = dml_get(a.array, a.first + k * a.step),
                         q = dml_get(b.array, b.first + k * b.step);
        const dml_scalar product = dml_apply(L, DM_OP_MUL, &p, &q, NULL);
        sum = k ? dml_apply(L, DM_OP_ADD, &sum, &product, NULL) : product;
    }
    return sum;
}

/* ---- new arrays for the other bindings ---- */

static const dml_scalar number = {.kind = DML_NUMBER};

double *dml_pushvector(lua_State *L, uint32_t n) {
    return dml_newarray(L, 1, n, 1, &number)->entries;
}

double *dml_pushmatrix(lua_State *L, uint32_t rows, uint32_t columns) {
    return dml_newarray(L, 2, rows, columns, &number)->entries;
}

void dml_pushscalars(lua_State *L, const dml_scalar *x, uint32_t n) {
    dml_scalar kind = number;
    for (uint32_t i = 0; i < n; i++) kind = dml_common(L, &kind, x + i);
    dml_array *a = dml_newarray(L, 1, n, 1, &kind);
    for (uint32_t i = 0; i < n; i++) dml_put(L, a, i, x + i);
}
