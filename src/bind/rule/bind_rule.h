/* bind_rule.h - `dm.rule`: a rule that brings data of its own (a quadrature, a tableau, a curve),
 * for `rule =`. */
#ifndef DML_RULE_H
#define DML_RULE_H

#include "bind/core/bind.h"
#include "integ/method/method.h"

#define DML_RULE "dm.rule"

/* user value 1: what keeps the data alive, 2: the text that names it in reports and messages */
typedef struct {
    dm_rule rule; /* name of a row of methods.def; `data` is what that method reads */
    /* where data differ with dim Q: those for n coordinates, kept alive by the object on the stack
     * at `data`, what is at user value 1; NULL: they do not */
    const void *(*for_space)(lua_State *L, int data, uint32_t n);
    /* of a rule that is DM_OF_FUNCTIONS: what its stepper reads (dm_stepper.brought), traced for
     * the system at `system` and steps of h; what keeps it alive is pushed. `object`: the rule */
    const void *(*bring)(lua_State *L, int object, int system, const char *backend, double h);
} dml_rule;

/* Pop what keeps `data` alive (the userdata that it is in) and push a rule of the method `name`
 * with it; it calls itself `text`. */
dml_rule *dml_pushrule(lua_State *L, const char *name, const void *data, const char *text);

/* The rule object at arg, or NULL. */
const dml_rule *dml_torule(lua_State *L, int arg);

/* Its data for a space of n coordinates. */
const void *dml_ruledata(lua_State *L, int arg, uint32_t n);

#endif
