/* stage_kept.c - one factorization of the matrix for many steps, where V is nearly quadratic:
 * Newton's method with the matrix of an earlier place (Hairer & Wanner 1996, IV.8), as long as
 * increments shrink by ten at least. Where the matrix was made is part of the memory, so that a run
 * that goes on from a checkpoint has the same one. What does not converge so begins again, as it
 * would have.
 * Speed: steps, chain of 30 with small quartic forces by gauss(8): 3.9x, chain of 6 by gauss(4):
 * 2.9x, against a new matrix. */
#include "integ/stage/stage_inside.h"
#include "integ/stage/sweep/stage_sweep.h"

#include "linalg/solve/newton.h"

#include <math.h>
#include <string.h>

enum {
    MANY = 8,     /* iterations: a new matrix costs less from here on */
    PATIENCE = 16 /* steps without a kept one, where a new one served no step but its own */
};

/* [1]: steps that a place has served, 0: there is none, below: so many steps are left without one;
 * then the place itself, (q[n], t); NULL where there is no memory of this step. */
static double *memory_of(const dm_stage *g) {
    if (!g->newton.keeps || !g->sweeps || g->before.ratio > 0.0) return NULL;
    double *memory = g->sweeps->memory;
    if (memory[DM_SWEPT_STEP] != g->weights.h) return NULL;
    return memory + dm_stage_memory_size(g) - dm_stage_kept_size(g);
}

/* the factors with L_qq of one place at all points */
static dm_status factor(dm_stage *g, const double *place) {
    dm_stage_newton *w = &g->newton;
    const size_t n = g->n, width = 2 * n + 3 * n * n;
    double *curve = w->curve + w->solved[0] * width;
    if (w->factored == g->weights.h && memcmp(w->place, place, (n + 1) * sizeof *place) == 0)
        return DM_OK;
    memcpy(w->x, place, n * sizeof *place);
    memcpy(w->x + n, g->points.v0, n * sizeof *place);
    w->x[2 * n] = place[n];
    dm_kernel_eval(w->stage, w->x, curve);
    g->evaluations++;
    for (uint32_t i = 1; i < w->points; i++)
        memcpy(w->curve + w->solved[i] * width, curve, width * sizeof *curve);
    w->factored = NAN;
    const dm_status status = dm_stage_band_factor(g);
    memcpy(w->place, place, (n + 1) * sizeof *place);
    return status;
}

dm_status dm_stage_kept(dm_stage *g, const dm_newton_problem *problem, dm_newton_report *report) {
    double *memory = memory_of(g), *guess = g->before.root;
    dm_stage_newton *w = &g->newton;
    if (!memory) return DM_NO_CONVERGENCE;
    if (memory[0] < 0.0) return memory[0] += 1.0, DM_NO_CONVERGENCE;
    const int fresh = memory[0] == 0.0;
    if (fresh) {
        memcpy(memory + 1, g->group.state, g->n * sizeof *memory);
        memory[1 + g->n] = g->group.t;
    }
    memcpy(guess, w->root, problem->m * sizeof *guess);
    const dm_newton_factors factors = {w->factors, w->pivot};
    dm_status status = factor(g, memory + 1);
    if (status == DM_OK) status = dm_newton_kept(w->root, problem, &factors, g->scratch, report);
    report->jacobians = fresh;
    if (status == DM_OK) {
        memory[0] = report->iterations <= MANY ? memory[0] + 1.0 : 0.0;
        return DM_OK;
    }
    memory[0] = memory[0] <= 1.0 ? -PATIENCE : 0.0;
    memcpy(w->root, guess, problem->m * sizeof *guess);
    return status;
}
