/* bind_field_force.c - masses and forces of a field: of its L as it is now, or as it was when a
 * path was made. */
#include "bind/model/bind_system.h"
#include "bind/run/bind_path.h"
#include "bind/value/array.h"
#include "chain/virtual_work.h"

#include <string.h>

/* the model that the path at 1 was stepped with, or that of the system there as it is now */
static dml_model *push_model_of(lua_State *L) {
    if (!luaL_testudata(L, 1, DML_PATH)) return dml_pushlast(L, 1, NULL);
    if (lua_getiuservalue(L, 1, DML_PATH_MODEL) == LUA_TNIL) luaL_error(L, "a path of no model");
    return lua_touserdata(L, -1);
}

/* core.field_masses(system | path): one for every entry of q, nil where the kinetic energy is of
 * another kind; why no rule steps them */
static int field_masses(lua_State *L) {
    const dml_model *m = push_model_of(L);
    const uint32_t n = m->n;
    if (!m->model.mass_matrix || !(m->model.structure & DM_CELLS)) return 0;
    memcpy(dml_pushvector(L, n), m->model.mass_matrix, n * sizeof(double));
    lua_pushstring(L, m->model.unfit);
    return 2;
}

/* core.field_force(system | path, q, t, v): dL/dq; where v is given, at v and with the forces
 * beside L */
static int field_force(lua_State *L) {
    const double t = dml_optnumber(L, 3, 0.0);
    lua_settop(L, 4);
    dml_model *m = push_model_of(L);
    const size_t n = m->n;
    dml_want(L, m, DM_WANT_FORCE, NULL);
    double *x = lua_newuserdatauv(L, (2 * n + 1) * sizeof *x, 0);
    memset(x, 0, (2 * n + 1) * sizeof *x);
    dml_vectorarg(L, 2, "q", x, m->n);
    if (!lua_isnil(L, 4)) dml_vectorarg(L, 4, "v", x + n, m->n);
    x[2 * n] = t;
    double *out = dml_pushvector(L, m->n);
    dm_kernel_prepare(&m->model.force, out);
    dm_kernel_eval(&m->model.force, x, out);
    if (lua_isnil(L, 4) || !m->model.work) return 1;
    double *scratch = lua_newuserdatauv(L, (dm_work_room(m->model.work) + 1) * sizeof *scratch, 0);
    dm_work_add(m->model.work, out, x, scratch);
    lua_pop(L, 1);
    return 1;
}

static const dml_row functions[] = {
    {"field_masses", field_masses,
     "core.field_masses(system | path) -> dm.vector or nil, text or nil\n"
     "The mass of every value, now or when a path was made; nil where the kinetic energy is no sum "
     "of m v^2 / 2. The text says why no rule steps these masses."},
    {"field_force", field_force,
     "core.field_force(system | path, q [, t [, v]]) -> dm.vector\n"
     "The force dL/dq at v = 0, or at v with the forces beside L; of a path: of the L that it was "
     "made with."},
    {NULL, NULL, NULL}};

const dml_class dml_class_field_force = {
    .functions = functions,
};
