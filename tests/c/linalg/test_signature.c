/* signs of the values of symmetric matrices, from congruences whose signs are known. */
#include "check.h"
#include "linalg/lu.h"
#include "linalg/signature.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { MOST = 12 };

static uint64_t seed = 1;

/* uniform in [-1, 1) */
static double random_number(void) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-52 - 1.0;
}

/* A = S D S^T has the signs of D (Sylvester). */
static void congruent(double *A, const double *S, const double *D, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) {
            double sum = 0.0;
            for (uint32_t k = 0; k < n; k++) sum += S[i * n + k] * D[k] * S[j * n + k];
            A[i * n + j] = A[j * n + i] = sum;
        }
}

/* the size of that of S D S^T; S becomes its factors */
static double determinant(double *S, const double *D, uint32_t n) {
    uint32_t pivot[MOST];
    double out = 1.0;
    CHECK(dm_lu_factor(S, pivot, n) == DM_OK);
    for (uint32_t i = 0; i < n; i++) out *= fabs(D[i]) / (S[i * n + i] * S[i * n + i]);
    return out;
}

/* of the sizes on the diagonal: what all are above or below at least, 1 where it is neither */
static double common_of(const double *A, uint32_t n) {
    double least = INFINITY, most = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        least = fmin(least, fabs(A[i * n + i]));
        most = fmax(most, fabs(A[i * n + i]));
    }
    return least > 1.0 ? least : most < 1.0 ? most : 1.0;
}

static void counts_random_matrices(void) {
    double A[MOST * MOST], S[MOST * MOST], D[MOST], least, all;
    for (uint32_t n = 1; n <= MOST; n++)
        for (int trial = 0; trial < 200; trial++) {
            uint32_t negative = 0;
            for (uint32_t i = 0; i < n * n; i++) S[i] = random_number();
            for (uint32_t i = 0; i < n; i++) {
                S[i * n + i] += 3.0; /* regular */
                D[i] = (random_number() < 0.0 ? -1.0 : 1.0) * exp(3.0 * random_number());
                negative += D[i] < 0.0;
            }
            congruent(A, S, D, n);
            const double size = n > 4 ? common_of(A, n) : 1.0;
            const double product = determinant(S, D, n) / pow(size, n - 1.0);
            memcpy(S, A, sizeof S);
            const int positive = dm_all_positive(S, n, 0.0, &least, &all);
            if (!CHECK(positive == (negative == 0))) return;
            const double least_positive = least, all_positive = all;
            if (!CHECK(dm_negative_values(A, n, &least, &all) == negative)) return;
            if (!CHECK(!positive || least == least_positive)) return;
            if (!CHECK(!positive || fabs(all - all_positive) < 1e-12 * all)) return;
            if (!CHECK(least > 0.0 && least < INFINITY)) return;
            if (!CHECK(fabs(all - product) < 1e-10 * product)) return;
        }
}

/* Ones on the diagonal, c beside it: n - 1 values 1 - c and one 1 - c + n c, all times g, then but for
 * the first row and column, whose pivot alone stays. */
static void tells_what_moves_alike(void) {
    const double c = 0.3;
    for (uint32_t n = 5; n <= MOST; n++)
        for (double g = 1e-3; g < 1e4; g *= 100.0)
            for (int but_one = 0; but_one < 2; but_one++) {
                double A[MOST * MOST], copy[MOST * MOST], least, all;
                const double rest = pow(1.0 - c, n - 1.0) * (1.0 - c + n * c);
                for (uint32_t i = 0; i < n * n; i++) {
                    const double by =
                        but_one ? (i / n ? sqrt(g) : 1.0) * (i % n ? sqrt(g) : 1.0) : g;
                    A[i] = copy[i] = (i / n == i % n ? 1.0 : c) * by;
                }
                const double expected = rest * (but_one ? pow(g, n - 1.0) : g);
                CHECK(dm_all_positive(A, n, 0.0, &least, &all));
                CHECK(fabs(all - expected) < 1e-12 * expected);
                CHECK(dm_negative_values(copy, n, &least, &all) == 0);
                CHECK(fabs(all - expected) < 1e-12 * expected);
            }
}

