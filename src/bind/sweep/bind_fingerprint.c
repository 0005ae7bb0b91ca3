/* bind_fingerprint.c - what decides the result of a run, as a short text: two systems whose
 * functions are traced to the same graph have the same one, whatever their script looks like. */
#include "algebra/fingerprint.h"
#include "base/random.h"
#include "bind/model/bind_system.h"
#include "bind/run/bind_path.h"
#include "bind/trace/function.h"
#include "bind/value/array.h"
#include "numbers/processor.h"

#include <math.h>
#include <stdio.h>

/* Continue a hash with a function that was traced. */
static void add_traced(lua_State *L, uint64_t *hash, const dm_graph *g, const dm_node *out,
                       uint32_t count, dm_arena *arena) {
    if (!dm_fingerprint(hash, g, out, count, arena)) luaL_error(L, "not enough memory");
}

/* with a field of the system at 1 as it prints */
static void add_field(lua_State *L, uint64_t *hash, const char *key) {
    size_t length;
    dml_systemfield(L, 1, key);
    const char *text = luaL_tolstring(L, -1, &length);
    *hash = dm_hash(*hash, text, length + 1);
    lua_pop(L, 2);
}

/* with what it is a system of: space, rule of a discrete Lagrangian */
static void add_kind(lua_State *L, uint64_t *hash) {
    static const char *const fields[] = {"Q", "rule"};
    const dml_system *s = dml_checksystem(L, 1);
    const uint32_t kind[] = {s->n,
                             s->momenta,
                             (uint32_t)s->placed,
                             (uint32_t)s->pair,
                             (uint32_t)s->ruled,
                             (uint32_t)s->hamiltonian,
                             (uint32_t)s->field};
    *hash = dm_hash(*hash, kind, sizeof kind);
    *hash = dm_hash(*hash, &s->h, sizeof s->h);
    for (size_t k = 0; k < sizeof fields / sizeof *fields; k++) add_field(L, hash, fields[k]);
}

/* with the chart of the group that the system lives on: groups of a user may print alike */
static void add_group(lua_State *L, uint64_t *hash, const dml_model *m, dm_arena *arena) {
    const dm_chart_trace *t = m->group.trace + DM_TAU_EXP;
    const uint32_t d = m->group.momenta;
    if (t->chart) add_traced(L, hash, t->chart, t->place, m->n + d, arena);
    if (t->end) add_traced(L, hash, t->end, t->carried, m->n + d, arena);
}

/* L (or Ld, H) and the functions that constrain the system or act on it */
static uint64_t fingerprint_of(lua_State *L, uint64_t hash, const dml_model *m) {
    dm_arena *arena = dml_pusharena(L);
    add_traced(L, &hash, m->graph, &m->lagrangian, 1, arena);
    hash = dm_hash(hash, m->values, m->params * sizeof *m->values);
    if (m->placed) add_group(L, &hash, m, arena);
    for (int k = 0; k < DML_CONSTRAINT_FUNCTIONS; k++) {
        const dml_traced *t = &m->constraint[k];
        if (!t->graph) continue;
        hash = dm_hash(hash, &k, sizeof k);
        add_traced(L, &hash, t->graph, t->out, (uint32_t)t->outputs, arena);
    }
    dml_sparearena(L, lua_gettop(L));
    lua_pop(L, 1);
    return hash;
}

/* a vector of n random numbers in [-2, 2] */
static void push_random(lua_State *L, uint32_t n, uint64_t row, uint32_t first) {
    double *x = dml_pushvector(L, n);
    for (uint32_t i = 0; i < n; i++) x[i] = 4 * dm_random_uniform(5, row, first + i) - 2;
}

/* L or Ld of the system at 1 at random numbers; NaN where it is none */
static double value_at(lua_State *L, const dml_system *s, uint64_t row) {
    if (s->pair)
        dml_pushboundpair(L, 1, "Ld");
    else
        dml_pushbound(L, 1, "L");
    push_random(L, s->n, row, 1);
    push_random(L, s->n, row, 1 + s->n);
    if (!s->pair) lua_pushnumber(L, 4 * dm_random_uniform(5, row, 0) - 2);
    const int fine = dml_try(L, s->pair ? 2 : 3, 1);
    const double value = fine && lua_type(L, -1) == LUA_TNUMBER ? lua_tonumber(L, -1) : NAN;
    lua_pop(L, 1);
    return isnan(value) ? (double)NAN : value;
}

