/* rule_sum.h - what tells a rule with data of its own from another one of the same name. */
#ifndef DML_RULE_SUM_H
#define DML_RULE_SUM_H

#include "bind/core/bind.h"
#include "integ/method/method.h"

/* A sum of its coefficients, or of values of its functions at made-up points, the same in every
 * run; 1 of a rule that its name tells. `brought`: what its stepper reads, of a rule of functions;
 * the object that keeps it alive is at stack index `at`. */
double dml_rule_sum(lua_State *L, int at, const dm_rule *rule, const void *brought);

#endif
