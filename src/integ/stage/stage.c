#include "integ/stage/stage_inside.h"
#include "integ/stage/sweep/stage_sweep.h"
#include "integ/stage/workspace/stage_warm.h"

#include <math.h>
#include <string.h>

enum { MOST_WAYS = 1000, SHORTER = 5 }; /* of a continuation in h: steps, first ones tried */

/* of h alone: what the first step continues is empty, whatever the state is */
dm_status dm_stage_start(dm_stepper *stepper, double *state, double t, double h) {
    dm_stage *g = dm_stage_of(stepper);
    (void)state, (void)t;
    if (g->sweeps)
        dm_stage_memory_clear(g, h);
    else if (g->one_point)
        dm_one_point_clear(g, h);
    else if (g->ahead)
        dm_stage_warm_clear(g, h);
    return DM_OK;
}

/* which memory that is was settled at opening, see choose_road in stage_open.c */
size_t dm_stage_memory(dm_stepper *stepper, double **place) {
    dm_stage *g = dm_stage_of(stepper);
    *place = g->group.memory;
    if (g->sweeps) return dm_stage_memory_size(g);
    if (g->one_point) return dm_one_point_memory(g);
    return g->ahead ? dm_stage_warm_memory(g) : 0;
}

void dm_stage_at(dm_stage *g, const double *shift, const double *v, double after) {
    const uint32_t n = g->n;
    const double *state = g->group.state, *low = state + 2 * n;
    double *x = g->newton.x;
    for (uint32_t i = 0; i < n; i++) {
        x[i] = state[i] + (low[i] + shift[i]);
        x[n + i] = v ? v[i] : g->points.v0[i];
    }
    x[2 * n] = g->group.t + after;
}

/* the constant outputs of the kernels for Newton's method, when it is needed first */
static dm_status prepare(dm_stage *g) {
    dm_stage_newton *w = &g->newton;
    const size_t n = g->n, curve = 2 * n + 3 * n * n;
    const dm_kernel *stage;
    const dm_status status = dm_model_stage(&stage, g->m);
    if (status != DM_OK) return status;
    w->stage = stage;
    for (uint32_t i = 0; i < g->table.r; i++) {
        dm_kernel_prepare(stage, w->curve + i * curve);
        dm_kernel_prepare(w->slope, w->slopes + i * (size_t)w->slope->outputs);
    }
    if (g->separable)
        dm_stage_band_open(g, g->room);
    else
        dm_stage_general_open(g);
    return DM_OK;
}

/* with all weights of the step in hand */
static dm_status by_newton(dm_stage *g, dm_stepper *stepper) {
    if (!g->weights.complete) dm_stage_weights_complete(g);
    return g->separable ? dm_stage_separable(g, stepper) : dm_stage_general(g, stepper);
}

/* the step of part * h from the root before, of a step so much shorter */
static dm_status longer(dm_stage *g, dm_stepper *stepper, double part, double h) {
    const size_t s = g->table.s, r = g->table.r, unknowns = (s > r ? s : r) * g->n;
    dm_stage_weights_scale(g, part * h);
    const dm_status status = by_newton(g, stepper);
    if (status == DM_OK) memcpy(g->before.root, g->newton.root, unknowns * sizeof *g->before.root);
    return status;
}

/* Has L a domain of velocities? One that is quadratic in v ends at places alone: a root that is
 * drawn back inside there belongs to another motion, so that the step fails. */
static int has_limits(const dm_stage *g) {
    return !(g->m->structure & DM_QUADRATIC_IN_V);
}

/* The first step of a continuation, h/16 or, near the edge of the domain, h/64, ...: its part. */
static dm_status first_part(dm_stage *g, dm_stepper *stepper, double h, double *part) {
    *part = 1.0 / 16.0;
    dm_status status = longer(g, stepper, *part, h);
    for (int k = 0; k < SHORTER && status != DM_OK && has_limits(g); k++) {
        *part *= 0.25;
        status = longer(g, stepper, *part, h);
    }
    return status;
}

