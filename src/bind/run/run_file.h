/* run_file.h - rows of a run that go to a .npy file as they come, so that memory stays bounded. The
 * header counts them block by block: of a run that is killed the file is whole up to there. */
#ifndef DML_RUN_FILE_H
#define DML_RUN_FILE_H

#include "bind/run/bind_path.h"
#include "run/run.h"

#include <stdio.h>

enum { DML_ROWS_IN_MEMORY = 4096 }; /* of a run that writes its rows */

typedef struct {
    dm_outlet outlet;
    luaL_Stream *stream;
    const char *name; /* on the stack */
    size_t width;
    long rows;   /* in the file, as its header says between two blocks */
    long before; /* of those, from the run that this one goes on from */
    long last;   /* rows of the last block that went there, which were the first in memory */
    long behind; /* place of the number of rows in the header, in bytes */
    long size;   /* of the header */
    int names;   /* stack index of the names of columns */
    int why;     /* errno of what could not be written */
} dml_run_file;

/* Where a run goes on. */
typedef struct {
    double t;            /* NaN: it does not, it starts */
    long missing;        /* rows before it that the file did not take */
    const double *state; /* its q, the first n, stands in a row behind the time */
    size_t n;            /* 0: rows hold something else */
} dml_file_start;

/* Open the file that field 'file' of the options at 2 names, for the columns whose names are the
 * list at `names`; arrays: q1, q2, ... are one field q, as those of a field on a mesh. A run that
 * goes on adds to a file of the same columns, whose rows from its time on it replaces. Raises when
 * that is not possible, as where rows before it are missing, or where the row of its time is that
 * of another state. Leaves things on the stack that must stay. */
void dml_file_open(lua_State *L, dml_run_file *f, int names, int arrays,
                   const dml_file_start *from);

/* Close it. 0: it is not whole, f->why says why. */
int dml_file_close(lua_State *L, dml_run_file *f);

/* After a run of `rows` rows the path keeps the last, or those that could not be written. */
void dml_file_keep(const dml_run_file *f, dml_path *path, long rows);

#endif
