/* sen.c - rigid motions of R^n: translations and rotations, each as they are alone. */
#include "geom/space.h"

static uint32_t dimension(uint32_t n) {
    return n + n * (n - 1) / 2;
}

/* on points */
static int acts(uint32_t n, uint32_t block) {
    return n == block;
}

/* n translations, then the rotations in the order of SO(n) */
static void generator(double *out, const double *x, uint32_t n, uint32_t block, uint32_t a) {
    if (a < n)
        dm_space_rn.generator(out, x, n, block, a);
    else
        dm_space_son.generator(out, x, n, block, a - n);
}

const dm_space dm_space_sen = {
    .kit = "sen",
    .name = "SE",
    .signature = "SE(n)",
    .doc = "Rigid motions of R^n, n >= 2: x -> R x + a. Elements of SE(2) are (x, y, theta), of "
           "SE(3) and more the matrices {{R, a}, {0, 1}}; the algebra has the translations "
           "first, then the rotations of SO(n). They act on blocks of n coordinates; the "
           "momentum is (sum of p, momentum of SO(n)).",
    .least = 2,
    .most = DM_LARGEST_GROUP,
    .multiple = 1,
    .dimension = dimension,
    .acts = acts,
    .generator = generator,
};
