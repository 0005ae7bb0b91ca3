/* repl.h - an interactive session. */
#ifndef DML_REPL_H
#define DML_REPL_H

#include <lua.h>

/* Execute the start-up file, when there is one; its errors are shown. */
void dml_startup(lua_State *L);

/* Read, evaluate and print until the input ends. environment: may variables be read? */
void dml_session(lua_State *L, int environment);

#endif
