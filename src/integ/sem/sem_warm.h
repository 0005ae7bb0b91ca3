/* sem_warm.h - a step begins where the steps before, continued, would have it: velocities and
 * length are smooth in the number of the step, as their equations do not know it. */
#ifndef DM_SEM_WARM_H
#define DM_SEM_WARM_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* So many values at most, of which the next is the polynomial; three of them always. */
enum { DM_SEM_TERMS = 6, DM_SEM_PARABOLA = 2 };

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

/* A step has made it z; goes_on: behind those that are kept. */
static inline void dm_sem_warm_keep(double *warm, const double *z, uint32_t K, int goes_on) {
    double *next = warm + DM_SEM_NEXT, *P = next + K, size[DM_SEM_TERMS] = {0.0};
    const int known = goes_on ? (int)warm[DM_SEM_KNOWN] : 0;
#pragma GCC unroll 8
    for (uint32_t k = 0; k < K; k++) {
        double value = z[k];
#pragma GCC unroll 8
        for (uint32_t j = 0; j < DM_SEM_TERMS; j++) {
            double *place = P + j * K + k;
            const double D = z[k] - *place;
            *place = value;
            value += D;
            size[j] = fabs(D) > size[j] ? fabs(D) : size[j];
        }
    }
    const double *guess = P + (uint32_t)dm_sem_degree(size, known) * K;
#pragma GCC unroll 8
    for (uint32_t k = 0; k < K; k++) next[k] = guess[k];
    warm[DM_SEM_KNOWN] = known < DM_SEM_TERMS ? known + 1 : DM_SEM_TERMS;
}

#endif
