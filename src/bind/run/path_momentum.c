/* path_momentum.c - momentum maps along a recorded path, and whether a group acts on its
 * coordinates at all. */
#include "bind/model/bind_space.h"
#include "bind/model/space_group.h"
#include "bind/run/bind_path.h"
#include "bind/trace/traced_call.h"
#include "bind/value/array.h"

#include <math.h>

/* J = p . xi(q) along the path for a generator xi written in Lua, at stack index 2 */
static int momentum_of_generator(lua_State *L, const dml_path *p) {
    const dml_signature s = {.what = "generator",
                             .arguments = 1,
                             .length = {(int)p->n},
                             .outputs = (int)p->n};
    double *xi = lua_newuserdatauv(L, p->n * sizeof *xi, 0);
    double *J = dml_pushvector(L, (uint32_t)p->rows);
    for (long i = 0; i < p->rows; i++) {
        const double *row = p->data + (size_t)i * dml_path_width(p);
        dml_call_numbers(L, 2, &s, row + 1, xi, p->n);
        J[i] = 0.0;
        for (uint32_t k = 0; k < p->n; k++) J[i] += row[1 + p->n + k] * xi[k];
    }
    return 1;
}

/* Do coordinates turn as the action of a group has it? Where the mass says that they do not, as of
 * r and phi, p . xi is a number of no use. What is told of a few rows, by 1 %. */
static void check_action(lua_State *L, const dml_path *p, const dm_action *action) {
    const int top = lua_gettop(L);
    const dml_system *s = dml_checksystem(L, 4);
    if (s->pair || s->stand_in || !p->rows) return;
    dml_model *m = dml_path_kernels(L, 0);
    if (m->hamiltonian || m->model.structure & (DM_CONSTANT_MASS | DM_LOOPS | DM_LINEAR_IN_V))
        return lua_settop(L, top);
    dml_want(L, m, DM_WANT_MASS, NULL);
    const size_t n = p->n;
    double *x = dml_path_scratch(L, p, m), worst = 0.0;
    double *work = lua_newuserdatauv(L, (4 * n * n + 5 * n + 1) * sizeof *work, 0);
    dm_kernel_prepare(&m->model.mass, work);
    dm_kernel_prepare(&m->model.mass, work + n + n * n);
    dm_kernel_prepare(&m->model.mass, work + 2 * (n + n * n));
    for (long k = 0; k < 3; k++) {
        if (dml_path_row(p, m, (p->rows - 1) * k / 2, x, x + 2 * n + 1) != DM_OK) continue;
        worst = fmax(worst, dml_turned_mass(action, &m->model.mass, p->n, x, work));
    }
    dml_rethrow(L, m);
    if (worst > 0.01)
        luaL_error(L,
                   "momentum: %s turns coordinates as those of points in space, and the kinetic "
                   "energy of this system is not the same where it does: are they others, as r "
                   "and phi? Give the generator in them, function(q) return { 0, 1 } end for a "
                   "turn of the second, whose momentum is p2; or function(q) return { -q[2], q[1] "
                   "} end if they are x and y",
                   luaL_tolstring(L, 2, NULL));
    lua_settop(L, top);
}

/* J = p . (generator of the group at q), by rows. */
int dml_path_momentum(lua_State *L) {
    const dml_path *p = dml_path_states(L, "a momentum map");
    lua_settop(L, 3);
    lua_getiuservalue(L, 1, DML_PATH_SYSTEM);
    if (dml_placed(L, -1)) return dml_place_momentum(L, -1);
    if (lua_isfunction(L, 2)) {
        if (!lua_isnil(L, 3))
            luaL_error(L, "momentum: a surplus argument: path:momentum(generator)");
        return momentum_of_generator(L, p);
    }
    const dm_action action = dml_standard_action(L, 2, 3, 4, p->n);
    check_action(L, p, &action);
    const uint32_t d = action.group->dimension(action.k), rows = (uint32_t)p->rows;
    double *J = d == 1 ? dml_pushvector(L, rows) : dml_pushmatrix(L, rows, d);
    for (long i = 0; i < p->rows; i++) {
        const double *row = p->data + (size_t)i * dml_path_width(p);
        dm_momentum(J + (size_t)i * d, &action, p->n, row + 1, row + 1 + p->n);
    }
    return 1;
}
