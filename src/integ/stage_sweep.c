/*
** stage_sweep.c - the step of a stage method by fixed-point sweeps with all stages in lanes:
**   S <- base + h^2 A M^-1 L_q(q0 + S)                      for L = T(v) - V(q, t), constant mass,
**   S <- h a V(q0 + S, p0 + h a L_q(q0 + S, V))            for Gauss collocation, where V(q, p) solves p = L_v.
** The first S comes from the polynomial through the forces of the step before (HLW VIII.6.1). Sweeps end when
** what the last one leaves is below round-off of the sums; the last ones use coefficients of two doubles.
*/
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

/* ---- evaluation ---- */

/* all stages, some lanes at a time through copies where there are fewer */
static void apply(const dm_stage_kernel *k, uint32_t width, uint32_t stages) {
    const uint32_t lanes = k->lanes;
    if (lanes == width) {
        dm_kernel_eval(&k->kernel, k->in, k->out);
        return;
    }
    for (uint32_t first = 0; first < stages; first += lanes) {
        for (uint32_t i = 0; i < k->inputs; i++)
            for (uint32_t l = 0; l < lanes; l++)
                k->some_in[i * lanes + l] = k->in[i * width + first + l];
        dm_kernel_eval(&k->kernel, k->some_in, k->some_out);
        for (uint32_t i = 0; i < k->outputs; i++)
            for (uint32_t l = 0; l < lanes; l++)
                k->out[i * width + first + l] = k->some_out[i * lanes + l];
    }
}

/* u = M^-1 out */
static void divide_by_mass(const dm_stage *g) {
    const dm_stage_sweeps *w = &g->sweeps;
    const uint32_t n = g->n, width = w->row->width;
    const double *factor = g->m->inverse_mass;
    if (g->m->structure & DM_DIAGONAL_MASS) {
        w->row->scale(w->u, factor, w->force.out, n);
        return;
    }
    memset(w->u, 0, n * width * sizeof *w->u);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++, factor++)
            for (uint32_t l = 0; l < width; l++)
                w->u[i * width + l] += *factor * w->force.out[j * width + l];
}

/* ---- the iteration ---- */

typedef struct {
    dm_stage *g;
    dm_sweep q, p;  /* positions; momenta of the general form */
    double size[2]; /* of positions and momenta, squared */
    double moved[2];
    double change; /* of the sums by the last sweep, relative; below CLEAN as foretold */
    double
        rate; /* by which it shrinks: of this step, or of the one before with a margin */
    int measured;
    int count; /* sweeps */
} iteration;

/* the coefficients for sums that changed by it->change last */
static void choose(const iteration *it, dm_sweep *a) {
    const dm_stage_sweeps *w = &it->g->sweeps;
    const int exact = it->change < EXACT;
    a->top = exact ? w->top : w->whole;
    a->rest = exact ? w->rest : NULL;
}

/* forces at the stages, and the velocities that follow from them */
static void evaluate(iteration *it) {
    dm_stage *g = it->g;
    dm_stage_sweeps *w = &g->sweeps;
    const uint32_t n = g->n, width = w->row->width;
    apply(&w->force, width, g->table.r);
    g->evaluations += g->table.r;
    if (g->separable) {
        divide_by_mass(g);
        return;
    }
    choose(it, &it->p);
    it->moved[1] = w->row->move(&it->p);
    apply(&w->velocity, width, g->table.r);
    memcpy(w->u, w->velocity.out, n * width * sizeof *w->u);
    memcpy(w->force.in + n * width, w->u, n * width * sizeof *w->u);
}

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

/* one sweep: new positions from the velocities, forces and velocities there */
static void sweep(iteration *it) {
    const double before = it->change;
    choose(it, &it->q);
    it->moved[0] = it->g->sweeps.row->move(&it->q);
    it->change = relative(it, it->moved);
    evaluate(it);
    if (before <= CLEAN && it->change <= 10.0 * CLEAN) {
        it->change = it->rate * before;
    } else if (it->count > 0) {
        it->rate = it->change / before;
        it->measured = 1;
    }
    it->count++;
}

/* what the first sweep starts from: u of the step before, continued, or a straight line */
static void set_off(iteration *it, int warm) {
    dm_stage *g = it->g;
    dm_stage_sweeps *w = &g->sweeps;
    const uint32_t n = g->n, width = w->row->width;
    const double *kept = w->memory + dm_stage_memory_size(g) - n * width;
    dm_sweep a = it->q;
    a.columns = warm ? g->table.r : 0;
    a.u = kept;
    a.top = w->ahead;
    if (!warm && !g->separable) a.base = w->base;
    it->size[0] = w->row->move(&a); /* from zero */
    if (g->separable) return;
    a.x = w->force.in + n * width; /* velocities */
    a.sum = w->u;
    a.base = w->none;
    a.top = w->further;
    a.low = a.start = w->none;
    if (warm)
        w->row->move(&a);
    else
        for (uint32_t k = 0; k < n; k++)
            for (uint32_t l = 0; l < width; l++) a.x[k * width + l] = g->v0[k];
}

