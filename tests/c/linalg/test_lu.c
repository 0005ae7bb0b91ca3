/* dense LU: solutions, inverses, singular and broken matrices. */
#include "check.h"
#include "linalg/lu.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { MOST = 40 };

static uint64_t seed = 1;

/* uniform in [-1, 1) */
static double random_number(void) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-52 - 1.0;
}

static void fill(double *A, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) A[i] = random_number();
}

static void solves_random_systems(void) {
    static double A[MOST * MOST], LU[MOST * MOST];
    double x[MOST], b[MOST];
    uint32_t pivot[MOST];
    for (uint32_t n = 1; n <= MOST; n++)
        for (int trial = 0; trial < 20; trial++) {
            fill(A, n * n);
            fill(b, n);
            memcpy(LU, A, n * n * sizeof *A);
            memcpy(x, b, n * sizeof *b);
            if (!CHECK(dm_lu_factor(LU, pivot, n) == DM_OK)) return;
            dm_lu_solve(x, LU, pivot, n);
            for (uint32_t i = 0; i < n; i++) { /* backward stable: small against |A| |x| */
                double r = -b[i], size = 0.0;
                for (uint32_t j = 0; j < n; j++) {
                    r += A[i * n + j] * x[j];
                    size += fabs(A[i * n + j] * x[j]);
                }
                CHECK_NEAR(r, 0.0, 1e-13 * (1.0 + size));
            }
        }
}

/* of the transposed matrix, from the same factors */
static void solves_transposed_systems(void) {
    static double A[MOST * MOST], LU[MOST * MOST];
    double x[MOST], b[MOST];
    uint32_t pivot[MOST];
    for (uint32_t n = 1; n <= MOST; n++) {
        fill(A, n * n);
        fill(b, n);
        memcpy(LU, A, n * n * sizeof *A);
        memcpy(x, b, n * sizeof *b);
        if (!CHECK(dm_lu_factor(LU, pivot, n) == DM_OK)) return;
        dm_lu_solve_transposed(x, LU, pivot, n);
        for (uint32_t i = 0; i < n; i++) {
            double r = -b[i], size = 0.0;
            for (uint32_t j = 0; j < n; j++) {
                r += A[j * n + i] * x[j];
                size += fabs(A[j * n + i] * x[j]);
            }
            CHECK_NEAR(r, 0.0, 1e-13 * (1.0 + size));
        }
    }
}

/* H_ij = 1/(i+j+1); the inverse of the Hilbert matrix of 4 is known in integers */
static void inverts_the_hilbert_matrix(void) {
    static const double exact[16] = {16,  -120,  240,  -140,  -120, 1200, -2700, 1680,
                                     240, -2700, 6480, -4200, -140, 1680, -4200, 2800};
    double H[16], inverse[16], column[4];
    uint32_t pivot[4];
    for (uint32_t i = 0; i < 16; i++) H[i] = 1.0 / (i / 4 + i % 4 + 1);
    CHECK(dm_lu_inverse(inverse, H, pivot, column, 4) == DM_OK);
    for (uint32_t i = 0; i < 16; i++) CHECK_NEAR(inverse[i], exact[i], 1e-9);
}

static void exchanges_rows(void) {
    double A[9] = {0, 0, 2, 3, 0, 0, 0, 5, 0}, x[3] = {2, 3, 5};
    uint32_t pivot[3];
    CHECK(dm_lu_factor(A, pivot, 3) == DM_OK);
    dm_lu_solve(x, A, pivot, 3);
    for (int i = 0; i < 3; i++) CHECK_NEAR(x[i], 1.0, 0.0);
}

/* units must not matter: a mass of 1e-30 beside one of 1 is not singular */
static void small_is_not_singular(void) {
    double A[4] = {1, 0, 0, 1e-30}, inverse[4], column[2];
    uint32_t pivot[2];
    CHECK(dm_lu_inverse(inverse, A, pivot, column, 2) == DM_OK);
    CHECK_NEAR(inverse[3], 1e30, 1e15);
}

static void tells_singular_and_broken_matrices(void) {
    double zero[1] = {0}, rank1[4] = {1, 2, 2, 4}, column[3], inverse[9];
    double nearly[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9}; /* rank 2, but not in floating point */
    double broken[4] = {NAN, 1, 1, 1}, infinite[4] = {1, 1, 1, INFINITY};
    uint32_t pivot[3];
    CHECK(dm_lu_factor(zero, pivot, 1) == DM_SINGULAR);
    CHECK(dm_lu_factor(rank1, pivot, 2) == DM_SINGULAR);
    CHECK(dm_lu_inverse(inverse, nearly, pivot, column, 3) == DM_SINGULAR);
    CHECK(dm_lu_factor(broken, pivot, 2) == DM_NOT_FINITE);
    CHECK(dm_lu_factor(infinite, pivot, 2) == DM_NOT_FINITE);
}

int main(void) {
    RUN(solves_random_systems, "solves random systems of 1 to 40 unknowns");
    RUN(solves_transposed_systems, "solves transposed systems by the same factors");
    RUN(inverts_the_hilbert_matrix, "inverts the Hilbert matrix of 4");
    RUN(exchanges_rows, "exchanges rows where the diagonal is zero");
    RUN(small_is_not_singular, "a matrix of very different units is not singular");
    RUN(tells_singular_and_broken_matrices, "tells singular and not finite matrices");
    return check_finish();
}
