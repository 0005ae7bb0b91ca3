/* stage_sweep_open.c - kernels, coefficients and workspace of the sweeps of stage_sweep.c. */
#include "code/native/jit.h"
#include "integ/method/cache.h"
#include "integ/method/hamilton.h"
#include "integ/stage/sweep/stage_sweep.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { LINE = 8, ARRAYS = 32 }; /* doubles of a line of the cache, where arrays begin */

static size_t width_of(size_t stages) {
    return stages == 1 ? 1 : stages <= 4 ? 4 : 8;
}

/* of the kernels: positions, velocities, time; L_q, triangle, b; pivots, triangle, b, p; and
 * copies for four lanes of what each takes and gives */
static size_t kernels_size(size_t n, size_t width, size_t known) {
    const size_t triangle = known ? n * (n + 1) / 2 : 0;
    return width * (6 * n + 1 + known + triangle) + 4 * (9 * n + 1 + 2 * (known + triangle));
}

size_t dm_stage_sweeps_size(size_t s, size_t r, const dm_model *m) {
    const size_t n = m->n, w = width_of(r);
    const int separable = (m->structure & DM_SEPARABLE) && (m->structure & DM_CONSTANT_MASS);
    if (s > DM_SWEEP_WIDTH || r > DM_SWEEP_WIDTH) return 0;
    if (!separable && !dm_hamilton_fits(m)) return 0;
    return dm_doubles(sizeof(dm_stage_sweeps)) +
           kernels_size(n, w, separable ? 0 : dm_hamilton_known(m->n)) + 4 * n * w + 5 * r * w +
           9 * w + 11 * n + 5 + ARRAYS * LINE;
}

static double *take(double **memory, size_t count) {
    double *block = *memory;
    *memory += (count + LINE - 1) / LINE * LINE;
    return block;
}

static void lay_copies(dm_stage_kernel *k, double **memory) {
    enum { LANES = 4 };
    k->some_in = take(memory, (size_t)k->inputs * LANES);
    k->some_out = take(memory, (size_t)k->outputs * LANES);
}

/* the kernels' arrays: each finds its arguments where the one before left them */
static double *lay_kernels(dm_stage_sweeps *w, size_t n, double *memory) {
    const size_t width = w->row->width;
    dm_stage_kernel *f = &w->force, *d = &w->factors, *v = &w->velocity;
    f->in = take(&memory, (2 * n + 1) * width);
    f->out = take(&memory, f->outputs * width);
    lay_copies(f, &memory);
    if (!v->lanes) return memory;
    d->in = f->out + n * width;
    d->out = take(&memory, (d->outputs + n) * width);
    v->in = d->out + n * width;
    v->out = f->in + n * width;
    lay_copies(d, &memory);
    lay_copies(v, &memory);
    return memory;
}

static void lay_out(dm_stage *g, double *memory) {
    dm_stage_sweeps *w = g->sweeps;
    const size_t n = g->n, r = g->table.r, width = w->row->width;
    double **const rows[] = {&w->u, &w->base, &w->lift, &w->none};
    double **const columns[] = {&w->whole, &w->rest, &w->further};
    double **const single[] = {&w->after,       &w->line.top, &w->line.rest,
                               &w->b.top,       &w->b.rest,   &w->flight.top,
                               &w->flight.rest, &w->mean.top, &w->mean.rest};
    memory = lay_kernels(w, n, memory);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) *rows[i] = take(&memory, n * width);
    for (size_t i = 0; i < sizeof columns / sizeof *columns; i++)
        *columns[i] = take(&memory, r * width);
    w->flying = take(&memory, 2 * r * width);
    w->turning = w->flying + r * width;
    for (size_t i = 0; i < sizeof single / sizeof *single; i++) *single[i] = take(&memory, width);
    w->share = take(&memory, 2 * n);
    w->drift = take(&memory, 2 * n);
    w->unit = take(&memory, 2 * n);
    const size_t before = dm_stage_memory_u(g); /* u begins a line, too */
    w->memory = memory + (LINE - before % LINE) % LINE;
}

/* ---- coefficients ---- */

/* columns of A E or a E, and of E, which extrapolates the polynomial through the nodes by one
 * step */
static void make_ahead(dm_stage *g, const dm_quadrature *q) {
    const int r = q->r;
    const uint32_t width = g->sweeps->row->width;
    const dm_weight *A = g->separable ? g->table.A : g->table.a;
    long double E[DM_SWEEP_WIDTH][DM_SWEEP_WIDTH];
    for (int m = 0; m < r; m++) dm_lagrange_value(E[m], q->c, r, 1.0L + q->c[m]);
    for (int j = 0; j < r; j++)
        for (int i = 0; i < r; i++) {
            long double sum = 0.0L;
            g->sweeps->turning[j * (int)width + i] = (double)E[i][j];
            for (int m = 0; m < r; m++) sum += dm_weight_exact(A[i * r + m]) * E[m][j];
            g->sweeps->flying[j * (int)width + i] = (double)sum;
        }
}

