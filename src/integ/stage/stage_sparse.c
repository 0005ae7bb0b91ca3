/* stage_sparse.c - the engine: the workspace, and a step around its equation. */
#include "base/doubles.h"
#include "chain/curvature.h"
#include "chain/loops.h"
#include "integ/method/hamilton.h"
#include "integ/stage/stage_continue.h"
#include "integ/stage/stage_sparse_inside.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

enum { FIRST = DM_SPARSE_FIRST, SOLVED = DM_SPARSE_SOLVED, LAST = DM_SPARSE_LAST };

typedef dm_stage_sparse layout;

/* In doubles. */
static size_t head(void) {
    return dm_doubles(sizeof(layout));
}

const char *dm_stage_field_fits(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_stage_basis(&g, rule, m);
    if (!g.s) return "its pair of tables is for L = T(v) - V(q) alone";
    if (g.sweeps) return "a number of sweeps is not for fields; leave it out";
    if (m->massless)
        return "values without mass are for kicks, drifts and explicit Runge-Kutta; take verlet";
    if (!m->inverse_mass) return "cells without mass have no equation of motion";
    return NULL;
}

unsigned dm_stage_field_wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return DM_WANT_FORCE | DM_WANT_CURVATURE;
}

/* entries of S, with r points at most */
static size_t entries(const dm_model *m, size_t r) {
    return (size_t)m->curvature->A.start[m->n] * r * r;
}

/* numbers that a matrix is made of */
static size_t place_of(const dm_model *m) {
    return m->curvature && !m->curvature->constant ? m->n + (size_t)1 : 0;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_stage_basis(&g, rule, m);
    const size_t n = m->n, r = (size_t)g.q.r, all = m->curvature ? entries(m, r) : 0;
    return head() + dm_stage_table_size((size_t)g.s, r) + 2 * n + 1 + 3 * r * n + 7 * r * n + all +
           (all + r * n + 4) / 2 + 4 + (all + 1) / 2 + 8 + dm_stage_place_room(place_of(m));
}

static int row_is_zero(const dm_stage_table *t, uint32_t m, int column) {
    for (uint32_t i = 0; i < t->r; i++)
        if (t->A[column ? i * t->r + m : m * t->r + i].top != 0.0) return 0;
    return 1;
}

/* first points are explicit, last ones are read off */
static void sort_points(layout *l) {
    l->first = l->table.r;
    for (uint32_t m = 0; m < l->table.r; m++) {
        l->kind[m] = (uint8_t)(row_is_zero(&l->table, m, 0)   ? FIRST
                               : row_is_zero(&l->table, m, 1) ? LAST
                                                              : SOLVED);
        if (l->kind[m] == SOLVED) l->at[l->solved++] = m;
        if (m < l->first && l->kind[m] == FIRST) l->first = m;
    }
}

static dm_status open(dm_stepper *s) {
    layout *l = (layout *)(void *)s->work;
    const dm_model *m = s->model;
    const size_t n = m->n;
    dm_galerkin g;
    dm_stage_basis(&g, s->rule, m);
    *l = (layout){.begin = s->work + head()};
    dm_stage_table_fill(&l->table, &g, l->begin);
    sort_points(l);
    const size_t r = l->table.r, k = l->solved, all = entries(m, k);
    double *place = l->begin + dm_stage_table_size(l->table.s, r);
    l->x = place;
    l->Z = l->x + 2 * n + 1;
    l->base = l->Z + r * n;
    l->F = l->base + r * n;
    l->R = l->F + r * n;
    l->dx = l->R + k * n;
    l->cg = l->dx + k * n;
    l->root = l->cg + 4 * k * n;
    l->S.value = l->root + k * n + dm_stage_place_room(place_of(m));
    dm_stage_place_open(&l->kept, l->root + k * n, place_of(m));
    l->S.row = (int32_t *)(void *)(l->S.value + all + 1);
    l->S.start = (int32_t *)(void *)(l->S.value + all + 1 + (all + 1) / 2 + 1);
    dm_stage_sparse_pattern(l, &m->curvature->A);
    dm_stage_factor_open(&l->factors, m->source.arena);
    memset(l->x, 0, (2 * n + 1) * sizeof *l->x);
    dm_kernel_prepare(&m->force, l->F);
    l->constant = m->curvature->constant && dm_loops_constant(&m->force);
    if (k > 1 && !s->solvers) return DM_NO_START;
    return DM_OK;
}

static void close(dm_stepper *s) {
    dm_stage_factor_close(&((layout *)(void *)s->work)->factors, s->solvers);
}

