/* stage_sweep.c - the step of a stage method by fixed-point sweeps with all stages in lanes:
 *   S <- base + h^2 A M^-1 L_q(q0 + S)          for L = T(v) - V(q, t), constant mass,
 *   S <- h a V(q0 + S, p0 + h a L_q(q0 + S, V))  for Gauss collocation, where V(q, p) solves
 * p = L_v. The first S comes from the polynomial through the forces of the step before
 * (HLW VIII.6.1). Sweeps end when what the last one leaves is below round-off of the sums. What
 * the coefficients lack as doubles is added to the bases once, from a u that is near enough to
 * the last one. */
#include "integ/stage/sweep/stage_sweep.h"
#include "integ/stage/workspace/stage_limits.h"

#include <math.h>
#include <string.h>

/* ---- evaluation ---- */

/* `lanes` of each of so many entries, that are so far apart there and here. Four lanes are in
 * vectors. Speed: P3 by gauss(5) to gauss(8) where registers hold four stages */
static void copy_lanes(double *to, const double *from, uint32_t to_width, uint32_t from_width,
                       uint32_t lanes, uint32_t entries) {
    enum { FOUR = 4 };
    for (uint32_t i = 0; i < entries; i++, to += to_width, from += from_width) {
        if (lanes == FOUR)
            memcpy(to, from, FOUR * sizeof *to);
        else
            memcpy(to, from, lanes * sizeof *to);
    }
}

/* some lanes at a time through copies */
void dm_stage_apply_some(const dm_stage_kernel *k, uint32_t width, uint32_t stages) {
    const uint32_t lanes = k->lanes;
    for (uint32_t first = 0; first < stages; first += lanes) {
        copy_lanes(k->some_in, k->in + first, lanes, width, lanes, k->inputs);
        dm_kernel_eval(&k->kernel, k->some_in, k->some_out);
        copy_lanes(k->out + first, k->some_out, width, lanes, lanes, k->outputs);
    }
}

/* u = M^-1 out */
static void divide_by_mass(const dm_stage *g) {
    const dm_stage_sweeps *w = g->sweeps;
    const uint32_t n = g->n, width = w->row->width;
    const double *factor = g->m->inverse_mass;
    memset(w->u, 0, n * width * sizeof *w->u);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++, factor++)
            for (uint32_t l = 0; l < width; l++)
                w->u[i * width + l] += *factor * w->force.out[j * width + l];
}

const double *dm_stage_sweeps_u(const dm_stage *g) {
    const dm_stage_sweeps *w = g->sweeps;
    if (!g->separable) return w->velocity.out; /* among the arguments of the force */
    return g->m->structure & DM_DIAGONAL_MASS ? w->force.out : w->u;
}

/* ---- the iteration ---- */

typedef struct {
    dm_stage *g;
    dm_stage_sweeps *w;
    int measured; /* what sweeps change is looked at */
    int settled;  /* the bases are whole */
    int rated;    /* the rate is of this step */
    int count;    /* sweeps */
    /* all squared: of positions and momenta, and 1 over their size */
    double size[2], least[2], scale[2], moved[2]; /* least: of a row, but zero */
    double change; /* of the sums by the last sweep, relative; below DM_SWEEP_CLEAN as foretold */
    double rate;   /* by which it shrinks: of this step, or of the one before with a margin */
} iteration;

static inline double move(const iteration *it, const dm_sweep *a) {
    if (it->measured) return it->w->row->move(a);
    it->w->row->put(a);
    return 0.0;
}

/* forces at the stages, and the velocities that follow from them */
static inline void evaluate(iteration *it, int first) {
    dm_stage *g = it->g;
    dm_stage_sweeps *w = it->w;
    const uint32_t width = w->row->width;
    dm_stage_apply(&w->force, width, g->table.r);
    g->evaluations += g->table.r;
    if (!g->separable) {
        dm_stage_apply(&w->factors, width, g->table.r);
        it->moved[1] = first ? w->row->set(&w->p, w->unit + g->n, it->least + 1) : move(it, &w->p);
        dm_stage_apply(&w->velocity, width, g->table.r);
    } else if (!(g->m->structure & DM_DIAGONAL_MASS)) {
        divide_by_mass(g);
    }
}

/* error left in the sums, squared; what it does to momenta, h L_qq of it, may be as large */
static double left(const iteration *it) {
    return it->rate * it->change;
}

