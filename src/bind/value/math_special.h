/* math_special.h - the functions of math on symbols and hyper-dual numbers. */
#ifndef DML_MATH_SPECIAL_H
#define DML_MATH_SPECIAL_H

#include "bind/value/value.h"

/* One function of math: how Lua calls it on numbers, the operation of a trace that it is
 * (DM_OP_COUNT: none), and what it does where one of its 1 or 2 arguments x[n] is a symbol or a
 * hyper-dual number. */
typedef struct dml_math {
    dml_row row;
    dm_op op;
    int (*call)(lua_State *L, const dml_scalar *x, int n, const struct dml_math *f);
} dml_math;

typedef int dml_math_call(lua_State *L, const dml_scalar *x, int n, const dml_math *f);
dml_math_call dml_math_unary;       /* f(x) */
dml_math_call dml_math_arctangent;  /* atan(y), atan(y, x) */
dml_math_call dml_math_power;       /* x^y */
dml_math_call dml_math_logarithm;   /* log(x), log(x) / log(base) */
dml_math_call dml_math_logarithm10; /* log(x) / log(10) */
dml_math_call dml_math_extremum;    /* the largest or smallest of all arguments */
dml_math_call dml_math_whole; /* floor and its like: a value is needed, none is differentiated */
dml_math_call dml_math_remainder; /* x - n y, n = x/y cut off */
dml_math_call dml_math_parts;     /* integral and fractional part */

#endif
