/* random.h - random numbers by counting: a number depends on its seed and its place alone
 * (Salmon et al. 2011). */
#ifndef DM_RANDOM_H
#define DM_RANDOM_H

#include <stdint.h>

/* Philox4x32-10: four random words from a counter and a key. */
void dm_philox(uint32_t out[4], const uint32_t counter[4], const uint32_t key[2]);

/* Number k of member i: uniform in (0, 1), 52 bits, never 0 or 1. */
double dm_random_uniform(uint64_t seed, uint64_t i, uint32_t k);

/* Number k of member i: normal with mean 0 and variance 1, independent of the uniform ones. */
double dm_random_normal(uint64_t seed, uint64_t i, uint32_t k);

#endif
