/* bind_matching.c - `dm.matching`: pairs of the cells of a mesh, for Lua modules that make
 * homology, cones and potentials of them; and `core.smith_form`. Cells of a script are numbered
 * from 1; a chain is a table from cells to integers. */
#include "bind/dec/bind_mesh.h"
#include "bind/value/array.h"
#include "dec/homology/matching.h"
#include "dec/homology/smith.h"

#include <string.h>

#define TNAME "dm.matching"

/* User value 1 keeps the arena, 2 the mesh. A flow is opened when its degree is first asked for. */
typedef struct {
    dm_matching M;
    dm_arena *arena;
    dm_flow flow[DM_DIMENSION + 1];
    int is_open[DM_DIMENSION + 1];
} matching;

static matching *check_matching(lua_State *L) {
    return luaL_checkudata(L, 1, TNAME);
}

static void raise_status(lua_State *L, dm_status status) {
    if (status == DM_STOPPED) dml_checkstop(L);
    if (status == DM_TOO_LARGE)
        luaL_error(L, "an integer leaves 64 bits on the way; what is asked is too large to be "
                      "computed exactly");
    luaL_error(L, "%s", dm_status_text(status));
}

/* a degree from `least` to the dimension */
static uint32_t check_degree(lua_State *L, int arg, const dm_matching *M, lua_Integer least) {
    const lua_Integer k = dml_checkinteger(L, arg);
    luaL_argcheck(L, k >= least && k <= M->K->n, arg, "there are no cells of this degree");
    return (uint32_t)k;
}

static uint32_t check_cell(lua_State *L, int at, uint32_t count) {
    int is_whole;
    const lua_Integer cell = dml_tointegerx(L, at, &is_whole);
    if (!is_whole || cell < 1 || cell > count)
        luaL_error(L, "there is no cell %s", luaL_tolstring(L, at, NULL));
    return (uint32_t)cell - 1;
}

/* ---- making one ---- */

/* the table at arg: [k + 1] is a list of cells of degree k */
static void read_absent(lua_State *L, int arg, dm_matching_wish *wish, const dm_complex *K) {
    if (lua_isnoneornil(L, arg)) return;
    luaL_checktype(L, arg, LUA_TTABLE);
    for (uint32_t k = 0; k <= K->n; k++) {
        uint8_t *mark = lua_newuserdatauv(L, (size_t)K->count[k] + 1, 0);
        memset(mark, 0, (size_t)K->count[k] + 1);
        if (lua_geti(L, arg, (lua_Integer)k + 1) == LUA_TTABLE)
            for (lua_Integer i = 1, n = luaL_len(L, -1); i <= n; i++) {
                lua_geti(L, -1, i);
                mark[check_cell(L, -1, K->count[k])] = 1;
                lua_pop(L, 1);
            }
        lua_pop(L, 1);
        wish->absent[k] = mark; /* the userdata stays on the stack meanwhile */
    }
}

static int matching_new(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    dm_matching_wish wish = {.hub = UINT32_MAX, .collapse = lua_toboolean(L, 4)};
    luaL_checkstack(L, 2 * DM_DIMENSION + 8, NULL);
    lua_settop(L, 4);
    if (!lua_isnil(L, 3)) wish.hub = check_cell(L, 3, m->K.count[0]);
    read_absent(L, 2, &wish, &m->K);
    matching *out = lua_newuserdatauv(L, sizeof *out, 2);
    memset(out, 0, sizeof *out);
    out->arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, 1);
    lua_pushvalue(L, 1);
    lua_setiuservalue(L, -2, 2);
    const dm_status status = dm_matching_build(&out->M, out->arena, &m->K, &wish, &dml_stop);
    if (status != DM_OK) raise_status(L, status);
    luaL_setmetatable(L, TNAME);
    return 1;
}

/* ---- asking it ---- */

