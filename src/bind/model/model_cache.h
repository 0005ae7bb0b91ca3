/* model_cache.h - the model of the last run of a system, for the next one: the function is traced
 * at every run, and when its graph is the one of the last run, node for node, so are the
 * kernels. */
#ifndef DML_MODEL_CACHE_H
#define DML_MODEL_CACHE_H

#include "bind/model/bind_system.h"

/* Push the cached model of the system at `arg` with kernels by `compile`; NULL and nothing pushed
 * when there is none. */
dml_model *dml_pushcached(lua_State *L, int arg, dm_compile *compile);

/* Has the cached model the graph of *fresh, which was just traced? */
int dml_sametrace(const dml_model *cached, const dml_model *fresh);

/* Keep the model on top of the stack, just traced, in place of the last one. */
void dml_cachemodel(lua_State *L, int arg, dml_model *m, dm_compile *compile);

#endif
