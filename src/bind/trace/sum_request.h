/* sum_request.h - what a call of dm.sum_over asks for. */
#ifndef DML_SUM_REQUEST_H
#define DML_SUM_REQUEST_H

#include "bind/trace/trace.h"

enum { DML_SUM_VECTORS = 7, DML_SUM_COLUMNS = 24 };

/* what the arguments ask for; vectors and scalars are numbered by their stack index */
typedef struct {
    int fn, given;                       /* stack index of the function; arguments before it */
    uint32_t width[DML_SUM_VECTORS + 1]; /* entries a body has of argument k, 0: a scalar */
    uint32_t bodies, from, to, block;
    int periodic;
    double within, margin, box[3]; /* of pairs: see dm_sum; 0: all of them, no box */
    uint32_t axes;
    dml_signature signature; /* of the function */
} dml_sum_request;

/* Read the arguments on the stack: vectors and numbers, the function, a table of options. */
void dml_read_sum(lua_State *L, dml_sum_request *r);

#endif
