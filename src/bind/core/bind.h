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

/* Methods that a binding file gives to a class of another one. */
typedef struct {
    const char *class; /* NULL ends a list */
    const dml_row *methods;
} dml_extension;

/* What a binding file adds to Lua, as the constant dml_class_<row of classes.def>; nothing else
 * registers anything. NULL stands for what it has none of. */
typedef struct {
    const char *name;           /* "dm.path": a class begins here */
    const char *doc;            /* of the class */
    const dml_row *meta;        /* its metamethods, without docs */
    const dml_row *methods;     /* Lua modules add to them with core.method */
    lua_CFunction field;        /* asked for value.key first; declines by 0 results */
    const dml_row *functions;   /* of dm itself */
    const dml_extension *more;  /* of classes above it in classes.def */
    void (*open)(lua_State *L); /* what rows cannot say; dm.core is on top before and after */
} dml_class;

/* Register it; dm.core is on top. */
void dml_register(lua_State *L, const dml_class *c);

/* The C function at `at`, that of its row where it has one; NULL: none. */
lua_CFunction dml_rowof(lua_State *L, int at);

/* Add a row, which must stay where it is, to the table on top and file its doc under
 * registry.dm_docs[function]; the same for `rows`, which name = NULL ends. */
void dml_setfunction(lua_State *L, const dml_row *row);
void dml_setfunctions(lua_State *L, const dml_row *rows);

/* How many arguments the signature that begins a doc allows, the object in front of a colon among
 * them: the most of its alternatives "f(a [, b]) -> c   or   f{d=}"; -1: any number ("..."). */
int dml_arity(const char *doc);

/* Raise where an argument behind number `most` is not nil; the message shows the signature. */
void dml_checksurplus(lua_State *L, int most, const char *doc);

/* The doc of the value at `at`, a function or the name of a class; NULL: none. */
void dml_setdoc(lua_State *L, int at, const char *doc);

/* Give the metatable on top, of class `name`, what all classes have: methods, and an __index that
 * asks `field` (or NULL) first, then the methods, and notes what is in neither. */
void dml_setindex(lua_State *L, const char *name, lua_CFunction field);

/* An arena owned by Lua: pushes a userdata that keeps its memory, which the collector takes
 * back. It comes from the allocator of the state: one that refuses is felt here too. */
dm_arena *dml_pusharena(lua_State *L);

/* Options tables. Each raises "field 'h' must be ... (got ...)" with what to try.
 * options: the keys that may occur, NULL at the end; another one: "did you mean".
 * number: finite, required when fallback is NaN. positive: > 0 and finite, required when
 * fallback is 0. count: whole and >= least, required when fallback < least.
 * numbers: a table or vector of n finite numbers. flag: true or false. text: a string or
 * nothing. */
void dml_options(lua_State *L, int arg, const char *const *known);
double dml_number(lua_State *L, int arg, const char *key, double fallback);
double dml_positive(lua_State *L, int arg, const char *key, double fallback);
long dml_count(lua_State *L, int arg, const char *key, long least, long fallback);
int dml_flag(lua_State *L, int arg, const char *key, int fallback);
void dml_text(lua_State *L, int arg, const char *key);
/* What they are made of. field: push table[key], true when it is not nil. wrongfield: raise
 * "field 'key' must be `expected` (got ...)", the value being on top. */
int dml_field(lua_State *L, int arg, const char *key);
int dml_wrongfield(lua_State *L, const char *key, const char *expected);
void dml_numbers(lua_State *L, int arg, const char *key, double *out, uint32_t n);
/* Raises where doubles near the time t0 are too far apart for steps of h. */
void dml_refuse_late(lua_State *L, double t0, double h);

/* Behind a message about the value at arg: what to do where it is a text that reads as a number, as
 * those of io.read and arg are; "" of any other. */
#define DML_TEXT_HINT ": write it without quotes, or tonumber(text)"
const char *dml_text_hint(lua_State *L, int arg);

/* As luaL_checknumber, lua_tointegerx and their relatives, but a text of digits is no number. */
double dml_checknumber(lua_State *L, int arg);
double dml_optnumber(lua_State *L, int arg, double fallback);
lua_Integer dml_checkinteger(lua_State *L, int arg);
lua_Integer dml_optinteger(lua_State *L, int arg, lua_Integer fallback);
lua_Integer dml_tointegerx(lua_State *L, int at, int *is_whole);

/* That of `known` which others call `word` or which is spelt most like it, or NULL when none is
 * near: for "did you mean". */
const char *dml_nearest(const char *word, const char *const *known);

/* Set by the cli's SIGINT handler; cleared when a run has seen it. */
extern volatile sig_atomic_t dml_stop;

/* Raise where it is set: for loops that take long and leave nothing behind. */
static inline void dml_checkstop(lua_State *L) {
    if (!dml_stop) return;
    dml_stop = 0;
    luaL_error(L, "interrupted!");
}

/* Set it, from a signal handler. While a module of ours is loaded a stop waits until the module is
 * whole: what it has put into its place would stay there, and be wrapped again by the next load.
 * Holds nest. */
void dml_tell_stop(void);
void dml_hold_stops(void);
void dml_release_stops(void);
int dml_holds_stops(void);

/* Ctrl-C as an error on its way through Lua: no pcall of our modules may keep it but
 * core.until_stop. */
extern volatile sig_atomic_t dml_raised;

/* lua_call of a function of the user that gives one value, which is pushed, nil for none. More
 * than one raise: what is behind the first would be lost in silence. `what` names the function. */
void dml_callone(lua_State *L, int arguments, const char *what);

/* Is the value at `at` what a stop raises, by Ctrl-C or a deadline: a text with "interrupted!", or
 * a dm.failure of code "stopped"? */
int dml_is_stop(lua_State *L, int at);

/* lua_pcall for what may fail: true when it did not. Stops, which may come between any two
 * instructions of Lua, and want of memory are passed on. */
int dml_try(lua_State *L, int arguments, int results);

/* lua_settop for a stack with values to be closed above `top`. Lua 5.4.0 to 5.4.4 keeps the old
 * address of a stack that the call of a __close made larger: here there is room for that call. */
void dml_cut(lua_State *L, int top);

/* require "dm.core" */
int luaopen_dm_core(lua_State *L);

/* Push a shallow copy of a table. */
void dml_pushcopy(lua_State *L, int table);

/* Make the table on top a result: tostring shows its entries. */
void dml_setresult(lua_State *L);

/* Put in the place of the list on top one that reads as it does and raises that `what`, "the
 * columns of a path", cannot be set. */
void dml_lock(lua_State *L, const char *what);

/* Put a table of its own in the place of such a list; what else is there stays. */
void dml_unlock(lua_State *L, int at);

#endif
