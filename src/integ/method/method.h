/* method.h - what every integrator is: one constant of this type per file, one row in
 * methods.def. */
#ifndef DM_METHOD_H
#define DM_METHOD_H

#include "base/status.h"
#include "integ/method/rule.h"
#include "mech/model.h"

typedef struct {
    int iterations;             /* Newton iterations of the last step */
    double residual;            /* of the last step equation, max norm, units of momentum */
    long solves;                /* step equations solved so far */
    long newton;                /* Newton iterations so far */
    long evaluations;           /* kernel evaluations so far */
    int plain;                  /* sums are made without compensation, as was asked for */
    long operations;            /* of a step, where the method makes kernels of its own */
    double constraint, rolling; /* largest |g|, |phi| at the ends of steps so far */
    /* of a step that failed since constraints lose rank: one that depends on those before it, from 1 */
    int dependent;
} dm_report;

typedef struct dm_stepper dm_stepper;
struct dm_galerkin; /* stage.h */

/* Members of an ensemble side by side in the lanes of vector registers, several groups of them. */
typedef struct {
    uint32_t lanes, groups;
    uint32_t together;    /* groups is a multiple of it; 0 is 1 */
    double *state;        /* [groups][dm_state_size][lanes] */
    double *params;       /* [groups x lanes][params of the model], by member */
    double *kept, *alone; /* room for all states once more, for one */
    int paced; /* the method steps members of an autonomous model with steps of their own */
    /* methods with a `memory`: [groups][memory_size][lanes] what members leave to their next
     * step, and what has become of members, [groups x lanes]: DM_OK, or why a step failed after
     * so many of a burst. NULL: neither */
    double *memory;
    size_t memory_size;
    dm_status *failed;
    long *done;
} dm_lanes;

enum {
    DM_SYMMETRIC = 1,
    DM_SYMPLECTIC = 2,
    DM_EXPLICIT = 4,
    DM_FOR_PAIRS = 8,  /* steps an Ld(q0, q1) */
    DM_OWN_TIME = 16,  /* h is a step of a fictitious time, t is part of the state */
    DM_KEEPS = 32,     /* open leaves the kernels it makes to the model (kept.h), or makes none */
    DM_HOLONOMIC = 64, /* knows the constraints of a model: g(q, t) = 0 */
    DM_ROLLING = 128,  /* phi(q, v, t) = 0 */
    DM_FORCED = 256,   /* forces; without the trait a model that has them is refused */
    DM_CONSTRAINTS = DM_HOLONOMIC | DM_ROLLING | DM_FORCED,
    DM_DEGENERATE = 1024,   /* steps L = alpha(q) . v - H(q), linear in v, and nothing else */
    DM_LOOSE_MOMENTUM = 512 /* leaves momenta off the hidden constraint G v + g_t = 0 */
};

