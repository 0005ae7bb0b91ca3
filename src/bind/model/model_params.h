/* model_params.h - a system whose varied parameters are inputs of its kernels, not constants in
 * them. */
#ifndef DML_MODEL_PARAMS_H
#define DML_MODEL_PARAMS_H

#include "bind/model/bind_system.h"

enum { DML_MOST_PARAMS = 16 };

/* Push L of the system at `system` as a function of (q, v, t, values), values of the parameters
 * in the list of names at `names`; and how it is traced. */
void dml_pushwith(lua_State *L, int system, int names);
dml_signature dml_withsignature(uint32_t n, uint32_t params);

/* Push the model of that function with all parameters that can be inputs of an explicit rule:
 * numbers that the potential alone depends on. Its kernels of L take (q, v, t, values). Its user
 * value 4 is the list of their names. Pushes nil and returns NULL where there are none, where L
 * is constrained or not separable, or where the function needs them as numbers. */
dml_model *dml_pushinputs(lua_State *L, int system);

/* Can kicks and drifts step it? */
int dml_issplit(const dm_model *m);

/* Values of the parameters of the system in the list of names on top of the stack, which is
 * dropped. */
void dml_readparams(lua_State *L, int system, double *out);

#endif