/* [x, 1; 1, 1] beside ones, all over 10, has the product x - 1 of its values: there is no jump at
 * x = 0. */
static void moves_through_a_zero_on_the_diagonal(void) {
    for (uint32_t n = 5; n <= MOST; n++)
        for (double x = -1e-9; x < 2e-9; x += 1e-9) {
            double A[MOST * MOST] = {0}, least, all;
            for (uint32_t i = 0; i < n; i++) A[i * n + i] = 0.1;
            A[0] = 0.1 * x, A[1] = A[n] = 0.1;
            CHECK(dm_negative_values(A, n, &least, &all) == 1);
            CHECK(fabs(all - 0.1 * (1.0 - x)) < 1e-15);
        }
}

/* [0, G^T; G, 0] has k of each sign and zeros, [1, g; g, 0] one of each */
static void counts_without_a_diagonal(void) {
    double least, all;
    double swap[] = {0.0, 2.0, 2.0, 0.0}, border[] = {1.0, 3.0, 3.0, 0.0};
    double zero[] = {0.0, 0.0, 0.0, 0.0};
    double two[] = {0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0};
    CHECK(dm_negative_values(swap, 2, &least, &all) == 1);
    CHECK(least == 2.0);
    CHECK(all == 4.0);
    CHECK(dm_negative_values(border, 2, &least, &all) == 1);
    CHECK(dm_negative_values(zero, 2, &least, &all) == 0);
    CHECK(least == 0.0 && all == 0.0);
    CHECK(dm_negative_values(two, 4, &least, &all) == 2);
}

/* [1, c; c, 1] with the pivots 1 and 1 - c^2 */
static void knows_positive_ones(void) {
    double least, all, near[] = {1.0, 0.9, 0.9, 1.0}, none[] = {1.0, NAN, NAN, 1.0};
    double far[] = {1.0, 0.9, 0.9, 1.0}, over[] = {1.0, 1.1, 1.1, 1.0};
    CHECK(dm_all_positive(near, 2, 0.1, &least, &all));
    CHECK(fabs(least - 0.19) < 1e-15);
    CHECK(!dm_all_positive(far, 2, 0.2, &least, &all));
    CHECK(!dm_all_positive(over, 2, 0.0, &least, &all));
    CHECK(!dm_all_positive(none, 2, 0.0, &least, &all));
}

/* The pivot goes to zero with the value. */
static void tells_how_near(void) {
    double near = 0.0, all;
    for (double e = 1e-2; e > 1e-9; e /= 10.0) {
        double A[] = {2.0, 1.0, 1.0, 0.5 + e};
        CHECK(dm_negative_values(A, 2, &near, &all) == 0);
        CHECK(fabs(near - e) < 1e-12);
    }
    double broken[] = {NAN, 1.0, 1.0, 1.0};
    dm_negative_values(broken, 2, &near, &all); /* ends */
}

/* What is told surely positive has no negative value, wherever its entries are within bounds; a
 * matrix of two is positive for all of them where the largest is. */
