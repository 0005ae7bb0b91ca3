/* gln.c - regular matrices; their algebra has all of them, basis element a = n i + j being
 * E_ij. */
#include "geom/space.h"

static uint32_t dimension(uint32_t n) {
    return n * n;
}

/* on vectors */
static int acts(uint32_t n, uint32_t block) {
    return n == block;
}

/* E_ij x, row-major */
static void generator(double *out, const double *x, uint32_t n, uint32_t block, uint32_t a) {
    for (uint32_t k = 0; k < block; k++) out[k] = 0.0;
    out[a / n] = x[a % n];
}

const dm_space dm_space_gln = {
    .kit = "gln",
    .name = "GL",
    .signature = "GL(n)",
    .doc = "Regular n x n matrices. The algebra has all matrices, row by row. They act on blocks "
           "of n coordinates by g x; the momentum is the sum of the matrices p_i x_j.",
    .least = 1,
    .most = DM_LARGEST_GROUP,
    .multiple = 1,
    .dimension = dimension,
    .acts = acts,
    .generator = generator,
};
