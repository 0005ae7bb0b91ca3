/* stepping.h - what a solver needs between its options and its first step. */
#ifndef DML_STEPPING_H
#define DML_STEPPING_H

#include "bind/run/bind_path.h"
#include "integ/method/method.h"
#include "run/control.h"
#include "run/inertia/inertia.h"

/* what the last run of a solver cost */
typedef struct {
    const char *backend; /* NULL: there was no run */
    long operations, steps, solves, newton, matrices, evaluations, substeps, unseen;
    double trace_ms, compile_ms, ns_per_step, condition, defect, drift;
    int constrained; /* the rest is known */
    double constraint, rolling;
} dml_last_run;

typedef struct {
    dm_rule nodes[DM_RULE_NODES];
    const dm_method *method;
    double h, tolerance;
    int max_iterations;
    int plain;   /* sums = "plain" */
    int threads; /* of a step */
    uint32_t n;
    int pair;   /* steps a discrete Lagrangian */
    int alone;  /* ... or one on a group: h is fixed, there is no energy and no velocity */
    double own; /* what tells its rule from others of that name, once it has run */
    dml_last_run last;
} dml_solver;

/* user values of dm.solver: the system, the rule as written, the backend's name or nil, the
 * dm.rule (its text is the rule) or nil, the checkpoint it starts from or nil */
enum {
    DML_SOLVER_SYSTEM = 1,
    DML_SOLVER_RULE,
    DML_SOLVER_BACKEND,
    DML_SOLVER_OBJECT,
    DML_SOLVER_START,
    DML_SOLVER_VALUES = DML_SOLVER_START
};

#define DML_SOLVER "dm.solver"

/* dm.solver{ system, rule =, h = } and system:solver{ rule =, h = }, as C functions. */
int dml_solver_new(lua_State *L);
int dml_solver_of(lua_State *L);

typedef struct {
    dml_solver *solver; /* at stack index 1; the options are at 2 */
    dml_model *model;
    int system, model_at, block_at; /* stack indices; the last: the memory of the run */
    int brought_at;                 /* and what a rule of functions brings */
    int numbers;                    /* parameters are not inputs (model_params.h) */
    dml_model *inputs; /* what the stepper steps: *model, but parameters are inputs; NULL: *model */
    double *given;     /* (q, v, t, values) of it */
    int apart;         /* a model of its own: other threads step with theirs */
    int varied;        /* parameters will have other values than the system's */
    int complete;      /* all kernels before the first step: threads cannot make any */
    int untimed;       /* what is asked has no times in it */
    unsigned wants;    /* kernels of the rule */
    dm_stepper stepper;
    double t0;
    double *x;                 /* inputs of L or Ld at the start: (q, v, t) or (q0, q1) */
    double *state;             /* dm_state_size doubles */
    double *work;              /* for the Legendre transform */
    const char *unwritten;     /* the file that ended the run, "name: why", or NULL */
    const char *unseen;        /* the column of `watch` that ended it, or NULL */
    double unseen_at;          /* the time of that row */
    int fading;                /* d2L/dv2 was about to lose a value where the run failed */
    const char *degenerate;    /* where d2L/dv2 has no inverse at the start, or NULL */
    const dm_control *control; /* of a run whose steps are chosen; NULL: all are h long */
    double *metric;            /* with constraints: inverse mass [n, n], then scratch */
} dml_stepping;

/* Trace, make the kernels and take all memory. Leaves system, model and workspace on the
 * stack. */
void dml_stepping_prepare(lua_State *L, dml_stepping *r, double t0);

/* Say where d2L/dv2 is singular to round-off, at the start of a run that failed for it; the text
 * stays on the stack. */
void dml_note_degenerate(lua_State *L, dml_stepping *r, const dm_inertia *x);

/* Push what is known of why a step from r->state failed, beyond its status; 0: nothing is, and
 * nothing was pushed. */
int dml_stepping_reason(lua_State *L, const dml_stepping *r, dm_status status);

/* Raise where numbers near r->t0 are too far apart for the steps. */
void dml_stepping_checktime(lua_State *L, const dml_stepping *r);

/* Fill in what a path says of itself; it is on top of the stack. */
void dml_stepping_describe(lua_State *L, const dml_stepping *r, dml_path *path);

/* Options at 2 with q0 and p0, as discrete mechanics writes a start, become q and p. */
void dml_stepping_names(lua_State *L);

/* Raise where the options at 2 have a quantity to carry along, `a`, and the system at `system` is
 * not on a group. */
void dml_carried(lua_State *L, int system);

/* Read the start from the options at 2, check the trace there, open the stepper. Raises
 * only before
 * the stepper holds anything. */
void dml_stepping_start(lua_State *L, dml_stepping *r);

/* Open the stepper; dml_stepping_start and dml_stepping_resume do. */
void dml_stepping_open(lua_State *L, dml_stepping *r);

/* Raise where plain sums were asked for and the opened stepper has none; it is closed then. */
void dml_stepping_checkplain(lua_State *L, dml_stepping *r);

/* Close the stepper. */
void dml_stepping_end(dml_stepping *r);

/* Leave the memory of a run that is over to the next one. */
void dml_stepping_leave(lua_State *L, const dml_stepping *r);

/* Keep what a run cost, for solver:report(). */
void dml_stepping_report(const dml_stepping *r, long steps, double seconds);

typedef struct {
    dm_control control;
    dm_hidden hidden;
} dml_run_control;

/* Field `control = { tolerance =, largest =, ends =, hidden =, negligible = }` of the options at
 * 2, for a run up to the time `until` (run_control.c). Leaves things on the stack that must
 * stay. */
dm_control *dml_control_read(lua_State *L, dml_run_control *c, const dml_stepping *r, double until);

/* Controlled steps of a run that keeps every one, `ended` by seconds or not. */
long dml_control_most(const dml_solver *s, int ended);

/* solver:run, as a C function (solver_run.c). */
int dml_solver_run(lua_State *L);

/* Raise what a run ended with: the user's own error, or a dm.failure with the path at stack
 * index `path` (0: none); DM_OK: nothing. */
void dml_solver_fail(lua_State *L, const dml_stepping *r, dm_status status, long done, int path);

/* Field `energy` of the options at 2, that all steps are to have, into *out unless that is NULL; 0:
 * it is not there. Raises where the rule does not choose its steps by it. */
int dml_stepping_energy(lua_State *L, const dml_solver *s, double *out);

/* Steps of h that cover a duration; raises when they are too many to count, and for a rule with a
 * time of its own, whose steps cover no duration that is known beforehand. */
long dml_stepping_cover(lua_State *L, const dml_solver *s, double duration, double h);

/* ---- varied parameters that are inputs of its kernels (stepping_params.c, model_params.h) ---- */

/* Let *r step the model with inputs where it can: r->inputs and its values; the stack grows by
 * what keeps them. */
void dml_stepping_inputs(lua_State *L, dml_stepping *r);

/* Push the list of names of the inputs of r->inputs. */
void dml_pushnames(lua_State *L, const dml_stepping *r);

/* True when L with inputs is L at r->state. */
int dml_stepping_agrees(dml_stepping *r);

#endif