/* what the coefficients lack, into the bases */
static void settle(iteration *it) {
    const dm_stage_sweeps *w = it->w;
    w->row->put(&w->q_rest);
    if (!it->g->separable) w->row->put(&w->p_rest);
    it->settled = 1;
}

/* one sweep: new positions from the velocities, forces and velocities there */
static void sweep(iteration *it) {
    const double before = it->change;
    it->moved[0] = move(it, &it->w->q);
    if (it->measured) it->change = dm_sweep_relative(it->moved, it->scale);
    evaluate(it, 0);
    if (before <= DM_SWEEP_CLEAN && it->change <= 100.0 * DM_SWEEP_CLEAN) {
        it->change = it->rate * before;
    } else if (it->measured && it->count > 0) {
        it->rate = it->change / before;
        it->rated = 1;
    }
    it->count++;
}

/* the first positions and velocities: u of the step before, continued, or a straight line */
static void set_off(iteration *it, int warm) {
    dm_stage *g = it->g;
    dm_stage_sweeps *w = it->w;
    const uint32_t n = g->n, width = w->row->width;
    const double *low = g->group.state + 2 * n, *v = g->separable || !warm ? g->points.v0 : w->none;
    w->row->line(w->base, low, v, &w->line, n);
    w->ahead.u = warm ? w->v_ahead.u : w->none;
    it->size[0] = w->row->set(&w->ahead, w->unit, it->least);
    if (g->separable) return;
    if (!warm) w->row->line(w->base, low, w->none, &w->line, n);
    w->row->line(w->lift, low + n, w->none, &w->line, n);
    if (warm) w->row->put(&w->v_ahead);
    for (uint32_t k = 0; k < n && !warm; k++)
        for (uint32_t l = 0; l < width; l++) w->v_ahead.x[k * width + l] = g->points.v0[k];
}

/* bases and times of the stages, arguments of the first sweep */
static void prepare(iteration *it, int warm) {
    dm_stage *g = it->g;
    dm_stage_sweeps *w = it->w;
    const uint32_t n = g->n, width = w->row->width;
    double *time = w->force.in + 2 * n * width;
    if (!(g->m->structure & DM_AUTONOMOUS))
        for (uint32_t l = 0; l < width; l++) time[l] = g->group.t + w->after[l];
    w->q.start = w->ahead.start = g->group.state;
    w->p.start = g->group.state + n;
    set_off(it, warm);
    if (warm) it->rate = fmax(DM_SWEEP_LEAST, 4.0 * w->memory[DM_SWEPT_RATE]);
}

/* do its rows count by their own sizes? */
static inline void judge(const iteration *it, dm_sweep *a, uint32_t part) {
    dm_stage_sweeps *w = it->w;
    const double least = w->by_all ? INFINITY : it->least[part];
    dm_sweep_judge(a, w->unit + part * it->g->n, it->size[part], least);
}

/* the first one, which tells what changes are compared with */
static void evaluate_first(iteration *it) {
    dm_stage_sweeps *w = it->w;
    judge(it, &w->q, 0);
    evaluate(it, 1);
    it->size[1] = it->g->separable ? 0.0 : it->moved[1];
    if (!it->g->separable) judge(it, &w->p, 1);
    for (int k = 0; k < 2; k++) it->scale[k] = 1.0 / it->size[k];
}

/* so many evaluations after a warm start; the last change is measured for the report */
static dm_status count_out(iteration *it, int fixed) {
    evaluate_first(it);
    for (int k = 1; k < fixed; k++) {
        it->measured = k == fixed - 1;
        sweep(it);
    }
    return DM_OK;
}

/* until what is left is round-off */
static dm_status iterate(iteration *it, double tolerance) {
    const double enough = DM_SWEEP_LEFT * tolerance;
    evaluate_first(it);
    for (int k = 1; k < DM_STAGE_SWEEPS; k++) {
        const int settled = it->settled;
        if (!settled && it->change < DM_SWEEP_SETTLED) settle(it);
        sweep(it);
        if (!isfinite(it->change)) return DM_NOT_FINITE;
        if (it->rated && it->rate > (it->count > 5 ? DM_SWEEP_SLOW : 4.0)) return DM_NO_CONVERGENCE;
        if (it->settled && left(it) <= enough * enough) return DM_OK;
    }
    return DM_NO_CONVERGENCE;
}

