/* model_roots.c - implicit functions in the functions of a model. */
#include "bind/model/bind_system.h"
#include "bind/trace/bind_root.h"

const char *dml_modeltrouble(lua_State *L, const dml_model *m) {
    const char *of_constraints = dml_roottrouble(L, m->constrained.graph);
    if (*of_constraints) return of_constraints;
    const char *of_map = dml_roottrouble(L, m->constraint[DML_MAP].graph);
    return *of_map ? of_map : dml_roottrouble(L, m->graph);
}

void dml_forgetroots(const dml_model *m) {
    if (m->graph) dm_root_forget(m->graph);
    if (m->constrained.graph) dm_root_forget(m->constrained.graph);
    if (m->constraint[DML_MAP].graph) dm_root_forget(m->constraint[DML_MAP].graph);
}
