/* start_constraints.h - a start must lie on the constraints of its system, or be moved there. */
#ifndef DML_START_CONSTRAINTS_H
#define DML_START_CONSTRAINTS_H

#include "bind/run/stepping.h"

/* Raise where the rule does not know a constraint that the system has; names the rules that do. */
void dml_refuseconstraints(lua_State *L, const dml_solver *s, const dml_model *m);

/* Raise where L is linear in v and the rule is not for that, or none knows what is beside it. */
void dml_refuselinear(lua_State *L, const dml_solver *s, const dml_model *m);

/* Kernels that the checks below need; 0 without constraints. */
unsigned dml_start_wants(const dml_stepping *r);

/* Doubles of workspace for them. */
size_t dml_start_work(const dm_model *m);

/* The start in r->x = (q, v, t) and r->state, whose momentum is known. With project = true among
 * the options at 2 it is moved to the nearest state on the constraints, in the metric of the mass;
 * else a start off them raises with the distance. `who` begins the message ("" or "member 3: ");
 * given_p: the momentum was given, not v. */
void dml_start_on_constraints(lua_State *L, dml_stepping *r, const char *who, int given_p);

/* The state that a search left there: the part of its momentum that the constraints take up,
 * which does not change the step, is made to fit the velocity. */
dm_status dml_tangent_momentum(dml_stepping *r);

/* r->x = (q, v, t): only the positions. */
void dml_check_on_constraints(lua_State *L, dml_stepping *r, const char *who);

/* Raise where two positions of a discrete Lagrangian, in r->x, do not fit its rolling
 * constraints. */
void dml_check_rolling_pair(lua_State *L, const dml_stepping *r);

/* A run, whose state is (q, p), finds v from p beginning at 0. Raise where that is not the v[n]
 * that p, behind q in state[2n], was made of; `who` stands before the message ("member 3: "). */
void dml_check_velocity(lua_State *L, dml_stepping *r, const double *state, const double *v,
                        const char *who);

/* Where the step leads that fails at r->state and t, and its engine does not say why: the
 * constraint that depends on those before it at its start, or at the end of a straight line, from
 * 1; 0: none does. */
uint32_t dml_lost_constraint(const dml_stepping *r, double t);

#endif
