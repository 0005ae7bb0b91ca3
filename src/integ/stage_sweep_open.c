/* stage_sweep_open.c - kernels, coefficients and workspace of the sweeps of stage_sweep.c. */
#include "expr/jit.h"
#include "integ/hamilton.h"
#include "integ/kept.h"
#include "integ/stage_inside.h"

#include <math.h>
#include <string.h>

static size_t width_of(size_t stages) {
    return stages == 1 ? 1 : stages <= 4 ? 4 : 8;
}

/* of the kernels: positions, velocities, time; L_q, triangle, b, momenta, with the triangle twice in copies; v,
** pivots */
static size_t kernels_size(size_t n, size_t lanes, int separable) {
    const size_t triangle = separable ? 0 : n * (n + 1) / 2;
    return lanes * (2 * n + 1 + 2 * (triangle + 2 * n) + 2 * n);
}

size_t dm_stage_sweeps_size(size_t s, size_t r, const dm_model *m) {
    const size_t n = m->n, w = width_of(r);
    const int separable =
        (m->structure & DM_SEPARABLE) && (m->structure & DM_CONSTANT_MASS);
    if (s > DM_SWEEP_WIDTH || r > DM_SWEEP_WIDTH) return 0;
    if (!separable && !dm_hamilton_fits(m)) return 0;
    return kernels_size(n, w, separable) + kernels_size(n, 4, separable) + 6 * n * w +
           6 * r * w + 5 * w + 6 * n + 3 + 4 * n;
}

static double *take(double **memory, size_t count) {
    double *block = *memory;
    *memory += count;
    return block;
}

/* the kernels' arrays: what force gives beside L_q is where velocity finds it */
static double *lay_kernels(dm_stage_sweeps *w, size_t n, double *memory) {
    const size_t width = w->row->width, lanes = 4;
    dm_stage_kernel *f = &w->force, *v = &w->velocity;
    const size_t more = v->lanes ? v->inputs - n : 0; /* triangle and b */
    f->in = take(&memory, (2 * n + 1) * width);
    f->out = take(&memory, (2 * n + more) * width);
    f->some_in = take(&memory, (2 * n + 1) * lanes);
    f->some_out = take(&memory, (n + more) * lanes);
    v->in = f->out + n * width;
    v->out = take(&memory, 2 * n * width);
    v->some_in = take(&memory, (n + more) * lanes);
    v->some_out = take(&memory, 2 * n * lanes);
    return memory;
}

static void lay_out(dm_stage_sweeps *w, size_t n, size_t r, double *memory) {
    const size_t width = w->row->width, column = r * width;
    memory = lay_kernels(w, n, memory);
    w->u = take(&memory, n * width);
    w->sum = take(&memory, n * width);
    w->base = take(&memory, n * width);
    w->momentum = take(&memory, n * width);
    w->none = take(&memory, n * width);
    w->whole = take(&memory, column);
    w->top = take(&memory, column);
    w->rest = take(&memory, column);
    w->ahead = take(&memory, column);
    w->unscaled = take(&memory, column);
    w->further = take(&memory, column);
    w->after = take(&memory, width);
    w->b_top = take(&memory, width);
    w->b_rest = take(&memory, width);
    w->mean_top = take(&memory, width);
    w->mean_rest = take(&memory, width);
    w->start = take(&memory, 2 * n);
    w->low = take(&memory, 2 * n);
    w->total = take(&memory, 2 * n);
    w->memory = memory;
}

/* ---- coefficients ---- */

/* columns of A E or a E; E extrapolates the polynomial through the nodes by one step */
static void find_ahead(dm_stage *g, const dm_quadrature *q) {
    const int r = q->r;
    const uint32_t width = g->sweeps.row->width;
    const dm_weight *A = g->separable ? g->table.A : g->table.a;
    long double E[DM_SWEEP_WIDTH][DM_SWEEP_WIDTH];
    for (int m = 0; m < r; m++) dm_lagrange_value(E[m], q->c, r, 1.0L + q->c[m]);
    for (int j = 0; j < r; j++)
        for (int i = 0; i < r; i++) {
            long double sum = 0.0L;
            g->sweeps.further[j * (int)width + i] = (double)E[i][j];
            for (int m = 0; m < r; m++) sum += dm_weight_exact(A[i * r + m]) * E[m][j];
            g->sweeps.unscaled[j * (int)width + i] = (double)sum;
        }
}

