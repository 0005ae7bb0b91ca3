/* phase_open.c - kernels, coefficients and workspace of the stage methods on H. */
#include "base/doubles.h"
#include "code/native/jit.h"
#include "integ/method/cache.h"
#include "integ/method/hamilton.h"
#include "integ/phase/phase_inside.h"
#include "linalg/solve/newton.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { LINE = 8, ARRAYS = 40 }; /* doubles of a line of the cache, where arrays begin */

/* lanes of an array of r stages */
static size_t width_of(size_t r) {
    return r == 1 ? 1 : r <= 4 ? 4 : r <= DM_SWEEP_WIDTH ? 8 : r;
}

size_t dm_phase_memory_size(const dm_phase *g) {
    return DM_SWEPT_END + 4 * (size_t)g->n + 2 * (size_t)g->n * g->width;
}

/* an upper bound: every array may begin a line */
size_t dm_phase_work(const dm_rule *rule, const dm_model *m) {
    dm_galerkin basis;
    dm_stage_basis(&basis, rule, m);
    const size_t n = m->n, r = (size_t)basis.q.r, w = width_of(r), unknowns = 2 * n * r;
    const size_t head = dm_doubles(sizeof(dm_phase));
    return head + dm_stage_table_size((size_t)basis.s, r) + dm_phase_modes_size((uint32_t)r) +
           4 * r * r + 4 * r + 12 * n * w + w + 8 * r * w + 6 * w + 4 * (4 * n + 1) + 14 * n +
           r * (2 * n + 4 * n * n) + 2 * n + 1 + unknowns +
           dm_larger(dm_newton_work((uint32_t)unknowns), dm_legendre_work(m)) + DM_SWEPT_END +
           ARRAYS * LINE;
}

/* the next block, which begins a line; *memory moves behind it */
static double *take(double **memory, size_t count) {
    double *block = *memory;
    *memory += (count + LINE - 1) / LINE * LINE;
    return block;
}

/* the next place where a line begins */
static double *aligned(double *memory) {
    const size_t line = LINE * sizeof *memory, past = (uintptr_t)memory % line;
    return past ? memory + (line - past) / sizeof *memory : memory;
}

/* arrays of stages in lanes; copies of four lanes are for kernels of fewer lanes than stages */
static void lay_sweeps(dm_phase *g, double **memory) {
    enum { LANES = 4 };
    const size_t n = g->n, r = g->r, w = g->width;
    g->x = take(memory, (2 * n + 1) * w);
    g->u = take(memory, 2 * n * w);
    g->base = take(memory, 2 * n * w);
    g->none = take(memory, 2 * n * w);
    g->field.some_in = take(memory, (2 * n + 1) * LANES);
    g->field.some_out = take(memory, 2 * n * LANES);
    for (int k = 0; k < 2; k++) {
        g->whole[k] = take(memory, r * w);
        g->lacking[k] = take(memory, r * w);
        g->further[k] = take(memory, r * w);
    }
    g->after = take(memory, w);
    g->b = (dm_parts){take(memory, w), take(memory, w)};
    g->flying[0] = take(memory, 2 * r * w); /* both behind each other, as the cache keeps them */
    g->flying[1] = g->flying[0] + r * w;
    g->line = (dm_parts){take(memory, w), take(memory, w)};
    g->ones = take(memory, 2 * n);
    g->unit = take(memory, 2 * n);
}

