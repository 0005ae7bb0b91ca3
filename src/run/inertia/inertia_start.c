/* inertia_start.c - is d2L/dv2 singular to round-off at a start, and along which velocity? */
#include "run/inertia/inertia_values.h"
#include "run/inertia/mass_lanes.h"

#include "linalg/lu.h"
#include "mech/constraints.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* of q; of p, to which velocities are found */
static const double ROUNDING = 32 * DBL_EPSILON, FOUND = 128 * DBL_EPSILON;

/* q[n] as round-off may have it, to either side */
static void place_near(double *near, const double *q, int side, size_t n) {
    for (size_t i = 0; i < n; i++) near[i] = q[i] * (1.0 + (i % 2 ? side : -side) * ROUNDING);
}

/* Four lanes are what any processor with lanes has. */
int dm_inertia_starts_by_far(dm_inertia *x, const double *state, double t) {
    enum { BEFORE, BEHIND, AHEAD, BETWEEN, PLACES };
    dm_mass_lanes *w = x->wide;
    const size_t n = x->model->n;
    double *near = x->aside;
    int clear = w != NULL;
    for (uint32_t b = 0; b < x->blocks.count; b++) clear = clear && x->course[b].all > 0.0;
    if (!clear) return 0;
    for (uint32_t l = 0; l < w->lanes; l++)
        dm_mass_lanes_put_scale(w, DM_MASS_LANES_OWN * w->lanes + l, x->scale);
    place_near(near, state, -1, n);
    dm_mass_lanes_put_place(w, BEFORE, near, t);
    place_near(near, state, 1, n);
    dm_mass_lanes_put_place(w, BEHIND, near, t);
    dm_mass_lanes_put_place(w, AHEAD, x->end, t);
    for (size_t i = 0; i < n; i++) near[i] = state[i] + 0.5 * (x->end[i] - state[i]);
    dm_mass_lanes_put_place(w, BETWEEN, near, t);
    const uint32_t asked = (1u << PLACES) - 1;
    if (dm_mass_lanes_look(w, DM_MASS_LANES_OWN, asked) != asked) return 0;
    for (uint32_t b = 0; b < x->blocks.count; b++) {
        const double *least = w->least + b * w->lanes, *all = w->all + b * w->lanes;
        const double most = fmax(x->course[b].all, all[AHEAD]);
        x->values[b] = (dm_inertia_value){least[AHEAD], all[AHEAD]};
        clear = clear && !(all[BETWEEN] < DM_INERTIA_VALLEY * most);
    }
    return clear;
}

/* Does round-off of q change a sign? */
static int is_at_place(const dm_inertia *x, const double *state, double t, double *near) {
    const size_t n = x->model->n;
    double least;
    uint32_t negative;
    memcpy(near + n, state + n, n * sizeof *near);
    for (int side = -1; side < 2; side += 2) {
        place_near(near, state, side, n);
        if (dm_inertia_at(x, near, t, &negative, &least) && negative != x->seen.negative) return 1;
    }
    return 0;
}

/* dp[n], scaled: what is left of p where v is found, which Newton's method compares with the
 * largest entry; terms of p may cancel, as dL/dv at v = 0 tells. at[n] is room. */
static void find_rounding(const dm_inertia *x, const double *state, double t, double *dp,
                          double *at) {
    const size_t n = x->model->n;
    const double *p0 = x->room + 2 * n + 1;
    double largest = 0.0;
    memset(at, 0, n * sizeof *at);
    dm_inertia_mass(x, state, at, t);
    for (size_t i = 0; i < n; i++)
        largest = fmax(largest, fabs(state[n + i]) + (isfinite(p0[i]) ? fabs(p0[i]) : 0.0));
    for (size_t i = 0; i < n; i++) dp[i] = x->scale[i] * FOUND * (largest > 0.0 ? largest : 1.0);
}

double dm_inertia_find_least(double *A, const double *dp, double *u, uint32_t n) {
    uint32_t *pivot = (uint32_t *)(void *)(A + (size_t)n * n);
    double size = 0.0;
    for (uint32_t i = 0; i < n; i++) u[i] = dp[i] / (double)(i + 1);
    if (dm_lu_factor(A, pivot, n) != DM_OK) return 0.0;
    for (int k = 0; k < 4; k++) {
        double squares = 0.0;
        if (k > 0) dm_lu_solve(u, A, pivot, n);
        for (uint32_t i = 0; i < n; i++) squares += u[i] * u[i];
        size = sqrt(squares);
        for (uint32_t i = 0; i < n; i++) u[i] /= size;
    }
    return isfinite(size) ? size : 0.0;
}

/* Does round-off of p change a sign? At a fold of p(v) its root is double, so that v is known to
 * the root of round-off alone. */
static int is_at_fold(const dm_inertia *x, const double *q, double t, const double *v,
                      const double *dp, double *u, double *near) {
    const uint32_t n = x->model->n;
    const double by = dm_inertia_find_least(dm_inertia_mass(x, q, v, t), dp, u, n);
    double along = 0.0;
    for (size_t i = 0; i < n; i++) along += fabs(u[i] * dp[i]);
    for (int side = -2; side < 3 && by > 0.0; side += 4) {
        for (size_t i = 0; i < n; i++) near[i] = v[i] + side * x->scale[i] * along * by * u[i];
        if (dm_inertia_negative(x, q, near, t) != x->seen.negative) return 1;
    }
    return 0;
}

/* By its own values, whose entries lose some digits where terms of L cancel, or since round-off
 * changes a sign. */
int dm_inertia_is_degenerate(const dm_inertia *x, const double *state, double t) {
    static const double LOST = 16 * DBL_EPSILON;
    const size_t n = x->model->n;
    double *near = x->aside, *v = near + 2 * n, *dp = v + n, *u = dp + n;
    if (x->seen.least <= LOST * (double)n) return 1;
    memcpy(v, x->room + n, n * sizeof *v);
    if (is_at_place(x, state, t, near)) return 1;
    if (x->model->structure & DM_QUADRATIC_IN_V) return 0;
    find_rounding(x, state, t, dp, near);
    return is_at_fold(x, state, t, v, dp, u, near);
}

/* v over its largest entry; 0: that is none */
static int normalize(double *v, uint32_t n) {
    double largest = 0.0;
    for (uint32_t i = 0; i < n; i++)
        if (fabs(v[i]) > fabs(largest)) largest = v[i];
    for (uint32_t i = 0; i < n; i++) v[i] /= largest;
    return largest != 0.0 && isfinite(largest);
}

int dm_inertia_direction(const dm_inertia *x, const double *state, double t, double *v) {
    static const double SHIFT = 1e-13;
    const dm_model *m = x->model;
    const uint32_t n = m->n;
    const int by_velocity = !(m->structure & DM_QUADRATIC_IN_V);
    const double *there = by_velocity ? dm_inertia_velocity(x, state, t) : NULL;
    double *at = x->aside, *dp = at + n;
    if (m->constraints && m->constraints->holonomic + m->constraints->rolling) return 0;
    if (by_velocity && !there) return 0;
    memset(at, 0, n * sizeof *at);
    if (there) memcpy(at, there, n * sizeof *at);
    find_rounding(x, state, t, dp, v);
    double *A = dm_inertia_mass(x, state, at, t);
    for (size_t i = 0; i < n; i++) A[i * n + i] += SHIFT;
    const int good = dm_inertia_find_least(A, dp, v, n) > 0.0;
    for (size_t i = 0; i < n; i++) v[i] *= x->scale[i];
    return good && normalize(v, n);
}
