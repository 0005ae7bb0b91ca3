/* compensated.h - compensated sums: a number kept as high + low, exact to about twice the
 * digits. The state of a run holds its coordinates and momenta so, since a step adds an
 * increment of size h to numbers of size 1, and what rounding takes away in every step would
 * add up. */
#ifndef DM_COMPENSATED_H
#define DM_COMPENSATED_H

/* high + low += x; `low` is the rounding error of the last sum (Kahan 1965; HLW VIII.5). */
static inline void dm_sum_add(double *high, double *low, double x) {
    const double a = *high, e = *low + x, sum = a + e;
    *low = e + (a - sum);
    *high = sum;
}

/* The same for arrays of n. */
static inline void dm_sum_add_n(double *high, double *low, const double *x, unsigned n) {
    for (unsigned i = 0; i < n; i++) dm_sum_add(high + i, low + i, x[i]);
}

#endif
