/* functions_entry.h - behind functions_text.h: the functions of a width, as its file calls them.
 * Angles beyond 2^30 go to the C library, one by one, in every width. */

#include "numbers/functions_hyperbolic.h"

#define LARGEST_ANGLE 0x1p30

/* where(large, f(x), y) lane by lane */
TARGET __attribute__((noinline, cold)) static real by_library(real x, real y, double f(double)) {
    for (size_t i = 0; i < sizeof x / sizeof(double); i++)
        if (!(fabs(x[i]) <= LARGEST_ANGLE)) y[i] = f(x[i]);
    return y;
}

INLINE int has_large(real x) {
    return any((whole) ~(size_of(x) <= LARGEST_ANGLE));
}

/* The functions as they are called: reduction, polynomial, and the C library for the rare lane
 * whose angle is beyond reduction. */
TARGET static real sines(real x) {
    const angle a = reduced(x);
    const real y = sine_of(&a);
    return __builtin_expect(has_large(x), 0) ? by_library(x, y, sin) : y;
}

TARGET static real cosines(real x) {
    const angle a = reduced(x);
    const real y = cosine_of(&a);
    return __builtin_expect(has_large(x), 0) ? by_library(x, y, cos) : y;
}

TARGET static real tangents(real x) {
    const angle a = reduced(x);
    const real y = tangent_of(&a);
    return __builtin_expect(has_large(x), 0) ? by_library(x, y, tan) : y;
}

/* sine and cosine of one reduction */
TARGET static real both(real x, real *cosine) {
    const angle a = reduced(x);
    const real s = sine_of(&a), c = cosine_of(&a);
    *cosine = c;
    if (__builtin_expect(!has_large(x), 1)) return s;
    *cosine = by_library(x, c, cos);
    return by_library(x, s, sin);
}

/* no argument is unusual: bounds are a part of the function */
TARGET static real exponentials(real x) {
    return exponential(x);
}

TARGET __attribute__((noinline, cold)) static real unusual_logarithms(real x) {
    return logarithm(x);
}

/* zero, negative, infinite, denormal and NaN go apart: they are rare, and the test is cheap */
TARGET static real logarithms(real x) {
    const whole usual = (whole)(x >= 0x1p-1022) & (whole)(x < INFINITY);
    if (__builtin_expect(any(~usual), 0)) return unusual_logarithms(x);
    return logarithm_of_normal(x, all(0x1p52 + 1023.0));
}

TARGET static real hyperbolic_sines(real x) {
    return hyperbolic_sine(x);
}

TARGET static real hyperbolic_cosines(real x) {
    return hyperbolic_cosine(x);
}

TARGET static real hyperbolic_tangents(real x) {
    return hyperbolic_tangent(x);
}
