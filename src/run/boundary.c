#include "run/boundary.h"

#include "base/largest.h"

#include <math.h>
#include <string.h>

static const double STALLED = 1e-9; /* an increment that small may be noise */
enum { HALVINGS = 12 };

typedef struct {
    const dm_boundary *p;
    dm_band band;
    uint32_t *order, *pivot;
    double *A, *r, *dx, *trial, *scratch, *out;
} solver;

static uint32_t unknowns(const dm_boundary *p) {
    return p->sites * p->block;
}
static uint32_t inputs(const dm_boundary *p) {
    return p->window * p->block;
}

/* The band, four vectors of all unknowns, outputs of both kernels, two lists of numbers. */
size_t dm_boundary_work(const dm_boundary *p) {
    const size_t n = unknowns(p), w = inputs(p);
    const dm_band band = {.n = (uint32_t)n, .width = (uint32_t)w - 1};
    return dm_band_size(&band) + 4 * n + w + w * w + (2 * n + 1) / 2 + 1;
}

/* Unknowns keep their own order: windows make the band narrow already. */
static solver lay_out(const dm_boundary *p, double *work) {
    const uint32_t n = unknowns(p), w = inputs(p);
    solver s = {.p = p, .band = {.n = n, .width = w - 1, .stop = p->stop}};
    s.A = work;
    s.r = s.A + dm_band_size(&s.band);
    s.dx = s.r + n;
    s.trial = s.dx + n;
    s.scratch = s.trial + n;
    s.out = s.scratch + n;
    s.order = (uint32_t *)(void *)(s.out + w + (size_t)w * w);
    s.pivot = s.order + n;
    for (uint32_t i = 0; i < n; i++) s.order[i] = i;
    s.band.order = s.order;
    return s;
}

/* The largest derivative of the sum, NaN where there is one; what is given has no equation. */
static double residual(solver *s, const double *x) {
    const dm_boundary *p = s->p;
    double largest = 0.0;
    memset(s->r, 0, unknowns(p) * sizeof *s->r);
    dm_kernel_prepare(&p->slope, s->out);
    for (uint32_t k = 0; k + p->window <= p->sites; k++) {
        dm_kernel_eval(&p->slope, x + (size_t)k * p->block, s->out);
        for (uint32_t i = 0; i < inputs(p); i++) s->r[k * p->block + i] += s->out[i];
    }
    for (uint32_t i = 0; i < unknowns(p); i++) {
        if (p->given[i]) s->r[i] = 0.0;
        largest = dm_largest(largest, s->r[i]);
    }
    return largest;
}

/* the second derivatives of the sum; rows and columns of what is given are those of 1 */
static dm_status assemble(solver *s, const double *x) {
    const dm_boundary *p = s->p;
    const uint32_t w = inputs(p);
    memset(s->A, 0, dm_band_size(&s->band) * sizeof *s->A);
    dm_kernel_prepare(&p->hessian, s->out);
    for (uint32_t k = 0; k + p->window <= p->sites; k++) {
        const uint32_t at = k * p->block;
        if (p->stop && *p->stop) return DM_STOPPED;
        dm_kernel_eval(&p->hessian, x + at, s->out);
        for (uint32_t i = 0; i < w; i++)
            for (uint32_t j = 0; j < w; j++)
                if (!p->given[at + i] && !p->given[at + j])
                    s->A[dm_band_row(&s->band, at + i) + dm_band_column(&s->band, at + j)] +=
                        s->out[w + i * w + j];
    }
    for (uint32_t i = 0; i < unknowns(p); i++)
        if (p->given[i]) s->A[dm_band_row(&s->band, i) + dm_band_column(&s->band, i)] = 1.0;
    return DM_OK;
}

/* NaN where there is one. */
static double norm(const double *x, uint32_t n) {
    double largest = 0.0;
    for (uint32_t i = 0; i < n; i++) largest = dm_largest(largest, x[i]);
    return largest;
}

/* the largest part of dx that makes the residual smaller; x moves there. 0: none does */
static int search(solver *s, double *x, double *now) {
    const uint32_t n = unknowns(s->p);
    double part = 1.0;
    for (int k = 0; k < HALVINGS; k++, part *= 0.5) {
        for (uint32_t i = 0; i < n; i++) s->trial[i] = x[i] + part * s->dx[i];
        const double then = residual(s, s->trial);
        if (!(then <= (1.0 - 0.25 * part) * *now)) continue;
        memcpy(x, s->trial, n * sizeof *x);
        *now = then;
        return 1;
    }
    return 0;
}

static void add(double *x, const double *dx, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) x[i] += dx[i];
}

/* An increment that is small enough is taken without a look at the residual, which is noise there.
 */
dm_status dm_boundary_solve(double *x, const dm_boundary *p, double *work,
                            dm_boundary_report *report) {
    solver s = lay_out(p, work);
    const uint32_t n = unknowns(p);
    *report = (dm_boundary_report){.residual = residual(&s, x)};
    if (!isfinite(report->residual)) return DM_NOT_FINITE;
    while (report->iterations < p->max_iterations) {
        dm_status status = assemble(&s, x);
        if (status == DM_OK) status = dm_band_factor(s.A, s.pivot, &s.band);
        if (status != DM_OK) return status;
        for (uint32_t i = 0; i < n; i++) s.dx[i] = -s.r[i];
        dm_band_solve(s.dx, s.A, s.pivot, &s.band, s.scratch);
        report->iterations++;
        const double step = norm(s.dx, n), size = norm(x, n) + step;
        if (!isfinite(step)) return DM_NOT_FINITE;
        if (step <= p->tolerance * size) return add(x, s.dx, n), DM_OK;
        if (search(&s, x, &report->residual)) continue;
        if (step > STALLED * size) return DM_NO_CONVERGENCE;
        return DM_OK; /* what is left is noise of the residual */
    }
    return DM_NO_CONVERGENCE;
}
