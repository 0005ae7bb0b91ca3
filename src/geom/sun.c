/* sun.c - SU(2) as the unit quaternions, in the algebra basis of SO(3): exp(t e_a) is cos(t/2) +
 * sin(t/2) times the unit a. */
#include "geom/space.h"

static uint32_t dimension(uint32_t n) {
    return n * n - 1;
}

/* on R^4, as quaternions */
static int acts(uint32_t n, uint32_t block) {
    return n == 2 && block == 4;
}

/* half the product of the unit a and x = (w, x, y, z): its entries are those of x at other places,
 * with signs */
static void generator(double *out, const double *x, uint32_t n, uint32_t block, uint32_t a) {
    static const uint32_t at[3][4] = {{1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}};
    static const double half[3][4] = {{-0.5, 0.5, -0.5, 0.5},
                                      {-0.5, 0.5, 0.5, -0.5},
                                      {-0.5, -0.5, 0.5, 0.5}};
    (void)n;
    for (uint32_t k = 0; k < block; k++) out[k] = half[a][k] * x[at[a][k]];
}

const dm_space dm_space_sun = {
    .kit = "su2",
    .name = "SU",
    .signature = "SU(n)",
    .doc = "SU(2), n = 2: unit quaternions (w, x, y, z), vectors of 4, which cover the rotations "
           "of SO(3) twice. The algebra has the basis of SO(3): exp(t e_a) turns by the angle t. "
           "It acts on blocks of 4 coordinates by quaternion products.",
    .least = 2,
    .most = 2,
    .multiple = 1,
    .usual = 2,
    .dimension = dimension,
    .acts = acts,
    .generator = generator,
};
