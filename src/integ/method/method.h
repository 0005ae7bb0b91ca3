/* method.h - a rule as data: one constant per file, one row in methods.def. What it says is read
 * by its engine (stepper.h), which it shares with the rules of its family. */
#ifndef DM_METHOD_H
#define DM_METHOD_H

#include "integ/method/stepper.h"

struct dm_galerkin;  /* stage_table.h */
struct dm_splitting; /* split/splitting.h */

enum {
    DM_SYMMETRIC = 1,
    DM_SYMPLECTIC = 2,
    DM_EXPLICIT = 4,
    DM_FOR_PAIRS = 8,        /* steps an Ld(q0, q1) */
    DM_OWN_TIME = 16,        /* h is a step of a fictitious time, t is part of the state */
    DM_FORMULA = 32,         /* its Ld(q0, q1) is a formula in L at q0, q1: nothing is solved */
    DM_HOLONOMIC = 64,       /* knows the constraints of a model: g(q, t) = 0 */
    DM_ROLLING = 128,        /* phi(q, v, t) = 0 */
    DM_FORCED = 256,         /* forces; without the trait a model that has them is refused */
    DM_LOOSE_MOMENTUM = 512, /* leaves momenta off the hidden constraint G v + g_t = 0 */
    DM_DEGENERATE = 1024,    /* steps L = alpha(q) . v - H(q), linear in v, and nothing else */
    DM_ON_GROUPS = 2048,     /* steps systems on groups (mech/group.h) */
    DM_OF_FUNCTIONS = 4096,  /* made of functions that are traced for its system (`brought`) */
    DM_BY_ENERGY = 8192,     /* chooses h by the energy of a step: a run may say which */
    DM_CONSTRAINTS = DM_HOLONOMIC | DM_ROLLING | DM_FORCED
};

typedef struct dm_method {
    const char *name;      /* the key used from Lua, without arguments */
    const char *aliases;   /* what others call it, "leapfrog, strang"; may be NULL */
    const char *signature; /* "gauss(s)", as help prints it */
    const char *doc;       /* what it is, cost per step, source with equation number */
    /* what dm.rules() says of it: order and stages as formulas, cost of a step with n
     * coordinates */
    const char *orders, *stages, *cost;
    /* "rule:stages:forces; ...": rules on which all that is measured (forces a step when
     * L = T(v) - V(q) and the rule is then explicit, 0: implicit); empty: measured elsewhere */
    const char *instances;
    unsigned traits;
    const char *parts; /* "h E_d": columns of every run, engine->parts; NULL: none, or a script's */
    const dm_engine *engine;
    const void *table; /* coefficients, as the engine reads them; NULL: it needs none */
    /* NULL when the arguments of the rule fit, else a static sentence; may be NULL itself: it takes
     * no argument */
    const char *(*check)(const dm_rule *rule);
    int (*order)(const dm_rule *rule); /* may be NULL: the number that `orders` begins with */
    /* nodes and quadrature of a stage rule, whose step has a discrete Lagrangian (s = 0: with
     * these arguments there is none); NULL: another kind */
    void (*basis)(struct dm_galerkin *out, const dm_rule *rule);
    /* kicks and drifts with which it steps L = T(v) - V(q, t), into *out unless that is NULL; 0:
     * with these arguments it has none. NULL: another kind */
    int (*splitting)(struct dm_splitting *out, const dm_rule *rule);
} dm_method;

/* NULL when the arguments of a rule fit its method, else a static sentence. */
const char *dm_rule_check(const dm_rule *rule);

/* Order of a rule whose arguments fit; 0: it is not known. */
int dm_rule_order(const dm_rule *rule);

/* The engine that steps a rule on a model. */
const dm_engine *dm_rule_engine(const dm_rule *rule, const dm_model *m);

/* NULL when the rule can step the model, else a static sentence. */
const char *dm_rule_fits(const dm_rule *rule, const dm_model *m);

/* Traits of a rule: those of its method; of a stage rule DM_SYMMETRIC is read off the
 * coefficients. */
unsigned dm_rule_traits(const dm_rule *rule);

/* The traits that the constraints of a model ask of a method: DM_HOLONOMIC, DM_ROLLING,
 * DM_FORCED; 0 without constraints. */
unsigned dm_method_needs(const dm_model *m);

#endif
