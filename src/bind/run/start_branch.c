#include "bind/run/start_branch.h"

#include <math.h>
#include <string.h>

/* of the larger: what a search for v from p leaves, where p hardly tells it, is less */
static const double APART = 1e-5;

void dml_check_velocity(lua_State *L, dml_stepping *r, const double *state, const double *v,
                        const char *who) {
    const dm_model *m = &r->model->model;
    double *found = r->work + dm_legendre_work(m), apart = 0.0, size = 0.0;
    if (m->structure & DM_QUADRATIC_IN_V || r->model->callback) return;
    memset(found, 0, m->n * sizeof *found);
    if (dm_legendre_inverse(m, found, state, state + m->n, r->t0, r->work) != DM_OK)
        return; /* the first step says so */
    for (uint32_t i = 0; i < m->n; i++) {
        apart = fmax(apart, fabs(found[i] - v[i]));
        size = fmax(size, fmax(fabs(v[i]), fabs(found[i])));
    }
    if (apart <= APART * size) return;
    luaL_error(L,
               "%sno start: L is not convex in v, so that the momentum of this v belongs to other "
               "velocities too, and a run, which goes on from q and p, would take one of these",
               who);
}
