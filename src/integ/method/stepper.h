/* stepper.h - what makes steps: an engine, a constant of functions that a family of rules shares,
 * and the stepper that it works on, opened for one rule on one model. */
#ifndef DM_STEPPER_H
#define DM_STEPPER_H

#include "base/status.h"
#include "integ/method/rule.h"
#include "mech/model.h"

/* Of the steps so far whose length their energy chose. */
typedef struct {
    long steps, fallbacks; /* all, and those that no length gave the energy */
    double energy;         /* that they are to have */
    double defect;         /* largest |E_d - energy| */
    double least, largest; /* h */
    double conditioning;   /* largest round-off of h */
} dm_energy_report;

/* What is known of a step that failed, beside its status. */
typedef struct {
    double turn;   /* rad: it left its chart, which is all there is to say; 0: it did not */
    double at;     /* where constraints cross: the time of that place */
    int dependent; /* constraints lose rank: one that depends on those before it, from 1 */
    int outside;   /* Newton's method met the edge of the domain of L */
    int crosses;   /* that one crosses others inside of the step (mech/crossing.h) */
    int fading;    /* p0 was about to determine no q1 any more */
} dm_trouble;

/* What is known of the steps made so far. */
typedef struct {
    int iterations;             /* Newton iterations of the last step */
    double residual;            /* of the last step equation, max norm, units of momentum */
    long solves;                /* step equations solved so far */
    long newton;                /* Newton iterations so far */
    long matrices;              /* of these, those that took a matrix and its factors anew */
    long evaluations;           /* kernel evaluations so far */
    long substeps;              /* so far, of engines that choose them */
    int plain;                  /* sums are made without compensation, as was asked for */
    long operations;            /* of a step, where the engine makes kernels of its own */
    double constraint, rolling; /* largest |g|, |phi| at the ends of steps so far */
    dm_trouble trouble;         /* of the last step */
    dm_energy_report sem;
    double condition; /* number of the step equation, where it is worth telling; 0: not */
    double defect;    /* largest |p1 - L_v| at the ends of curves, over |L_v|, where it is told */
    double drift; /* largest |H - H of the start| over the largest v . L_v, where it is watched */
} dm_report;

typedef struct dm_stepper dm_stepper;

/* Members of an ensemble side by side in the lanes of vector registers, several groups of them. */
typedef struct {
    uint32_t lanes, groups;
    uint32_t together;    /* groups is a multiple of it; 0 is 1 */
    double *state;        /* [groups][dm_state_size][lanes] */
    double *params;       /* [groups x lanes][params of the model], by member */
    double *kept, *alone; /* room for all states once more, for one */
    int paced;            /* members of an autonomous model may have steps of their own */
    /* numbers that the engine has made of h and of the parameters for all bursts to come; 0: it
     * has none, or h or parameters are others than in the burst before */
    size_t told;
    /* engines with a `memory`: [groups][memory_size][lanes] what members leave to their next
     * step, and what has become of members, [groups x lanes]: DM_OK, or why a step failed after
     * so many of a burst, and what is known of it. NULL: neither */
    double *memory;
    size_t memory_size;
    dm_status *failed;
    dm_trouble *trouble;
    long *done;
} dm_lanes;

/* How a family of rules steps. What differs from rule to rule it reads from the row of the rule
 * (method.h). Of the functions only wants, work, open and step must be there. */
