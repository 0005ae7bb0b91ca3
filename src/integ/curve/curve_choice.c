#include "integ/curve/curve_choice.h"

#include "algebra/derive.h"
#include "integ/curve/curve_inside.h"
#include "integ/method/cache.h"

#include <math.h>
#include <string.h>

static const double MOST = 1e6; /* of a weight */
static const char maker;

/* In a graph of its own: that of the choice stays as it is. */
dm_status dm_curve_choice_build(dm_kernel *out, const dm_curve_choice *c, const dm_model *m) {
    const uint32_t inputs = 2 * c->n + 2, count = (uint32_t)c->outputs;
    if (dm_cache_find(out, m, &maker, c->serial)) return DM_OK;
    if (!m->source.compile) return DM_TOO_LARGE;
    dm_graph *g = dm_graph_new(m->source.arena, inputs);
    dm_node *with = dm_arena_take(m->source.arena, inputs * sizeof *with);
    dm_node *roots = dm_arena_take(m->source.arena, count * sizeof *roots);
    if (!g || !with || !roots) return DM_NO_MEMORY;
    dm_inputs(g, with, 0, inputs);
    dm_transplant(g, c->graph, c->out, count, with, roots);
    dm_status status = dm_graph_status(g);
    if (status == DM_OK) status = m->source.compile(out, g, roots, count, m->source.arena);
    if (status == DM_OK) dm_cache_add(m, &maker, c->serial, out, 1);
    return status;
}

/* a number of equal substeps, from 1 to count */
static void share_equally(double *share, int count, double number) {
    const double n = fmin(fmax(floor(number + 0.5), 1.0), (double)count);
    for (int i = 0; i < count; i++) share[i] = i < (int)n ? 1.0 / n : 0.0;
}

/* NaN, negative weights and no weight at all are refused: a step needs some length. */
int dm_curve_shares(const dm_curve_choice *c, double *share, int count, const double *out) {
    double sum = 0.0;
    if (c->bare && isfinite(out[0])) share_equally(share, count, out[0]);
    if (c->bare) return isfinite(out[0]);
    for (int i = 0; i < count; i++) {
        share[i] = floor(out[i] + 0.5);
        if (!(share[i] >= 0.0 && share[i] <= MOST)) return 0;
        sum += share[i];
    }
    for (int i = 0; i < count; i++) share[i] /= sum;
    return sum > 0.0;
}

/* A method of other substeps than the last step had: its points and coefficients. */
static void recompose(dm_curve_step *e, const dm_curve *whole) {
    if (whole->recipe) return;
    dm_curve_compose(&e->curve, whole, e->share);
    dm_curve_bias(&e->curve, whole->bias);
    e->segment.points = (size_t)e->curve.s;
    e->segment.h = NAN;
}

/* From (q0, v0) with v0 of p0, not of the last segment: a choice that is a function of the state
 * alone is the same after a restart. */
dm_status dm_curve_choose(dm_curve_step *e, dm_stepper *s, const dm_curve *whole) {
    const size_t n = e->n, count = (size_t)whole->substeps;
    const double t0 = e->t - (1.0 - whole->bias) * e->h;
    double *x = e->share + count, *out = x + 2 * n + 2, *next = out + count;
    double *v = x + n;
    memset(v, 0, n * sizeof *v);
    dm_status status = dm_legendre_inverse(s->model, v, e->state, e->state + n, t0, e->scratch);
    if (e->tie.m) status = dm_curve_tie_hide(e, s, v, e->state + n, e->state, t0);
    if (status != DM_OK) return status;
    memcpy(x, e->state, n * sizeof *x);
    x[2 * n] = e->h;
    x[2 * n + 1] = t0;
    dm_kernel_prepare(&e->chooses, out);
    dm_kernel_eval(&e->chooses, x, out);
    if (!dm_curve_shares(whole->choice, next, whole->substeps, out)) return DM_NOT_FINITE;
    /* what was chosen is reported, also where it is what the last step had */
    for (size_t i = 0; i < count; i++) s->report.substeps += next[i] > 0.0;
    if (memcmp(e->share, next, count * sizeof *next) == 0) return DM_OK;
    memcpy(e->share, next, count * sizeof *next);
    if (e->segment.share) memcpy(e->segment.share, next, count * sizeof *next);
    recompose(e, whole);
    return DM_OK;
}
