/* wide_product.h - products of many numbers, whose size may be beyond that of any one number. */
#ifndef DM_WIDE_PRODUCT_H
#define DM_WIDE_PRODUCT_H

#include <math.h>

/* part x 2^power, part from 1/2 to 1 in size, or zero, infinite, NaN */
typedef struct {
    double part;
    long power;
} dm_wide_product;

static const dm_wide_product DM_WIDE_ONE = {0.5, 1};

static inline dm_wide_product dm_wide_times(dm_wide_product p, double x) {
    int power = 0;
    p.part = frexp(p.part * x, &power);
    p.power += power;
    return p;
}

/* p / 2^power, as far as there is a number */
static inline double dm_wide_over(dm_wide_product p, double power) {
    return ldexp(p.part, (int)fmax(-4000.0, fmin(4000.0, (double)p.power - power)));
}

#endif