/* the same, from the model where the last stepper left it; turning is laid out behind flying */
static void find_ahead(dm_stage *g, const dm_galerkin *basis) {
    static const char maker;
    const uint32_t count = 2 * g->table.r * g->sweeps->row->width;
    double key[DM_STAGE_KEY];
    const uint32_t keys = dm_stage_key(key, basis);
    const double *kept = basis->tableau ? NULL : dm_cache_numbers(g->m, &maker, key, keys);
    if (kept) {
        memcpy(g->sweeps->flying, kept, count * sizeof *kept);
        return;
    }
    make_ahead(g, &basis->q);
    if (!basis->tableau) dm_cache_leave(g->m, &maker, key, keys, g->sweeps->flying, count);
}

/* Of few bits and the rest: what rounding takes from the product with the first is then far
 * smaller than the product with the rest. The nearest double leaves a rest that two roundings of
 * its product take away in every step alike, so that invariants drift. */
static void put_parts(const dm_parts *out, uint32_t at, dm_weight w) {
    out->top[at] = w.top;
    out->rest[at] = w.rest;
}

/* What sweeps multiply by; the rest is added where their number is not given. */
static void put_whole(const dm_stage_sweeps *w, uint32_t at, dm_weight a, int few_bits) {
    const double nearest = dm_weight_double(a);
    w->whole[at] = few_bits && !w->count ? dm_weight_few_bits(nearest) : nearest;
    w->rest[at] = (double)(dm_weight_exact(a) - (long double)w->whole[at]);
}

void dm_stage_sweeps_scale(dm_stage_sweeps *w, const dm_stage *g) {
    const double h = g->weights.h;
    const uint32_t r = g->table.r, width = w->row->width;
    const dm_weight *A = g->separable ? g->weights.hA : g->weights.ha;
    const double factor = g->separable ? h * h : h;
    const int few_bits = !g->separable && r <= DM_SWEEP_RATIOS;
    if (g->separable) put_parts(&w->flight, 0, *g->weights.flight);
    for (uint32_t i = 0; i < r; i++) {
        w->after[i] = dm_weight_double(g->weights.hc[i]);
        put_parts(&w->line, i, g->weights.hc[i]);
        put_parts(&w->b, i, g->weights.hb[i]);
        if (g->separable) put_parts(&w->mean, i, g->weights.hmean[i]);
        for (uint32_t m = 0; m < r; m++) {
            const uint32_t at = m * width + i;
            put_whole(w, at, A[i * r + m], few_bits);
            w->further[at] = factor * w->flying[at];
        }
    }
}

size_t dm_stage_sweeps_scaled(const dm_stage_sweeps *w, const double **first) {
    *first = w->whole;
    return (size_t)(w->mean.rest + w->row->width - w->whole);
}

/* ---- the sums ---- */

static void plan(dm_stage *g) {
    dm_stage_sweeps *w = g->sweeps;
    const uint32_t n = g->n, width = w->row->width;
    const int diagonal = g->separable && g->m->structure & DM_DIAGONAL_MASS;
    const double *kept = w->memory + dm_stage_memory_u(g);
    const dm_sweep all = {.rows = n, .columns = g->table.r, .start = w->none};
    w->q = w->p = w->v_ahead = all;
    w->q.x = w->force.in;
    w->q.base = w->base;
    w->q.column = w->whole;
    w->q.u = dm_stage_sweeps_u(g);
    w->q.factor = diagonal ? g->m->inverse_mass : NULL;
    w->p.x = w->factors.out + (size_t)w->factors.outputs * width;
    w->p.base = w->lift;
    w->p.column = w->whole;
    w->p.u = w->force.out;
    for (uint32_t k = 0; k < n; k++)
        w->share[k] = diagonal ? w->q.factor[k] : 1.0, w->share[n + k] = 1.0;
    w->end = (dm_sweep_end){.rows = n,
                            .u = {w->q.u, w->force.out},
                            .b = {g->separable ? &w->mean : &w->b, &w->b},
                            .factor = w->share,
                            .drift = w->drift};
    w->q_rest = w->q;
    w->q_rest.x = w->base;
    w->q_rest.start = w->none;
    w->q_rest.column = w->rest;
    w->p_rest = w->p;
    w->p_rest.x = w->lift;
    w->p_rest.start = w->none;
    w->p_rest.column = w->rest;
    w->ahead = w->q;
    w->ahead.column = w->further;
    w->ahead.u = kept;
    w->v_ahead.x = w->force.in + n * width;
    w->v_ahead.base = w->none;
    w->v_ahead.column = w->turning;
    w->v_ahead.u = kept;
}

