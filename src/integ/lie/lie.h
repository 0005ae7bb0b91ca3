/* lie.h - Lie group variational integrators in the natural chart about the start of a step (Leok
 * 5.3.2), g = g0 tau(xi), xi = h sum_j a_j(c) V_j with velocities V_j at nodes as in stage/stage.h:
 *   sum_i b_i [h a_ij L_xi(i) + d_ij L_xi'(i)] = beta_j dtau_R(xi1)^T (p0 + P),
 *   P = h sum_i b_i L_e(i),  xi1 = h sum_j beta_j V_j,  g1 = g0 tau(xi1),  p1 = Ad*_tau(xi1) (p0 +
 * P), where L_e is the derivative at g0. On R^n this is the Galerkin method of the same basis. */
#ifndef DM_LIE_H
#define DM_LIE_H

#include "integ/method/method.h"
#include "mech/group.h"

/* Reads the basis of a row; steps free coordinates as rules of stages do. */
extern const dm_engine dm_engine_lie;

/* rad: a step whose xi turns a body further is refused. The chart of exp ends at pi, and next to it
 * a small change of the step leads to its other side. That of the Cayley map does not end, but its
 * equations have other roots, which turn the body elsewhere: by 2.2 rad = 2 atan(3.93/2) and more
 * on random bodies (tests/lua/lie/test_traps.lua). */
static inline double dm_lie_reach(dm_tau tau) {
    return tau == DM_TAU_CAYLEY ? 3.93 : 2.98;
}

/* The turn by the velocity of the start that a step which failed tells: one near to the end of the
 * chart, where equations lose their root before a root is out of reach; else 0. */
static inline double dm_lie_told_turn(double turn, dm_tau tau) {
    return turn >= 0.75 * dm_lie_reach(tau) ? turn : 0.0;
}

/* Why a step failed, into text[size]: turn is its angle where that was too large, else 0; NULL is
 * the general advice. */
const char *dm_lie_why(char *text, size_t size, double turn, dm_tau tau, dm_status status);

/* The map that the arguments of a rule name; exp where they name none. */
dm_tau dm_lie_tau(const dm_rule *rule);

#endif
