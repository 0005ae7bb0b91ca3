/* read_file.h - files that are read: regular ones and pipes, nothing that has no end. */
#ifndef DML_READ_FILE_H
#define DML_READ_FILE_H

#include "bind/core/bind.h"

#include <stdio.h>

/* Push a file of Lua, open for reading, which can be sought in; of a pipe what came through it, up
 * to its end. NULL: what is pushed says why not, "cannot open name: ..." or "cannot read name:
 * ...". */
FILE *dml_openfile(lua_State *L, const char *name);

/* core.open_file */
int dml_core_open_file(lua_State *L);

#endif
