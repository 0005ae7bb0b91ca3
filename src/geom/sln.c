/* sln.c - matrices of determinant 1; their algebra has the matrices of trace zero. */
#include "geom/space.h"

/* all entries but one */
static uint32_t dimension(uint32_t n) {
    return n * n - 1;
}

static int acts(uint32_t n, uint32_t block) {
    return n == block;
}

/* X x with the entries of X row by row, but for the last, which makes the trace zero */
static void generator(double *out, const double *x, uint32_t n, uint32_t block, uint32_t a) {
    const uint32_t i = a / n, j = a % n;
    for (uint32_t k = 0; k < block; k++) out[k] = 0.0;
    out[i] = x[j];
    if (i == j) out[n - 1] = -x[n - 1];
}

const dm_space dm_space_sln = {
    .kit = "sln",
    .name = "SL",
    .signature = "SL(n)",
    .doc = "Matrices n x n of determinant 1, n >= 2. The algebra has the matrices of trace zero, "
           "row by row without the last entry: (a, b, c) is {{a, b}, {c, -a}} for SL(2). They "
           "act on blocks of n coordinates by g x.",
    .least = 2,
    .most = DM_LARGEST_GROUP,
    .multiple = 1,
    .dimension = dimension,
    .acts = acts,
    .generator = generator,
};
