/* lie_equation.c - the step equation of lie.h and its exact matrix, for one member. */
#define W 1
#define HOW
#define DM_LANES_FUSED 0
#include "integ/lie/lie_text.h"

/* One velocity and one point of three coordinates: sizes that are constants leave straight code
 * (lie(1) of a free body in docs/benchmarks/groups.md). */
static double find_short(const dm_lie *e, double *R, double *J, const double *velocities) {
    if (e->is_free) return find_free_equation(e, 3, R, J, velocities);
    dm_lie one = *e;
    one.d = one.m = 3;
    one.s = one.r = 1;
    return find_equation(&one, R, J, velocities);
}

dm_status dm_lie_equation(void *lie, double *R, double *J, const double *velocities) {
    dm_lie *e = lie;
    const int is_short = e->d == 3 && e->s == 1 && e->r == 1;
    e->size = is_short ? find_short(e, R, J, velocities) : find_equation(e, R, J, velocities);
    return DM_OK;
}
