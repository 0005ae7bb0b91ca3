/* random.c - Philox4x32-10 of Salmon, Moraes, Dror and Shaw (SC 2011): random numbers as a
 * function of a seed and a place. So member i of an ensemble has the same numbers whatever
 * thread it is in and whoever was asked before it; nothing is kept between calls. */
#include "base/random.h"

#include <math.h>

enum { ROUNDS = 10 };
enum { UNIFORM, NORMAL }; /* the last word of the counter keeps the kinds apart */

/* multipliers of the round, and what the key grows by: Salmon et al. 2011, section 3.3 */
static const uint32_t factor[2] = {0xD2511F53, 0xCD9E8D57};
static const uint32_t weyl[2] = {0x9E3779B9, 0xBB67AE85};

/* ten rounds of two 32 x 32 -> 64 bit products, a key that grows in between */
void dm_philox(uint32_t out[4], const uint32_t counter[4], const uint32_t key[2]) {
    uint32_t a = counter[0], b = counter[1], c = counter[2], d = counter[3];
    uint32_t k0 = key[0], k1 = key[1];
    for (int i = 0; i < ROUNDS; i++, k0 += weyl[0], k1 += weyl[1]) {
        const uint64_t x = (uint64_t)factor[0] * a, y = (uint64_t)factor[1] * c;
        a = (uint32_t)(y >> 32) ^ b ^ k0;
        c = (uint32_t)(x >> 32) ^ d ^ k1;
        b = (uint32_t)y;
        d = (uint32_t)x;
    }
    out[0] = a, out[1] = b, out[2] = c, out[3] = d;
}

/* four words for number k of member i */
static void words(uint32_t out[4], uint64_t seed, uint64_t i, uint32_t k, uint32_t kind) {
    const uint32_t counter[4] = {(uint32_t)i, (uint32_t)(i >> 32), k, kind};
    const uint32_t key[2] = {(uint32_t)seed, (uint32_t)(seed >> 32)};
    dm_philox(out, counter, key);
}

/* the middle of one of 2^52 equal intervals */
static double fraction(uint32_t high, uint32_t low) {
    const uint64_t bits = ((uint64_t)high << 32 | low) >> 12;
    return ((double)bits + 0.5) * 0x1p-52;
}

double dm_random_uniform(uint64_t seed, uint64_t i, uint32_t k) {
    uint32_t w[4];
    words(w, seed, i, k, UNIFORM);
    return fraction(w[0], w[1]);
}

/* Box & Muller 1958 */
double dm_random_normal(uint64_t seed, uint64_t i, uint32_t k) {
    static const double TWO_PI = 6.283185307179586477;
    uint32_t w[4];
    words(w, seed, i, k, NORMAL);
    return sqrt(-2.0 * log(fraction(w[0], w[1]))) * cos(TWO_PI * fraction(w[2], w[3]));
}
