/* lift.h - rules of coordinates on groups by the collective lift (mech/group_lift.c) or the
 * homogeneous one (mech/group_homogeneous.c): a step of (q, p) on T*R^N, which leads to the
 * momentum J(q, p) on the group. The lifted state, which has more
 * than J tells, stays with the stepper from step to step, and its memory is part of a restart. */
#ifndef DM_LIFT_H
#define DM_LIFT_H

#include "integ/method/method.h"
#include "mech/group.h"

/* Steps the lifted model by the engine that the rule has for it. */
extern const dm_engine dm_engine_lift;

/* The lifted model that it steps: the one of polynomials (dm_group_lift) where the rule keeps the
 * group and there are no constraints, else the homogeneous one (dm_group_homogeneous), which may
 * not be there yet, or not at all: NULL. */
const dm_model *dm_lifted_model(const dm_rule *rule, const dm_model *m);

#endif
