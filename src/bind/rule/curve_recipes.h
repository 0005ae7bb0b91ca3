/* curve_recipes.h - methods written in Lua: traced for coefficients, or kept as recipes, one for
 * every dim Q. */
#ifndef DML_CURVE_RECIPES_H
#define DML_CURVE_RECIPES_H

#include "bind/rule/bind_curve.h"
#include "bind/trace/trace.h"
#include "integ/curve/curve_recipe.h"

/* A method called with symbols; kinds and arena are on the stack, at these places. */
typedef struct {
    dml_signature signature;
    dml_traced traced;
    dm_kernel kernel; /* of all that was traced */
    dm_arena *arena;
    int kinds, arena_at, calls;
} dml_curve_asked;

/* Call the method at fn for so many coordinates; raises what it raises. */
void dml_curve_ask(lua_State *L, int fn, uint32_t n, dml_curve_asked *out);

/* Its coefficients; 0 where it is not linear in the values of f. Raises when it is no method. */
int dml_curve_tableau(lua_State *L, int fn, dm_curve *out);

/* Of the dm_curve at stack index `at`, whose user value is the table { method =, substeps = }: its
 * copy for so many coordinates, with the recipe and the choice for them, kept in that table. */
const dm_curve *dml_curve_for(lua_State *L, int at, uint32_t n);

#endif
