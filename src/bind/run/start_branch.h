/* start_branch.h - which velocity a start goes on with, where L is not convex in v and a
 * momentum belongs to several. */
#ifndef DML_START_BRANCH_H
#define DML_START_BRANCH_H

#include "bind/run/stepping.h"

/* A run, whose state is (q, p), finds v from p beginning at 0. Raise where that is not the v[n]
 * that p, behind q in state[2n], was made of; `who` stands before the message ("member 3: "). */
void dml_check_velocity(lua_State *L, dml_stepping *r, const double *state, const double *v,
                        const char *who);

#endif
