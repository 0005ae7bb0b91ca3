/* momentum.c - momentum maps of actions that are linear or affine on blocks of coordinates. */
#include "geom/action/momentum.h"

/* block by block: J_a = sum p . xi_a(q) */
void dm_momentum(double *J, const dm_action *action, uint32_t n, const double *q, const double *p) {
    const dm_space *group = action->group;
    const uint32_t block = action->block;
    double xi[DM_MAX_BLOCK];
    for (uint32_t a = 0; a < group->dimension(action->k); a++) {
        J[a] = 0.0;
        for (uint32_t at = 0; at + block <= n; at += block) {
            group->generator(xi, q + at, action->k, block, a);
            for (uint32_t i = 0; i < block; i++) J[a] += p[at + i] * xi[i];
        }
    }
}

/* all block sizes that divide n are tried; two possible ones are the user's choice */
uint32_t dm_action_block(const dm_space *group, uint32_t k, uint32_t n, uint32_t *other) {
    uint32_t found = 0;
    *other = 0;
    for (uint32_t block = 1; block <= n && block <= DM_MAX_BLOCK; block++) {
        if (n % block != 0 || !group->acts(k, block)) continue;
        if (!found)
            found = block;
        else
            *other = block;
    }
    return found;
}
