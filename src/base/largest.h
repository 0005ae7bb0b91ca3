/* largest.h - the largest of many numbers, NaN when there is one among them. */
#ifndef DM_LARGEST_H
#define DM_LARGEST_H

#include <math.h>

/* The larger of so_far and |x|. A NaN stays: `so_far <= |x|` alone would lose it to the next x. */
static inline double dm_largest(double so_far, double x) {
    return fabs(x) <= so_far || isnan(so_far) ? so_far : fabs(x);
}

#endif
