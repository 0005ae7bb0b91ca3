/* model_sums.h - a Lagrangian with sums is compared with its trace without loops over all bodies
 * in Lua. */
#ifndef DML_MODEL_SUMS_H
#define DML_MODEL_SUMS_H

#include "bind/model/bind_system.h"

/* Where *m keeps sums as loops: from here on, until the stack is cut below what this pushes,
 * dm.sum_over gives the numbers that stand behind the inputs of L in a comparison. *kernel
 * becomes the one that takes them; returns x (which may be NULL) with their values behind. */
const double *dml_givesums(lua_State *L, const dml_model *m, const dm_kernel **kernel,
                           const double *x);

/* The same of the sums of a graph; checked: few rounds of them are compared. */
void dml_pushgiven(lua_State *L, const dm_graph *g, int checked);

/* Where the sums of the model at `at` stay loops and `want` needs tables, or its slope and mass
 * are parts of a stage kernel that `want` does without: put a model of the same trace in its
 * place, which it keeps, so that what steps by loops goes on doing so, and a rule has the same
 * bits whatever ran before it. Gives the model that is there then. */
dml_model *dml_standin(lua_State *L, int at, unsigned want);

/* Raise that `why` cannot be had, of a Lagrangian with sums over cells of a mesh or near pairs. */
void dml_refusecells(lua_State *L, const dml_model *m, const char *why);

/* Raise that a rule of several stages cannot step a field without a library of solvers. */
void dml_refusestages(lua_State *L, const char *rule);

#endif
