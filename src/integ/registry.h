/* registry.h - the list of methods: one row of methods.def each, one constant dm_method each. */
#ifndef DM_REGISTRY_H
#define DM_REGISTRY_H

#include "integ/method/method.h"

extern const dm_method *const dm_methods[]; /* NULL-terminated */

/* NULL when no method has that name; *nearest, if asked for, is then the closest one. */
const dm_method *dm_method_find(const char *name, const char **nearest);

/* dm_rule_parse, and the method of every node whose name is one. Returns NULL or what is wrong
 * with the text; an unknown name is no such error: nodes[0].method is NULL then, and *nearest
 * the closest name. */
const char *dm_rule_read(dm_rule nodes[DM_RULE_NODES], const char *text, const char **nearest);

#endif
