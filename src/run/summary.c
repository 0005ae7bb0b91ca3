#include "run/summary.h"

#include "base/largest.h"
#include "run/drift.h"

#include <math.h>

/* max |y - y_0| over rows first .. last - 1 */
static double farthest(const double *y, long first, long last) {
    double far = 0.0;
    for (long i = first; i < last; i++) {
        const double d = fabs(y[i] - y[0]);
        far = dm_largest(far, d); /* NaN too */
    }
    return far;
}

/* where y stays late, beside its start */
static void look_late(dm_summary *out, const double *y, long rows) {
    const long half = rows / 2 - 1;
    double least = INFINITY, largest = -INFINITY;
    out->nearest = INFINITY;
    for (long i = half > 1 ? half : 1; i < rows; i++) {
        out->nearest = fmin(out->nearest, fabs(y[i] - y[0]));
        least = fmin(least, y[i]);
        largest = fmax(largest, y[i]);
    }
    out->span = least <= largest ? largest - least : INFINITY;
}

/* MEGNO is Y(t) = 2/t int s y'(s) ds = 2 (y(t) - mean of y over [0, t]), y = ln |tangent
 * vector|, and its mean over time: by the trapezoidal rule. */
static double megno(const double *t, size_t stride, const double *y, long rows) {
    double area = 0.0, sum = 0.0, before = 0.0;
    for (long i = 1; i < rows; i++) {
        const double at = t[(size_t)i * stride] - t[0];
        const double dt = at - (t[(size_t)(i - 1) * stride] - t[0]);
        area += 0.5 * dt * ((y[i] - y[0]) + (y[i - 1] - y[0]));
        const double Y = 2.0 * ((y[i] - y[0]) - area / at);
        sum += 0.5 * dt * (Y + before);
        before = Y;
    }
    return rows > 1 ? sum / (t[(size_t)(rows - 1) * stride] - t[0]) : 0.0;
}

/* One pass for each kind of number; rows are few next to what made them. */
void dm_summary_make(dm_summary *out, const double *t, size_t stride, const double *y, long rows) {
    *out = (dm_summary){NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    if (rows < 1) return;
    dm_drift drift;
    dm_drift_fit(&drift, t, stride, y, rows);
    out->first = out->least = out->largest = y[0];
    out->last = y[rows - 1];
    for (long i = 1; i < rows; i++) {
        out->least = fmin(out->least, y[i]);
        out->largest = fmax(out->largest, y[i]);
    }
    out->mean = drift.mean, out->slope = drift.slope, out->error = drift.error;
    out->early = farthest(y, 0, rows / 4 + 1);
    out->late = farthest(y, rows - rows / 4 - 1, rows);
    look_late(out, y, rows);
    out->megno = megno(t, stride, y, rows);
}
