/* apart.h - functions that are called with numbers while another one is traced or compared. */
#ifndef DML_APART_H
#define DML_APART_H

#include "bind/core/scope.h"

/* What is called while a function is traced or compared, and calls functions with numbers itself
 * (a comparison, the equations of a root, hyper-dual numbers): sums of those are loops, and are
 * not counted among the sums of the function, also where what is called raises and the function
 * goes on. Its end gives both back. */
typedef struct {
    dml_scope scope;
    const double *values; /* of what was given */
    uint32_t sums;        /* of the newest trace */
} dml_apart;

/* Begun and ended by one function in C that lets no error pass. */
void dml_setapart(dml_state *state, dml_apart *a);
void dml_endapart(dml_state *state, dml_apart *a);

/* The same until the stack is cut back behind it, or an error passes; pushes nothing where
 * nothing is under way. */
void dml_pushapart(lua_State *L);

/* The numbers that stand for the sums of the function that is called now; NULL: it sums itself. A
 * run inside of what is compared traces what it steps: those sums are its own. */
dml_given *dml_sumsgiven(dml_state *state);

#endif
