/* stepping_params.h - runs of a system whose varied parameters are inputs of its kernels
 * (model_params.h). */
#ifndef DML_STEPPING_PARAMS_H
#define DML_STEPPING_PARAMS_H

#include "bind/run/stepping.h"

/* Let *r step the model with inputs where it can: r->inputs and its values; the stack grows by
 * what keeps them. */
void dml_stepping_inputs(lua_State *L, dml_stepping *r);

/* Push the list of names of the inputs of r->inputs. */
void dml_pushnames(lua_State *L, const dml_stepping *r);

/* True when L with inputs is L at r->state. */
int dml_stepping_agrees(dml_stepping *r);

#endif