typedef struct dm_method {
    const char *name;      /* the key used from Lua, without arguments */
    const char *signature; /* "gauss(s)", as help prints it */
    const char *doc;       /* what it is, cost per step, source with equation number */
    /* what dm.rules() says of it: order and stages as formulas, cost of a step with n coordinates */
    const char *orders, *stages, *cost;
    /* "rule:stages:forces; ...": rules on which all that is measured (forces a step when
     * L = T(v) - V(q) and the rule is then explicit, 0: implicit); empty: measured elsewhere */
    const char *instances;
    unsigned traits;
    /* NULL when the arguments of the rule fit, else a static sentence */
    const char *(*check)(const dm_rule *rule);
    /* NULL when the rule can step the model, else a static sentence; may be NULL itself: any
     * model */
    const char *(*fits)(const dm_rule *rule, const dm_model *m);
    int (*order)(const dm_rule *rule);
    /* nodes and quadrature of a stage method (stage.h), whose step has a discrete Lagrangian;
     * NULL: another kind */
    void (*basis)(struct dm_galerkin *out, const dm_rule *rule);
    /* DM_WANT_*; may depend on m->structure */
    unsigned (*wants)(const dm_rule *rule, const dm_model *m);
    size_t (*work)(const dm_rule *rule, const dm_model *m); /* doubles of workspace */
    dm_status (*open)(dm_stepper *s);                       /* tables and matrices into s->work */
    /* before the first step, at time t: set what the state carries beside q and p, forget what
     * steps have left; steps of h are those that will find something (see memory). NULL: nothing */
    dm_status (*start)(dm_stepper *s, double *state, double t, double h);
    /* methods with a time of their own: dt/dh at a state */
    double (*pace)(const dm_stepper *s, const double *state);
    /* one step of length h, in place; on failure the state is unchanged. h may be another one at
     * every call: what is made for an h is made anew when another one comes */
    dm_status (*step)(dm_stepper *s, double *state, double t, double h);
    /* as `count` calls of step, same bits, *done counted also on failure; NULL: dm_advance loops */
    dm_status (*advance)(dm_stepper *s, double *state, double t, double h, long count, long *done);
    /* doubles inside work that a step leaves to the next one beside the state, and where they
     * are: from the state and these a run goes on bit for bit; NULL: none */
    size_t (*memory)(dm_stepper *s, double **place);
    /* impulses that the constraints gave the momentum in the last step, at the constraint points from its
     * start to its end: out[points][constraints] in units of momentum, the multipliers of the rows of
     * the reactions. Two steps meet at a node, where the discrete equations have the sum of
     * both. Points: dm_constrained_nodes, or without a basis both ends. NULL: it keeps none */
    void (*impulses)(const dm_stepper *s, double *out);
    /* kernels for as many lanes as there can be, after open; *x in the model's arena. 0: no
     * lanes; NULL: never */
    int (*widen)(dm_stepper *s, dm_lanes *x);
    /* as `advance` for every member, same bits, with steps h[groups x lanes] by member, all the same
     * where x->paced is 0; what fails has a state that is not finite, and
     * stays so, or where x->failed is there says so and keeps its last good state, and lanes
     * that have failed are left alone */
    void (*advance_lanes)(dm_stepper *s, dm_lanes *x, double t, const double *h, long count);
    /* why a step from this state failed and what to try, a static sentence; NULL, or gives it:
     * the general advice */
    const char *(*why)(dm_stepper *s, const double *state, dm_status status);
    void (*close)(dm_stepper *s); /* what open took outside the workspace (GSL); may be NULL */
} dm_method;

/* State of a run: q[n], p[n], the low-order parts of both (compensated sums), zero at the start;
 * then, for methods with a time of their own and zero for all others: t, its low-order part, the
 * binding energy -E. */
enum { DM_STATE_OWN = 3 };
static inline size_t dm_state_size(uint32_t n) {
    return 4 * (size_t)n + DM_STATE_OWN;
}

struct dm_stepper {
    const dm_method *method;
    const dm_model *model;
    const dm_rule *rule;
    /* q1[n] that the first step leads to, of a start from two positions; NULL: not known */
    const double *toward;
    int plain; /* sums without compensation are asked for; report.plain: they are had */
    /* the caller's promise, for the next call alone: the state is what the last one left, and
     * this stepper has done nothing else since */
    int goes_on;
    double tolerance; /* Newton: relative, 4e-15 unless the user says otherwise */
    int max_iterations;
    const double *params; /* [params of the model] */
    double *work;         /* method->work doubles */
    void *outside;        /* what close gives back */
    double
        *aside; /* room for `memory` while a side step is taken (run/interpolate.h); NULL: none */
    dm_report report;
};

/* The traits that the constraints of a model ask of a method: DM_HOLONOMIC, DM_ROLLING, DM_FORCED; 0
 * without constraints. */
unsigned dm_method_needs(const dm_model *m);

/* `count` steps from time t; *done is the number finished, also on failure. */
dm_status dm_advance(dm_stepper *s, double *state, double t, double h, long count, long *done);

/* The same by `step` alone: an explicit method that looks for NaN only at the end of a burst
 * does the burst again this way, to find the step and to stop before it. */
dm_status dm_advance_by_step(dm_stepper *s, double *state, double t, double h, long count,
                             long *done);

/* True when no entry of the state is NaN or infinite. */
int dm_state_is_finite(const double *state, uint32_t n);

#endif