/* ---- one step ---- */

/* What is known of Z_i, h r_i v0 and the forces of the first points; Z begins there. */
static void begin(dm_stepper *s, layout *l, const double *q, const double *p, double t, double h) {
    const uint32_t n = s->model->n, r = l->table.r;
    const double *w = s->model->inverse_mass;
    for (uint32_t m = 0; m < r; m++) {
        const double reach = h * dm_weight_double(l->table.reach[m]);
        double *base = l->base + (size_t)m * n, *Z = l->Z + (size_t)m * n;
        for (uint32_t i = 0; i < n; i++) Z[i] = base[i] = reach * (w[i] * p[i]);
        if (l->kind[m] == FIRST) dm_stage_sparse_force(s, q, m, t, h);
    }
    if (l->first == r) return;
    for (uint32_t m = 0; m < r; m++) {
        double *base = l->base + (size_t)m * n;
        if (l->kind[m] == FIRST) continue;
        dm_stage_sparse_add(s, base, m, FIRST, h);
        memcpy(l->Z + (size_t)m * n, base, n * sizeof *base);
    }
}

/* q1 and p1 of all forces, into the compensated state */
static void end(const dm_stepper *s, const layout *l, double *state, double h) {
    const uint32_t n = s->model->n, r = l->table.r;
    double *p = state + n, *low_q = p + n, *low_p = low_q + n;
    for (uint32_t i = 0; i < n; i++) {
        const double w = s->model->inverse_mass[i];
        double dq = h * (w * p[i]), dp = 0.0;
        for (uint32_t m = 0; m < r; m++) {
            const double F = l->F[(size_t)m * n + i];
            dq += h * h * dm_weighted(l->table.mean[m], w * F);
            dp += h * dm_weighted(l->table.b[m], F);
        }
        dm_sum_add(state + i, low_q + i, dq);
        dm_sum_add(p + i, low_p + i, dp);
    }
}

/* a dm_stage_try; linear equations have nothing to go on from */
static dm_status find_points(dm_stepper *s, const double *state, double t, double h, double ratio) {
    layout *l = dm_stage_sparse_of(s);
    const size_t n = s->model->n;
    begin(s, l, state, state + n, t, h);
    for (uint32_t a = 0; a < l->solved && ratio > 0.0; a++)
        for (size_t i = 0; i < n; i++) l->Z[l->at[a] * n + i] = ratio * l->root[a * n + i];
    const dm_status status = dm_stage_sparse_newton(s, state, t, h, ratio == 0.0);
    for (uint32_t a = 0; a < l->solved && !l->constant && status == DM_OK; a++)
        memcpy(l->root + a * n, l->Z + l->at[a] * n, n * sizeof *l->root);
    return status;
}

/* where its matrix was made is what a step leaves */
static size_t memory(dm_stepper *s, double **place) {
    const layout *l = dm_stage_sparse_of(s);
    *place = l->kept.memory;
    return l->solved ? dm_stage_place_memory(&l->kept) : 0;
}

static dm_status start(dm_stepper *s, double *state, double t, double h) {
    (void)state, (void)t;
    dm_stage_place_clear(&dm_stage_sparse_of(s)->kept, h);
    return DM_OK;
}

static dm_status step(dm_stepper *s, double *state, double t, double h) {
    layout *l = dm_stage_sparse_of(s);
    const uint32_t n = s->model->n, r = l->table.r;
    if (!l->solved) begin(s, l, state, state + n, t, h);
    dm_status status = DM_OK;
    if (l->solved && l->constant) status = find_points(s, state, t, h, 0.0);
    if (l->solved && !l->constant) status = dm_stage_continue(s, find_points, state, t, h);
    if (status != DM_OK) return status;
    for (uint32_t m = 0; m < r; m++) {
        if (l->kind[m] == FIRST) continue;
        if (l->kind[m] == LAST) dm_stage_sparse_add(s, l->Z + (size_t)m * n, m, SOLVED, h);
        if (l->kind[m] == LAST || !l->fresh) dm_stage_sparse_force(s, state, m, t, h);
    }
    for (uint32_t i = 0; i < r * n && !(l->fresh && l->solved == r); i++)
        if (!isfinite(l->F[i])) return DM_NOT_FINITE;
    end(s, l, state, h);
    return DM_OK;
}

const dm_engine dm_engine_stage_sparse = {
    .fits = dm_stage_field_fits,
    .wants = dm_stage_field_wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .memory = memory,
    .close = close,
};
