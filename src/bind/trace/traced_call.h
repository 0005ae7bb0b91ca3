/* traced_call.h - arguments and results of a traced function, shared by the files that call
 * one. */
#ifndef DML_TRACED_CALL_H
#define DML_TRACED_CALL_H

#include "bind/trace/trace.h"

/* Numbers in all arguments together. */
uint32_t dml_signature_inputs(const dml_signature *s);

/* Push argument k, made of its entries x. */
void dml_pushargument(lua_State *L, const dml_signature *s, int k, const dml_scalar *x);

/* How many numbers the result at that stack index holds; raises when it does not fit
 * the signature. */
uint32_t dml_result_length(lua_State *L, const dml_signature *s, int result);
dml_scalar dml_result_entry(lua_State *L, const dml_signature *s, int result, uint32_t i);

#endif
