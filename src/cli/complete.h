/* complete.h - Tab: readline asks, dm.complete answers. Only in a build with readline. */
#ifndef DML_COMPLETE_H
#define DML_COMPLETE_H

#include <lua.h>

void dml_complete_open(lua_State *L);

/* Earlier lines of the entry (kept by the caller), or NULL. */
void dml_complete_before(const char *text);

#endif
