/* complex_number.h - complex numbers as two doubles: products without the checks for infinite parts
 * that C has for its own. Arrays of them are arrays of re and im in turn. */
#ifndef DM_COMPLEX_NUMBER_H
#define DM_COMPLEX_NUMBER_H

#include <math.h>

typedef struct {
    double re, im;
} dm_complex_number;

static inline dm_complex_number dm_csum(dm_complex_number a, dm_complex_number b) {
    return (dm_complex_number){a.re + b.re, a.im + b.im};
}

static inline dm_complex_number dm_cproduct(dm_complex_number a, dm_complex_number b) {
    return (dm_complex_number){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

static inline dm_complex_number dm_cscaled(double factor, dm_complex_number a) {
    return (dm_complex_number){factor * a.re, factor * a.im};
}

/* conj(a) b */
static inline dm_complex_number dm_cinner(dm_complex_number a, dm_complex_number b) {
    return dm_cproduct((dm_complex_number){a.re, -a.im}, b);
}

/* |a|^2 */
static inline double dm_csquare(dm_complex_number a) {
    return a.re * a.re + a.im * a.im;
}

static inline dm_complex_number dm_cquotient(dm_complex_number a, dm_complex_number b) {
    return dm_cscaled(1.0 / dm_csquare(b), dm_cinner(b, a));
}

/* exp(i angle) */
static inline dm_complex_number dm_cunit(double angle) {
    return (dm_complex_number){cos(angle), sin(angle)};
}

#endif