void dm_stage_sweeps_scale(dm_stage *g) {
    dm_stage_sweeps *w = &g->sweeps;
    if (!w->row) return;
    const uint32_t r = g->table.r, width = w->row->width;
    const dm_weight *A = g->separable ? g->hA : g->ha;
    const double factor = g->separable ? g->h * g->h : g->h;
    for (uint32_t i = 0; i < r; i++) {
        w->after[i] = dm_weight_double(g->hc[i]);
        w->b_top[i] = g->hb[i].top;
        w->b_rest[i] = g->hb[i].rest;
        w->mean_top[i] = g->hmean[i].top;
        w->mean_rest[i] = g->hmean[i].rest;
        for (uint32_t m = 0; m < r; m++) {
            const uint32_t at = m * width + i;
            w->whole[at] = dm_weight_double(A[i * r + m]);
            w->top[at] = A[i * r + m].top;
            w->rest[at] = A[i * r + m].rest;
            w->ahead[at] = factor * w->unscaled[at];
        }
    }
}

/* ---- opening ---- */

/* the method is Gauss collocation of Hamilton's equations: b_i a_ij + b_j a_ji = b_i b_j (HLW VI.4.1) */
static int is_collocation(const dm_stage *g, const dm_galerkin *basis) {
    const dm_stage_table *t = &g->table;
    if (t->s != t->r) return 0;
    for (uint32_t i = 0; i < t->r; i++)
        for (uint32_t j = 0; j < t->r; j++) {
            const long double bi = basis->q.b[i], bj = basis->q.b[j];
            const long double left = bi * dm_weight_exact(t->a[i * t->r + j]) +
                                     bj * dm_weight_exact(t->a[j * t->r + i]) - bi * bj;
            if (fabsl(left) > 1e-15L || basis->node[i] != basis->q.c[i]) return 0;
        }
    return 1;
}

static int has_unknowns(const dm_stage *g) {
    for (uint32_t i = 0; i < g->table.r; i++)
        if (g->known[i] == DM_POINT_SOLVED) return 1;
    return 0;
}

/* 0 where there is no kernel */
static int build(dm_stage *g, uint32_t width) {
    const dm_model *m = g->m;
    dm_stage_kernel *f = &g->sweeps.force, *v = &g->sweeps.velocity;
    f->lanes = g->separable ? dm_lanes_build(&f->kernel, m, m->source.graph,
                                             m->source.gradient, m->n, width)
                            : dm_hamilton_split(&f->kernel, &v->kernel, m, width);
    v->lanes = g->separable ? 0 : f->lanes;
    return f->lanes > 0;
}

/* the kernels of the model's last stepper, or new ones */
static int find_kernels(dm_stage *g, const dm_galerkin *basis) {
    static const char force, velocity;
    dm_stage_kernel *f = &g->sweeps.force, *v = &g->sweeps.velocity;
    const uint32_t r = g->table.r;
    if (r > DM_SWEEP_WIDTH || !g->m->source.graph || basis->tableau) return 0;
    if (r == 1 && !g->separable) return 0; /* Newton's method is cheaper */
    if (g->separable ? !has_unknowns(g) : !is_collocation(g, basis)) return 0;
    const uint32_t width = dm_sweep_find(r)->width;
    f->lanes = dm_kept_find(&f->kernel, g->m, &force, width);
    v->lanes = f->lanes ? dm_kept_find(&v->kernel, g->m, &velocity, width) : 0;
    if (f->lanes && (g->separable || v->lanes)) return 1;
    if (!build(g, width)) return 0;
    dm_kept_add(g->m, &force, width, &f->kernel, f->lanes);
    if (v->lanes) dm_kept_add(g->m, &velocity, width, &v->kernel, v->lanes);
    return 1;
}

static void open_kernel(dm_stage_kernel *k, uint32_t width) {
    dm_kernel_prepare_lanes(&k->kernel, k->lanes,
                            k->lanes == width ? k->out : k->some_out);
}

void dm_stage_sweeps_open(dm_stage *g, const dm_galerkin *basis, double *memory) {
    dm_stage_sweeps *w = &g->sweeps;
    const uint32_t r = g->table.r, n = g->n;
    const uint32_t triangle = n * (n + 1) / 2;
    w->row = NULL;
    if (!find_kernels(g, basis)) return;
    w->row = dm_sweep_find(r);
    w->count = basis->sweeps;
    w->force.inputs = 2 * n + 1;
    w->force.outputs = w->velocity.lanes ? 2 * n + triangle : n;
    w->velocity.inputs = triangle + 2 * n;
    w->velocity.outputs = 2 * n;
    memset(memory, 0, dm_stage_sweeps_size(g->table.s, r, g->m) * sizeof *memory);
    lay_out(w, n, r, memory);
    open_kernel(&w->force, w->row->width);
    if (w->velocity.lanes) open_kernel(&w->velocity, w->row->width);
    find_ahead(g, &basis->q);
    dm_stage_sweeps_scale(g);
}