static int matching_critical(lua_State *L) {
    const dm_matching *M = &check_matching(L)->M;
    const uint32_t k = check_degree(L, 2, M, 0);
    lua_createtable(L, (int)M->criticals[k], 0);
    dml_setresult(L);
    for (uint32_t i = 0; i < M->criticals[k]; i++) {
        lua_pushinteger(L, (lua_Integer)M->critical[k][i] + 1);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    return 1;
}

static int matching_core(lua_State *L) {
    const dm_matching *M = &check_matching(L)->M;
    lua_pushinteger(L, M->core[check_degree(L, 2, M, 0)]);
    return 1;
}

static void push_terms(lua_State *L, const dm_term *t, uint32_t count) {
    lua_createtable(L, 0, (int)count);
    dml_setresult(L);
    for (uint32_t i = 0; i < count; i++) {
        lua_pushinteger(L, t[i].coefficient);
        lua_rawseti(L, -2, (lua_Integer)t[i].cell + 1);
    }
}

static dm_flow *open_flow(lua_State *L, matching *m, uint32_t k) {
    if (!m->is_open[k]) {
        const dm_status status = dm_flow_open(m->flow + k, m->arena, &m->M, k);
        if (status != DM_OK) raise_status(L, status);
        m->is_open[k] = 1;
    }
    return m->flow + k;
}

/* The chain is read whole before anything is added: an error leaves nothing behind. */
static int matching_flow(lua_State *L) {
    matching *m = check_matching(L);
    const uint32_t k = check_degree(L, 2, &m->M, 0);
    luaL_checktype(L, 3, LUA_TTABLE);
    dm_flow *w = open_flow(L, m, k);
    size_t count = 0, i = 0;
    for (lua_pushnil(L); lua_next(L, 3); lua_pop(L, 1)) count++;
    dm_term *chain = lua_newuserdatauv(L, (count + 1) * sizeof *chain, 0);
    for (lua_pushnil(L); lua_next(L, 3); lua_pop(L, 1)) {
        chain[i].cell = check_cell(L, -2, m->M.K->count[k]);
        int is_whole;
        chain[i++].coefficient = dml_tointegerx(L, -1, &is_whole);
        if (!is_whole)
            luaL_error(L, "a coefficient must be an integer (got %s)", luaL_tolstring(L, -1, NULL));
    }
    int fine = 1;
    for (i = 0; i < count; i++) fine &= dm_flow_add(w, chain[i].cell, chain[i].coefficient);
    const dm_status status = dm_flow_run(w, &dml_stop);
    if (!fine || status != DM_OK) raise_status(L, fine ? status : DM_TOO_LARGE);
    push_terms(L, w->upper, w->uppers);
    push_terms(L, w->rest, w->rests);
    return 2;
}

/* alpha (or nil), values at critical cells (or nil) -> beta */
static int matching_cocone(lua_State *L) {
    lua_settop(L, 4);
    const dm_matching *M = &check_matching(L)->M;
    const uint32_t k = check_degree(L, 2, M, 0), above = k < M->K->n ? M->K->count[k + 1] : 0;
    double *alpha = lua_newuserdatauv(L, ((size_t)above + 1) * sizeof *alpha, 0);
    double *given = lua_newuserdatauv(L, ((size_t)M->criticals[k] + 1) * sizeof *given, 0);
    const int with_alpha = !lua_isnil(L, 3) && above > 0;
    if (with_alpha) dml_vectorarg(L, 3, "the values of a form", alpha, above);
    memset(given, 0, ((size_t)M->criticals[k] + 1) * sizeof *given);
    if (!lua_isnoneornil(L, 4) && M->criticals[k] > 0)
        dml_vectorarg(L, 4, "the values at critical cells", given, M->criticals[k]);
    double *beta = dml_pushvector(L, M->K->count[k]);
    for (uint32_t i = 0; i < M->criticals[k]; i++) beta[M->critical[k][i]] = given[i];
    dm_matching_cocone(M, k, with_alpha ? alpha : NULL, beta);
    return 1;
}

static int matching_gather(lua_State *L) {
    lua_settop(L, 3);
    const dm_matching *M = &check_matching(L)->M;
    const uint32_t k = check_degree(L, 2, M, 0), below = k > 0 ? M->K->count[k - 1] : 0;
    double *alpha = lua_newuserdatauv(L, ((size_t)M->K->count[k] + 1) * sizeof *alpha, 0);
    double *beta = lua_newuserdatauv(L, ((size_t)below + 1) * sizeof *beta, 0);
    dml_vectorarg(L, 3, "the values of a form", alpha, M->K->count[k]);
    memset(beta, 0, ((size_t)below + 1) * sizeof *beta);
    if (k > 0) dm_matching_cocone(M, k - 1, alpha, beta);
    dm_matching_gather(M, k, alpha, beta, dml_pushvector(L, M->criticals[k]));
    return 1;
}

/* ---- Smith's form ---- */

/* Entries of the table of rows at 1, each as long as the first. */
static void read_rows(lua_State *L, dm_smith *s) {
    for (uint32_t i = 0; i < s->m; i++) {
        if (lua_geti(L, 1, (lua_Integer)i + 1) != LUA_TTABLE || luaL_len(L, -1) != s->n)
            luaL_error(L, "dm.smith: row %d must be a list of %d integers", (int)i + 1, (int)s->n);
        for (uint32_t j = 0; j < s->n; j++) {
            int whole = 0;
            lua_geti(L, -1, (lua_Integer)j + 1);
            const lua_Integer x = dml_tointegerx(L, -1, &whole);
            if (!whole || x == LUA_MININTEGER)
                luaL_error(L, "dm.smith: entry %d of row %d must be an integer (got %s)",
                           (int)j + 1, (int)i + 1, luaL_tolstring(L, -1, NULL));
            s->D[(size_t)i * s->n + j] = x;
            lua_pop(L, 1);
        }
        lua_pop(L, 1);
    }
}

static void push_rows(lua_State *L, const char *name, const int64_t *a, uint32_t m, uint32_t n) {
    lua_createtable(L, (int)m, 0);
    for (uint32_t i = 0; i < m; i++) {
        lua_createtable(L, (int)n, 0);
        for (uint32_t j = 0; j < n; j++) {
            lua_pushinteger(L, a[(size_t)i * n + j]);
            lua_rawseti(L, -2, (lua_Integer)j + 1);
        }
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    lua_setfield(L, -2, name);
}

enum { MOST = 4000 }; /* rows or columns: four square matrices of them must fit in memory */

/* rows [, columns]: columns tells how many where there are no rows */
static int smith_form(lua_State *L) {
    dm_smith s;
    luaL_checktype(L, 1, LUA_TTABLE);
    const lua_Integer m = luaL_len(L, 1);
    lua_Integer n = dml_optinteger(L, 2, 0);
    if (m > 0 && lua_geti(L, 1, 1) == LUA_TTABLE) n = luaL_len(L, -1);
    if (m > MOST || n > MOST || n < 0)
        luaL_error(L, "dm.smith: a matrix of %I x %I; at most %d rows and columns", m, n, MOST);
    lua_settop(L, 1);
    if (dm_smith_open(&s, dml_pusharena(L), (uint32_t)m, (uint32_t)n) != DM_OK)
        raise_status(L, DM_NO_MEMORY);
    read_rows(L, &s);
    const dm_status status = dm_smith_form(&s, &dml_stop);
    if (status != DM_OK) raise_status(L, status);
    lua_createtable(L, 0, 6);
    lua_createtable(L, (int)s.rank, 0);
    for (uint32_t i = 0; i < s.rank; i++) {
        lua_pushinteger(L, s.D[(size_t)i * s.n + i]);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    lua_setfield(L, -2, "factors");
    lua_pushinteger(L, s.rank);
    lua_setfield(L, -2, "rank");
    push_rows(L, "U", s.U, s.m, s.m);
    push_rows(L, "W", s.W, s.m, s.m);
    push_rows(L, "V", s.V, s.n, s.n);
    push_rows(L, "X", s.X, s.n, s.n);
    return 1;
}

static const dml_row methods[] =
    {{"critical", matching_critical,
      "M:critical(k) -> list of cell numbers\nThe cells of degree k that are in no pair."},
     {"core", matching_core,
      "M:core(k) -> integer\nHow many cells of degree k collapses left over."},
     {"flow", matching_flow,
      "M:flow(k, chain) -> table, table\n"
      "h and f of a chain of degree k, tables from cells to integers: the cells of degree k + 1 "
      "along which it flows, and what is left of it on critical cells. Raises where an integer "
      "leaves 64 bits."},
     {"cocone", matching_cocone,
      "M:cocone(k, alpha [, values]) -> dm.vector\n"
      "The transpose, of degree k: h^T of alpha, values on the cells of degree k + 1 (nil for 0), "
      "and f^T of values at the critical cells of degree k."},
     {"gather", matching_gather,
      "M:gather(k, alpha) -> dm.vector\n"
      "Values at the critical cells of degree k from alpha on all cells of that degree: alpha - "
      "h^T alpha on the boundary."},
     {NULL, NULL, NULL}};

static const dml_row functions[] =
    {{"matching", matching_new,
      "core.matching(K [, absent] [, hub] [, collapse]) -> dm.matching\n"
      "An acyclic matching of the cells of a mesh by coreductions from the vertex hub: few cells "
      "stay in no pair. absent: [k + 1] is a list of cells of degree k that are taken as nothing. "
      "collapse = true: free faces are taken away first. K:homology, K:cone and K:potential are "
      "made of it (Leok 3.11)."},
     {"smith_form", smith_form,
      "core.smith_form(rows [, columns]) -> {factors, rank, U, W, V, X}\n"
      "Smith's normal form of a matrix of integers, as lists of rows: U A V is diagonal with "
      "factors, W = U^-1, X = V^-1; see dm.smith. Raises where an integer leaves 64 bits."},
     {NULL, NULL, NULL}};

const dml_class dml_class_matching = {
    .name = TNAME,
    .doc = "dm.matching: an acyclic matching of the cells of a mesh, made by core.matching(K)\n"
           "M:critical(k): the cells in no pair; chains flow along the pairs to them (Leok 3.11).",
    .methods = methods,
    .functions = functions,
};
