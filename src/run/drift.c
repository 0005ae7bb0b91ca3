#include "run/drift.h"

#include "numbers/compensated.h"

#include <math.h>

enum { BLOCKS = 16, FEWER = 11, SHORTEST = 4 }; /* numbers of blocks; rows of one at least */

typedef struct {
    const double *t, *y;
    size_t stride;
} series;

typedef struct {
    double t, y; /* means */
} point;

/* means over rows first .. last-1, from deviations so that a large constant costs no digits */
static point mean_of(const series *s, long first, long last) {
    const double t0 = s->t[0], y0 = s->y[0];
    double t = 0.0, low_t = 0.0, y = 0.0, low_y = 0.0;
    for (long i = first; i < last; i++) {
        dm_sum_add(&t, &low_t, s->t[(size_t)i * s->stride] - t0);
        dm_sum_add(&y, &low_y, s->y[i] - y0);
    }
    const double count = (double)(last - first);
    return (point){t / count, y / count};
}

/* slope of the line through n points whose mean is m */
static double slope_of(const point *p, int n, point m) {
    double ty = 0.0, tt = 0.0;
    for (int i = 0; i < n; i++) {
        ty += (p[i].t - m.t) * (p[i].y - m.y);
        tt += (p[i].t - m.t) * (p[i].t - m.t);
    }
    return tt > 0.0 ? ty / tt : 0.0;
}

/* The same over all rows, with compensated sums. */
static double slope_of_rows(const series *s, long rows, point m) {
    const double t0 = s->t[0], y0 = s->y[0];
    double ty = 0.0, low_ty = 0.0, tt = 0.0, low_tt = 0.0;
    for (long i = 0; i < rows; i++) {
        const double t = s->t[(size_t)i * s->stride] - t0 - m.t;
        dm_sum_add(&ty, &low_ty, t * (s->y[i] - y0 - m.y));
        dm_sum_add(&tt, &low_tt, t * t);
    }
    return tt > 0.0 ? ty / tt : 0.0;
}

/* standard error of a slope fitted to block means: residuals of n points, n - 2 of them free */
static double slope_error(const series *s, long rows, point m, int blocks) {
    const int n = rows / SHORTEST < blocks ? (int)(rows / SHORTEST) : blocks;
    point block[BLOCKS];
    double left = 0.0, tt = 0.0;
    if (n < 3) return 0.0;
    for (int i = 0; i < n; i++) block[i] = mean_of(s, rows * i / n, rows * (i + 1) / n);
    const double slope = slope_of(block, n, m);
    for (int i = 0; i < n; i++) {
        const double t = block[i].t - m.t, y = block[i].y - m.y - slope * t;
        left += y * y;
        tt += t * t;
    }
    return tt > 0.0 ? sqrt(left / (n - 2) / tt) : 0.0;
}

/* standard error when there are too few rows for blocks: rows taken as independent */
static double error_of_few(const series *s, long rows, point m, double slope) {
    double left = 0.0, tt = 0.0;
    for (long i = 0; i < rows; i++) {
        const double t = s->t[(size_t)i * s->stride] - s->t[0] - m.t;
        const double y = s->y[i] - s->y[0] - m.y - slope * t;
        left += y * y;
        tt += t * t;
    }
    return tt > 0.0 ? sqrt(left / (double)(rows - 2) / tt) : 0.0;
}

/* The slope is that of all rows; blocks only tell how far it can be trusted. */
void dm_drift_fit(dm_drift *out, const double *t, size_t stride, const double *y, long rows) {
    const series s = {t, y, stride};
    const point m = mean_of(&s, 0, rows);
    *out = (dm_drift){.mean = y[0] + m.y};
    for (long i = 0; i < rows; i++) out->largest = fmax(out->largest, fabs(y[i] - y[0]));
    if (rows < 3) return;
    out->slope = slope_of_rows(&s, rows, m);
    if (rows < 3 * SHORTEST) {
        out->error = error_of_few(&s, rows, m, out->slope);
        return;
    }
    /* two lengths of block: an oscillation may fit one exactly and vanish from its means */
    out->error = fmax(slope_error(&s, rows, m, BLOCKS), slope_error(&s, rows, m, FEWER));
}

dm_drift_verdict dm_drift_judge(const dm_drift *fit, const double *t, size_t stride,
                                const double *y, long rows) {
    static const int coarse[] = {7, 5};
    static const double tiny = 1e-14; /* of the mean: round-off of the quantity itself */
    const series s = {t, y, stride};
    if (rows < 3 * SHORTEST) return DM_DRIFT_OPEN;
    const point m = mean_of(&s, 0, rows);
    const double slope = fabs(fit->slope);
    double error = fit->error;
    if (slope * fabs(t[(size_t)(rows - 1) * stride] - t[0]) <= tiny * fabs(fit->mean))
        return DM_DRIFT_NONE;
    for (size_t i = 0; i < sizeof coarse / sizeof *coarse; i++)
        error = fmax(error, slope_error(&s, rows, m, coarse[i]));
    return slope > 6.0 * error   ? DM_DRIFT_FOUND
           : slope > 3.0 * error ? DM_DRIFT_OPEN
                                 : DM_DRIFT_NONE;
}

/* largest and least distance from y0 over rows first .. last-1 */
static void reach_of(const double *y, long first, long last, double *least, double *largest) {
    *least = INFINITY;
    *largest = 0.0;
    for (long i = first; i < last; i++) {
        const double size = fabs(y[i] - y[0]);
        *least = fmin(*least, size);
        *largest = fmax(*largest, size);
    }
}

/* A jump near either end cannot be told from the rows beside it. */
long dm_drift_jump(const double *y, long rows) {
    enum { WITHIN = 3 };
    long row = 0;
    double most, least, before, ignored;
    reach_of(y, 0, rows, &ignored, &most);
    while (row < rows && fabs(y[row] - y[0]) <= 0.5 * most) row++;
    if (row <= WITHIN || rows - row <= WITHIN) return 0;
    reach_of(y, 0, row - WITHIN, &ignored, &before);
    reach_of(y, row, rows, &least, &ignored);
    return before < 0.1 * most && least > 0.25 * most ? row : 0;
}

int dm_drift_grows(const double *y, long rows) {
    enum { PARTS = 4, LEAST = 5 };
    double before = 0.0, ignored;
    if (rows < PARTS * LEAST) return 0;
    for (long k = 0; k < PARTS; k++) {
        double largest;
        reach_of(y, k * rows / PARTS, (k + 1) * rows / PARTS, &ignored, &largest);
        if (!(largest > 0.0 && (k == 0 || largest >= 10.0 * before))) return 0;
        before = largest;
    }
    return 1;
}
