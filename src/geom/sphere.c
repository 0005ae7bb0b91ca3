/* sphere.c - spheres of unit vectors, manifolds and no groups: they act on nothing, but others
 * act on them. */
#include "geom/space.h"

static uint32_t dimension(uint32_t n) {
    return n;
}

/* no group: it acts on nothing */
static int acts(uint32_t n, uint32_t block) {
    (void)n, (void)block;
    return 0;
}

static void generator(double *out, const double *x, uint32_t n, uint32_t block, uint32_t a) {
    (void)x, (void)n, (void)a;
    for (uint32_t i = 0; i < block; i++) out[i] = 0.0;
}

const dm_space dm_space_sphere = {
    .kit = "sphere",
    .name = "S",
    .signature = "S(n)",
    .doc = "Sphere S^n of unit vectors of R^(n+1): a manifold that groups act on. A system on it "
           "has n+1 coordinates q and the constraint q . q = 1, which dm.system adds. It is no "
           "group: S:exp(z, w) and S:log(z, y) are those of its great circles, from a point z.",
    .least = 1,
    .most = DM_LARGEST_SPACE,
    .multiple = 1,
    .sphere = 1,
    .dimension = dimension,
    .acts = acts,
    .generator = generator,
};
