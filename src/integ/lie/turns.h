/* turns.h - kernels of the splitting steps of rotations(k) (rotations.c), for one state or for
 * members side by side in lanes; the bits are the same. */
#ifndef DM_TURNS_H
#define DM_TURNS_H

#include "mech/group.h"

/* Entries of w lanes each. */
typedef struct {
    /* takes q[n], mu[d], torque[d], w, h: gives (q, mu) after the kick mu += w torque and the
     * symmetric sequence of flows of mu_a^2/(2 I_a) of length h, a counting blocks of axes; or,
     * where dm_turns_sum, what they have more than before */
    dm_kernel turns;
    /* takes q[n], mu[d], w, t: gives mu + w torque [d], then the torque there [d] */
    dm_kernel kick;
} dm_turns;

/* Has the group gains of turns that can be summed to twice the digits? */
static inline int dm_turns_sum(const dm_model *m) {
    return m->group->trace[DM_TAU_EXP].axes != NULL;
}

static inline uint32_t dm_turns_inputs(const dm_model *m) {
    return m->n + 2 * dm_momenta(m) + 2;
}

static inline uint32_t dm_turns_kick_inputs(const dm_model *m) {
    return m->n + dm_momenta(m) + 2;
}

/* Is the kinetic energy of L a sum over blocks of axes that commute, each with a flow of turns
 * about its axes? L is separable with a constant inertia and nothing linear in xi. */
int dm_turns_split(const dm_model *m);

/* Of the model's last stepper, or new ones, for so many lanes (1, or what there are registers for);
 * 0: there are none. */
int dm_turns_find(dm_turns *out, const dm_model *m, uint32_t lanes);

#endif
