/* lie_equation.c - the step equation of lie.h and its exact matrix, for one member. */
#define W 1
#define HOW
#define DM_LANES_FUSED 0
#include "integ/lie/lie_text.h"

dm_status dm_lie_equation(void *lie, double *R, double *J, const double *velocities) {
    dm_lie *e = lie;
    e->size = find_equation(e, R, J, velocities);
    return DM_OK;
}
