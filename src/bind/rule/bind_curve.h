/* bind_curve.h - `dm.curve`: one-step methods as curve segments, for `rule =` and for bundles. */
#ifndef DML_CURVE_H
#define DML_CURVE_H

#include "bind/rule/bind_rule.h"
#include "integ/curve/curve.h"

/* The curve of the dm.rule at arg, or NULL when it is none. */
const dm_curve *dml_tocurve(lua_State *L, int arg);

/* dm.curve, as a C function. */
int dml_curve_new(lua_State *L);

#endif
