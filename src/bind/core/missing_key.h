/* missing_key.h - what was asked for last and is not there. A field, method or index that does not
 * exist is nil, as in all of Lua, so that scripts can probe; the error that comes of the nil a
 * moment later names it, and the nearest name. */
#ifndef DML_MISSING_KEY_H
#define DML_MISSING_KEY_H

#include "bind/core/bind.h"

/* Note that the function at `level` of the stack asked something, "dm.path" or "a vector of 2",
 * for the key at index `key` in vain. A note is forgotten with the next one. */
void dml_miss(lua_State *L, int level, const char *of, int key);

/* The message on top gets what was noted at its line, where it speaks of a nil. */
void dml_explain(lua_State *L);

/* What is noted, as words that are pushed, or NULL; and forget it, before a function is called
 * whose nil is looked into. */
const char *dml_noted(lua_State *L);
void dml_forget(lua_State *L);

/* luaL_typeerror; of a nil it says what the function that called has it under: (global 'K'). */
int dml_typeerror(lua_State *L, int arg, const char *wanted);

/* Push a copy of the table at `table` that notes which name a function asked for in vain;
 * anything else as it is. */
void dml_pushparams(lua_State *L, int table);

/* Push a copy of a table of params, with a metatable of theirs, to put other values in. */
void dml_copyparams(lua_State *L, int table);

/* core.miss(of, key [, names]), for classes written in Lua; core.nearest(word, names) -> name or
 * nil */
int dml_core_miss(lua_State *L);
int dml_core_nearest(lua_State *L);

#endif
