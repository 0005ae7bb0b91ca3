/* model_roots.c - implicit functions in the functions of a model. */
#include "bind/model/bind_system.h"
#include "bind/trace/bind_root.h"

const char *dml_modeltrouble(lua_State *L, const dml_model *m) {
    const char *of_constraints = dml_roottrouble(L, m->constrained.graph);
    return *of_constraints ? of_constraints : dml_roottrouble(L, m->graph);
}

void dml_forgetroots(const dml_model *m) {
    if (m->graph) dm_root_forget(m->graph);
    if (m->constrained.graph) dm_root_forget(m->constrained.graph);
}
