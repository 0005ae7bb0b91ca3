/* last_run.c - what the last run of a solver cost, as solver:report() tells it. */
#include "bind/run/stepping.h"

/* Of the kernels of the constraints that a rule evaluates. */
static uint32_t constraint_operations(const dm_constraints *t, unsigned wants) {
    return (wants & DM_WANT_HOLONOMIC ? t->holonomic_kernel.operations : 0) +
           (wants & DM_WANT_ROLLING ? t->rolling_kernel.operations : 0) +
           (wants & DM_WANT_CONSTRAINT_FORCE ? t->force.operations : 0) +
           (wants & DM_WANT_FORCE_CURVE ? t->force_curve.operations : 0) +
           (wants & DM_WANT_REACTION ? t->reaction.operations : 0);
}

/* Of all kernels that a step evaluates, once each: solver:report() says it. */
static uint32_t operations(const dm_model *m, unsigned wants) {
    return (wants & DM_WANT_STAGE ? m->stage.operations : 0) +
           (wants & DM_WANT_FORCE ? m->force.operations : 0) +
           (wants & DM_WANT_SLOPE ? m->slope.operations : 0) +
           (wants & DM_WANT_PAIR ? m->pair.operations : 0) +
           (wants & DM_WANT_MAP ? m->map.operations : 0) +
           (m->constraints ? constraint_operations(m->constraints, wants) : 0);
}

void dml_stepping_report(const dml_stepping *r, long steps, double seconds) {
    const dm_report *report = &r->stepper.report;
    const long own = report->operations;
    r->solver->last =
        (dml_last_run){.backend = r->model->backend ? r->model->backend : "tape",
                       .operations = own ? own : (long)operations(&r->model->model, r->wants),
                       .trace_ms = r->model->trace_ms,
                       .compile_ms = r->model->trace_ms + r->model->compile_ms,
                       .steps = steps,
                       .ns_per_step = steps ? seconds * 1e9 / (double)steps : 0.0,
                       .newton = report->newton,
                       .evaluations = report->evaluations,
                       .substeps = report->substeps,
                       .constrained = r->model->model.constraints != NULL,
                       .constraint = report->constraint,
                       .rolling = report->rolling};
}
