/* sem_warm.h - a step begins where the steps before, continued, would have it: velocities and
 * length are smooth in the number of the step, as their equations do not know it. */
#ifndef DM_SEM_WARM_H
#define DM_SEM_WARM_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* So many values at most, of which the next is the polynomial; three of them always. */
enum { DM_SEM_TERMS = 6, DM_SEM_PARABOLA = 2, DM_SEM_MANY = 14 };

/* What is kept of K unknowns z: how many steps are known, at most TERMS; the next z[K]; and
 * P_j[TERMS][K], the polynomial of degree j through j + 1 of them at the next point. A new z has
 * the differences D_j = z - P_j, and the new P_j is z + D_0 + ... + D_(j-1). */
enum { DM_SEM_KNOWN, DM_SEM_NEXT };
static inline size_t dm_sem_warm_size(uint32_t K) {
    return DM_SEM_NEXT + (1 + DM_SEM_TERMS) * (size_t)K;
}

/* The degree of the next guess, where `known` polynomials had been there and size[j] is what P_j
 * missed: further out only where one more halves that, as on rough motion the guess may lead to
 * another root. */
static inline int dm_sem_degree(const double *size, int known) {
    int j = known < DM_SEM_PARABOLA ? known : DM_SEM_PARABOLA;
    while (j + 1 < known && size[j + 1] <= 0.5 * size[j]) j++;
    return j;
}

typedef double dm_sem_two __attribute__((vector_size(16), aligned(8), may_alias));
typedef long long dm_sem_mask __attribute__((vector_size(16)));

/* The larger of |D| and a size, which a NaN does not change. */
static inline dm_sem_two dm_sem_larger(dm_sem_two size, dm_sem_two D) {
    static const dm_sem_mask positive = {INT64_MAX, INT64_MAX};
    const dm_sem_mask x = (dm_sem_mask)D & positive, larger = (dm_sem_two)x > size;
    return (dm_sem_two)((x & larger) | ((dm_sem_mask)size & ~larger));
}

/* Two unknowns z, P_0 of which stands at `place`: new polynomials, and what the old ones missed. */
static inline void dm_sem_warm_two(double *place, dm_sem_two z, uint32_t K, dm_sem_two *sizes) {
    dm_sem_two value = z;
#pragma GCC unroll 8
    for (uint32_t j = 0; j < DM_SEM_TERMS; j++) {
        dm_sem_two *P = (dm_sem_two *)(void *)(place + j * (size_t)K);
        const dm_sem_two D = z - *P;
        *P = value;
        value += D;
        sizes[j] = dm_sem_larger(sizes[j], D);
    }
}

/* Of an even number of them, which it returns; size: what the old ones missed. */
static inline uint32_t dm_sem_warm_twos(double *P, const double *z, uint32_t K, double *size) {
    dm_sem_two sizes[DM_SEM_TERMS] = {{0}};
    for (uint32_t k = 0; k < K / 2; k++)
        dm_sem_warm_two(P + 2 * k, ((const dm_sem_two *)(const void *)z)[k], K, sizes);
    for (int j = 0; j < DM_SEM_TERMS; j++)
        size[j] = sizes[j][0] > sizes[j][1] ? sizes[j][0] : sizes[j][1];
    return K / 2 * 2;
}

/* One unknown. */
static inline void dm_sem_warm_one(double *place, double z, uint32_t K, double *size) {
    double value = z;
#pragma GCC unroll 8
    for (uint32_t j = 0; j < DM_SEM_TERMS; j++) {
        double *P = place + j * (size_t)K;
        const double D = z - *P;
        *P = value;
        value += D;
        size[j] = fabs(D) > size[j] ? fabs(D) : size[j];
    }
}

/* How many steps are known; a checkpoint may hold anything there. */
static inline int dm_sem_known(const double *warm) {
    const double known = warm[DM_SEM_KNOWN];
    return known >= 0.0 && known <= DM_SEM_TERMS ? (int)known : 0;
}

/* A step has made it z; goes_on: behind those that are kept. Two unknowns at a time pay where there
 * are many. */
static inline void dm_sem_warm_keep(double *warm, const double *z, uint32_t K, int goes_on) {
    double *next = warm + DM_SEM_NEXT, *P = next + K, size[DM_SEM_TERMS] = {0.0};
    const int known = goes_on ? dm_sem_known(warm) : 0;
    uint32_t k = K < DM_SEM_MANY ? 0 : dm_sem_warm_twos(P, z, K, size);
#pragma GCC unroll 8
    for (; k < K; k++) dm_sem_warm_one(P + k, z[k], K, size);
    const double *guess = P + (uint32_t)dm_sem_degree(size, known) * K;
#pragma GCC unroll 8
    for (k = 0; k < K; k++) next[k] = guess[k];
    warm[DM_SEM_KNOWN] = known < DM_SEM_TERMS ? known + 1 : DM_SEM_TERMS;
}

#endif
