/* rule.h - the name of a rule, read: "gauss(2)", "galerkin(3, lobatto(4))". */
#ifndef DM_RULE_H
#define DM_RULE_H

#include <stddef.h>

enum { DM_RULE_ARGS = 4, DM_RULE_NAME = 32, DM_RULE_NODES = 8 };

struct dm_method;

typedef struct dm_rule {
    char name[DM_RULE_NAME];
    int count; /* arguments given */
    struct {
        double number;
        const struct dm_rule *rule; /* NULL: a number */
    } arg[DM_RULE_ARGS];
    const struct dm_method *method; /* of that name; NULL: not looked for, or none (registry.h) */
    const void *data; /* coefficients that are not in the name, read by the method; NULL: none */
} dm_rule;

/* Read `text` into nodes[0]; nested rules take the further nodes. Returns NULL, or a static
 * sentence that says what is wrong with the text. Names may hold letters, digits, _ and -. */
const char *dm_rule_parse(dm_rule nodes[DM_RULE_NODES], const char *text);

#endif
