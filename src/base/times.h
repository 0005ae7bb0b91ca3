/* times.h - times are t0 + k h in doubles, whose distance grows with t0. */
#ifndef DM_TIMES_H
#define DM_TIMES_H

#include <math.h>

/* Are there enough numbers near the time t for steps of h? Where there is none it stands still. */
static inline int dm_times_differ(double t, double h) {
    enum { A_STEP = 8 };
    return nextafter(fabs(t), INFINITY) - fabs(t) <= fabs(h) / A_STEP;
}

#endif
