/*
** stage_sweep.c - the step of a stage method by fixed-point sweeps with all stages in lanes:
**   S <- base + h^2 A M^-1 L_q(q0 + S)                      for L = T(v) - V(q, t), constant mass,
**   S <- h a (v, L_q)(q0 + S_q, p0 + S_p)                   for Gauss collocation of Hamilton's equations.
** The first S comes from the polynomial through the forces of the step before (HLW VIII.6.1). Sweeps end when
** what the last one leaves is below round-off of the sums; the last ones use coefficients of two doubles.
*/
#include "expr/jit.h"
#include "integ/hamilton.h"
#include "integ/kept.h"
#include "integ/stage_inside.h"

#include <math.h>
#include <string.h>

/* error left in the sums, relative to the state, for the usual tolerance 4e-15: 1e-19 */
static const double LEFT = 2.5e-5;
static const double CLEAN =
    1e-14; /* changes below are mostly rounding: foretold, not measured */
static const double EXACT = 1e-12; /* changes below: coefficients of two doubles */
static const double SLOW = 0.35;   /* contraction that calls for Newton's method */
static const double LEAST =
    0.01; /* contraction taken for granted before it is measured */
enum { MOST = 60 };

/* ---- workspace ---- */

static size_t width_of(size_t stages) {
    return stages == 1 ? 1 : stages <= 4 ? 4 : 8;
}

size_t dm_stage_sweeps_size(size_t s, size_t r, const dm_model *m) {
    const size_t n = m->n, w = width_of(r);
    if (s > DM_SWEEP_WIDTH || r > DM_SWEEP_WIDTH) return 0;
    return w * (2 * n + 1 + 3 * n + 2 * n) + 4 * (5 * n + 1) + w * 4 * n + 5 * r * w +
           5 * w + 6 * n + 3 + 4 * n + 2 * n * w;
}

static double *take(double **memory, size_t count) {
    double *block = *memory;
    *memory += count;
    return block;
}

static void lay_out(dm_stage_sweeps *w, size_t n, size_t r, double *memory) {
    const size_t width = w->row->width, column = r * width;
    w->in = take(&memory, w->inputs * width);
    w->out = take(&memory, w->outputs * width);
    w->u = take(&memory, w->rows * width);
    w->some_in = take(&memory, (size_t)w->inputs * 4);
    w->some_out = take(&memory, (size_t)w->outputs * 4);
    w->sum = take(&memory, w->rows * width);
    w->base = take(&memory, w->rows * width);
    w->whole = take(&memory, column);
    w->top = take(&memory, column);
    w->rest = take(&memory, column);
    w->ahead = take(&memory, column);
    w->unscaled = take(&memory, column);
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

/* lanes of a new kernel, 0 where there is none */
static uint32_t build(dm_stage *g, uint32_t stages) {
    const dm_model *m = g->m;
    dm_kernel *kernel = &g->sweeps.kernel;
    if (!g->separable) return dm_hamilton_build(kernel, m, stages);
    return dm_lanes_build(kernel, m, m->source.graph, m->source.gradient, m->n, stages);
}

/* the kernel of the model's last stepper, or a new one */
static uint32_t find_kernel(dm_stage *g, const dm_galerkin *basis) {
    static const char maker;
    dm_stage_sweeps *w = &g->sweeps;
    const uint32_t n = g->n, r = g->table.r;
    const uint32_t width = dm_sweep_find(r)->width;
    w->inputs = 2 * n + 1;
    w->rows = g->separable ? n : 2 * n;
    w->outputs = g->separable ? n : 3 * n;
    if (r > DM_SWEEP_WIDTH || !g->m->source.graph) return 0;
    if (g->separable ? !has_unknowns(g) : !is_collocation(g, basis)) return 0;
    uint32_t lanes = dm_kept_find(&w->kernel, g->m, &maker, width);
    if (!lanes) {
        lanes = build(g, width);
        if (lanes) dm_kept_add(g->m, &maker, width, &w->kernel, lanes);
    }
    return lanes;
}

void dm_stage_sweeps_open(dm_stage *g, const dm_galerkin *basis, double *memory) {
    dm_stage_sweeps *w = &g->sweeps;
    const uint32_t r = g->table.r;
    w->row = NULL;
    w->lanes = find_kernel(g, basis);
    if (!w->lanes) return;
    w->row = dm_sweep_find(r);
    w->count = basis->sweeps;
    memset(memory, 0, dm_stage_sweeps_size(g->table.s, r, g->m) * sizeof *memory);
    lay_out(w, g->n, r, memory);
    if (w->lanes == w->row->width)
        dm_kernel_prepare_lanes(&w->kernel, w->lanes, w->out);
    else
        dm_kernel_prepare_lanes(&w->kernel, w->lanes, w->some_out);
    find_ahead(g, &basis->q);
    dm_stage_sweeps_scale(g);
}

/* ---- evaluation ---- */

/* some lanes at a time, through copies */
static void evaluate_parts(dm_stage_sweeps *w, uint32_t stages) {
    const uint32_t width = w->row->width, lanes = w->lanes;
    for (uint32_t first = 0; first < stages; first += lanes) {
        for (uint32_t i = 0; i < w->inputs; i++)
            for (uint32_t l = 0; l < lanes; l++)
                w->some_in[i * lanes + l] = w->in[i * width + first + l];
        dm_kernel_eval(&w->kernel, w->some_in, w->some_out);
        for (uint32_t i = 0; i < w->outputs; i++)
            for (uint32_t l = 0; l < lanes; l++)
                w->out[i * width + first + l] = w->some_out[i * lanes + l];
    }
}

/* u = M^-1 out */
static void divide_by_mass(const dm_stage *g) {
    const dm_stage_sweeps *w = &g->sweeps;
    const uint32_t n = g->n, width = w->row->width;
    const double *factor = g->m->inverse_mass;
    if (g->m->structure & DM_DIAGONAL_MASS) {
        w->row->scale(w->u, factor, w->out, n);
        return;
    }
    memset(w->u, 0, n * width * sizeof *w->u);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++, factor++)
            for (uint32_t l = 0; l < width; l++)
                w->u[i * width + l] += *factor * w->out[j * width + l];
}