/* all pivots of the mass matrix are positive, so that its elimination was exact to round-off */
static int is_regular(const dm_stage *g) {
    const dm_stage_sweeps *w = g->sweeps;
    const uint32_t n = g->n, width = w->row->width;
    int bad = 0;
    for (uint32_t k = 0; k < n && !g->separable; k++)
        for (uint32_t l = 0; l < g->table.r; l++) {
            const double pivot = w->factors.out[k * width + l];
            bad |= !(pivot > DM_PIVOT_LEAST && pivot < DM_PIVOT_MOST);
        }
    return !bad;
}

/* q1 = q0 + h v0 + sum mean_m u_m or q0 + h sum b_m V_m, p1 = p0 + h sum b_m L_q(m) */
static dm_status finish(dm_stage *g, const double *before) {
    dm_stage_sweeps *w = g->sweeps;
    w->end.state = g->group.state;
    if (w->row->finish(&w->end) == 0.0) return DM_OK;
    dm_stage_copy(g->group.state, before, 4 * g->n);
    return DM_NOT_FINITE;
}

/* h v0 in one pass with v0 = p over masses, or from v0 where the masses are no diagonal */
static void find_drift(const dm_stage *g, const double *factor) {
    const double *p = g->group.state + g->n;
    const double top = g->sweeps->flight.top[0], rest = g->sweeps->flight.rest[0];
    double *v0 = g->points.v0, *drift = g->sweeps->drift;
    for (uint32_t k = 0; k < g->n; k++) {
        const double v = factor ? factor[k] * p[k] : v0[k];
        v0[k] = v;
        drift[k] = top * v + rest * v;
    }
}

/* v0, and h v0 in the separable form, where a step needs them */
static dm_status find_velocity(dm_stage *g, int warm) {
    const double *q = g->group.state, *p = q + g->n;
    const int diagonal = g->separable && g->m->structure & DM_DIAGONAL_MASS;
    double *v0 = g->points.v0;
    dm_status status = DM_OK;
    if (!g->separable && warm) return DM_OK;
    if (!diagonal) {
        memset(v0, 0, g->n * sizeof *v0);
        status = dm_legendre_inverse(g->m, v0, q, p, g->group.t, g->scratch);
    }
    if (g->separable) find_drift(g, diagonal ? g->m->inverse_mass : NULL);
    return status;
}

/* the iteration from one start */
static dm_status attempt(iteration *it, dm_stage *g, const dm_stepper *stepper, int warm) {
    const int fixed = warm ? g->sweeps->count : 0;
    /* what is not set here is before it is read: zeros all over take 12 ns */
    it->g = g, it->w = g->sweeps;
    it->measured = !fixed;
    it->settled = it->rated = it->count = 0;
    it->moved[0] = it->moved[1] = 0.0;
    it->change = 1.0, it->rate = DM_SWEEP_SLOW;
    dm_status status = find_velocity(g, warm);
    if (status != DM_OK) return status;
    prepare(it, warm);
    status = fixed ? count_out(it, fixed) : iterate(it, stepper->tolerance);
    return status == DM_OK && !is_regular(g) ? DM_NO_CONVERGENCE : status;
}

/* far from its step the polynomial may leave the domain: then from a straight line */
static dm_status attempts(iteration *it, dm_stage *g, const dm_stepper *stepper, int warm) {
    const dm_status status = attempt(it, g, stepper, warm);
    return status != DM_OK && warm ? attempt(it, g, stepper, 0) : status;
}

/* The end is in the state. */
dm_status dm_stage_sweep(dm_stage *g, dm_stepper *stepper) {
    iteration it;
    dm_stage_sweeps *w = g->sweeps;
    const int warm = dm_stage_memory_fits(g);
    const double *before = warm ? w->memory + DM_SWEPT_END : g->group.next;
    if (!warm)
        dm_stage_copy(g->group.next, g->group.state, 4 * g->n); /* should the end not be finite */
    dm_status status = attempts(&it, g, stepper, warm);
    if (status != DM_OK && (w->q.unit || w->p.unit)) {
        w->by_all = 1;
        status = attempts(&it, g, stepper, warm);
        w->by_all = 0;
    }
    stepper->report.iterations = it.count;
    if (status == DM_OK) status = finish(g, before);
    if (status != DM_OK) return status;
    const double missed = sqrt(left(&it)) * sqrt(it.size[!g->separable]);
    stepper->report.residual = g->separable ? missed * w->heaviest / fabs(g->weights.h) : missed;
    dm_stage_memory_keep(g, it.rated ? it.rate : w->memory[DM_SWEPT_RATE]);
    return DM_OK;
}
