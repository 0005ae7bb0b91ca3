/* verlet.h - the rule that rules made of others take where none is named. */
#ifndef DM_VERLET_H
#define DM_VERLET_H

#include "integ/method/method.h"

extern const dm_rule dm_rule_verlet;

#endif
