/* model_sums.h - a Lagrangian with sums is compared with its trace without loops over all bodies in Lua. */
#ifndef DML_MODEL_SUMS_H
#define DML_MODEL_SUMS_H

#include "bind/system.h"

/*
** Where *m keeps sums as loops: from here on, until the stack is cut below what this pushes, dm.sum_over gives
** the numbers that stand behind the inputs of L in a comparison. *kernel becomes the one that takes them;
** returns x (which may be NULL) with their values behind.
*/
const double *dml_givesums(lua_State *L, const dml_model *m, const dm_kernel **kernel,
                           const double *x);

#endif
