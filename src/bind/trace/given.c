/* given.c - which rounds of a sum are compared with its trace, and what is a difference. */
#include "bind/trace/given.h"

#include <math.h>

static const double tolerance = 1e-8; /* rounding differs where simplifying changed the order */

enum { ROUNDS = 256 }; /* of one sum */

uint32_t dml_given_stride(dml_given *given, uint32_t rounds) {
    if (given->calls <= given->looked) return rounds;
    given->looked = given->calls;
    return 1 + (rounds - 1) / ROUNDS;
}

void dml_given_compare(dml_given *given, const char *what, uint32_t round, uint32_t rounds,
                       double plain, double traced) {
    const double size = fmax(1.0, fmax(fabs(plain), fabs(traced)));
    if (given->differs || !isfinite(plain) || !isfinite(traced)) return;
    if (fabs(plain - traced) <= tolerance * size) return;
    given->differs = 1;
    given->what = what;
    given->round = round;
    given->rounds = rounds;
    given->plain = plain;
    given->traced = traced;
}
