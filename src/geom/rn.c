/* rn.c - vector spaces R^n, and as groups the translations of R^n. xi_a is basis vector a. */
#include "geom/space.h"

static uint32_t dimension(uint32_t n) {
    return n;
}

/* one vector a block */
static int acts(uint32_t n, uint32_t block) {
    return n == block;
}

/* translations: every basis vector is its own generator */
static void generator(double *out, const double *x, uint32_t n, uint32_t block, uint32_t a) {
    (void)x, (void)n;
    for (uint32_t i = 0; i < block; i++) out[i] = i == a ? 1.0 : 0.0;
}

const dm_space dm_space_rn = {
    .kit = "rn",
    .name = "R",
    .signature = "R(n)",
    .doc = "Euclidean space R^n. As a group it acts on blocks of n coordinates by translation; "
           "its momentum is the sum of the momenta of the blocks.",
    .least = 1,
    .most = DM_LARGEST_SPACE,
    .multiple = 1,
    .chart = 1,
    .vectors = 1,
    .dimension = dimension,
    .acts = acts,
    .generator = generator,
};
