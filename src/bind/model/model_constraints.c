/* model_constraints.c - from constraint =, rolling =, force =, reaction = to the constraints of a
 * model. */
#include "bind/model/model_constraints.h"
#include "bind/model/space_group.h"

#include "algebra/derive.h"
#include "bind/model/model_cache.h"
#include "bind/trace/bind_root.h"

static void check_lengths(lua_State *L, const dml_model *m, int pair) {
    const uint32_t n = m->n, k = m->constraint[DML_CONSTRAINT].outputs,
                   l = m->constraint[DML_ROLLING].outputs;
    const uint32_t given = m->constraint[DML_REACTION].outputs;
    if (pair && m->constraint[DML_FORCE].graph && m->constraint[DML_FORCE].outputs != 2 * n)
        luaL_error(L,
                   "force of a discrete Lagrangian must return { F1, F2 }, %d numbers each, got %d "
                   "in "
                   "all",
                   (int)n, (int)m->constraint[DML_FORCE].outputs);
    if (!pair && m->constraint[DML_FORCE].graph && m->constraint[DML_FORCE].outputs != n)
        luaL_error(L, "force must return %d numbers, one per coordinate, got %d", (int)n,
                   (int)m->constraint[DML_FORCE].outputs);
    if (m->constraint[DML_REACTION].graph && given != l * n)
        luaL_error(L,
                   "reaction must return %d rows of %d numbers, one row per rolling constraint, "
                   "got %d numbers in all",
                   (int)l, (int)m->group.momenta,
                   (int)(m->placed ? given / n * m->group.momenta : given));
    if (m->constraint[DML_MAP].graph && m->constraint[DML_MAP].outputs != 2 * n + k + l)
        luaL_error(L,
                   "map must return %d numbers, q1, p1 and an impulse for each constraint, got %d",
                   (int)(2 * n + k + l), (int)m->constraint[DML_MAP].outputs);
    if (k + l > m->group.momenta)
        luaL_error(L, "%d constraints for %d coordinates: they leave no motion", (int)(k + l),
                   (int)m->group.momenta);
}

/* the traced function with its inputs q, v, t in the graph of all */
static const dm_node *transplant(dml_model *m, int which) {
    const dml_traced *one = m->constraint + which;
    const uint32_t n = m->n;
    if (!one->graph) return NULL;
    dm_node *with = dm_arena_take(m->arena, one->inputs * sizeof *with);
    dm_node *out = dm_arena_take(m->arena, one->outputs * sizeof *out);
    if (!with || !out) return NULL;
    const uint32_t beyond = m->constrained.holonomic + m->constrained.rolling; /* u comes behind */
    for (uint32_t i = 0; i < one->inputs; i++) {
        const int is_time = which == DML_CONSTRAINT && i == n;
        with[i] = dm_input(m->constrained.graph, is_time ? 2 * n : i > 2 * n ? i + beyond : i);
    }
    dm_transplant(m->constrained.graph, one->graph, one->out, one->outputs, with, out);
    return out;
}

/* All functions in one graph, so that they share what they have in common. */
static void join(lua_State *L, dml_model *m) {
    dm_constraints_traced *t = &m->constrained;
    const uint32_t k = m->constraint[DML_CONSTRAINT].outputs,
                   l = m->constraint[DML_ROLLING].outputs;
    const uint32_t c = m->constraint[DML_CONTROL].outputs;
    *t = (dm_constraints_traced){.n = m->n,
                                 .holonomic = k,
                                 .rolling = l,
                                 .controls = c,
                                 .forces = m->constraint[DML_FORCE].outputs};
    t->graph = dm_graph_new(m->arena, 2 * m->n + 1 + k + l + c);
    if (!t->graph) luaL_error(L, "not enough memory");
    t->g = transplant(m, DML_CONSTRAINT);
    t->phi = transplant(m, DML_ROLLING);
    t->u = transplant(m, DML_CONTROL);
    t->f = transplant(m, DML_FORCE);
    t->E = transplant(m, DML_REACTION);
    const int missing = (k && !t->g) || (l && !t->phi) ||
                        (m->constraint[DML_FORCE].graph && !t->f) || (c && !t->u) ||
                        (m->constraint[DML_REACTION].graph && !t->E);
    if (missing || dm_graph_status(t->graph) != DM_OK) luaL_error(L, "not enough memory");
    m->constraints_traced = dm_graph_size(t->graph);
}

