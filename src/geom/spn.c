/* spn.c - symplectic matrices g^T J g = J; their algebra has the matrices X with J X symmetric. */
#include "geom/space.h"

/* n = 2 k: A of k x k entries, then B and C by their upper triangles */
static uint32_t dimension(uint32_t n) {
    return n * (n + 1) / 2;
}

/* on pairs (q, p) of k entries each */
static int acts(uint32_t n, uint32_t block) {
    return n == block;
}

/* the entry a of an upper triangle of k x k entries, row by row */
static void triangle(uint32_t k, uint32_t a, uint32_t *i, uint32_t *j) {
    for (*i = 0; a >= k - *i; a -= k - *i, ++*i) continue;
    *j = *i + a;
}

/* {{A, B}, {C, -A^T}} x, B and C symmetric */
static void generator(double *out, const double *x, uint32_t n, uint32_t block, uint32_t a) {
    const uint32_t k = n / 2, corner = k * (k + 1) / 2;
    uint32_t i, j;
    for (uint32_t l = 0; l < block; l++) out[l] = 0.0;
    if (a < k * k) {
        out[a / k] = x[a % k];
        out[k + a % k] = -x[k + a / k];
        return;
    }
    const int lower = a >= k * k + corner;
    const uint32_t to = lower ? k : 0, from = lower ? 0 : k;
    triangle(k, a - k * k - (lower ? corner : 0), &i, &j);
    out[to + i] = x[from + j];
    out[to + j] = x[from + i];
}

const dm_space dm_space_spn = {
    .kit = "spn",
    .name = "Sp",
    .signature = "Sp(n)",
    .doc = "Symplectic n x n matrices, n = 2k: g^T J g = J for x = (q, p) with k entries each. "
           "The algebra has the matrices {{A, B}, {C, -A^T}}, B and C symmetric: A row by row, "
           "then the upper triangles of B and of C. They act on blocks of n coordinates by g x.",
    .least = 2,
    .most = DM_LARGEST_GROUP,
    .multiple = 2,
    .dimension = dimension,
    .acts = acts,
    .generator = generator,
};
