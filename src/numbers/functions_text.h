/* functions_text.h - elementary functions written once for all widths. A file that includes this
 * says before what `real` (a vector of doubles), `whole` (unsigned 64-bit integers, as many)
 * are, and INLINE, all(c), fused(a, b, c) = a b + c rounded once, smaller and larger(a, b),
 * which give b where one is a NaN, any(mask) and times_power(y, k) = y 2^k, picked(table, n) =
 * the entries of 16 that the low bits of n say. Every width does the same operations in the same
 * order, so a lane has the bits of a single call. What is added last is small, so that the last
 * rounding is nearly the only one. Reduction after Cody & Waite (1980), with products that are
 * exact by fused multiply-add; polynomials are minimax (Remez), their errors relative to the
 * function. */

/* 1.5 2^52: adding it rounds to a whole number, which is then in the low bits */
#define SHIFT 6755399441055744.0
#define SIXTEENTHS 0x1.8p48 /* to sixteenths */
#define SIGN_BIT ((uint64_t)1 << 63)

/* pi/2 and log 2 in parts of 53 bits */
#define HALF_PI_1 0x1.921fb54442d18p+0
#define HALF_PI_2 0x1.1a62633145c07p-54
#define HALF_PI_3 -0x1.f1976b7ed8fbcp-110
#define LOG2_1 0x1.62e42fefa39efp-1
#define LOG2_2 0x1.abc9e3b39803fp-56

/* lane by lane: bits of one or the other */
INLINE real choose(whole mask, real yes, real no) {
    return (real)(((whole)yes & mask) | ((whole)no & ~mask));
}

/* x| */
INLINE real size_of(real x) {
    return (real)((whole)x & ~SIGN_BIT);
}

/* x with the sign bit of `sign` turned over */
INLINE real turned(real x, whole sign) {
    return (real)((whole)x ^ (sign & SIGN_BIT));
}

/* 2^k, -1022 <= k <= 1023 whole */
INLINE real power_of_2(real k) {
    return (real)((whole)(k + (SHIFT + 1023.0)) << 52);
}

/* ---- exp: x = k log 2 + r + low, |r| < 0.34662, e^r = 1 + r + r^2 p(r), p to 2^-60 ---- */

typedef struct {
    real k, r, low, rest; /* rest = r^2 p(r) */
} exponent;

/* p(r) in pairs (Estrin), whose operations do not wait for each other */
INLINE real exponential_tail(real r) {
    const real r2 = r * r, r4 = r2 * r2;
    const real c01 = fused(all(0x1.555555555555cp-3), r, all(0.5));
    const real c23 = fused(all(0x1.111111110ebb0p-7), r, all(0x1.555555555555ep-5));
    const real c45 = fused(all(0x1.a01a01b3bc314p-13), r, all(0x1.6c16c16c13564p-10));
    const real c67 = fused(all(0x1.71ddef91216c9p-19), r, all(0x1.a01a01b45dd8dp-16));
    const real c89 = fused(all(0x1.af6cd1891ec5bp-26), r, all(0x1.27e4bf230b4f3p-22));
    const real high = fused(fused(all(0x1.1f9dfff721344p-29), r2, c89), r4, fused(c67, r2, c45));
    return r2 * fused(high, r4, fused(c23, r2, c01));
}

/* k by adding SHIFT; r and low together are x - k log 2 to twice the digits */
INLINE exponent split_exponent(real x) {
    const real k = fused(x, all(0x1.71547652b82fep+0), all(SHIFT)) - SHIFT;
    const real exact = fused(k, all(-LOG2_1), x), r = fused(k, all(-LOG2_2), exact);
    const real low = fused(k, all(-LOG2_2), exact - r);
    return (exponent){k, r, low, exponential_tail(r)};
}

/* bounds; a NaN becomes the lower one, and comes back at the end where that matters */
INLINE real between(real x, double least, double most) {
    return smaller(all(most), larger(all(least), x));
}

/* x = (m + j/16) log 2 + r, |r| < 0.02167: e^x = 2^m 2^(j/16) (1 + r + r^2 p(r)), the powers
 * from a table, p to 2^-56 of the whole; 1.5 2^48 rounds to sixteenths, j is the low bits then */
INLINE real exponential(real x) {
    const real y = between(x, -746.0, 710.0);
    const real t = fused(y, all(0x1.71547652b82fep+0), all(SIXTEENTHS));
    const real k = t - SIXTEENTHS, m = (real)((whole)t & ~(uint64_t)15) - SIXTEENTHS;
    const real r = fused(k, all(-LOG2_2), fused(k, all(-LOG2_1), y)), r2 = r * r;
    const real c01 = fused(all(EXP_1), r, all(EXP_0));
    const real c23 = fused(all(EXP_3), r, all(EXP_2));
    const real p = fused(fused(all(EXP_4), r2, c23), r2, c01);
    const real high = picked(dm_exp_powers[0], (whole)t);
    const real low = picked(dm_exp_powers[1], (whole)t);
    return times_power(high + fused(high, fused(p, r2, r), low), m);
}

/* ---- log: x = 2^k (1 + f), s = f/(2 + f), log(1 + f) = 2 s + 2/3 s^3 + ...; the tail to 2^-58
 * ---- */

