#include "dec/simplex_rule.h"

#include "dec/complex.h"

#include <math.h>

static uint32_t half(uint32_t order) {
    return order / 2; /* s, for degree 2 s + 1 >= order */
}

static double binomial(uint32_t n, uint32_t k) {
    double product = 1.0;
    for (uint32_t i = 1; i <= k; i++) product = product * (n - k + i) / i;
    return product;
}

uint32_t dm_simplex_nodes(uint32_t k, uint32_t order) {
    double count = 0.0;
    for (uint32_t i = 0; i <= half(order); i++) count += binomial(i + k, k);
    return (uint32_t)(count + 0.5);
}

/* the next way to write the same sum with k + 1 numbers >= 0, or 0 after the last */
static int next_composition(uint32_t *beta, uint32_t k) {
    uint32_t first = 0;
    while (first < k && beta[first] == 0) first++;
    if (first == k) return 0;
    const uint32_t rest = beta[first] - 1;
    beta[first] = 0;
    beta[0] = rest;
    beta[first + 1]++;
    return 1;
}

/* weight of the nodes ((2 beta + 1) / (d + k - 2 i)), |beta| = s - i, d = 2 s + 1:
 * (-1)^i 4^-s (d + k - 2 i)^d k! / (i! (d + k - i)!) */
static double weight_of(uint32_t k, uint32_t s, uint32_t i) {
    const uint32_t d = 2 * s + 1;
    double w = (i % 2 ? -1.0 : 1.0) * ldexp(1.0, -2 * (int)s) * pow(d + k - 2 * i, d);
    for (uint32_t j = 2; j <= i; j++) w /= j;
    for (uint32_t j = k + 1; j <= d + k - i; j++) w /= j;
    return w;
}

void dm_simplex_rule(double *node, double *weight, uint32_t k, uint32_t order) {
    const uint32_t s = half(order);
    double sum = 0.0;
    uint32_t count = 0;
    for (uint32_t i = 0; i <= s; i++) {
        uint32_t beta[DM_DIMENSION + 1] = {s - i};
        const double w = weight_of(k, s, i);
        do {
            for (uint32_t j = 0; j <= k; j++)
                node[count * (k + 1) + j] = (2.0 * beta[j] + 1.0) / (2 * s + 1 + k - 2 * i);
            weight[count++] = w;
            sum += w;
        } while (next_composition(beta, k));
    }
    for (uint32_t i = 0; i < count; i++) weight[i] /= sum; /* 1 but for rounding */
}
