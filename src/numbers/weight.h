/* weight.h - a coefficient of a method kept as two doubles, the first of 24 bits. Rounding a
 * coefficient to a double would make the same error in every step, and invariants would drift
 * in proportion to time; two products err at random (Hairer, McLachlan & Razakarivony 2008). */
#ifndef DM_WEIGHT_H
#define DM_WEIGHT_H

#include <float.h>
#include <math.h>
#include <stdint.h>

/* w = top + rest */
typedef struct {
    double top, rest;
} dm_weight;

/* top is w rounded to 24 bits, of whatever size: h^2 a_ij of h = 1e-23 is no number of a float;
 * rest is what a double holds of the remainder */
static inline dm_weight dm_weight_of(long double w) {
    double top = (double)(float)w;
    if (!(fabs(top) >= FLT_MIN && fabs(top) <= FLT_MAX)) {
        int power;
        const float digits = (float)frexpl(w, &power);
        top = ldexp((double)digits, power);
    }
    return (dm_weight){top, (double)(w - (long double)top)};
}

/* as it was given, to 64 bits */
static inline long double dm_weight_exact(dm_weight w) {
    return (long double)w.top + (long double)w.rest;
}

/* the nearest double, or its neighbour */
static inline double dm_weight_double(dm_weight w) {
    return w.top + w.rest;
}

/* x rounded to 47 bits. A product with the nearest double to a ratio of small numbers, as h a_ij =
 * 0.05 * 2/9 is, lies at few places between two doubles, and what rounding takes has a mean; one
 * with this lies at all of them, and what is lacking is small enough to be added once. */
static inline double dm_weight_few_bits(double x) {
    const double wide = (0x1p6 + 1.0) * x;
    return wide - (wide - x);
}

/* w x */
static inline double dm_weighted(dm_weight w, double x) {
    return w.top * x + w.rest * x;
}

/* out[n] += w x[n] */
static inline void dm_weighted_add(double *out, dm_weight w, const double *x, uint32_t n) {
    for (uint32_t k = 0; k < n; k++) out[k] += dm_weighted(w, x[k]);
}

#endif
