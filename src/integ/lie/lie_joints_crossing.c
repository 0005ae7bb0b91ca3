/* lie_joints_crossing.c - steps over places where holonomic constraints cross (mech/crossing.h): in
 * the chart of the step, where they are constraints on R^d. */
#include "integ/lie/lie_joints_inside.h"
#include "mech/crossing.h"

#include <math.h>
#include <string.h>

static int is_looked_at(const dm_lie_joints *e) {
    return e->k > 0 && !e->constraints->crossings;
}

size_t dm_lie_joints_crossing_work(const dm_lie_joints *e) {
    return is_looked_at(e) ? 2 * (size_t)e->n + e->d + dm_crossing_work(e->constraints) : 0;
}

/* For dm_crossing_chart: what a multiplier of 1 does to xi is the derivative of its constraint. */
static void look(void *joints, double *g, double *G, const double *xi, double t) {
    dm_lie_joints *e = joints;
    const uint32_t n = e->n, d = e->d, k = e->k;
    double *lambda = e->x + n + 2 * d + 1;
    memcpy(e->x, e->state, n * sizeof *e->x);
    memcpy(e->x + n, xi, d * sizeof *xi);
    e->x[n + 2 * d] = t;
    for (uint32_t c = 0; c < k; c++) {
        memset(lambda, 0, e->m * sizeof *lambda);
        lambda[c] = 1.0;
        dm_group_entries_eval(&e->joints->reaction, e->x, e->reaction, 0);
        memcpy(G + c * (size_t)d, e->reaction + k + d, d * sizeof *G);
    }
    memcpy(g, e->reaction, k * sizeof *g);
}

int dm_lie_joints_cross(dm_lie_joints *e, dm_trouble *trouble) {
    if (!is_looked_at(e)) return 0;
    const dm_constraints *c = e->constraints;
    const size_t n = e->n;
    double *weight = e->work, *here = weight + n, *room = here + e->d;
    const double *mass = e->memory + DM_LIE_AT_UNITS + 2 * (size_t)e->m;
    const dm_crossing_chart chart = {e->d, look, e};
    const dm_crossing_way way = {here, e->xi, weight, e->t, e->t + e->h, &chart};
    dm_crossing_place place;
    for (size_t i = 0; i < n; i++) weight[i] = i < e->d && mass[i] > 0.0 ? 1.0 / mass[i] : 1.0;
    memset(here, 0, e->d * sizeof *here);
    const dm_wide_product volume = dm_crossing_volume(c, e->holonomic, weight, room);
    if (!dm_crossing_in_step(c, e->memory + DM_LIE_AT_VOLUMES, volume, &way, &place, room))
        return 0;
    *trouble = (dm_trouble){.dependent = (int)place.row, .crosses = 1, .at = place.t};
    return 1;
}
