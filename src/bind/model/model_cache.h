/* model_cache.h - the model of the last run of a system, for the next one: the function is traced
 * at every run, and when its graph is the one of the last run, node for node, so are the
 * kernels. */
#ifndef DML_MODEL_KEPT_H
#define DML_MODEL_KEPT_H

#include "bind/model/bind_system.h"

/* Push the kept model of the system at `arg` with kernels by `compile`; NULL and nothing pushed
 * when there is none. */
dml_model *dml_pushkept(lua_State *L, int arg, dm_compile *compile);

/* Has the kept model the graph of *fresh, which was just traced? */
int dml_sametrace(const dml_model *kept, const dml_model *fresh);

/* Keep the model on top of the stack, just traced, in place of the last one. */
void dml_keep(lua_State *L, int arg, dml_model *m, dm_compile *compile);

#endif
