/* phase_sweep.c - the stages of a step on H by fixed-point sweeps with all of them in lanes,
 *   (Q, P) <- (q0, p0) + base + h (a V, A F),  (V, F) <- field(Q, P),
 * which end, like those of stage_sweep.c, when what the last one leaves is below round-off of the
 * sums. The first stages come from the polynomials through V and F of the step before. */
#include "integ/phase/phase_inside.h"
#include "integ/stage/workspace/stage_limits.h"

#include <math.h>

typedef struct {
    dm_phase *g;
    int by_all;                /* the largest coordinate alone tells when they end */
    int measured;              /* what sweeps change is looked at */
    int settled;               /* what the coefficients lack is in the base */
    int rated;                 /* the rate is of this step */
    int count;                 /* sweeps */
    int known;                 /* the last of them that was looked at */
    double scale[2], moved[2]; /* squares, of q and p: 1 over their size, of the last change */
    double change;             /* of the sums by that one, relative, squared */
    double ratio;              /* by which it shrank, of this step */
    double rate;               /* by which it is taken to shrink: the larger of the last two ratios,
                                  which change in turns where q moves p and p moves q */
} iteration;

static void evaluate(dm_phase *g) {
    dm_stage_apply(&g->field, g->width, g->r);
    g->evaluations += g->r;
}

/* what positions and momenta moved by, relative to their size; with that of the sweep before it
 * tells the rate */
static void look(iteration *it) {
    const double before = it->change, change = dm_sweep_relative(it->moved, it->scale);
    it->change = change;
    if (it->known == it->count - 1 && it->count > 1) {
        if (before <= DM_SWEEP_CLEAN && change <= 100.0 * DM_SWEEP_CLEAN) {
            it->change = it->rate * before;
        } else {
            const double last = it->ratio;
            it->ratio = change / before;
            it->rate = it->ratio > last ? it->ratio : last;
            it->rated = 1;
        }
    }
    it->known = it->count;
}

/* One sweep. The next arguments of the field do not wait for the look at what it changed. */
static void sweep(iteration *it) {
    dm_phase *g = it->g;
    it->count++;
    for (int k = 0; k < 2; k++) {
        if (it->measured)
            it->moved[k] = g->row->move(&g->sum[k]);
        else
            g->row->put(&g->sum[k]);
    }
    evaluate(g);
    if (it->measured) look(it);
}

/* what the coefficients lack, into the bases, from a u that is near enough to the last one */
static void settle(iteration *it) {
    for (int k = 0; k < 2; k++) it->g->row->put(&it->g->rest[k]);
    it->settled = 1;
}

/* until what is left is round-off; `fixed` sweeps where their number is given */
static dm_status iterate(iteration *it, double tolerance, int fixed) {
    const double enough = DM_SWEEP_LEFT * tolerance;
    const double slow = dm_phase_slow(it->g);
    for (int k = 1; k < (fixed ? fixed : DM_PHASE_SWEEPS); k++) {
        if (!it->settled && it->change < DM_SWEEP_SETTLED) settle(it);
        it->measured = !fixed || !it->settled || k >= fixed - 2;
        sweep(it);
        if (!isfinite(it->change)) return DM_NOT_FINITE;
        if (fixed) continue;
        if (it->rated && it->ratio > (it->count > 5 ? slow : 4.0)) return DM_NO_CONVERGENCE;
        if (it->settled && it->rate * it->change <= enough * enough) return DM_OK;
    }
    return fixed ? DM_OK : DM_NO_CONVERGENCE;
}

/* times of the stages, low-order parts, and the first stages: ahead of the step before, or all at
 * the start; what moves are compared with */
static void set_off(iteration *it, int warm) {
    dm_phase *g = it->g;
    double *time = g->x + 2 * (size_t)g->n * g->width;
    for (uint32_t i = 0; i < g->r; i++) time[i] = g->t + g->after[i];
    g->row->line(g->base, g->state + 2 * g->n, g->none, &g->line, 2 * g->n);
    for (int k = 0; k < 2; k++) {
        const double *start = g->state + (k ? g->n : 0);
        g->sum[k].start = g->ahead[k].start = start;
        dm_sweep first = g->ahead[k];
        if (!warm) first.u = g->none;
        double least, *own = g->unit + (k ? g->n : 0);
        const double size = g->row->set(&first, own, &least);
        dm_sweep_judge(&g->sum[k], own, size, it->by_all ? INFINITY : least);
        it->scale[k] = 1.0 / size;
    }
}

/* the iteration from one guess; the rate of the step before is taken with a margin */
static dm_status attempt(iteration *it, const dm_stepper *stepper, int warm) {
    dm_phase *g = it->g;
    *it = (iteration){.g = g, .by_all = it->by_all, .change = 1.0, .rate = DM_SWEEP_SLOW};
    if (warm) it->rate = fmax(DM_SWEEP_LEAST, 4.0 * g->memory[DM_SWEPT_RATE]);
    set_off(it, warm);
    evaluate(g);
    return iterate(it, stepper->tolerance, warm ? g->count : 0);
}

/* Far from its step the polynomial may leave the domain: then from the start. */
static dm_status attempts(iteration *it, const dm_stepper *stepper, int warm) {
    const dm_status status = attempt(it, stepper, warm);
    return status != DM_OK && warm ? attempt(it, stepper, 0) : status;
}

dm_status dm_phase_sweep(dm_phase *g, dm_stepper *stepper) {
    iteration it = {.g = g};
    const int warm = dm_phase_memory_fits(g);
    dm_status status = attempts(&it, stepper, warm);
    if (status != DM_OK && (g->sum[0].unit || g->sum[1].unit)) {
        it.by_all = 1;
        status = attempts(&it, stepper, warm);
    }
    stepper->report.iterations = it.count;
    if (status != DM_OK) return status;
    stepper->report.residual = sqrt(it.rate * it.change / it.scale[1]);
    if (it.rated) g->memory[DM_SWEPT_RATE] = it.rate;
    return DM_OK;
}