/* returns what is behind the last array */
static double *lay_out(dm_phase *g, double *memory) {
    const size_t n = g->n, r = g->r, unknowns = 2 * n * r;
    g->ha = (dm_weight *)(void *)take(&memory, 2 * r * r);
    g->hA = (dm_weight *)(void *)take(&memory, 2 * r * r);
    g->hb = (dm_weight *)(void *)take(&memory, 2 * r);
    g->hc = (dm_weight *)(void *)take(&memory, 2 * r);
    lay_sweeps(g, &memory);
    g->root = take(&memory, unknowns);
    g->curve = take(&memory, r * (2 * n + 4 * n * n));
    g->at = take(&memory, 2 * n + 1);
    g->modes_memory = take(&memory, dm_phase_modes_size(g->r));
    g->before = take(&memory, 4 * n);
    g->scratch =
        take(&memory, dm_larger(dm_newton_work((uint32_t)unknowns), dm_legendre_work(g->m)));
    const size_t ahead = DM_SWEPT_END + 4 * n; /* u begins a line, too */
    g->memory = memory + (LINE - ahead % LINE) % LINE;
    return g->memory + dm_phase_memory_size(g);
}

/* ---- coefficients ---- */

/* a_ij of q (p = 0), A_ij of p */
static long double coefficient(const dm_stage_table *t, int p, uint32_t i, uint32_t j) {
    const uint32_t r = t->r;
    if (!p) return dm_weight_exact(t->a[i * r + j]);
    const long double bi = dm_weight_exact(t->b[i]), bj = dm_weight_exact(t->b[j]);
    return bj - bj * dm_weight_exact(t->a[j * r + i]) / bi;
}

/* columns of a E and A E, where E extrapolates the polynomial through the stages by one step */
static void make_ahead(const dm_phase *g, const dm_quadrature *q) {
    const uint32_t r = g->r;
    long double E[DM_SWEEP_WIDTH][DM_SWEEP_WIDTH];
    for (uint32_t m = 0; m < r; m++) dm_lagrange_value(E[m], q->c, (int)r, 1.0L + q->c[m]);
    for (int k = 0; k < 2; k++)
        for (uint32_t j = 0; j < r; j++)
            for (uint32_t i = 0; i < r; i++) {
                long double sum = 0.0L;
                for (uint32_t m = 0; m < r; m++) sum += coefficient(&g->table, k, i, m) * E[m][j];
                g->flying[k][j * g->width + i] = (double)sum;
            }
}

/* the same, from the model where the last stepper left it */
static void find_ahead(const dm_phase *g, const dm_galerkin *basis) {
    static const char maker;
    const uint32_t count = 2 * g->r * g->width;
    double key[DM_STAGE_KEY];
    const uint32_t keys = dm_stage_key(key, basis);
    const double *kept = basis->tableau ? NULL : dm_cache_numbers(g->m, &maker, key, keys);
    if (kept) {
        memcpy(g->flying[0], kept, count * sizeof *kept);
        return;
    }
    make_ahead(g, &basis->q);
    if (!basis->tableau) dm_cache_leave(g->m, &maker, key, keys, g->flying[0], count);
}

/* What sweeps multiply by, and the rest, which is added where their number is not given. Not of the
 * end's coefficients, which are of few bits and the rest: see put_parts of stage_sweep_open.c. */
static void split(const dm_phase *g, double *top, double *rest, dm_weight w) {
    const double nearest = dm_weight_double(w);
    *top = g->count || g->r > DM_SWEEP_RATIOS ? nearest : dm_weight_few_bits(nearest);
    *rest = (double)(dm_weight_exact(w) - (long double)*top);
}

/* One product of h with each coefficient, rounded once. */
void dm_phase_scale(dm_phase *g, double h) {
    const dm_stage_table *t = &g->table;
    const uint32_t r = g->r;
    dm_weight *const scaled[2] = {g->ha, g->hA};
    g->h = h;
    for (uint32_t i = 0; i < r; i++) {
        g->hb[i] = dm_weight_of(h * dm_weight_exact(t->b[i]));
        g->hc[i] = dm_weight_of(h * dm_weight_exact(t->c[i]));
        g->after[i] = dm_weight_double(g->hc[i]);
        g->b.top[i] = g->hb[i].top;
        g->b.rest[i] = g->hb[i].rest;
        for (uint32_t j = 0; j < r; j++)
            for (int k = 0; k < 2; k++) {
                const size_t at = j * (size_t)g->width + i;
                const dm_weight w = dm_weight_of(h * coefficient(t, k, i, j));
                scaled[k][i * r + j] = w;
                split(g, g->whole[k] + at, g->lacking[k] + at, w);
                g->further[k][at] = h * g->flying[k][at];
            }
    }
}

