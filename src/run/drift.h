/* drift.h - does a recorded quantity drift? */
#ifndef DM_DRIFT_H
#define DM_DRIFT_H

#include <stddef.h>

typedef struct {
    double slope;   /* of the least-squares line, per unit of time */
    double error;   /* its standard error */
    double mean;    /* of the quantity */
    double largest; /* max |y - y_0|, against the first row */
} dm_drift;

/* Fit y[rows] against the times t[0], t[stride], t[2 stride], ... The error comes from the means
 * of blocks, so that an oscillation, whose values are not independent, is not mistaken for many
 * of them: it holds when a block is longer than the oscillation. rows >= 1; with rows < 3 or a
 * time that stands still slope and error are 0. */
void dm_drift_fit(dm_drift *out, const double *t, size_t stride, const double *y, long rows);

/* What may be said of a drift in words: it is there (six standard errors, by blocks of up to a
 * fifth of the rows too, which slow oscillations move), it is not (three), or the rows leave it
 * open, as fewer than twelve do. Rows sparser than an oscillation may show it as a slow one, hence
 * as a drift: who says so has to know how dense they are. */
typedef enum { DM_DRIFT_NONE, DM_DRIFT_OPEN, DM_DRIFT_FOUND } dm_drift_verdict;
dm_drift_verdict dm_drift_judge(const dm_drift *fit, const double *t, size_t stride,
                                const double *y, long rows);

/* The row at which y[rows] has gone, within three rows, to another level where it stays: before
 * them it is near the first row, by a tenth of its largest distance, and from there on never
 * back within a quarter of that. 0: it does not. */
long dm_drift_jump(const double *y, long rows);

/* Does y[rows] go away from its first row tenfold in every quarter of the rows? A straight line
 * does not, and its fit says nothing of what does. 0 with less than 20 rows. */
int dm_drift_grows(const double *y, long rows);

#endif
