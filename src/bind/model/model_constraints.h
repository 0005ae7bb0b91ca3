/* model_constraints.h - the functions that constrain a system or act on it: constraint, rolling,
 * force, reaction. */
#ifndef DML_MODEL_CONSTRAINTS_H
#define DML_MODEL_CONSTRAINTS_H

#include "bind/model/bind_system.h"

/* Does the system at `arg` have any of these functions? */
int dml_isconstrained(lua_State *L, int arg);

/* Check the fields of the options at 1: functions, or nil; a reaction needs a rolling
 * constraint, and in a discrete Lagrangian (pair) the other way round. */
void dml_check_functions(lua_State *L, int hyperdual, int pair);

/* Trace them into m->constrained; raises what dml_trace raises, and wrong lengths. */
void dml_traceconstraints(lua_State *L, int arg, dml_model *m);

/* Do the functions do what they did when *cached was traced? What is made on the way is in
 * `arena`. */
int dml_repeatconstraints(lua_State *L, int arg, const dml_model *cached, dm_arena *arena);

/* Derivatives and structure, into m->constraints; raises where one constrains nothing. */
void dml_buildconstraints(lua_State *L, dml_model *m);

/* Raise where the constraints of a discrete Lagrangian see the time. */
void dml_checkpairconstraints(lua_State *L, const dml_model *m);

/* Compare the traces with plain calls around x = (q, v, t), as dml_trace_check does; NULL:
 * nowhere in particular. */
void dml_checkconstraints(lua_State *L, int arg, dml_model *m, const double *x);

/* What function `which` (DML_CONSTRAINT ...) is called among the options; is it given, of the
 * system at `arg`? What it takes: constraint(q, t); force(q, v, t, u) where there are controls;
 * map(q, p); all others (q, v, t), or (q0, q1) of a discrete Lagrangian (pair). Push it with params
 * bound; its rows come as one list. */
const char *dml_functionname(int which);
int dml_has_function(lua_State *L, int arg, int which);
dml_signature dml_function_signature(const dml_model *m, int pair, int which);
void dml_push_constraint_function(lua_State *L, int arg, int which);

/* A number that tells function `which` from others at x = (q, v, t) or (q0, q1, 0): its entries
 * with weights, one that is not finite as 1; controls are those of x. NaN: no memory for it. */
double dml_constraintsum(dml_model *m, int which, const double *x);

/* The discrete forces of a discrete Lagrangian at x = (q0, q1): p0[n] -= F1, p1[n] += F2 (NULL: not
 * wanted); nothing where there are none. */
void dml_addforces(lua_State *L, dml_model *m, const double *x, double *p0, double *p1);

/* system:constraint(q [, t]), system:rolling(q, v [, t]), system:force(q, v [, t]); what they
 * are called. */
extern const dml_row dml_constraint_methods[];

#endif