typedef struct dm_engine {
    int hamiltonian; /* it steps DM_HAMILTONIAN models, too */
    int spheres;     /* it steps fields of unit vectors (sphere of a model), too */
    int works;       /* it steps fields with forces beside L (worked of a model), too */
    /* the engine that steps such a model: this one, or another that serves it better */
    const struct dm_engine *(*choose)(const dm_rule *rule, const dm_model *m);
    /* NULL when the rule can step the model, else a static sentence */
    const char *(*fits)(const dm_rule *rule, const dm_model *m);
    /* does a step of the rule keep every quadratic invariant of an H (HLW IV.2)? NULL: no */
    int (*keeps_quadratic)(const dm_rule *rule, const dm_model *m);
    /* DM_WANT_*; may depend on m->structure */
    unsigned (*wants)(const dm_rule *rule, const dm_model *m);
    size_t (*work)(const dm_rule *rule, const dm_model *m); /* doubles of workspace */
    /* tables and matrices into s->work; the kernels it makes are left to the model (cache.h) */
    dm_status (*open)(dm_stepper *s);
    /* before the first step, at time t: set what the state carries beside q and p, forget what
     * steps have left; steps of h are those that will find something (see memory) */
    dm_status (*start)(dm_stepper *s, double *state, double t, double h);
    /* engines with a time of their own: dt/dh at a state */
    double (*pace)(const dm_stepper *s, const double *state);
    /* one step of length h, in place; on failure the state is unchanged. h may be another one at
     * every call: what is made for an h is made anew when another one comes */
    dm_status (*step)(dm_stepper *s, double *state, double t, double h);
    /* as `count` calls of step, same bits, *done counted also on failure; NULL: a loop does it */
    dm_status (*advance)(dm_stepper *s, double *state, double t, double h, long count, long *done);
    /* doubles inside work that a step leaves to the next one beside the state, and where they
     * are: from the state and these a run goes on bit for bit */
    size_t (*memory)(dm_stepper *s, double **place);
    int keyed; /* memory says of which states it is: steps on the side need not put it away */
    /* numbers of its own that the engine has at a state beside q, p: `count` of them from `first`
     * on; NULL: none */
    void (*parts)(const dm_stepper *s, double *out, const double *state, double t, uint32_t first,
                  uint32_t count);
    /* impulses that the constraints gave the momentum in the last step, at the constraint points
     * from its start to its end: out[points][constraints] in units of momentum, the multipliers
     * of the rows of the reactions. Two steps meet at a node, where the discrete equations have
     * the sum of both. Points: dm_constrained_nodes, or without a basis both ends */
    void (*impulses)(const dm_stepper *s, double *out);
    /* kernels for as many lanes as there can be, after open; *x in the model's arena. 0: none */
    int (*widen)(dm_stepper *s, dm_lanes *x);
    /* as `advance` for every member, same bits, with steps h[groups x lanes] by member, all the
     * same where x->paced is 0; what fails has a state that is not finite, and stays so, or where
     * x->failed is there says so and keeps its last good state, and lanes that have failed are
     * left alone */
    void (*advance_lanes)(dm_stepper *s, dm_lanes *x, double t, const double *h, long count);
    /* why a step from this state failed and what to try, a static sentence; NULL is the general
     * advice */
    const char *(*why)(dm_stepper *s, const double *state, dm_status status);
    /* D[2n*2n], the exact derivative in (q, p) of the step h from `state`, where the engine has one
     * of its own, and the doubles of memory for it (0: not on this model); NULL: prolong L */
    size_t (*tangent_work)(const dm_stepper *s);
    dm_status (*tangent)(dm_stepper *s, double *D, const double *state, double t, double h,
                         double *memory);
    void (*close)(dm_stepper *s); /* gives back what open took outside the workspace (GSL) */
} dm_engine;

/* State of a run: q[n], p[n], the low-order parts of both (compensated sums), zero at the start;
 * then, for engines with a time of their own and zero for all others: t, its low-order part, the
 * binding energy -E. */
enum { DM_STATE_OWN = 3 };
static inline size_t dm_state_size(uint32_t n) {
    return 4 * (size_t)n + DM_STATE_OWN;
}

struct dm_stepper {
    const dm_engine *engine; /* set by dm_stepper_open */
    const dm_model *model;
    const dm_rule *rule;
    /* q1[n] that the first step leads to, of a start from two positions; NULL: not known */
    const double *toward;
    const struct dm_solvers *solvers; /* a loaded library (linalg/sparse/solvers.h), or NULL */
    int threads;                      /* of one step, where the engine has such; 0: one */
    int plain; /* sums without compensation are asked for; report.plain: they are had */
    /* the caller's promise, for the next call alone: the state is what the last one left, and
     * this stepper has done nothing else since */
    int goes_on;
    double tolerance; /* Newton: relative, 4e-15 unless the user says otherwise */
    int max_iterations;
    const double *params; /* [params of the model] */
    const double *energy; /* that steps are to have (DM_BY_ENERGY); NULL: that of the first one */
    const void *brought;  /* what a run brings for a rule that is DM_OF_FUNCTIONS, else NULL */
    double *work;         /* as many doubles as engine->work says */
    void *outside;        /* what close gives back */
    double *aside;        /* room for `memory` during a step on the side (run/interpolate.h) */
    dm_report report;
};

/* Choose the engine and open; start, memory (0: none), close of it, where it has them. */
dm_status dm_stepper_open(dm_stepper *s);
dm_status dm_stepper_start(dm_stepper *s, double *state, double t, double h);
size_t dm_stepper_memory(dm_stepper *s, double **place);
void dm_stepper_close(dm_stepper *s);

/* `count` steps of h from time t; *done is the number finished, also on failure. */
dm_status dm_advance(dm_stepper *s, double *state, double t, double h, long count, long *done);

/* The same by `step` alone: an explicit engine that looks for NaN only at the end of a burst
 * does the burst again this way, to find the step and to stop before it. */
dm_status dm_advance_by_step(dm_stepper *s, double *state, double t, double h, long count,
                             long *done);

/* True when no entry of the state is NaN or infinite. */
int dm_state_is_finite(const double *state, uint32_t n);

#endif
