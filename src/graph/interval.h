/* interval.h - arithmetic with intervals, rounded outwards: what comes out holds every value that
 * the operation, or its computed result, can have. */
#ifndef DM_INTERVAL_H
#define DM_INTERVAL_H

#include "graph/graph.h"

typedef struct {
    double lo, hi; /* lo <= hi; infinite: not bounded there */
} dm_interval;

#define DM_ANYWHERE                                                                                \
    { -INFINITY, INFINITY }

dm_interval dm_interval_add(dm_interval a, dm_interval b);
dm_interval dm_interval_negative(dm_interval a);
dm_interval dm_interval_multiply(dm_interval a, dm_interval b);
dm_interval dm_interval_square(dm_interval a);
dm_interval dm_interval_reciprocal(dm_interval a);
dm_interval dm_interval_divide(dm_interval a, dm_interval b);
dm_interval dm_interval_power(dm_interval a, dm_interval k);
dm_interval dm_interval_angle(dm_interval y, dm_interval x); /* atan2 */

/* An operation with one operand; anywhere where that may be outside its domain. */
dm_interval dm_interval_of(dm_op op, dm_interval a);

/* condition > 0 ? yes : no */
dm_interval dm_interval_either(dm_interval condition, dm_interval yes, dm_interval no);

/* What is in both. */
dm_interval dm_interval_common(dm_interval a, dm_interval b);

#endif
