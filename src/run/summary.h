/* summary.h - what the rows of one column say in a few numbers. */
#ifndef DM_SUMMARY_H
#define DM_SUMMARY_H

#include <stddef.h>

typedef struct {
    double first, last, least, largest;
    double mean, slope, error; /* as dm_drift_fit finds them */
    double early, late;        /* max |y - y_0| over the first and the last quarter of the rows */
    /* min |y - y_0| and max y - min y over the second half of the rows, without y_0 itself;
     * infinite where these are none */
    double nearest, span;
    double megno; /* mean over the rows of 2 (y - mean of y so far) (Cincotta & Simo 2000) */
} dm_summary;

/* Of y[rows] at the times t[0], t[stride], ...; NaN without rows. Of rows that are not finite
 * all but first and last may be NaN. */
void dm_summary_make(dm_summary *out, const double *t, size_t stride, const double *y, long rows);

#endif
