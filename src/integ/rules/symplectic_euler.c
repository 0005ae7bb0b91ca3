/* symplectic_euler.c - Ld = h L(q0, v) or h L(q1, v) with v = (q1 - q0)/h. */
#include "integ/split/splitting.h"
#include "integ/stage/stage.h"

#include <string.h>

/* a: L at q0, kick then drift; b: L at q1, drift then kick */
static int takes_end(const dm_rule *rule) {
    return rule->count && strcmp(rule->arg[0].rule->name, "b") == 0;
}

static const char *check(const dm_rule *rule) {
    const dm_rule *side = rule->count == 1 ? rule->arg[0].rule : NULL;
    if (!rule->count) return NULL;
    if (!side || side->count || strlen(side->name) != 1 || !strchr("ab", side->name[0]))
        return "symplectic-euler is written alone (then it is a), or with a or b";
    return NULL;
}

/* one velocity, one point at an end */
static void basis(dm_galerkin *g, const dm_rule *rule) {
    *g = (dm_galerkin){.s = 1, .node = {0.5L}, .q = {.r = 1, .b = {1.0L}}};
    g->q.c[0] = takes_end(rule) ? 1.0L : 0.0L;
}

/* a table that begins with a kick takes its force from the end of the step before: a drift of
 * length zero comes first */
static int splitting(dm_splitting *out, const dm_rule *rule) {
    static const dm_splitting kick_drift = {2, {0.0, 1.0, 0.0}, {0.0, 1.0}};
    static const dm_splitting drift_kick = {1, {0.0, 1.0}, {1.0}};
    if (out) *out = takes_end(rule) ? drift_kick : kick_drift;
    return 1;
}

const dm_method dm_method_symplectic_euler = {
    .name = "symplectic-euler",
    .aliases = "euler",
    .signature = "symplectic-euler[(a|b)]",
    .doc = "Symplectic Euler, order 1: a takes L at the start of the step (kick, then drift), b at "
           "its end (drift, then kick); one force a step when L = T(v) - V(q, t), else n unknowns; "
           "b is the adjoint of a (HLW I.1.9, VI.3.1).",
    .orders = "1",
    .stages = "1",
    .cost = "1 force; else n unknowns",
    .instances = "symplectic-euler(a):1:1; symplectic-euler(b):1:1",
    .traits = DM_SYMPLECTIC | DM_FORCED,
    .check = check,
    .engine = &dm_engine_stage,
    .basis = basis,
    .splitting = splitting,
};
