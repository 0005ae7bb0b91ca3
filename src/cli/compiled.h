/* compiled.h - modules in Lua as make has compiled them. Reading one takes a fifth of the time of
 * compiling its text (rows "first" of `tests/bench/frames.lua first`). */
#ifndef DML_COMPILED_H
#define DML_COMPILED_H

#include <lua.h>

#include <stddef.h>

/* The bytes of a file that lua/dm/session/compiled.lua wrote, for as long as the process lives;
 * none: NULL, 0. */
typedef struct {
    const char *bytes;
    size_t size;
} dml_compiled;

/* None where the file is missing, or was written by another program or with another Lua. */
dml_compiled dml_compiled_open(const char *file);

/* As luaL_loadfile(L, file): a status, and the chunk or a message on the stack. What is compiled is
 * taken only where `file` has, byte for byte, the text that it was compiled from. */
int dml_compiled_load(lua_State *L, const dml_compiled *from, const char *file);

#endif
