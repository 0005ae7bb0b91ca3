/* momentum.h - the momentum map of a group acting linearly on blocks of coordinates. */
#ifndef DM_MOMENTUM_H
#define DM_MOMENTUM_H

#include "geom/space.h"

/* J[a] = sum over blocks of p . xi_a(q), a < dimension: <J(q, p), xi> = <p, xi_Q(q)>.
 * q, p: n coordinates, a whole number of blocks of at most DM_MAX_BLOCK entries. */
enum { DM_MAX_BLOCK = 64 };
/* How a group acts on R^n. */
typedef struct {
    const dm_space *group;
    uint32_t k;     /* of group(k) */
    uint32_t block; /* coordinates moved together */
} dm_action;
void dm_momentum(double *J, const dm_action *action, uint32_t n, const double *q, const double *p);

/* The block size that the standard action of group(k) has on R^n: 0 when it has none, and
 * *other is a second possible size when the choice is the user's (else 0). */
uint32_t dm_action_block(const dm_space *group, uint32_t k, uint32_t n, uint32_t *other);

#endif
