/* son.c - rotations of R^n. The algebra has one basis element a coordinate plane (i, j): xi =
 * x_i e_j - x_j e_i, turning from i to j. */
#include "geom/space.h"

/* planes of R^n */
static uint32_t dimension(uint32_t n) {
    return n * (n - 1) / 2;
}

/* SO(n) on R^n; SO(2) also on R^3, about the third axis */
static int acts(uint32_t n, uint32_t block) {
    return n == block || (n == 2 && block == 3);
}

/* planes in the order that makes the momentum of SO(3) equal q x p: (2,3), (3,1), (1,2)
 */
static void plane(uint32_t n, uint32_t a, uint32_t *i, uint32_t *j) {
    if (n == 3) {
        *i = (a + 1) % 3, *j = (a + 2) % 3;
        return;
    }
    for (*i = 0; a >= n - 1 - *i; a -= n - 1 - *i, ++*i) continue;
    *j = *i + 1 + a;
}

/* the velocity of x under a rotation in plane a */
static void generator(double *out, const double *x, uint32_t n, uint32_t block, uint32_t a) {
    uint32_t i, j;
    plane(n, a, &i, &j);
    for (uint32_t k = 0; k < block; k++) out[k] = 0.0;
    out[i] = -x[j];
    out[j] = x[i];
}

const dm_space dm_space_son = {
    .kit = "son",
    .name = "SO",
    .signature = "SO(n)",
    .doc = "Rotations of R^n, n >= 2, of dimension n(n-1)/2. The algebra of SO(3) has the vectors "
           "w with hat(w) a = w x a (cross product), of others the entries below the diagonal, "
           "column by column "
           "from (2, 1) on. They act on blocks of n coordinates; SO(2) also on blocks of 3, about "
           "the third axis. The momentum of SO(3) "
           "is the sum of q x p, of SO(2) the sum of q1 p2 - q2 p1.",
    .least = 2,
    .most = DM_LARGEST_GROUP,
    .multiple = 1,
    .chart = 0,
    .dimension = dimension,
    .acts = acts,
    .generator = generator,
};
