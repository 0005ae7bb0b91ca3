/* pivots of many masses side by side have the bits that dm_all_positive finds for each alone */
#include "linalg/signature.h"
#include "numbers/processor.h"
#include "run/ensemble/mass_lanes.h"

#include "check.h"

enum { MOST = 7, TRIES = 400 };
static const double FAR = 1e-3;
static uint64_t state = 88172645463325252u;

/* in [-1, 1), xorshift (Marsaglia 2003) */
static double any(void) {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return (double)(int64_t)state / 9223372036854775808.0;
}

/* M = B B^T + shift, its lower triangle row by row; a shift below zero makes some indefinite */
static void make_mass(double *M, uint32_t n, uint32_t lanes, double shift) {
    double B[MOST * MOST];
    for (uint32_t i = 0; i < n * n; i++) B[i] = any();
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++, M += lanes) {
            *M = i == j ? shift : 0.0;
            for (uint32_t k = 0; k < n; k++) *M += B[i * n + k] * B[j * n + k];
        }
}

/* of one lane: as a look alone has it */
static int alone(const dm_mass_lanes *w, uint32_t lane, double *least, double *all) {
    const uint32_t n = w->n;
    const double *M = w->M + lane;
    double A[MOST * MOST];
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++, M += w->lanes)
            A[i * n + j] = w->scale[i * w->lanes + lane] * *M * w->scale[j * w->lanes + lane];
    const int fine = dm_all_positive(A, n, FAR, least);
    *all = 1.0;
    for (uint32_t i = 0; i < n; i++) *all *= A[i * n + i];
    return fine;
}

static void compare(const dm_mass_lanes *w, uint32_t asked, long *some) {
    const uint32_t told = w->pivots(w, w->scale, FAR, asked);
    for (uint32_t l = 0; l < w->lanes; l++) {
        double least, all;
        const int fine = alone(w, l, &least, &all) && (asked >> l & 1);
        CHECK(fine == (int)(told >> l & 1));
        if (fine) CHECK(memcmp(&w->least[l], &least, sizeof least) == 0 && w->all[l] == all);
        *some += fine;
    }
}

static void compare_all(uint32_t lanes, dm_mass_lanes_pivots *pivots) {
    static _Alignas(64) double M[MOST * MOST * 8], A[MOST * MOST * 8], scale[MOST * 8], out[16];
    long some = 0, all = 0;
    for (uint32_t n = 1; n <= MOST; n++)
        for (int k = 0; k < TRIES; k++) {
            dm_mass_lanes w = {.n = n,
                               .lanes = lanes,
                               .M = M,
                               .A = A,
                               .scale = scale,
                               .least = out,
                               .all = out + 8,
                               .pivots = pivots};
            for (uint32_t l = 0; l < lanes; l++) make_mass(M + l, n, lanes, k % 3 ? 0.01 : -0.1);
            for (uint32_t i = 0; i < n * lanes; i++) scale[i] = 1.0 + 0.5 * any();
            if (k % 50 == 0) M[0] = NAN;
            compare(&w, k % 4 ? (1u << lanes) - 1 : 5u, &some);
            all += lanes;
        }
    CHECK(some > all / 4 && some < all);
}

static void sides(void) {
    dm_mass_lanes_pivots *four = NULL, *eight = NULL;
#ifdef __x86_64__
    four = dm_mass_pivots_avx, eight = dm_mass_pivots_avx512;
#endif
    if (four && dm_processor() >= DM_FMA) compare_all(4, four);
    if (eight && dm_processor() == DM_AVX512) compare_all(8, eight);
}

int main(void) {
    RUN(sides, "pivots of masses side by side are those of each alone, to the bit");
    return check_finish();
}
