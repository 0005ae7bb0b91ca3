/* implicit_bracket.c - where Newton's method has nothing to go by, since F is flat but for a narrow
 * place (tanh(50 y) is 1 to its last digit), its signs still tell where a root is. */
#include "code/implicit/implicit_bracket.h"

#include <math.h>

enum {
    TO_A_SIDE = 48, /* intervals on either side of the start */
    FINEST = 12,    /* of those that double in two: the first is 2^-6 of 1 + |y| wide */
    HALVINGS = 100
};
static const double HALF_TURN = 0x1.921fb54442d18p+1;
static const double NEAR = 1e-3; /* |F| beside a root, of that at the ends of the interval */

/* end m of the intervals on a side, 0 .. TO_A_SIDE */
static double end_of(const dm_root_solver *s, int m, double side) {
    const double start = s->from[0];
    if (s->angles & 1) return start + side * HALF_TURN * m / TO_A_SIDE;
    return m ? start + side * (1.0 + fabs(start)) * sqrt(ldexp(1.0, m - FINEST)) : start;
}

/* F at y; NaN where it has no value */
static double value(dm_root_solver *s, double y) {
    s->in[0] = y;
    dm_kernel_eval(&s->equation, s->in, s->out);
    return s->out[0];
}

/* *y beside the root between a and b, where F has other signs; 0: it has a pole or jumps there */
static int halve(dm_root_solver *s, double a, double b, double Fa, double Fb, double *y) {
    const double small = NEAR * fmin(fabs(Fa), fabs(Fb));
    for (int k = 0; k < HALVINGS; k++) {
        const double middle = 0.5 * (a + b), F = value(s, middle);
        *y = middle;
        if (fabs(F) <= small) return 1;
        if (!(fabs(F) < INFINITY) || middle == a || middle == b) return 0;
        if (signbit(F) == signbit(Fa))
            a = middle;
        else
            b = middle;
    }
    return 0;
}

int dm_root_bracket(dm_root_solver *s, int *next, double *y) {
    while (*next < 2 * TO_A_SIDE) {
        const double side = *next % 2 ? -1.0 : 1.0;
        const int m = (*next)++ / 2;
        const double a = end_of(s, m, side), b = end_of(s, m + 1, side);
        const double Fa = value(s, a), Fb = value(s, b);
        *y = a;
        if (Fa == 0.0) return 1;
        if (!isfinite(Fa) || !isfinite(Fb) || signbit(Fa) == signbit(Fb)) continue;
        if (Fb != 0.0 && halve(s, a, b, Fa, Fb, y)) return 1;
    }
    return 0;
}
