/* functions_hyperbolic.h - behind functions_text.h: hyperbolic functions from e^x - 1 = m +
 * low, which keeps its digits near 0. sinh x = (m + m/(m + 1))/2, cosh x = (m + 1 + 1/(m +
 * 1))/2, tanh x = m/(m + 2) of the double argument; beyond BEYOND the smaller exponential does
 * not count. */

#define BEYOND 22.0 /* sinh and cosh are e^|x| / 2 there, tanh is 1 */

/* e^x - 1 and that plus a number, each as a sum of two */
typedef struct {
    real m, low, d, d_low; /* d = m + `more` */
} excess;

INLINE excess excess_of(const exponent *e, double more) {
    const real power = power_of_2(e->k), start = power - 1.0, term = power * e->r;
    const real sum = start + term; /* exact where k = 0; else |start| > |term| */
    const real rest = ((start - sum) + term) + power * (e->rest + e->low);
    const real m = sum + rest, low = (sum - m) + rest;
    const real d = m + more, back = d - m; /* two-sum (Knuth) */
    return (excess){m, low, d, ((m - (d - back)) + (more - back)) + low};
}

/* of |x|, the sign last */
INLINE real hyperbolic_tangent(real x) {
    const exponent e = split_exponent(2.0 * between(size_of(x), 0.0, BEYOND));
    const excess m = excess_of(&e, 2.0);
    const ratio q = quotient(m.m, m.low, m.d, m.d_low);
    return turned(q.high + q.low, (whole)x);
}

/* e^x/2 without overflow where e^x has one */
INLINE real half_exponential(const exponent *e) {
    return times_power(1.0 + (e->r + (e->rest + e->low)), e->k - 1.0);
}

/* up to 711, where it overflows */
INLINE real hyperbolic_sine(real x) {
    const real t = between(size_of(x), 0.0, 711.0);
    exponent e = split_exponent(t);
    const real large = half_exponential(&e);
    e.k = between(e.k, 0.0, 60.0);
    const excess m = excess_of(&e, 1.0);
    const ratio q = quotient(m.m, m.low, m.d, m.d_low);
    const real sum = m.m + q.high, rest = ((m.m - sum) + q.high) + (q.low + m.low);
    return turned(choose((whole)(t > BEYOND), large, 0.5 * (sum + rest)), (whole)x);
}

INLINE real hyperbolic_cosine(real x) {
    const real t = between(size_of(x), 0.0, 711.0);
    exponent e = split_exponent(t);
    const real large = half_exponential(&e);
    e.k = between(e.k, 0.0, 60.0);
    const excess m = excess_of(&e, 1.0);
    return choose((whole)(t > BEYOND), large, 0.5 * (m.d + (m.d_low + 1.0 / m.d)));
}