/* the unknowns at the arguments in w->in */
static void evaluate(dm_stage *g) {
    dm_stage_sweeps *w = &g->sweeps;
    if (w->lanes == w->row->width)
        dm_kernel_eval(&w->kernel, w->in, w->out);
    else
        evaluate_parts(w, g->table.r);
    if (g->separable)
        divide_by_mass(g);
    else
        memcpy(w->u, w->out, w->rows * w->row->width * sizeof *w->u);
    g->evaluations += g->table.r;
}

/* ---- the iteration ---- */

typedef struct {
    dm_stage *g;
    dm_sweep a;
    double size[2]; /* of positions and momenta, squared */
    double change;  /* of the sums by the last sweep, relative; below CLEAN as foretold */
    double
        rate; /* by which it shrinks: of this step, or of the one before with a margin */
    int measured;
    int count; /* sweeps */
} iteration;

static double relative(const iteration *it, const double change[2]) {
    double largest = 0.0;
    for (int k = 0; k < 2; k++) {
        const double ratio = change[k] > 0.0 ? change[k] / it->size[k] : change[k];
        if (!(ratio <= largest)) largest = ratio;
    }
    return sqrt(largest);
}

/* error left in the sums; what it does to momenta, h L_qq of it, may be as large */
static double left(const iteration *it) {
    return it->rate * it->change;
}

/* one sweep: new sums from the forces, forces there */
static void sweep(iteration *it) {
    const dm_stage_sweeps *w = &it->g->sweeps;
    const int exact = it->change < EXACT;
    const double before = it->change;
    double moved[2];
    it->a.top = exact ? w->top : w->whole;
    it->a.rest = exact ? w->rest : NULL;
    w->row->move(&it->a, moved);
    evaluate(it->g);
    it->change = relative(it, moved);
    if (before <= CLEAN && it->change <= 10.0 * CLEAN) {
        it->change = it->rate * before;
    } else if (it->count > 0) {
        it->rate = it->change / before;
        it->measured = 1;
    }
    it->count++;
}