/* Where Newton's method fails from its guess: h/16, h/8, ... h from the same state, each from
 * the root before. What fails then has no root that is the one of a small step, but for an L that
 * is not quadratic in v: near the edge of its domain Newton's method reaches less far, and shorter
 * ways are tried, down to 1/5000 of the step. What fails then is a fold. */
static dm_status by_continuation(dm_stage *g, dm_stepper *stepper) {
    const double h = g->weights.h, least = has_limits(g) ? 1.0002 : 2.0;
    const dm_report first = stepper->report;
    double part, factor = 2.0;
    dm_status status = first_part(g, stepper, h, &part);
    for (int k = 0; k < MOST_WAYS && part < 1.0 && status == DM_OK; k++) {
        const double next = fmin(part * factor, 1.0);
        g->before.ratio = next / part;
        const dm_status there = longer(g, stepper, next, h);
        if (there == DM_OK) part = next;
        if (there != DM_OK || factor < 1.2) factor = pow(factor, there == DM_OK ? 1.5 : 0.5);
        if (there != DM_OK && factor < least) status = there;
    }
    g->before.ratio = 0.0;
    if (g->weights.h != h) dm_stage_weights_scale(g, h);
    if (status == DM_OK && part < 1.0) status = DM_NO_CONVERGENCE;
    if (status != DM_OK) stepper->report = first; /* what the first try met */
    return status;
}

/* Where all else fails, of an L that is not quadratic in v: from rest, which is in the domain. A
 * root near the speed of light is far from one on the other side, along the edge of the domain. */
static dm_status from_rest(dm_stage *g, dm_stepper *stepper) {
    const dm_report first = stepper->report;
    memset(g->before.root, 0, (size_t)g->table.s * g->n * sizeof *g->before.root);
    g->before.ratio = 1.0;
    const dm_status status = by_newton(g, stepper);
    g->before.ratio = 0.0;
    if (status != DM_OK) stepper->report = first;
    return status;
}

/* the end is in the state; sweeps and steps of one point leave the rare one to Newton's method */
static dm_status solve(dm_stage *g, dm_stepper *stepper) {
    dm_status status = DM_NO_CONVERGENCE;
    if (g->sweeps && !dm_stage_memory_is_stiff(g)) status = dm_stage_sweep(g, stepper);
    if (g->one_point) status = dm_one_point_step(g, stepper);
    if (status == DM_OK) return DM_OK;
    status = g->newton.stage ? DM_OK : prepare(g);
    if (status != DM_OK) return status;
    if (g->one_point) status = by_continuation(g, stepper);
    if (!g->one_point || status != DM_OK) status = by_newton(g, stepper);
    const int may_go_on = status == DM_NO_CONVERGENCE || status == DM_SINGULAR ||
                          (status == DM_NOT_FINITE && has_limits(g));
    if (!g->one_point && may_go_on) {
        dm_status again = by_continuation(g, stepper);
        if (again != DM_OK && has_limits(g)) again = from_rest(g, stepper);
        if (again == DM_OK) status = DM_OK;
    }
    if (status == DM_OK && g->sweeps) dm_stage_memory_newton(g);
    if (status != DM_OK) return status;
    dm_stage_copy(g->group.state, g->group.next, 4 * g->n);
    if (g->one_point) dm_one_point_newton(g);
    return DM_OK;
}

/* the group is one member, the state is stepped in place, and stays as it was on failure */
dm_status dm_stage_step(dm_stepper *stepper, double *state, double t, double h) {
    dm_stage *g = dm_stage_of(stepper);
    g->group.state = state;
    g->group.t = t;
    if (g->weights.h != h) {
        dm_stage_weights_scale(g, h);
        if (g->sweeps) dm_stage_sweeps_scale(g->sweeps, g);
    }
    g->evaluations = 0;
    const dm_status status = solve(g, stepper);
    stepper->report.solves++;
    stepper->report.newton += stepper->report.iterations;
    stepper->report.evaluations += g->evaluations;
    return status;
}