size_t dm_phase_scaled(const dm_phase *g, const double **first) {
    *first = g->whole[0];
    return (size_t)(g->b.rest + g->width - g->whole[0]);
}

/* ---- opening ---- */

/* sums of q (k = 0) and p (k = 1) over the stages */
static void plan(dm_phase *g, int k) {
    const size_t n = g->n, w = g->width, at = (size_t)k * n * w;
    const dm_sweep all = {.rows = g->n,
                          .columns = g->r,
                          .x = g->x + at,
                          .base = g->base + at,
                          .column = g->whole[k],
                          .u = g->u + at,
                          .start = g->none};
    g->sum[k] = g->rest[k] = g->ahead[k] = all;
    g->rest[k].x = g->base + at;
    g->rest[k].column = g->lacking[k];
    g->ahead[k].column = g->further[k];
    g->ahead[k].u = g->memory + DM_SWEPT_END + 4 * n + at;
    g->end.u[k] = g->u + at;
    g->end.b[k] = &g->b;
}

/* the field for all stages, from the model where the last stepper left it; lanes stay 0 where
 * there is none */
static void find_kernel(dm_phase *g) {
    static const char maker;
    dm_stage_kernel *f = &g->field;
    const uint32_t w = g->width;
    f->inputs = 2 * g->n + 1;
    f->outputs = 2 * g->n;
    f->in = g->x;
    f->out = g->u;
    if (!g->row) return;
    f->lanes = dm_cache_find(&f->kernel, g->m, &maker, w);
    if (!f->lanes) {
        f->lanes =
            dm_lanes_build(&f->kernel, g->m, g->m->source.graph, g->m->source.field, 2 * g->n, w);
        if (f->lanes) dm_cache_add(g->m, &maker, w, &f->kernel, f->lanes);
    }
    if (f->lanes)
        dm_kernel_prepare_lanes(&f->kernel, f->lanes, f->lanes == w ? f->out : f->some_out);
}

/* Arrays of stages are zero at first: lanes without a stage stay at the start. What Newton's method
 * works on is most of the memory, and is written before it is read. */
static void clear(const dm_phase *g, double *first) {
    memset(first, 0, (size_t)(g->root - first) * sizeof *first);
    memset(g->memory, 0, dm_phase_memory_size(g) * sizeof *g->memory);
}

dm_status dm_phase_open(dm_stepper *stepper) {
    dm_phase *g = dm_phase_of(stepper);
    const dm_model *m = stepper->model;
    dm_galerkin basis;
    dm_stage_basis(&basis, stepper->rule, m);
    double *const table = aligned((double *)(void *)(g + 1));
    *g = (dm_phase){.m = m, .n = m->n, .r = (uint32_t)basis.q.r, .count = basis.sweeps};
    g->width = (uint32_t)width_of(g->r);
    if (g->r <= DM_SWEEP_WIDTH) g->row = dm_sweep_find(g->r);
    g->h = NAN; /* of no step yet */
    double *const end = lay_out(g, aligned(table + dm_stage_table_size((size_t)basis.s, g->r)));
    assert(end <= stepper->work + dm_phase_work(stepper->rule, m));
    clear(g, table);
    dm_stage_table_find(&g->table, &basis, m, table);
    for (uint32_t k = 0; k < 2 * g->n; k++) g->ones[k] = 1.0;
    for (int k = 0; k < 2; k++) plan(g, k);
    g->end.rows = g->n;
    g->end.factor = g->ones;
    g->end.drift = g->none;
    find_kernel(g);
    if (g->field.lanes) find_ahead(g, &basis);
    stepper->report.operations = g->field.lanes ? g->field.kernel.operations : 0;
    return DM_OK;
}
