/* still_clock.c - a clock that stands still, loaded before a program: bursts of steps have the length of
 * those of a fast machine; under callgrind they would end after a few (bench/table/instructions.lua). */
#define _POSIX_C_SOURCE 199309L
#include <time.h>

int clock_gettime(clockid_t clock, struct timespec *t) {
    (void)clock;
    *t = (struct timespec){.tv_sec = 1000};
    return 0;
}
