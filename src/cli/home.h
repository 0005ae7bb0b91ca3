/* home.h - where dmlua finds its own Lua files. */
#ifndef DML_HOME_H
#define DML_HOME_H

#include <lua.h>

/* Preload dm.core and dm.manual, let require find dm and dm.* beside the executable, and set the
 * global dm. package.path and package.cpath stay as they are. A status with a message. */
int dml_open_home(lua_State *L);

#endif
