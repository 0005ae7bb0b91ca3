/* largest.h - the largest of numbers, the lesser of two. */
#ifndef DM_LARGEST_H
#define DM_LARGEST_H

#include "base/written_out.h"

#include <math.h>
#include <stddef.h>

/* The larger of so_far and |x|. A NaN stays: `so_far <= |x|` alone would lose it to the next x. */
static inline double dm_largest(double so_far, double x) {
    return fabs(x) <= so_far || isnan(so_far) ? so_far : fabs(x);
}

static inline long dm_lesser(long a, long b) {
    return a < b ? a : b;
}

/* The largest |a|, of few; a NaN among them is passed over. */
DM_WRITTEN_OUT double dm_largest_of(const double *a, size_t size) {
    double largest = 0.0;
#pragma GCC unroll 4
    for (size_t k = 0; k < size; k++) {
        const double x = fabs(a[k]);
        largest = x > largest ? x : largest;
    }
    return largest;
}

#endif
