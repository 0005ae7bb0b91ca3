/* step_inside.h - the workspace of dm.step, for its files only. */
#ifndef DM_STEP_INSIDE_H
#define DM_STEP_INSIDE_H

#include "integ/step_method.h"
#include "mech/crossing.h"

/* what a step works on, laid into the workspace of its stepper */
typedef struct {
    const dm_step_kernels *k;
    double *in;       /* [n + d + 1 + w + m + 1] */
    double *short_in; /* [n + d + 1 + w + 1] */
    double *out;      /* [m + m*m] */
    double *x;        /* [m] */
    double *scale;    /* [m] */
    double *after;    /* [n + d + 1 + w + 1] */
    double *reached;  /* [n + d + 1 + w] the state behind the step */
    double *low;      /* [2n] low-order parts of its q and p */
    double *inside;   /* what the conditions gave */
    double *watched;  /* [DM_CROSSING_WATCHED] of a step with holonomic constraints; then */
    double *places;   /* [PLACES][2 + n + d + w] */
    const dm_step_row *row;
    uint32_t ties; /* the last unknowns, which are impulses */
    double *newton;
    double size, first; /* of the terms of F, now and where Newton's method began */
    double h, pace;     /* that the run began with; dt/dh of the last step */
    char trouble[120];  /* why the last step failed, or "" */
} dm_made_step;

/* numbers of (q, p, t), and with parts */
static inline size_t dm_step_states(const dm_made_step *e) {
    return e->k->n + (size_t)e->k->d + 1;
}
static inline size_t dm_step_numbers(const dm_made_step *e) {
    return dm_step_states(e) + e->k->w;
}

/* ---- step_tied.c: constraints that a step holds ---- */

/* Doubles that such a step leaves to the next one. */
static inline size_t dm_step_watched(const dm_step_row *row) {
    return row && row->holonomic ? DM_CROSSING_WATCHED : 0;
}

/* Doubles for Newton's method with so many unknowns, or for what follows it. */
size_t dm_step_scratch(const dm_model *m, size_t unknowns);

/* Of a step that was solved, to e->reached: does it go over a place where holonomic constraints
 * cross? Then DM_SINGULAR, and the report says where. */
dm_status dm_step_crosses(dm_made_step *e, dm_stepper *s, double t, double h);

/* The same of a step that was not solved, from where Newton's method ended; else `status`. */
dm_status dm_step_stuck(dm_made_step *e, dm_stepper *s, double t, double h, dm_status status);

/* What is left of the constraints at the root. */
void dm_step_report_ties(dm_made_step *e, dm_stepper *s);

#endif
