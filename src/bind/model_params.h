/* model_params.h - a system whose varied parameters are inputs of its kernels, not constants in them. */
#ifndef DML_MODEL_PARAMS_H
#define DML_MODEL_PARAMS_H

#include "bind/system.h"

enum { DML_MOST_PARAMS = 16 };

/* Push a copy of a table. */
void dml_pushcopy(lua_State *L, int table);

/* Push L of the system at `system` as a function of (q, v, t, values), values of the parameters in the list of names at
** `names`; and how it is traced. */
void dml_pushwith(lua_State *L, int system, int names);
dml_signature dml_withsignature(uint32_t n, uint32_t params);

/*
** Push the model of that function: kernels of L take (q, v, t, values). Raises where explicit rules could not step it
** so: where momenta depend on these parameters, or the function needs them as numbers.
*/
dml_model *dml_pushwithparams(lua_State *L, int system, int names);

#endif
