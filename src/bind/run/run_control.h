/* run_control.h - `control = { tolerance =, largest =, ends =, hidden =, negligible = }` of a run:
 * steps as long as their error allows. */
#ifndef DML_RUN_CONTROL_H
#define DML_RUN_CONTROL_H

#include "bind/run/stepping.h"
#include "run/control.h"

enum { DML_CONTROL_MOST = 200000 }; /* steps of a run that keeps every one */

typedef struct {
    dm_control control;
    dm_hidden hidden;
} dml_run_control;

/* Field 'control' of the options at 2, for a run up to the time `until`. Leaves things on the
 * stack that must stay. */
dm_control *dml_control_read(lua_State *L, dml_run_control *c, const dml_stepping *r, double until);

#endif
