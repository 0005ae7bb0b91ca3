/* field_rows.h - rows t, q, p of runs of a field that no dm_run makes: of asynchronous steps, over
 * uneven slices. They stay in the path or, with option `file` of the table at stack index 2, go to
 * a file as they come; the path then keeps the last one. */
#ifndef DML_FIELD_ROWS_H
#define DML_FIELD_ROWS_H

#include "bind/run/bind_path.h"
#include "bind/run/run_file.h"

typedef struct {
    dml_path *path;
    dml_run_file file;
    int is_filed;
    long room, held; /* rows that the path has room for, and has that are not in the file yet */
    long rows;       /* of the run so far */
} dml_field_rows;

/* Push an empty path for `rows` rows of the system at stack index `system`, whose n coordinates are
 * a field's. from: the time at which the run goes on; NaN: a start. Option `missing`: rows before
 * it that the file does not have. Other things stay below it. */
dml_path *dml_field_rows_open(lua_State *L, dml_field_rows *r, int system, uint32_t n, long rows,
                              double from);

/* *row: room for the next row, 1 + 2 n numbers. DM_NOT_WRITTEN: r->file.why says why. */
dm_status dml_field_rows_next(dml_field_rows *r, double **row);

/* The rest goes to the file, which is closed; the path keeps its last row. DM_NOT_WRITTEN then
 * takes the place of DM_OK. */
dm_status dml_field_rows_close(lua_State *L, dml_field_rows *r, dm_status status);

/* Push why rows were not written, for a failure. */
const char *dml_field_rows_why(lua_State *L, const dml_field_rows *r);

#endif
