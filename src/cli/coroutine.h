/* coroutine.h - coroutine.resume and coroutine.wrap that tell which thread runs, so that Ctrl-C
 * reaches it. */
#ifndef DML_COROUTINE_H
#define DML_COROUTINE_H

#include <lua.h>

/* In place of the two functions of the library, and like them in all else. */
void dml_open_coroutines(lua_State *L);

#endif
