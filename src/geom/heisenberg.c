/* heisenberg.c - the Heisenberg group of n pairs, on itself from the left: xi_a at x is the
 * derivative of (exp(s e_a)) x at s = 0. */
#include "geom/space.h"

static uint32_t dimension(uint32_t n) {
    return 2 * n + 1;
}

/* on its own elements */
static int acts(uint32_t n, uint32_t block) {
    return 2 * n + 1 == block;
}

/* of the translations from the left (a, b, c)(x, y, z) = (a + x, b + y, c + z + (a . y - b .
 * x)/2) */
static void generator(double *out, const double *x, uint32_t n, uint32_t block, uint32_t a) {
    for (uint32_t k = 0; k < block; k++) out[k] = 0.0;
    out[a] = 1.0;
    if (a < n) out[2 * n] = 0.5 * x[n + a];
    if (a >= n && a < 2 * n) out[2 * n] = -0.5 * x[a - n];
}

const dm_space dm_space_heisenberg = {
    .kit = "heisenberg",
    .name = "Heisenberg",
    .signature = "Heisenberg(n)",
    .doc = "The Heisenberg group of n pairs (1 when left out), of dimension 2n + 1: vectors (x, "
           "y, z) with (a, b, c)(x, y, z) = (a + x, b + y, c + z + (a . y - b . x)/2), so that "
           "exp is the identity. It acts on blocks of 2n + 1 coordinates from the left.",
    .least = 1,
    .most = DM_LARGEST_GROUP / 2 - 1,
    .multiple = 1,
    .usual = 1,
    .dimension = dimension,
    .acts = acts,
    .generator = generator,
};