/* Of functions on hyper-dual numbers, which have no graph: by what they give at places. */
static uint64_t fingerprint_of_values(lua_State *L, uint64_t hash) {
    enum { PLACES = 64 };
    for (uint64_t row = 0; row < PLACES; row++) {
        const double value = value_at(L, dml_checksystem(L, 1), row);
        hash = dm_hash(hash, &value, sizeof value);
    }
    return hash;
}

/* of a dm.function */
static uint64_t fingerprint_of_function(lua_State *L, const dml_function *f) {
    uint64_t hash = dm_hash(DM_HASH_START, &f->inputs, sizeof f->inputs);
    dm_arena *arena = dml_pusharena(L);
    add_traced(L, &hash, f->graph, f->parts[DML_VALUE].nodes, dml_outputs(f), arena);
    dml_sparearena(L, lua_gettop(L));
    lua_pop(L, 1);
    return hash;
}

/* at 1; of a discrete Lagrangian of a system and a rule by that system, too */
static uint64_t fingerprint_of_system(lua_State *L) {
    uint64_t hash = DM_HASH_START;
    dml_checksystem(L, 1);
    add_kind(L, &hash);
    while (dml_checksystem(L, 1)->ruled) {
        dml_systemfield(L, 1, "system");
        lua_replace(L, 1);
        add_kind(L, &hash);
    }
    const dml_model *m = dml_pushmodel(L, 1);
    return m->graph ? fingerprint_of(L, hash, m) : fingerprint_of_values(L, hash);
}

/* Of the system of the path at 1 as the path was stepped with it. */
static uint64_t fingerprint_of_path(lua_State *L) {
    uint64_t hash = DM_HASH_START;
    lua_getiuservalue(L, 1, DML_PATH_MODEL);
    lua_getiuservalue(L, 1, DML_PATH_SYSTEM);
    lua_replace(L, 1);
    const dml_model *m = lua_touserdata(L, 2);
    if (!m || !m->graph) return fingerprint_of_system(L);
    add_kind(L, &hash);
    return fingerprint_of(L, hash, m);
}

/* (system | path | function) -> text */
static int fingerprint(lua_State *L) {
    char text[24];
    lua_settop(L, 1);
    const dml_function *f = luaL_testudata(L, 1, DML_FUNCTION);
    const uint64_t hash = f                                ? fingerprint_of_function(L, f)
                          : luaL_testudata(L, 1, DML_PATH) ? fingerprint_of_path(L)
                                                           : fingerprint_of_system(L);
    snprintf(text, sizeof text, "%016llx", (unsigned long long)hash);
    lua_pushstring(L, text);
    return 1;
}

/* (system) -> entries of q, entries of p */
static int sizes(lua_State *L) {
    const dml_system *s = dml_checksystem(L, 1);
    lua_pushinteger(L, s->n);
    lua_pushinteger(L, s->momenta);
    return 2;
}

/* () -> name of the level that holds now */
static int processor(lua_State *L) {
    static const char *const names[] = {"plain", "fma", "avx512"};
    lua_pushstring(L, names[dm_processor()]);
    return 1;
}

static const dml_row functions[] = {
    {"fingerprint", fingerprint,
     "core.fingerprint(system | path | function) -> string\n"
     "Sixteen digits that another space, L, force or constraint changes, and another script of the "
     "same functions does not; with derivatives = \"hyperdual\" by values of L at 64 places. Of a "
     "path: of its system as it was stepped."},
    {"sizes", sizes, "core.sizes(system) -> integer, integer\nEntries of q (flat) and of p."},
    {"processor", processor,
     "core.processor() -> string\n"
     "\"plain\", \"fma\" or \"avx512\": what bits of results depend on (DMLUA_PROCESSOR)."},
    {NULL, NULL, NULL}};

const dml_class dml_class_fingerprint = {
    .functions = functions,
};
