/* bind_step.h - `dm.step`: a rule from three Lua functions. */
#ifndef DML_STEP_H
#define DML_STEP_H

#include "bind/model/bind_system.h"
#include "integ/step_method.h"

/* Trace the functions of the dm.rule at `object` for the system at `arg` and push what keeps their
 * kernels alive. Raises what dml_trace raises, and wrong lengths. */
const dm_step_kernels *dml_step_trace(lua_State *L, int object, int arg, const char *backend);

#endif
