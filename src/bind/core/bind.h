/* bind.h - what every binding file shares. Only this folder and cli see lua.h. */
#ifndef DML_BIND_H
#define DML_BIND_H

#include "base/arena.h"
#include "base/status.h"

#include <lauxlib.h>
#include <lua.h>
#include <signal.h>

/* One row per function that Lua sees: name, C function, docstring for help(). Its first line
 * is "signature -> result", then shapes, units, errors, source. Metamethods may have none. */
typedef struct {
    const char *name;
    lua_CFunction call;
    const char *doc;
} dml_row;

/* Add `rows` (name = NULL ends it) to the table on top and file their docs under
 * registry.dm_docs[function]. */
void dml_setfunctions(lua_State *L, const dml_row *rows);

/* Register class `tname` ("dm.path"): its doc (dm_docs["dm.path"]), metamethods, methods.
 * value.key asks `field` first (may be NULL; returns 0 results to decline), then the
 * methods, to which Lua modules add with dm.core.method(tname, name, f, doc). */
void dml_newclass(lua_State *L, const char *tname, const char *doc, const dml_row *meta,
                  const dml_row *methods, lua_CFunction field);

/* Add methods to a class that another file registered; the stack stays as it is. */
void dml_addmethods(lua_State *L, const char *tname, const dml_row *methods);

/* An arena owned by Lua: pushes a userdata that keeps its memory, which the collector takes
 * back. It comes from the allocator of the state: one that refuses is felt here too. */
dm_arena *dml_pusharena(lua_State *L);

/* Options tables. Each raises "field 'h' must be ... (got ...)" with what to try.
 * options: the keys that may occur, NULL at the end; another one: "did you mean".
 * number: finite, required when fallback is NaN. positive: > 0 and finite, required when
 * fallback is 0. count: whole and >= least, required when fallback < least.
 * numbers: a table or vector of n finite numbers. */
void dml_options(lua_State *L, int arg, const char *const *known);
double dml_number(lua_State *L, int arg, const char *key, double fallback);
double dml_positive(lua_State *L, int arg, const char *key, double fallback);
long dml_count(lua_State *L, int arg, const char *key, long least, long fallback);
/* What they are made of. field: push table[key], true when it is not nil. wrongfield: raise
 * "field 'key' must be `expected` (got ...)", the value being on top. */
int dml_field(lua_State *L, int arg, const char *key);
int dml_wrongfield(lua_State *L, const char *key, const char *expected);
void dml_numbers(lua_State *L, int arg, const char *key, double *out, uint32_t n);

/* Closest of `known` to `word`, or NULL when none is near: for "did you mean". */
const char *dml_nearest(const char *word, const char *const *known);

/* Set by the cli's SIGINT handler; cleared when a run has seen it. */
extern volatile sig_atomic_t dml_stop;

/* Ctrl-C as an error on its way through Lua: no pcall of our modules may keep it but
 * core.until_stop. */
extern volatile sig_atomic_t dml_raised;

/* lua_pcall for what may fail: true when it did not. Ctrl-C, which may come between any two
 * instructions of Lua, and want of memory are passed on. */
int dml_try(lua_State *L, int arguments, int results);

/* One opener per binding file, listed in classes.def; each adds to the table on top. */
#define X(name) void dml_open_##name(lua_State *L);
#include "bind/classes.def"
#undef X

/* require "dm.core" */
int luaopen_dm_core(lua_State *L);

/* Push a shallow copy of a table. */
void dml_pushcopy(lua_State *L, int table);

/* Make the table on top a result: tostring shows its entries. */
void dml_setresult(lua_State *L);

#endif
