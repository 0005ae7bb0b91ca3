/* curve_segment_written.c - a segment of a method that is no tableau: three kernels of all of
 * it. */
#include "base/doubles.h"
#include "integ/curve/curve_segment.h"

#include <math.h>
#include <string.h>

/* Controls are inputs of the field, before h. */
static size_t controls(const dm_model *m) {
    return m->constraints ? m->constraints->controls : 0;
}

/* In the order of dm_written_segment_open; the last are plus, minus, arrival and next. */
size_t dm_written_segment_work(const dm_curve *c, const dm_model *m) {
    const size_t n = m->n;
    return dm_written_inputs(c, m) + dm_written_outputs(m) + controls(m) + (size_t)c->substeps +
           4 * n;
}

/* Matrices are parts of what one kernel writes. */
dm_status dm_written_segment_open(dm_segment *g, double *memory) {
    const size_t n = g->n, N = 2 * n, rolling = g->field.rolling;
    const dm_status status = dm_written_build(&g->written, g->curve, g->m);
    if (status != DM_OK) return status;
    g->points = g->written.calls;
    g->inputs = g->written.inputs;
    g->x = dm_take(&memory, g->inputs);
    g->pull = dm_take(&memory, 4 * n + 1 + 2 * rolling);
    g->slope = dm_take(&memory, N);
    g->hessian = dm_take(&memory, 2 * N * N);
    g->plus_tangent = g->hessian + N * N;
    g->minus_tangent = g->plus_tangent + n * N;
    g->held = dm_take(&memory, controls(g->m));
    g->share = dm_take(&memory, (size_t)g->curve->substeps);
    g->plus = dm_take(&memory, n);
    g->minus = dm_take(&memory, n);
    g->arrival = dm_take(&memory, n);
    g->next = dm_take(&memory, n);
    memset(g->x, 0, g->inputs * sizeof *g->x);
    dm_kernel_prepare(&g->written.ends, g->pull);
    dm_kernel_prepare(&g->written.gradient, g->slope);
    dm_kernel_prepare(&g->written.hessian, g->hessian);
    return DM_OK;
}

/* (q, v, t) stand first in x, as those of point 0 of a tableau do: constraints look there. */
dm_status dm_written_segment_run(dm_segment *g, const dm_segment_place *at) {
    const size_t n = g->n, held = controls(g->m);
    double *x = g->x;
    for (size_t k = 0; k < n; k++) x[k] = at->q[k] + (at->shift ? at->shift[k] : 0.0);
    memcpy(x + n, at->v, n * sizeof *x);
    x[2 * n] = at->t;
    x[g->written.h] = at->h;
    if (held) memcpy(x + g->written.h - held, g->held, held * sizeof *x);
    for (int i = 0; i < g->curve->substeps; i++) x[g->written.share + (size_t)i] = g->share[i];
    dm_kernel_eval(&g->written.ends, x, g->pull);
    memcpy(g->plus, g->pull, n * sizeof *x);
    memcpy(g->minus, g->pull + n, n * sizeof *x);
    memcpy(g->arrival, g->pull + 2 * n, n * sizeof *x);
    for (size_t k = 0; k < n; k++) g->next[k] = at->v[k] + (g->arrival[k] - g->pull[3 * n + k]);
    return DM_OK;
}

/* After run, which set all other inputs. */
void dm_written_segment_gradient(dm_segment *g, const double *p1, const double *p0) {
    double *x = g->x;
    memcpy(x + g->written.p1, p1, g->n * sizeof *x);
    if (p0) memcpy(x + g->written.p0, p0, g->n * sizeof *x);
    if (!p0) memset(x + g->written.p0, 0, g->n * sizeof *x);
    dm_kernel_eval(&g->written.gradient, x, g->slope);
}

/* All columns; the tangents of both ends lie behind. */
void dm_written_segment_hessian(dm_segment *g) {
    dm_kernel_eval(&g->written.hessian, g->x, g->hessian);
}

double dm_written_segment_action(const dm_segment *g) {
    return g->pull[4 * g->n];
}

void dm_written_segment_impulses(const dm_segment *g, double *out) {
    memcpy(out, g->pull + 4 * g->n + 1, 2 * (size_t)g->field.rolling * sizeof *out);
}
