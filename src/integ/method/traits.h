/* traits.h - what holds of a rule with its arguments, where the method alone does not tell. */
#ifndef DM_TRAITS_H
#define DM_TRAITS_H

#include "integ/method/rule.h"

/* Traits of a rule: those of its method; of a stage rule DM_SYMMETRIC is read off the
 * coefficients. */
unsigned dm_rule_traits(const dm_rule *rule);

#endif
