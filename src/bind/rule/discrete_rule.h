/* discrete_rule.h - discrete Lagrangians of a system and a stage rule, whose value is found by
 * solving for the stages. */
#ifndef DML_DISCRETE_RULE_H
#define DML_DISCRETE_RULE_H

#include "bind/model/bind_system.h"
#include "integ/rules/discrete.h"

/* Push the discrete Lagrangian of the system at 1 with the rule and h of the options at 2. */
void dml_pushruled(lua_State *L);

/* Solve for the stages between q0 and q1 at 2 and 3, at the time at 4 (nil: 0), of the discrete
 * Lagrangian at 1; the arrays of *out are in a userdata left on the stack. Raises when there is
 * no such curve. */
void dml_solveruled(lua_State *L, dm_discrete *out);

/* For a solver of the discrete Lagrangian at 2 with options at 1: put its system at 2, its rule
 * and h into the options. */
void dml_unfoldruled(lua_State *L);

/* The rule of the options at 2 has one velocity, (q1 - q0)/h, and nothing is to be solved: its
 * points, else 0. */
int dml_formula_points(lua_State *L);

/* Turn (system, { rule =, h = }) on the stack into the options of a discrete Lagrangian at 1: a
 * formula. */
void dml_formula_of_system(lua_State *L);

/* Raise where Ld is a formula, which has no points inside of a step. */
void dml_needstages(lua_State *L, const dml_system *s);

/* Push { system =, rule = } of the Ld at 1, nil for a formula of the script; as a C function. */
int dml_discrete_source(lua_State *L);

/* Ld:coefficients(), as a C function. */
int dml_discrete_coefficients(lua_State *L);

/* core.with_step, by which shape:discrete makes what it steps. */
int dml_core_with_step(lua_State *L);

#endif
