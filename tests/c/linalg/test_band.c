/* banded LU: the numbering finds hidden bands, solutions are those of dense LU, broken matrices
 * are told */
#include "check.h"
#include "linalg/band.h"
#include "linalg/lu.h"

#include <stdint.h>

enum { MOST = 60, REACH = 3 };

static uint64_t seed = 7;

/* uniform in [-1, 1) */
static double random_number(void) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-52 - 1.0;
}

/* a band of half width REACH with zeros on its diagonal here and there, its unknowns shuffled */
static void fill(double *A, uint32_t n) {
    uint32_t place[MOST];
    for (uint32_t i = 0; i < n; i++) place[i] = i;
    for (uint32_t i = n - 1; i > 0; i--) {
        const uint32_t j = (uint32_t)((random_number() + 1.0) * 0.5 * (i + 1));
        const uint32_t kept = place[i];
        place[i] = place[j], place[j] = kept;
    }
    memset(A, 0, (size_t)n * n * sizeof *A);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
            if (i + REACH >= j && j + REACH >= i && !(i == j && i % 3 == 2))
                A[place[i] * n + place[j]] = random_number();
}

static void pack(double *out, const double *A, const dm_band *b) {
    memset(out, 0, dm_band_size(b) * sizeof *out);
    for (uint32_t i = 0; i < b->n; i++)
        for (uint32_t j = 0; j < b->n; j++)
            if (A[i * b->n + j] != 0.0)
                out[dm_band_row(b, i) + dm_band_column(b, j)] = A[i * b->n + j];
}

static void solves_as_dense_does(void) {
    static double A[MOST * MOST], LU[MOST * MOST], ab[MOST * (6 * MOST + 1)];
    uint32_t order[MOST], pivot[MOST], scratch[2 * MOST];
    double x[MOST], y[MOST], more[MOST];
    for (uint32_t n = 1; n <= MOST; n++)
        for (int trial = 0; trial < 10; trial++) {
            fill(A, n);
            dm_band b = {.n = n, .order = order};
            b.width = dm_band_order(order, A, n, scratch);
            CHECK(b.width <= 3 * REACH);
            pack(ab, A, &b);
            memcpy(LU, A, (size_t)n * n * sizeof *A);
            for (uint32_t i = 0; i < n; i++) x[i] = y[i] = random_number();
            const dm_status dense = dm_lu_factor(LU, pivot, n);
            if (dense == DM_OK) dm_lu_solve(x, LU, pivot, n);
            CHECK(dm_band_factor(ab, pivot, &b) == dense);
            if (dense != DM_OK) continue;
            memcpy(more, y, sizeof more);
            double scratch_of[MOST], size = 1.0;
            dm_band_solve(y, ab, pivot, &b, scratch_of);
            for (uint32_t i = 0; i < n; i++) size = fmax(size, fabs(y[i]));
            for (uint32_t i = 0; i < n; i++) { /* backward stable, as dense LU is */
                double r = -more[i];
                for (uint32_t j = 0; j < n; j++) r += A[i * n + j] * y[j];
                CHECK_NEAR(r, 0.0, 1e-13 * size);
            }
        }
}

static void broken_matrices_are_told(void) {
    double A[3] = {0.0, 0.0, 0.0}, B[3] = {1.0, NAN, 1.0};
    const uint32_t order[3] = {2, 0, 1};
    uint32_t pivot[3];
    const dm_band b = {.n = 3, .width = 0, .order = order};
    CHECK(dm_band_factor(A, pivot, &b) == DM_SINGULAR);
    CHECK(dm_band_factor(B, pivot, &b) == DM_NOT_FINITE);
}

int main(void) {
    RUN(solves_as_dense_does, "a shuffled band is found and solved as dense LU solves it");
    RUN(broken_matrices_are_told, "zero and broken pivots are told");
    return check_finish();
}