/* base and time of the stages, arguments at the start; the sums from the step before or a straight line */
static void prepare(iteration *it) {
    dm_stage *g = it->g;
    dm_stage_sweeps *w = &g->sweeps;
    const uint32_t n = g->n, width = w->row->width;
    double moved[2];
    memcpy(w->start, g->state, 2 * n * sizeof *w->start);
    memcpy(w->low, g->state + 2 * n, 2 * n * sizeof *w->low);
    for (uint32_t l = 0; l < width; l++) {
        w->in[2 * n * width + l] = g->t + w->after[l];
        for (uint32_t k = 0; k < n && g->separable; k++)
            w->base[k * width + l] =
                l < g->table.r ? dm_weighted(g->hc[l], g->v0[k]) : 0.0;
    }
    const int warm = dm_stage_memory_fits(g);
    it->a = (dm_sweep){.rows = w->rows, .first = n, .columns = warm ? g->table.r : 0};
    it->a.x = w->in;
    it->a.sum = w->sum;
    it->a.base = w->base;
    it->a.top = w->ahead;
    it->a.u = w->memory + dm_stage_memory_size(g) - w->rows * width;
    it->a.start = w->start;
    it->a.low = w->low;
    memset(w->sum, 0, w->rows * width * sizeof *w->sum);
    w->row->move(&it->a, moved); /* from zero: the size of the sums */
    for (uint32_t k = 0; k < w->rows; k++) it->size[k >= n] += w->start[k] * w->start[k];
    for (int k = 0; k < 2; k++) it->size[k] += moved[k];
    it->a.columns = g->table.r;
    it->a.u = w->u;
    if (warm) it->rate = fmax(LEAST, 2.0 * dm_stage_memory_rate(g));
}

/* until what is left is round-off, or as many sweeps as the rule says after a warm start */
static dm_status iterate(iteration *it, double tolerance, int warm) {
    const int fixed = warm ? it->g->sweeps.count : 0;
    evaluate(it->g);
    for (int k = 1; !fixed && k < MOST; k++) {
        sweep(it);
        if (!isfinite(it->change)) return DM_NOT_FINITE;
        if (it->change == 0.0) return DM_OK;
        if (it->measured && it->rate > SLOW) return DM_NO_CONVERGENCE;
        if (left(it) <= LEFT * tolerance) return DM_OK;
    }
    for (int k = 1; k < fixed; k++) sweep(it);
    return fixed ? DM_OK : DM_NO_CONVERGENCE;
}

/* all pivots of the mass matrix are positive, so that its elimination was exact to round-off */
static int is_regular(const dm_stage *g) {
    const dm_stage_sweeps *w = &g->sweeps;
    const uint32_t n = g->n, width = w->row->width;
    for (uint32_t k = 2 * n; k < 3 * n && !g->separable; k++)
        for (uint32_t l = 0; l < g->table.r; l++)
            if (!(w->out[k * width + l] > 0.0)) return 0;
    return 1;
}

/* q1 = q0 + h v0 + sum mean_m u_m, p1 = p0 + sum b_m L_q(m); Hamilton: both with b */
static dm_status finish(iteration *it) {
    dm_stage *g = it->g;
    const dm_stage_sweeps *w = &g->sweeps;
    const uint32_t n = g->n;
    it->a.top = g->separable ? w->mean_top : w->b_top;
    it->a.rest = g->separable ? w->mean_rest : w->b_rest;
    w->row->collect(w->total, &it->a);
    if (g->separable) {
        for (uint32_t k = 0; k < n; k++) w->total[k] += g->h * g->v0[k];
        it->a.u = w->out;
        it->a.top = w->b_top;
        it->a.rest = w->b_rest;
        w->row->collect(w->total + n, &it->a);
    }
    return dm_stage_update(g, w->total, w->total + n);
}

dm_status dm_stage_sweep(dm_stage *g, dm_stepper *stepper) {
    iteration it = {.g = g, .change = 1.0, .rate = SLOW};
    dm_status status = DM_OK;
    if (g->separable)
        status =
            dm_legendre_inverse(g->m, g->v0, g->state, g->state + g->n, g->t, g->scratch);
    if (status != DM_OK) return status;
    const int warm = dm_stage_memory_fits(g);
    prepare(&it);
    status = iterate(&it, stepper->tolerance, warm);
    stepper->report.iterations = it.count;
    if (status == DM_OK && !is_regular(g)) status = DM_NO_CONVERGENCE;
    if (status == DM_OK) status = finish(&it);
    if (status != DM_OK) return status;
    const double missed = left(&it) * sqrt(it.size[!g->separable]);
    stepper->report.residual = g->separable ? dm_stage_momentum(g, missed) : missed;
    dm_stage_memory_keep(g, it.measured ? it.rate : dm_stage_memory_rate(g));
    return DM_OK;
}
