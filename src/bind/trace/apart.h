/* apart.h - functions that are called with numbers while another one is traced or compared. */
#ifndef DML_APART_H
#define DML_APART_H

#include "bind/core/state.h"

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

#endif
