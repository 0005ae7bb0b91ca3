/* model_ties.h - the functions that tie a system: constraint, rolling, force, reaction. */
#ifndef DML_MODEL_TIES_H
#define DML_MODEL_TIES_H

#include "bind/system.h"

/* Does the system at `arg` have any of these functions? */
int dml_istied(lua_State *L, int arg);

/* Check the fields of the options at 1: functions, or nil; a reaction needs a rolling
 * constraint. */
void dml_checktiefields(lua_State *L, int hyperdual);

/* Trace them into m->tied; raises what dml_trace raises, and wrong lengths. */
void dml_traceties(lua_State *L, int arg, dml_model *m);

/* Do the functions do what they did when *kept was traced? What is made on the way is in
 * `arena`. */
int dml_repeatties(lua_State *L, int arg, const dml_model *kept, dm_arena *arena);

/* Derivatives and structure, into m->ties; raises where one constrains nothing. */
void dml_buildties(lua_State *L, dml_model *m);

/* Raise where the ties of a discrete Lagrangian see the time. */
void dml_checkpairties(lua_State *L, const dml_model *m);

/* Is the trace that of the other model, node for node? */
int dml_sameties(const dml_model *kept, const dml_model *fresh);

/* Compare the traces with plain calls around x = (q, v, t), as dml_trace_check does; NULL:
 * nowhere in particular. */
void dml_checkties(lua_State *L, int arg, dml_model *m, const double *x);

/* system:constraint(q [, t]), system:rolling(q, v [, t]), system:force(q, v [, t]); what they
 * are called. */
extern const dml_row dml_tie_methods[];

/* Add "2 constraints, 1 rolling constraint, a force" to a text, nothing without any. */
void dml_describeties(lua_State *L, luaL_Buffer *b, const dml_model *m);

#endif
