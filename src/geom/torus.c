/* torus.c - tori T^n of n angles. The group of turns is R^n by the angles, so its generators
 * are. */
#include "geom/space.h"

static uint32_t dimension(uint32_t n) {
    return n;
}

/* n angles a block */
static int acts(uint32_t n, uint32_t block) {
    return n == block;
}

/* rotations of each angle: every basis vector is its own generator */
static void generator(double *out, const double *x, uint32_t n, uint32_t block, uint32_t a) {
    (void)x, (void)n;
    for (uint32_t i = 0; i < block; i++) out[i] = i == a ? 1.0 : 0.0;
}

const dm_space dm_space_torus = {
    .kit = "torus",
    .name = "T",
    .signature = "T(n)",
    .doc = "Torus T^n of n angles in rad. Paths keep the angles unwrapped, so that differences "
           "stay small; it acts on blocks of n angles by addition.",
    .least = 1,
    .most = DM_LARGEST_SPACE,
    .multiple = 1,
    .chart = 1,
    .dimension = dimension,
    .acts = acts,
    .generator = generator,
};
