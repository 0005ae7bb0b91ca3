/* model_sums.h - a Lagrangian with sums is compared with its trace without loops over all bodies
 * in Lua. */
#ifndef DML_MODEL_SUMS_H
#define DML_MODEL_SUMS_H

#include "bind/core/state.h"
#include "bind/model/bind_system.h"

/* Where *m keeps sums as loops: from here on, until the stack is cut below what this pushes,
 * dm.sum_over gives the numbers that stand behind the inputs of L in a comparison. *kernel
 * becomes the one that takes them; returns x (which may be NULL) with their values behind. */
const double *dml_givesums(lua_State *L, const dml_model *m, const dm_kernel **kernel,
                           const double *x);

/* What is called while a function is traced or compared, and calls functions with numbers itself
 * (a comparison, the equations of a root, hyper-dual numbers): sums of those are loops, and are
 * not counted among the sums of the function, also where what is called raises and the function
 * goes on. Its end gives both back. */
typedef struct {
    dml_given *given;
    const double *values;
    dml_frame *frame;
    uint32_t sums;
} dml_apart;
dml_apart dml_setapart(dml_state *state);
void dml_endapart(const dml_apart *a);

/* The same until the stack is cut back behind it, or an error passes; pushes nothing where
 * nothing is under way. */
void dml_pushapart(lua_State *L);

/* Where the sums of the model at `at` stay loops and `want` needs tables, or its slope and mass
 * are parts of a stage kernel that `want` does without: put a model of the same trace in its
 * place, which it keeps, so that what steps by loops goes on doing so, and a rule has the same
 * bits whatever ran before it. Gives the model that is there then. */
dml_model *dml_standin(lua_State *L, int at, unsigned want);

#endif
