/* wide_product.h - products of many numbers, whose size may be beyond that of any one number. */
#ifndef DM_WIDE_PRODUCT_H
#define DM_WIDE_PRODUCT_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* part x 2^power, part from 1/2 to 1 in size, or zero, infinite, NaN */
typedef struct {
    double part;
    long power;
} dm_wide_product;

static const dm_wide_product DM_WIDE_ONE = {0.5, 1};

/* frexp without a call, where x is no more special than most. Speed: steps, midpoint, spherical
 * pendulum in space */
static inline double dm_part_of(double x, int *power) {
    enum { SIGNIFICAND = 52, SPECIAL = 0x7ff, HALF = 0x3fe };
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    const int exponent = (int)(bits >> SIGNIFICAND) & SPECIAL;
    if (exponent == 0 || exponent == SPECIAL) return frexp(x, power);
    *power = exponent - HALF;
    bits ^= (uint64_t)(exponent ^ HALF) << SIGNIFICAND;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static inline dm_wide_product dm_wide_times(dm_wide_product p, double x) {
    int power = 0;
    p.part = dm_part_of(p.part * x, &power);
    p.power += power;
    return p;
}

/* p / 2^power, as far as there is a number */
static inline double dm_wide_over(dm_wide_product p, double power) {
    enum { MOST = 4000, NORMAL = 1000, BIAS = 1023, SIGNIFICAND = 52 };
    const double by = (double)p.power - power;
    if (!(fabs(by) <= NORMAL))
        return ldexp(p.part, (int)(by < -MOST ? -MOST : by < MOST ? by : MOST));
    const uint64_t bits = (uint64_t)((int64_t)by + BIAS) << SIGNIFICAND;
    double times;
    memcpy(&times, &bits, sizeof times);
    return p.part * times;
}

#endif
