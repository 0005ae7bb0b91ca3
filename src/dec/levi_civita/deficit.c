/* deficit.c - see deficit.h */
#include "dec/levi_civita/deficit.h"

#include "dec/cell.h"

#include <math.h>

/* pi, and what a double leaves of it: sums over many cells would add up the latter */
static const double PI = 3.14159265358979323846, PI_LOW = 1.2246467991473532e-16;

/* add the angle of (re, im), im > 0; only the direction counts, and stays of size 1 */
static inline void add(dm_turn *t, double re, double im) {
    const double x = t->re * re - t->im * im, y = t->re * im + t->im * re;
    const double scale = 1.0 / (fabs(x) + fabs(y));
    const int beyond = y < 0.0 || (y == 0.0 && x < 0.0); /* past pi */
    t->re = beyond ? -x * scale : x * scale;
    t->im = beyond ? -y * scale : y * scale;
    t->half += (uint32_t)beyond;
    t->cells++;
}

/* Triangles: at the vertex opposite to an edge of squared length a, between those of b and c, the
 * angle is that of ((b + c - a)/2, 2 area). */
static void add_triangles(dm_turn *t, const dm_complex *K, const dm_metric *metric) {
    const double *l = metric->length2;
    for (uint32_t i = 0; i < K->count[2]; i++) {
        const uint32_t *v = K->vertex[2] + (size_t)i * 3, *e = K->face[2] + (size_t)i * 3;
        const double a = l[e[0]], b = l[e[1]], c = l[e[2]], area2 = 2.0 * metric->volume[2][i];
        add(t + v[0], 0.5 * (b + c - a), area2);
        add(t + v[1], 0.5 * (a + c - b), area2);
        add(t + v[2], 0.5 * (a + b - c), area2);
    }
}

/* A top cell s: between the facets opposite to its vertices a and b, at their common face f, the
 * angle is that of (-grad_a . grad_b, |grad_a ^ grad_b| = |f| / (n (n - 1) |s|)). */
static void add_cells(dm_turn *t, const dm_complex *K, const dm_metric *metric) {
    const uint32_t n = K->n, all = (2u << n) - 1;
    dm_cell c;
    for (uint32_t i = 0; i < K->count[n]; i++) {
        dm_cell_read(&c, K, metric, i);
        const double scale = 1.0 / (n * (n - 1.0) * c.metric.volume[all]);
        for (uint32_t b = 1; b <= n; b++)
            for (uint32_t a = 0; a < b; a++) {
                const uint32_t face = all & ~(1u << a | 1u << b);
                add(t + c.metric.face[face], -c.gradients[a][b], scale * c.metric.volume[face]);
            }
    }
}

void dm_deficits(double *deficit, dm_turn *work, const dm_complex *K, const dm_metric *metric) {
    const uint32_t count = K->count[K->n - 2];
    for (uint32_t i = 0; i < count; i++) work[i] = (dm_turn){1.0, 0.0, 0, 0};
    if (K->n == 2)
        add_triangles(work, K, metric);
    else
        add_cells(work, K, metric);
    for (uint32_t i = 0; i < count; i++) {
        const double turns = 2.0 - work[i].half;
        deficit[i] = turns * PI - atan2(work[i].im, work[i].re) + turns * PI_LOW;
    }
}
