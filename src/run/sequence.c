#include "run/sequence.h"

#include <math.h>
#include <string.h>

enum { BURST = 64 };             /* steps between looks at the stop flag */
static const double LEFT = 1e-6; /* of the terms at the start: a residual above is no root's */

/* in: y, x; out: R, dR/dx; beyond: y' and the conditions */
typedef struct {
    const dm_sequence *r;
    double *in, *residual, *out, *after, *conditions, *scale, *newton;
    double size;  /* of the terms of R, as |dR/dx| |x| tells */
    double first; /* that size where the search began, |R| included; < 0: not known yet */
} stage;

static size_t outputs(const dm_sequence *r) {
    return r->m + (size_t)r->m * r->m;
}

/* y and x, what the kernels give, and Newton's method; x once more in front. */
size_t dm_sequence_work(const dm_sequence *r) {
    return 2 * (size_t)r->n + 3 * (size_t)r->m + outputs(r) + r->inside.outputs + r->m +
           dm_newton_work(r->m);
}

/* The start, and the last one also where `every` does not divide the steps. */
long dm_sequence_rows(const dm_sequence_plan *plan) {
    return 1 + (plan->steps + plan->every - 1) / plan->every;
}

/* Constant outputs of the kernels are written once, here. */
static stage lay_out(const dm_sequence *r, double *work) {
    stage s = {.r = r, .in = work};
    s.after = s.in + r->n + r->m;
    s.residual = s.after + r->n;
    s.out = s.residual + r->m;
    s.conditions = s.out + outputs(r);
    s.scale = s.conditions + r->inside.outputs;
    s.newton = s.scale + r->m;
    memset(s.scale, 0, r->m * sizeof *s.scale);
    dm_kernel_prepare(&r->equation, s.residual);
    dm_kernel_prepare(&r->tangent, s.out);
    dm_kernel_prepare(&r->next, s.after);
    if (r->scale.outputs) dm_kernel_prepare(&r->scale, s.scale);
    if (r->inside.outputs) dm_kernel_prepare(&r->inside, s.conditions);
    return s;
}

/* max_i sum_j |J_ij| (|x_j| + scale_j): what cancels in R is not smaller */
static double size_of_terms(const double *J, const double *x, const double *scale, uint32_t m) {
    double largest = 0.0;
    for (uint32_t i = 0; i < m; i++) {
        double sum = 0.0;
        for (uint32_t j = 0; j < m; j++) sum += fabs(J[i * m + j]) * (fabs(x[j]) + fabs(scale[j]));
        if (sum > largest) largest = sum;
    }
    return largest;
}

/* Of |x|; NaN is passed over, since dm_newton looks for it. */
static double largest_of(const double *x, uint32_t m) {
    double largest = 0.0;
    for (uint32_t i = 0; i < m; i++) largest = fmax(largest, fabs(x[i]));
    return largest;
}

/* For dm_newton. The size of the terms is renewed with every matrix. */
static dm_status residual(void *ctx, double *r, double *J, const double *x) {
    stage *s = ctx;
    const uint32_t m = s->r->m;
    memmove(s->in + s->r->n, x, m * sizeof *x);
    dm_kernel_eval(J ? &s->r->tangent : &s->r->equation, s->in, J ? s->out : s->residual);
    memcpy(r, J ? s->out : s->residual, m * sizeof *r);
    if (!J) return DM_OK;
    memcpy(J, s->out + m, (size_t)m * m * sizeof *J);
    s->size = size_of_terms(J, x, s->scale, m);
    if (s->first < 0.0) s->first = s->size + largest_of(r, m);
    return DM_OK;
}

/* NaN breaks a condition, too. */
static uint32_t first_broken(const stage *s) {
    const uint32_t count = s->r->inside.outputs;
    if (count) dm_kernel_eval(&s->r->inside, s->in, s->conditions);
    for (uint32_t i = 0; i < count; i++)
        if (!(s->conditions[i] > 0.0)) return i + 1;
    return 0;
}

/* No NaN, no infinity. */
static int finite(const double *x, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        if (!isfinite(x[i])) return 0;
    return 1;
}

/* from y in s->in to y' there */
static dm_status step(stage *s, const dm_newton_problem *problem, double *x,
                      dm_sequence_report *report) {
    const dm_sequence *r = s->r;
    dm_kernel_prepare(&r->start, x);
    dm_kernel_eval(&r->start, s->in, x);
    if (r->scale.outputs) dm_kernel_eval(&r->scale, s->in, s->scale);
    if (!finite(x, r->m)) return DM_NOT_FINITE;
    s->first = -1.0;
    const dm_status status = dm_newton(x, problem, s->newton, &report->newton);
    if (status != DM_OK) return status;
    if (report->newton.residual > LEFT * s->first) return DM_NO_CONVERGENCE;
    memcpy(s->in + r->n, x, r->m * sizeof *x);
    report->outside = first_broken(s);
    if (report->outside) return DM_NO_CONVERGENCE;
    dm_kernel_eval(&r->next, s->in, s->after);
    if (!finite(s->after, r->n)) return DM_NOT_FINITE;
    memcpy(s->in, s->after, r->n * sizeof *s->in);
    return DM_OK;
}

/* A root whose residual is far above what cancels in it is none: Newton's method stalled. */
dm_status dm_sequence_run(double *rows, const dm_sequence *r, const dm_sequence_plan *plan,
                          double *work, dm_sequence_report *report) {
    double *x = work;
    stage s = lay_out(r, work + r->m);
    const dm_newton_problem problem = {.m = r->m,
                                       .equation = residual,
                                       .ctx = &s,
                                       .size = &s.size,
                                       .place = s.scale,
                                       .places = r->m,
                                       .over = 1.0,
                                       .tolerance = plan->tolerance,
                                       .max_iterations = plan->max_iterations};
    dm_status status = DM_OK;
    *report = (dm_sequence_report){.rows = 1};
    memcpy(s.in, rows, r->n * sizeof *rows);
    while (status == DM_OK && report->done < plan->steps) {
        status = step(&s, &problem, x, report);
        if (status != DM_OK) break;
        report->done++;
        if (report->done % plan->every == 0)
            memcpy(rows + (size_t)r->n * (size_t)report->rows++, s.in, r->n * sizeof *rows);
        if (plan->stop && report->done % BURST == 0 && *plan->stop) status = DM_STOPPED;
    }
    if (report->done % plan->every != 0)
        memcpy(rows + (size_t)r->n * (size_t)report->rows++, s.in, r->n * sizeof *rows);
    return status;
}