/* even in s, so in z = s^2 */
INLINE real logarithm_tail(real z) {
    const real z2 = z * z;
    const real c01 = fused(all(0x1.999999997fd37p-2), z, all(0x1.5555555555592p-1));
    const real c23 = fused(all(0x1.c71c5202b2d57p-3), z, all(0x1.24924941f8d2fp-2));
    const real c45 = fused(all(0x1.39a1933edc4b9p-3), z, all(0x1.7466405bb5e1dp-3));
    return z * fused(fused(fused(all(0x1.2f070517bf057p-3), z2, c45), z2, c23), z2, c01);
}

/* of x > 0, neither infinite nor denormal; `offset` = 2^52 + 1023 where x is not scaled */
INLINE real logarithm_of_normal(real x, real offset) {
    const whole root = (whole)all(0x1.6a09e667f3bcdp-1), one = (whole)all(1.0);
    const whole bits = (whole)x;
    const whole power =
        (bits - root + one) & (whole)all(-INFINITY); /* exponent of x/sqrt(1/2), in place */
    const real f = (real)(bits - power + one) - 1.0;
    /* the biased exponent as the low bits of 2^52 + exponent */
    const real k = (real)((power >> 52) | (whole)all(0x1p52)) - offset;
    const real s = f / (2.0 + f), half = 0.5 * f * f;
    const real tail = fused(s, half + logarithm_tail(s * s), k * LOG2_2);
    return fused(k, all(LOG2_1), f - (half - tail));
}

/* of any x, the same bits */
INLINE real logarithm(real x) {
    const whole tiny = (whole)(x < 0x1p-1022);
    const real y = logarithm_of_normal(choose(tiny, x * 0x1p54, x),
                                       choose(tiny, all(0x1p52 + 1077.0), all(0x1p52 + 1023.0)));
    const real low_end = choose((whole)(x == 0.0), all(-INFINITY), all(NAN));
    return choose((whole)(x < INFINITY), choose((whole)(x > 0.0), y, low_end), x);
}

/* ---- sine and cosine: x = k pi/2 + r + low, |r| < 0.7856 ---- */

typedef struct {
    real sine, cosine, sine_low, cosine_low; /* of r + low; the low parts are what rounding lost */
    whole quadrant;                          /* k */
} angle;

/* p = k pi/2's second part has an error of its own; |exact| is a multiple of the last place of
 * p, so that (exact - r) - p is what rounding lost in r */
INLINE angle reduced(real x) {
    const real t = fused(x, all(0x1.45f306dc9c883p-1), all(SHIFT)), k = t - SHIFT;
    const real exact = fused(k, all(-HALF_PI_1), x), p = k * HALF_PI_2, r = exact - p;
    const real lost = fused(k, all(HALF_PI_2), -p);
    const real low = fused(k, all(-HALF_PI_3), ((exact - r) - p) - lost);
    const real z = r * r, z2 = z * z, z_low = fused(r, r, -z);
    const real s01 = fused(all(0x1.111111110f870p-7), z, all(-0x1.5555555555549p-3));
    const real s23 = fused(all(0x1.71de35768ad5bp-19), z, all(-0x1.a01a019c104ddp-13));
    const real s45 = fused(all(0x1.5d92b7edf7f33p-33), z, all(-0x1.ae5e6546ec8bcp-26));
    const real c01 = fused(all(-0x1.6c16c16c15173p-10), z, all(0x1.555555555554cp-5));
    const real c23 = fused(all(-0x1.27e4f8091d6e2p-22), z, all(0x1.a01a019cb0a5ap-16));
    const real c45 = fused(all(-0x1.8fae4c647c8fep-37), z, all(0x1.1ee9eb53ed56ep-29));
    const real half = 0.5 * z, main = 1.0 - half;
    const real sine_rest =
        fused(z * r, fused(fused(s45, z2, s23), z2, s01), fused(-half, low, low));
    const real quartic = z2 * fused(fused(c45, z2, c23), z2, c01);
    const real cosine_rest = ((1.0 - main) - half) + (quartic - fused(r, low, 0.5 * z_low));
    const real sine = r + sine_rest, cosine = main + cosine_rest;
    return (angle){sine, cosine, (r - sine) + sine_rest, (main - cosine) + cosine_rest, (whole)t};
}

/* all ones in lanes where sine and cosine change places */
INLINE whole is_odd(whole quadrant) {
    return -(quadrant & 1);
}

/* by quadrant: which of the two, and its sign */
INLINE real sine_of(const angle *a) {
    const real value = choose(is_odd(a->quadrant), a->cosine, a->sine);
    return turned(value, a->quadrant << 62);
}

INLINE real cosine_of(const angle *a) {
    const real value = choose(is_odd(a->quadrant), a->sine, a->cosine);
    return turned(value, (a->quadrant + 1) << 62);
}

typedef struct {
    real high, low;
} ratio;

/* (a + a_low) / (b + b_low), its sum not yet rounded */
INLINE ratio quotient(real a, real a_low, real b, real b_low) {
    const real inverse = 1.0 / b, q = a * inverse;
    const real rest = fused(-q, b, a) + fused(-q, b_low, a_low);
    return (ratio){q, rest * inverse};
}

INLINE real tangent_of(const angle *a) {
    const whole odd = is_odd(a->quadrant);
    const ratio q =
        quotient(choose(odd, a->cosine, a->sine), choose(odd, a->cosine_low, a->sine_low),
                 choose(odd, a->sine, a->cosine), choose(odd, a->sine_low, a->cosine_low));
    return turned(q.high + q.low, odd);
}