/* base and time of the stages, arguments of the first sweep */
static void prepare(iteration *it, int warm) {
    dm_stage *g = it->g;
    dm_stage_sweeps *w = &g->sweeps;
    const uint32_t n = g->n, r = g->table.r, width = w->row->width;
    memcpy(w->start, g->state, 2 * n * sizeof *w->start);
    memcpy(w->low, g->state + 2 * n, 2 * n * sizeof *w->low);
    for (uint32_t l = 0; l < width; l++) {
        w->force.in[2 * n * width + l] = g->t + w->after[l];
        for (uint32_t k = 0; k < n && (g->separable || !warm); k++)
            w->base[k * width + l] = l < r ? dm_weighted(g->hc[l], g->v0[k]) : 0.0;
    }
    memset(w->sum, 0, n * width * sizeof *w->sum);
    memset(w->momentum, 0, n * width * sizeof *w->sum);
    it->q =
        (dm_sweep){.rows = n, .columns = r, .u = w->u, .start = w->start, .low = w->low};
    it->q.x = w->force.in;
    it->q.sum = w->sum;
    it->q.base = g->separable ? w->base : w->none;
    it->p = it->q;
    it->p.x = w->force.out + (w->force.outputs) * width;
    it->p.sum = w->momentum;
    it->p.base = w->none;
    it->p.u = w->force.out;
    it->p.start = w->start + n;
    it->p.low = w->low + n;
    set_off(it, warm);
    for (uint32_t k = 0; k < 2 * n; k++) it->size[k >= n] += w->start[k] * w->start[k];
    if (warm) it->rate = fmax(LEAST, 2.0 * dm_stage_memory_rate(g));
}

/* until what is left is round-off, or as many sweeps as the rule says after a warm start */
static dm_status iterate(iteration *it, double tolerance, int warm) {
    const int fixed = warm ? it->g->sweeps.count : 0;
    evaluate(it);
    it->size[1] += it->moved[1];
    for (int k = 1; !fixed && k < MOST; k++) {
        sweep(it);
        if (!isfinite(it->change)) return DM_NOT_FINITE;
        if (it->change == 0.0) return DM_OK;
        if (it->measured && it->rate > (it->count > 5 ? SLOW : 2.0))
            return DM_NO_CONVERGENCE;
        if (left(it) <= LEFT * tolerance) return DM_OK;
    }
    for (int k = 1; k < fixed; k++) sweep(it);
    return fixed ? DM_OK : DM_NO_CONVERGENCE;
}

/* all pivots of the mass matrix are positive, so that its elimination was exact to round-off */
static int is_regular(const dm_stage *g) {
    const dm_stage_sweeps *w = &g->sweeps;
    const uint32_t n = g->n, width = w->row->width;
    for (uint32_t k = n; k < 2 * n && !g->separable; k++)
        for (uint32_t l = 0; l < g->table.r; l++)
            if (!(w->velocity.out[k * width + l] > 0.0)) return 0;
    return 1;
}

/* q1 = q0 + h v0 + sum mean_m u_m or q0 + h sum b_m V_m, p1 = p0 + h sum b_m L_q(m) */
static dm_status finish(iteration *it) {
    dm_stage *g = it->g;
    const dm_stage_sweeps *w = &g->sweeps;
    const uint32_t n = g->n;
    it->q.top = g->separable ? w->mean_top : w->b_top;
    it->q.rest = g->separable ? w->mean_rest : w->b_rest;
    w->row->collect(w->total, &it->q);
    for (uint32_t k = 0; k < n && g->separable; k++) w->total[k] += g->h * g->v0[k];
    it->p.top = w->b_top;
    it->p.rest = w->b_rest;
    w->row->collect(w->total + n, &it->p);
    return dm_stage_update(g, w->total, w->total + n);
}

/* the iteration from one start */
static dm_status attempt(iteration *it, dm_stepper *stepper, int warm) {
    dm_stage *g = it->g;
    dm_status status = DM_OK;
    *it = (iteration){.g = g, .change = 1.0, .rate = SLOW};
    memset(g->v0, 0, g->n * sizeof *g->v0);
    if (g->separable || !warm)
        status =
            dm_legendre_inverse(g->m, g->v0, g->state, g->state + g->n, g->t, g->scratch);
    if (status != DM_OK) return status;
    prepare(it, warm);
    status = iterate(it, stepper->tolerance, warm);
    return status == DM_OK && !is_regular(g) ? DM_NO_CONVERGENCE : status;
}

/* far from its step the polynomial may leave the domain: then from a straight line */
dm_status dm_stage_sweep(dm_stage *g, dm_stepper *stepper) {
    iteration it = {.g = g};
    const int warm = dm_stage_memory_fits(g);
    dm_status status = attempt(&it, stepper, warm);
    if (status != DM_OK && warm) status = attempt(&it, stepper, 0);
    stepper->report.iterations = it.count;
    if (status == DM_OK) status = finish(&it);
    if (status != DM_OK) return status;
    const double missed = left(&it) * sqrt(it.size[!g->separable]);
    stepper->report.residual = g->separable ? dm_stage_momentum(g, missed) : missed;
    dm_stage_memory_keep(g, it.measured ? it.rate : dm_stage_memory_rate(g));
    return DM_OK;
}
