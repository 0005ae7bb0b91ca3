/* Phases on arrays: the bits of every processor level, whole and by two; phases against libm. */
#include "check.h"
#include "numbers/processor.h"
#include "wave/turn.h"

#include <math.h>
#include <string.h>

enum { MOST = 37 };

/* numbers without order */
static void fill(double *out, size_t n, unsigned seed) {
    for (size_t i = 0; i < n; i++) {
        seed = seed * 1664525u + 1013904223u;
        out[i] = (double)seed / 2147483648.0 - 1.0;
    }
}

/* z e f as two sums of two products each */
static void by_hand(double *z, const double *e, size_t n) {
    for (size_t i = 0; i < 2 * n; i += 2) {
        const double a = z[i], b = z[i + 1];
        z[i] = a * e[i] - b * e[i + 1];
        z[i + 1] = b * e[i] + a * e[i + 1];
    }
}

static const dm_processor_level levels[] = {DM_PLAIN, DM_FMA, DM_AVX512};

static void turns(dm_processor_level level, size_t n) {
    _Alignas(64) double z[2 * MOST], e[2 * MOST], f[2 * MOST], hand[2 * MOST];
    fill(z, 2 * n, 1), fill(e, 2 * n, 2), fill(f, 2 * n, 3);
    memcpy(hand, z, 2 * n * sizeof *z);
    dm_processor_limit(level);
    dm_turn(z, e, n);
    by_hand(hand, e, n);
    CHECK(memcmp(z, hand, 2 * n * sizeof *z) == 0);
    dm_turn_twice(z, e, f, n);
    by_hand(hand, e, n);
    by_hand(hand, f, n);
    CHECK(memcmp(z, hand, 2 * n * sizeof *z) == 0);
}

static void test_turns(void) {
    for (int i = 0; i < 3; i++)
        for (size_t n = 1; n <= MOST; n += 6) turns(levels[i], n);
}

static void test_phases(void) {
    _Alignas(64) double angle[MOST + 8] = {0}, e[2 * MOST];
    fill(angle, MOST, 5);
    for (int i = 0; i < 3; i++) {
        dm_processor_limit(levels[i]);
        dm_phases(e, angle, MOST);
        for (size_t j = 0; j < MOST; j++) {
            CHECK_NEAR(e[2 * j], cos(angle[j]), 3e-16);
            CHECK_NEAR(e[2 * j + 1], sin(angle[j]), 3e-16);
        }
    }
}

int main(void) {
    RUN(test_turns, "products have the same bits at every level of the processor");
    RUN(test_phases, "phases are those of the C library");
    return check_finish();
}