/* ---- opening ---- */

/* the method is Gauss collocation of Hamilton's equations: b_i a_ij + b_j a_ji = b_i b_j (HLW
 * VI.4.1) */
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
        if (g->points.kind[i] == DM_POINT_SOLVED) return 1;
    return 0;
}

/* 0 where there are no kernels */
static uint32_t build(dm_kernel *out, const dm_model *m, int separable, uint32_t width) {
    dm_hamilton parts;
    if (separable) return dm_lanes_build(out, m, m->source.graph, m->source.gradient, m->n, width);
    const uint32_t lanes = dm_hamilton_split(&parts, m, width);
    out[0] = parts.force;
    out[1] = parts.factors;
    out[2] = parts.velocity;
    return lanes;
}

uint32_t dm_stage_sweeps_kernels(dm_kernel out[3], const dm_stage *g, uint32_t width) {
    static const char makers[3];
    const uint32_t count = g->separable ? 1 : 3;
    uint32_t found = 0, lanes = 0;
    for (; found < count; found++) {
        lanes = dm_cache_find(out + found, g->m, makers + found, width);
        if (!lanes) break;
    }
    if (found == count) return lanes;
    lanes = build(out, g->m, g->separable, width);
    for (uint32_t i = 0; lanes && i < count; i++)
        dm_cache_add(g->m, makers + i, width, out + i, lanes);
    return lanes;
}

/* the kernels of the model's last stepper, or new ones */
static int find_kernels(dm_stage_sweeps *w, const dm_stage *g, const dm_galerkin *basis) {
    dm_kernel kernels[3];
    const uint32_t r = g->table.r;
    if (r > DM_SWEEP_WIDTH || !g->m->source.graph) return 0;
    if (r == 1 && !g->separable) return 0; /* Newton's method is cheaper */
    if (g->separable ? !has_unknowns(g) : !is_collocation(g, basis)) return 0;
    const uint32_t lanes = dm_stage_sweeps_kernels(kernels, g, dm_sweep_find(r)->width);
    if (!lanes) return 0;
    w->force.lanes = lanes;
    w->force.kernel = kernels[0];
    if (g->separable) return 1;
    w->factors.lanes = w->velocity.lanes = lanes;
    w->factors.kernel = kernels[1];
    w->velocity.kernel = kernels[2];
    return 1;
}

static double *aligned(double *memory) {
    const size_t line = LINE * sizeof *memory, past = (uintptr_t)memory % line;
    return past ? memory + (line - past) / sizeof *memory : memory;
}

static void open_kernel(dm_stage_kernel *k, uint32_t width) {
    dm_kernel_prepare_lanes(&k->kernel, k->lanes, k->lanes == width ? k->out : k->some_out);
}

/* what kernels take and give; `factors` takes what `force` gives behind L_q */
static void count_entries(dm_stage_sweeps *w, uint32_t n) {
    const uint32_t triangle = n * (n + 1) / 2;
    w->force.inputs = 2 * n + 1;
    w->force.outputs = w->force.kernel.outputs;
    w->factors.inputs = w->force.outputs - n;
    w->factors.outputs = triangle + 2 * n;
    w->velocity.inputs = triangle + 2 * n;
    w->velocity.outputs = n;
}

static void open_kernels(dm_stage_sweeps *w) {
    const uint32_t width = w->row->width;
    open_kernel(&w->force, width);
    if (w->factors.lanes) open_kernel(&w->factors, width);
    if (w->velocity.lanes) open_kernel(&w->velocity, width);
}

void dm_stage_sweeps_open(dm_stage *g, const dm_galerkin *basis, double *memory) {
    dm_stage_sweeps *w = (dm_stage_sweeps *)(void *)aligned(memory);
    const size_t all = dm_stage_sweeps_size(g->table.s, g->table.r, g->m);
    if (!all) return;
    *w = (dm_stage_sweeps){0};
    if (!find_kernels(w, g, basis)) return;
    double *behind = (double *)(void *)(w + 1);
    memset(behind, 0, (size_t)(memory + all - behind) * sizeof *behind);
    g->sweeps = w;
    w->row = dm_sweep_find(g->table.r);
    w->count = basis->sweeps;
    count_entries(w, g->n);
    lay_out(g, aligned(behind));
    g->group.memory = w->memory;
    assert(w->memory + dm_stage_memory_size(g) <= memory + all);
    open_kernels(w);
    w->heaviest = g->separable ? dm_stage_heaviest(g->m) : 0.0;
    find_ahead(g, basis);
    plan(g);
}
