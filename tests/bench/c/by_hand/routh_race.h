/* routh_race.h - three ways of a step by hand in turns, best of some; for routh.c and
 * routh_pendulum.c. */
#ifndef BENCH_ROUTH_RACE_H
#define BENCH_ROUTH_RACE_H

#include <math.h>
#include <stdio.h>
#include <time.h>

enum { STEPS = 100000, REPEATS = 15, WAYS = 3 };

typedef struct {
    long iterations;
    double last; /* a coordinate at the end, so that nothing is left out */
} race_end;

static inline double race_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

/* the first way is the reduced one */
static inline void race(race_end (*run)(int how), const char *what) {
    static const char *const name[WAYS] = {"reduced", "unreduced, theta' by hand",
                                           "unreduced, all solved for"};
    double best[WAYS] = {INFINITY, INFINITY, INFINITY};
    race_end end[WAYS];
    for (int i = 0; i < REPEATS; i++)
        for (int how = 0; how < WAYS; how++) {
            const double start = race_now();
            end[how] = run(how);
            best[how] = fmin(best[how], (race_now() - start) / STEPS);
        }
    for (int how = 0; how < WAYS; how++)
        printf("%-28s %6.1f ns a step, %.2f iterations, the reduced one is %.2f of it; "
               "%s = %.9f\n",
               name[how], best[how], (double)end[how].iterations / STEPS, best[0] / best[how], what,
               end[how].last);
}

#endif
