/* hyperdual.h - arithmetic of hyper-dual numbers: x + a e1 + b e2 + c e1 e2, e1^2 =
 * e2^2 = 0. */
#ifndef DML_HYPERDUAL_H
#define DML_HYPERDUAL_H

#include "bind/value/value.h"

/* op(x, y, z) with exact first and second derivatives along both directions. */
dml_hyperdual dml_hyper_apply(dm_op op, const dml_hyperdual *x, const dml_hyperdual *y,
                              const dml_hyperdual *z);

#endif