/* Each is traced in a graph of its own first, to be compared alone. */
void dml_traceconstraints(lua_State *L, int arg, dml_model *m) {
    int any = 0;
    arg = lua_absindex(L, arg);
    for (int i = 0; i < DML_CONSTRAINT_FUNCTIONS; i++) {
        if (!dml_has_function(L, arg, i)) continue;
        const dml_signature s = dml_function_signature(m, dml_checksystem(L, arg)->pair, i);
        dml_push_constraint_function(L, arg, i);
        dml_retrace(L, lua_gettop(L), &s, m->arena, NULL, m->constraint + i);
        lua_pop(L, 1);
        if (!m->constraint[i].graph)
            luaL_error(L, "%s makes more than %d operations: too many to trace",
                       dml_functionname(i), DM_GRAPH_LIMIT);
        dml_refusenans(L, m->constraint + i, dml_functionname(i));
        any = 1;
    }
    if (!any) return;
    check_lengths(L, m, dml_checksystem(L, arg)->pair);
    join(L, m);
    m->constrained.crossings = dml_checksystem(L, arg)->crossings;
    m->constrained.prolonged = dml_checksystem(L, arg)->prolonged;
}

/* *cached is not changed. */
int dml_repeatconstraints(lua_State *L, int arg, const dml_model *cached, dm_arena *arena) {
    arg = lua_absindex(L, arg);
    for (int i = 0; i < DML_CONSTRAINT_FUNCTIONS && cached->constrained.graph; i++) {
        const dml_traced *last = cached->constraint + i;
        dml_traced now;
        if (!last->graph) continue;
        const dml_signature s = dml_function_signature(cached, dml_checksystem(L, arg)->pair, i);
        dml_push_constraint_function(L, arg, i);
        dml_retrace(L, lua_gettop(L), &s, arena, last, &now);
        lua_pop(L, 1);
        if (now.graph != last->graph) return 0;
    }
    return 1;
}

/* a discrete Lagrangian knows no time */
void dml_checkpairconstraints(lua_State *L, const dml_model *m) {
    if (m->constraints.structure & DM_CONSTRAINTS_TIMED)
        luaL_error(L, "the constraint of a discrete Lagrangian is a function of q alone: Ld(q0, "
                      "q1) knows no time");
}

/* Of an element of a group. */
static dm_status find_directions(dml_model *m) {
    dm_constraints_traced *t = &m->constrained;
    const uint32_t n = m->n, d = m->group.momenta;
    dm_node *X = dm_arena_take(m->arena, (size_t)n * d * sizeof *X);
    t->directions = X;
    t->momenta = d;
    if (!X) return DM_NO_MEMORY;
    return dm_group_directions(X, t->graph, m->group.trace + DM_TAU_EXP, n, d, m->arena);
}

/* Counts are known after this. */
void dml_buildconstraints(lua_State *L, dml_model *m) {
    const uint32_t k = m->constrained.holonomic;
    dm_status status = m->placed && k ? find_directions(m) : DM_OK;
    if (status == DM_OK) status = dm_constraints_build(&m->constraints, &m->constrained, m->arena);
    if (status != DM_OK) luaL_error(L, "constraints or force: %s", dm_status_text(status));
    const uint32_t idle = dm_constraints_idle(&m->constraints);
    if (idle < k)
        luaL_error(L,
                   "constraint %d does not depend on q: a constraint is an expression in the "
                   "coordinates that shall be zero, for instance q:dot(q) - 1",
                   (int)idle + 1);
    if (idle < k + m->constrained.rolling)
        luaL_error(L,
                   "rolling constraint %d does not depend on v (of a discrete Lagrangian: on q1): "
                   "one on "
                   "the coordinates alone goes into 'constraint'",
                   (int)(idle - k) + 1);
}

/* ---- implicit functions in them and in L ---- */

const char *dml_modeltrouble(lua_State *L, const dml_model *m) {
    const char *of_constraints = dml_roottrouble(L, m->constrained.graph);
    if (*of_constraints) return of_constraints;
    const char *of_map = dml_roottrouble(L, m->constraint[DML_MAP].graph);
    return *of_map ? of_map : dml_roottrouble(L, m->graph);
}

void dml_forgetroots(const dml_model *m) {
    if (m->graph) dm_root_forget(m->graph);
    if (m->constrained.graph) dm_root_forget(m->constrained.graph);
    if (m->constraint[DML_MAP].graph) dm_root_forget(m->constraint[DML_MAP].graph);
}
