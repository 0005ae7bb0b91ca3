/* bind_step.h - `dm.step`: a rule from three Lua functions. */
#ifndef DML_STEP_H
#define DML_STEP_H

#include "bind/model/bind_system.h"
#include "integ/step_method.h"

/* The row of the dm.rule at `object` on the system at `arg`: has its `next` a time of its own? */
const dm_method *dml_step_method(lua_State *L, int object, int arg);

/* Raise where the rule of the solver at 1, of this method, has not the order that it declares, in
 * the first run on its system, whose options are at 2; members: those of an ensemble. A time of its
 * own has no order in h. */
void dml_step_order(lua_State *L, const dm_method *method, int members);

/* Pop the dm.rule of a solver, or nil, and its system; push what is known of its order, in
 * brackets; nothing of other methods than dm.step. */
void dml_step_said(lua_State *L, const dm_method *method);

/* Compare the traces of a dm.step with plain calls of its functions at the start of a run; at: what
 * its `bring` left on the stack. Raises where they differ, as a trace does not see ==. Nothing of
 * other methods. */
void dml_step_compare(lua_State *L, int at, const dm_method *method, const double *state, double t,
                      double h);

/* What tells the functions of a dm.step from those of another one: a sum of their values at made-up
 * points, the same in every run; NAN of other methods. at: as above. */
double dml_step_sum(lua_State *L, int at, const dm_method *method);

/* Push the list of parts of the dm.rule at `object`, { name, count } each, or nil. */
void dml_step_parts(lua_State *L, int object);

#endif
