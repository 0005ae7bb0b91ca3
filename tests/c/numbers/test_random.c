/* random numbers by counting: published answers, moments, independence of neighbours. */
#include "base/random.h"

#include "check.h"

/* known answers that the authors publish with the generator (Salmon et al. 2011) */
static void published_answers(void) {
    static const struct {
        uint32_t counter[4], key[2], out[4];
    } rows[] = {
        {{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
        {{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
         {0xffffffff, 0xffffffff},
         {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
        {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
         {0xa4093822, 0x299f31d0},
         {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
    };
    for (int i = 0; i < 3; i++) {
        uint32_t out[4];
        dm_philox(out, rows[i].counter, rows[i].key);
        for (int k = 0; k < 4; k++) CHECK(out[k] == rows[i].out[k]);
    }
}

enum { COUNT = 200000 };

/* moment m of a distribution from COUNT numbers is known to sigma / sqrt(COUNT); 5 of those are
 * allowed */
static void moments(void) {
    double u1 = 0, u2 = 0, n1 = 0, n2 = 0, n4 = 0;
    for (uint64_t i = 0; i < COUNT; i++) {
        const double u = dm_random_uniform(7, i, 3), x = dm_random_normal(7, i, 3);
        CHECK(u > 0.0 && u < 1.0);
        u1 += u / COUNT, u2 += u * u / COUNT;
        n1 += x / COUNT, n2 += x * x / COUNT, n4 += x * x * x * x / COUNT;
    }
    const double five = 5.0 / sqrt(COUNT);
    CHECK_NEAR(u1, 1.0 / 2, five * sqrt(1.0 / 12));
    CHECK_NEAR(u2, 1.0 / 3, five * sqrt(4.0 / 45));
    CHECK_NEAR(n1, 0.0, five);
    CHECK_NEAR(n2, 1.0, five * sqrt(2.0));
    CHECK_NEAR(n4, 3.0, five * sqrt(96.0));
}

/* numbers that are next to each other in member, place, seed or kind do not go together */
static void neighbours_are_independent(void) {
    double sum[4] = {0};
    for (uint64_t i = 0; i < COUNT; i++) {
        const double x = dm_random_normal(1, i, 0), u = dm_random_uniform(1, i, 0) - 0.5;
        sum[0] += x * dm_random_normal(1, i + 1, 0);
        sum[1] += x * dm_random_normal(1, i, 1);
        sum[2] += x * dm_random_normal(2, i, 0);
        sum[3] += x * u * sqrt(12.0);
    }
    for (int k = 0; k < 4; k++) CHECK_NEAR(sum[k] / COUNT, 0.0, 5.0 / sqrt(COUNT));
}

int main(void) {
    RUN(published_answers, "philox gives the published answers");
    RUN(moments, "moments are those of the distributions");
    RUN(neighbours_are_independent, "neighbours are independent");
    return check_finish();
}
