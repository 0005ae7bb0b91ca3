/* sem_places.h - states that a stepper knows: where the last step began, where it led, and where a
 * step on the side from there led. So a step of another length than the whole one, for an event or
 * a row between two steps, leaves the run as it is. */
#ifndef DM_SEM_PLACES_H
#define DM_SEM_PLACES_H

#include "integ/sem/sem_inside.h"

#include <string.h>

enum { DM_SEM_BASE, DM_SEM_FIRST, DM_SEM_OTHER, DM_SEM_PLACES };

/* Numbers of a place. Of the step that ended there: its h, energy and flag, and WARM, LAST: it was
 * the last one that sem_warm.h keeps, GONE: a whole step has been made from here. Of the one that
 * begins there, h = 0: not known yet. */
enum {
    DM_SEM_LENGTH,
    DM_SEM_ENERGY,
    DM_SEM_FLAG,
    DM_SEM_WARM,
    DM_SEM_NEXT_LENGTH,
    DM_SEM_NEXT_ENERGY,
    DM_SEM_NEXT_FLAG,
    DM_SEM_NUMBERS
};
enum { DM_SEM_COLD, DM_SEM_LAST, DM_SEM_GONE };

/* A place: its mark (1: a state is there), q[n], p[n], t, and the numbers. */
static inline size_t dm_sem_place_size(uint32_t n) {
    return 2 + 2 * (size_t)n + DM_SEM_NUMBERS;
}

static inline double *dm_sem_place(const dm_sem *e, int which, uint32_t n) {
    return e->places + (size_t)which * dm_sem_place_size(n);
}

static inline double *dm_sem_numbers(const dm_sem *e, int which, uint32_t n) {
    return dm_sem_place(e, which, n) + 2 + 2 * (size_t)n;
}

/* Do both have the same bits? 0: yes. */
static inline uint64_t dm_sem_differ(const double *a, const double *b) {
    uint64_t x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return x ^ y;
}

/* Does the place hold (q, p, t) of this state? */
static inline int dm_sem_holds(const dm_sem *e, int which, const double *state, uint32_t n) {
    const double *place = dm_sem_place(e, which, n), *key = place + 1;
    uint64_t differ = dm_sem_differ(key + 2 * n, state + 4 * (size_t)n);
#pragma GCC unroll 8
    for (uint32_t k = 0; k < 2 * n; k++) differ |= dm_sem_differ(key + k, state + k);
    return place[0] != 0.0 && differ == 0;
}

/* The place takes this state and its numbers. */
static inline void dm_sem_put(const dm_sem *e, int which, const double *state,
                              const double *numbers, uint32_t n) {
    double *place = dm_sem_place(e, which, n), *key = place + 1, *to = key + 2 * n + 1;
    place[0] = 1.0;
#pragma GCC unroll 8
    for (uint32_t k = 0; k < 2 * n; k++) key[k] = state[k];
    key[2 * n] = state[4 * (size_t)n];
#pragma GCC unroll 8
    for (uint32_t k = 0; k < DM_SEM_NUMBERS; k++) to[k] = numbers[k];
}

#endif
