/* checkpoint.h - all that a run needs to go on bit for bit, in memory and in a file. */
#ifndef DML_CHECKPOINT_H
#define DML_CHECKPOINT_H

#include "bind/run/stepping.h"

/* What tells one system from another: L at (q, p, t), or Ld at (q, p); L or Ld near q; each of the
 * functions of model_constraints.h, NaN where there is none; and all of them far from q, where the
 * motion may come to: NaN in a file of a dmlua that did not look there. */
enum {
    DML_CHECK_STATE,
    DML_CHECK_NEAR,
    DML_CHECK_FUNCTIONS,
    DML_CHECK_FAR = DML_CHECK_FUNCTIONS + DML_CONSTRAINT_FUNCTIONS,
    DML_CHECK_RULE, /* what tells a rule with data of its own; NAN as above */
    DML_CHECKS
};

/* The end of a run: state, what the rule left beside it, and which step it was. */
typedef struct {
    double t0;
    long steps; /* from t0 on: t = t0 + steps h */
    uint32_t n;
    uint32_t carried;         /* numbers of what a reduced system carries along, as it began */
    size_t memory;            /* doubles of dm_method.memory */
    double check[DML_CHECKS]; /* is it the same system? */
    int checked;    /* that is known: it is asked for when somebody wants to go on from here */
    long unfiled;   /* rows before it that its file did not take; not known in a file of it */
    double state[]; /* dm_state_size(n), memory, carried */
} dml_checkpoint;

/* Push an empty one for an open stepper: nothing can fail when it is filled. */
dml_checkpoint *dml_pushcheckpoint(lua_State *L, const dml_stepping *r);

/* carried[] of one */
static inline double *dml_checkpoint_carried(dml_checkpoint *c) {
    return c->state + dm_state_size(c->n) + c->memory;
}

/* Push what it carries along as a vector; nil where that is nothing or there is no checkpoint. */
void dml_pushcarried(lua_State *L, dml_checkpoint *c);

/* The time of its state, by the solver that goes on from it. */
double dml_checkpoint_time(const dml_checkpoint *c, const dml_solver *s);

/* Fill it with where the run is, `steps` steps after r->t0. */
void dml_checkpoint_take(dml_checkpoint *c, dml_stepping *r, long steps);

/* What it has of the system, once it is taken. */
void dml_checkpoint_check(dml_checkpoint *c, dml_stepping *r);

/* Write it to a file, by way of a new one that replaces it when it is whole. 0: not possible,
 * errno says why. */
int dml_checkpoint_write(const dml_checkpoint *c, const dml_solver *s, const char *rule,
                         const char *file);

/* Push the options of the solver of the checkpoint in a file, then the checkpoint. Raises with the
 * line of what is no whole one. */
void dml_checkpoint_read(lua_State *L, const char *file);

/* Could it be written there? 0: no, errno says why. */
int dml_checkpoint_try(const char *file);

/* Start where the checkpoint at `arg` ended: as dml_stepping_start. Raises when the system is
 * another one. */
void dml_stepping_resume(lua_State *L, dml_stepping *r, const dml_checkpoint *c);

/* path:checkpoint(file), and dm.resume. */
int dml_path_checkpoint(lua_State *L);
int dml_resume(lua_State *L);

#endif
