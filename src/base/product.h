/* product.h - products of many numbers, whose size may be beyond that of any one number. */
#ifndef DM_PRODUCT_H
#define DM_PRODUCT_H

#include <math.h>

/* part x 2^power, part from 1/2 to 1 in size, or zero, infinite, NaN */
typedef struct {
    double part;
    long power;
} dm_product;

static const dm_product DM_PRODUCT_OF_NONE = {0.5, 1};

static inline dm_product dm_product_times(dm_product p, double x) {
    int power = 0;
    p.part = frexp(p.part * x, &power);
    p.power += power;
    return p;
}

/* p / 2^power, as far as there is a number */
static inline double dm_product_over(dm_product p, double power) {
    return ldexp(p.part, (int)fmax(-4000.0, fmin(4000.0, (double)p.power - power)));
}

#endif