static void is_sure_of_bounds(void) {
    double centre[MOST * MOST], radius[MOST * MOST], A[MOST * MOST], copy[2][MOST * MOST], least,
        of_all;
    int told[2] = {0, 0}, refused = 0;
    for (int trial = 0; trial < 4000; trial++) {
        const uint32_t n = 1 + (uint32_t)trial % 5;
        const int near = trial % 2; /* else entries have any sign */
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t j = 0; j <= i; j++) {
                const double size = near ? 0.1 : 0.8;
                centre[i * n + j] = centre[j * n + i] = i == j ? exp(2.0 * random_number())
                                                        : near ? random_number()
                                                               : 0.0;
                radius[i * n + j] = radius[j * n + i] = i == j ? 0.0 : size * fabs(random_number());
            }
        memcpy(copy[0], centre, sizeof centre);
        memcpy(copy[1], radius, sizeof radius);
        const int sure = dm_surely_positive(copy[0], copy[1], n);
        const double most = n == 2 ? fabs(centre[1]) + radius[1] : 0.0, all = centre[0] * centre[3];
        if (n == 2) CHECK(sure == (all - most * most > 1e-6 * all));
        told[near] += sure, refused += !sure;
        for (int inside = 0; sure && inside < 20; inside++) {
            for (uint32_t i = 0; i < n; i++)
                for (uint32_t j = 0; j <= i; j++)
                    A[i * n + j] = A[j * n + i] =
                        i == j ? centre[i * n + j] * (1.0 + fabs(random_number()))
                               : centre[i * n + j] + radius[i * n + j] * random_number();
            CHECK(dm_negative_values(A, n, &least, &of_all) == 0);
        }
    }
    CHECK(told[0] > 300 && told[1] > 300 && refused > 300);
    double zero[2][4] = {{0}}, none[] = {1.0, NAN, NAN, 1.0}, flat[] = {1.0, 1.0, 1.0, 1.0};
    double one[] = {1.0, 0.0, 0.0, 1.0}, open[] = {0.0, INFINITY, INFINITY, 0.0};
    CHECK(!dm_surely_positive(none, zero[0], 2) && !dm_surely_positive(flat, zero[1], 2) &&
          !dm_surely_positive(one, open, 2));
}

/* A form on the vectors that rows leave at zero has the negative values of the bordered matrix, less
 * one for every row that is independent; a multiple of 1 stays one, with its pivots. */
static void restricts_forms(void) {
    double A[MOST * MOST], G[3 * 8 + 8], whole[MOST * MOST], least, all;
    for (int trial = 0; trial < 2000; trial++) {
        const uint32_t n = 4 + (uint32_t)trial % 5, k = 1 + (uint32_t)trial % 3, N = n + k;
        memset(whole, 0, sizeof whole);
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t j = 0; j <= i; j++)
                whole[i * N + j] = whole[j * N + i] = A[i * n + j] = A[j * n + i] = random_number();
        for (uint32_t c = 0; c < k; c++)
            for (uint32_t i = 0; i < n; i++)
                whole[(n + c) * N + i] = whole[i * N + n + c] = G[c * n + i] = random_number();
        CHECK(dm_restrict(A, n, G, k, G + k * n) == n - k);
        CHECK(dm_negative_values(whole, N, &least, &all) ==
              k + dm_negative_values(A, n - k, &least, &all));
    }
    for (uint32_t i = 0; i < 25; i++) A[i] = i % 6 == 0 ? 0.25 : 0.0;
    const double rows[] = {1, 2, 3, 4, 5, 2, 4, 6, 8, 10, 0, 0, 0, 0, 0};
    memcpy(G, rows, sizeof rows);
    CHECK(dm_restrict(A, 5, G, 3, G + 15) == 4); /* twice the same row, and none */
    for (uint32_t i = 0; i < 16; i++) CHECK(fabs(A[i] - (i % 5 == 0 ? 0.25 : 0.0)) < 1e-15);
}

int main(void) {
    RUN(restricts_forms, "restricts forms to the vectors that rows leave at zero");
    RUN(counts_random_matrices, "counts negative values of 1 to 12");
    RUN(tells_what_moves_alike, "tells what all values have in common once");
    RUN(moves_through_a_zero_on_the_diagonal, "moves through a zero on the diagonal");
    RUN(counts_without_a_diagonal, "counts where the diagonal is zero");
    RUN(knows_positive_ones, "knows matrices that are positive by far");
    RUN(is_sure_of_bounds, "is sure of matrices within bounds");
    RUN(tells_how_near, "tells how near to zero a value is");
    return check_finish();
}
