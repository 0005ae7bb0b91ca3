/* claims.h - what is said of every method, and measured. */
#ifndef DM_CLAIMS_H
#define DM_CLAIMS_H

#include "integ/rule.h"

typedef struct {
    const char *name; /* of a row of methods.def */
    const char *order, *stages, *cost;
    /* "rule:stages:forces; ...", empty: it is measured elsewhere, with what it is for */
    const char *instances;
} dm_claim;
extern const dm_claim dm_claims[]; /* ends with name = NULL */

/* NULL when there is none of that name. */
const dm_claim *dm_claim_find(const char *name);

/* Traits of a rule: those of its method; of a stage rule DM_SYMMETRIC is read off the
 * coefficients. */
unsigned dm_rule_traits(const dm_rule *rule);

#endif
