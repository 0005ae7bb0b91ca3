/* run_file.h - rows of a run that go to a .npy file as they come, so that memory stays bounded. */
#ifndef DML_RUN_FILE_H
#define DML_RUN_FILE_H

#include "bind/core/bind.h"
#include "run/run.h"

#include <stdio.h>

enum { DML_ROWS_IN_MEMORY = 4096 }; /* of a run that writes its rows */

typedef struct {
    dm_outlet outlet;
    luaL_Stream *stream;
    const char *name; /* on the stack */
    size_t width;
    long rows; /* written */
    int names; /* stack index of the names of columns */
} dml_run_file;

/* Open the file that field 'file' of the options at 2 names and write the header for the columns
 * whose names are the list at `names`. Raises when that is not possible. Leaves things on the
 * stack that must stay. */
void dml_file_open(lua_State *L, dml_run_file *f, int names);

/* Write the number of rows into the header and close. 0: the disk is full. */
int dml_file_close(lua_State *L, dml_run_file *f);

#endif
