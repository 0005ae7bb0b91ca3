/* bind_solver.c - `dm.solver`: a system, a rule and a step; runs end in a path or a
 * dm.failure. */
#include "bind/model/space_group.h"
#include "bind/rule/bind_step.h"
#include "bind/run/bind_path.h"
#include "bind/run/checkpoint.h"
#include "bind/run/stepping.h"
#include "integ/method/lift.h"

#include <string.h>

typedef dml_solver solver;

/* The solver at stack index 1. */
static solver *check(lua_State *L) {
    return luaL_checkudata(L, 1, DML_SOLVER);
}

/* q and p of the state that a step ended in. */
static int push_state(lua_State *L, const dml_stepping *r) {
    const uint32_t momenta = dml_checksystem(L, r->system)->momenta;
    dml_pushposition(L, r->system, r->state);
    memcpy(dml_pushvector(L, momenta), r->state + r->solver->n, momenta * sizeof(double));
    return 2;
}

/* solver:step(q0, q1) -> q2 is step{ q0 =, q1 = } followed by one more */
static void options_from_pair(lua_State *L) {
    lua_newtable(L);
    lua_pushvalue(L, 2);
    lua_setfield(L, -2, "q0");
    lua_pushvalue(L, 3);
    lua_setfield(L, -2, "q1");
    lua_replace(L, 2);
    lua_settop(L, 2);
}

static int solver_step(lua_State *L) {
    static const char *const known[] = {"q", "v", "p", "q0", "q1", "p0", "t0", "project", NULL};
    dml_stepping r = {.solver = check(L), .untimed = 1};
    const int pair = lua_gettop(L) > 2;
    long done = 0;
    lua_settop(L, 3);
    if (pair) options_from_pair(L);
    lua_settop(L, 2);
    luaL_checktype(L, 2, LUA_TTABLE);
    dml_options(L, 2, known);
    dml_stepping_names(L);
    dml_stepping_prepare(L, &r, dml_number(L, 2, "t0", 0.0));
    dml_stepping_start(L, &r);
    const double h = r.solver->h;
    dm_status status = dm_stepper_start(&r.stepper, r.state, r.t0, h);
    if (status == DM_OK) status = dm_advance(&r.stepper, r.state, r.t0, h, pair ? 2 : 1, &done);
    dml_stepping_end(&r);
    dml_solver_fail(L, &r, status, done, 0);
    push_state(L, &r);
    if (!pair) return 2;
    lua_pop(L, 1);
    return 1;
}

/* Step and derivative are made from the same start, the step last. */
static int solver_step_tangent(lua_State *L) {
    static const char *const known[] = {"q", "v", "p", "t0", NULL};
    dml_stepping r = {.solver = check(L), .untimed = 1};
    const uint32_t n = r.solver->n;
    long done = 0;
    lua_settop(L, 2);
    luaL_checktype(L, 2, LUA_TTABLE);
    dml_options(L, 2, known);
    dml_stepping_prepare(L, &r, dml_number(L, 2, "t0", 0.0));
    const dm_engine *engine = dm_rule_engine(r.solver->nodes, &r.model->model);
    if (!engine->tangent)
        luaL_error(L, "solver:step_tangent: only rules of curve segments have it; solver:tangent "
                      "is for all");
    if (dm_method_needs(&r.model->model) & (DM_HOLONOMIC | DM_ROLLING))
        luaL_error(L, "solver:step_tangent: the unit vectors of (q, p) are not tangent to the "
                      "constraints of this system");
    double *D = dml_pushmatrix(L, 2 * n, 2 * n);
    const int at = lua_gettop(L);
    dml_stepping_start(L, &r);
    const double h = r.solver->h;
    dm_status status = dm_stepper_start(&r.stepper, r.state, r.t0, h);
    double *memory = lua_newuserdatauv(L, engine->tangent_work(&r.stepper) * sizeof *memory, 0);
    if (status == DM_OK) status = engine->tangent(&r.stepper, D, r.state, r.t0, h, memory);
    if (status == DM_OK) status = dm_advance(&r.stepper, r.state, r.t0, h, 1, &done);
    dml_stepping_end(&r);
    dml_solver_fail(L, &r, status, done, 0);
    lua_pushvalue(L, at);
    return 1 + push_state(L, &r);
}

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
           (wants & DM_WANT_MASS ? m->mass.operations : 0) +
           (wants & DM_WANT_POTENTIAL ? m->potential.operations : 0) +
           (wants & DM_WANT_FIELD ? m->field.operations : 0) +
           (wants & DM_WANT_FIELD_CURVE ? m->field_curve.operations : 0) +
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
                       .solves = report->solves,
                       .newton = report->newton,
                       .matrices = report->matrices,
                       .evaluations = report->evaluations,
                       .substeps = report->substeps,
                       .condition = report->condition,
                       .defect = report->defect,
                       .drift = report->drift,
                       .unseen = r->control ? r->control->unseen : 0,
                       .constrained = r->model->model.constraints != NULL,
                       .constraint = report->constraint,
                       .rolling = report->rolling};
}

/* Entry of the table on top. */
static void set_number(lua_State *L, const char *key, double x) {
    lua_pushnumber(L, x);
    lua_setfield(L, -2, key);
}

/* A whole number as an entry of the table on top. */
static void set_count(lua_State *L, const char *key, long n) {
    lua_pushinteger(L, n);
    lua_setfield(L, -2, key);
}

/* what the last run cost */
static int solver_report(lua_State *L) {
    const solver *s = check(L);
    const dml_last_run *last = &s->last;
    if (!last->backend) luaL_error(L, "no report yet: run the solver first");
    lua_createtable(L, 0, 12);
    dml_setresult(L);
    lua_getiuservalue(L, 1, DML_SOLVER_RULE);
    lua_setfield(L, -2, "rule");
    lua_pushstring(L, last->backend);
    lua_setfield(L, -2, "backend");
    set_number(L, "h", s->h);
    set_count(L, "order", dm_rule_order(s->nodes));
    set_count(L, "operations", last->operations);
    set_number(L, "trace_ms", last->trace_ms);
    set_number(L, "compile_ms", last->compile_ms);
    set_count(L, "steps", last->steps);
    set_number(L, "ns_per_step", last->ns_per_step);
    set_count(L, "solves", last->solves);
    set_count(L, "newton", last->newton);
    set_count(L, "matrices", last->matrices);
    set_count(L, "evaluations", last->evaluations);
    set_number(L, "newton_per_step",
               last->steps ? (double)last->newton / (double)last->steps : 0.0);
    if (last->substeps && last->steps)
        set_number(L, "substeps_per_step", (double)last->substeps / (double)last->steps);
    if (last->condition > 0.0) set_number(L, "condition", last->condition);
    if (last->defect > 0.0) set_number(L, "defect", last->defect);
    if (last->drift > 0.0) set_number(L, "drift", last->drift);
    if (last->unseen) set_count(L, "unseen", last->unseen);
    if (!last->constrained) return 1;
    set_number(L, "constraint", last->constraint);
    set_number(L, "rolling", last->rolling);
    return 1;
}

/* With what is known of the order of a step of one's own. */
static void push_ordered(lua_State *L, const solver *s, const char *rule, const char *system) {
    lua_getiuservalue(L, 1, DML_SOLVER_OBJECT);
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    dml_step_said(L, s->method);
    lua_pushfstring(L, "solver '%s', order %d%s, h = %f, for %s", rule, dm_rule_order(s->nodes),
                    lua_tostring(L, -1), s->h, system);
}

static int solver_tostring(lua_State *L) {
    const solver *s = check(L);
    lua_getiuservalue(L, 1, DML_SOLVER_RULE);
    const char *rule = lua_tostring(L, -1);
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    const char *system = luaL_tolstring(L, -1, NULL);
    if (s->alone) /* its order is that of Ld, which Ld:order measures */
        lua_pushfstring(L, "solver '%s', h = %f, for %s", rule, s->h, system);
    else
        push_ordered(L, s, rule, system);
    return 1;
}

/* Push which lift a rule of coordinates steps on a group; nil: none. Raises where it cannot. */
static void push_lift(lua_State *L) {
    dml_stepping r = {.solver = check(L)};
    lua_settop(L, 1);
    dml_stepping_prepare(L, &r, 0.0);
    const dm_model *m = &r.model->model;
    if (dm_rule_engine(r.solver->nodes, m) != &dm_engine_lift)
        lua_pushnil(L);
    else if (dm_lifted_model(r.solver->nodes, m) == m->group->lifted)
        lua_pushliteral(L, "collective");
    else
        lua_pushliteral(L, "homogeneous");
}

static int solver_field(lua_State *L) {
    const solver *s = check(L);
    const char *key = luaL_checkstring(L, 2);
    if (strcmp(key, "h") == 0)
        lua_pushnumber(L, s->h);
    else if (strcmp(key, "rule") == 0) {
        if (lua_getiuservalue(L, 1, DML_SOLVER_OBJECT) == LUA_TNIL)
            lua_getiuservalue(L, 1, DML_SOLVER_RULE);
    } else if (strcmp(key, "system") == 0)
        lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    else if (strcmp(key, "order") == 0)
        lua_pushinteger(L, dm_rule_order(s->nodes));
    else if (strcmp(key, "tolerance") == 0)
        lua_pushnumber(L, s->tolerance);
    else if (strcmp(key, "max_iterations") == 0)
        lua_pushinteger(L, s->max_iterations);
    else if (strcmp(key, "lift") == 0)
        push_lift(L);
    else if (strcmp(key, "backend") == 0)
        lua_getiuservalue(L, 1, DML_SOLVER_BACKEND);
    else if (strcmp(key, "own_time") == 0)
        lua_pushboolean(L, (s->method->traits & DM_OWN_TIME) != 0);
    else if (strcmp(key, "sums") == 0)
        lua_pushstring(L, s->plain ? "plain" : "compensated");
    else
        return 0;
    return 1;
}

static const dml_row meta[] = {{"__tostring", solver_tostring, NULL}, {NULL, NULL, NULL}};
static const dml_row methods[] = {
    {"run", dml_solver_run,
     "solver:run{q=, v=, p=, q0=, q1=, p0=, steps=, t=, at=, every=, t0=, project=, watch=, "
     "record=, gaps=, events=, file=, checkpoint=, energy=, most=} -> dm.path\n"
     "Run `steps` steps of h, or as many as cover the duration t, from q and v, from q and the "
     "momentum p, or from two positions q0, q1 one step apart (each dim Q numbers, in a list or "
     "by the names of coordinates, q = { x = 1, y = 0 }); keep the start, one state in `every` "
     "(default 1) and the end, or the states at the growing times `at` (by a shorter step on the "
     "side, which leaves the run as it is); t0 (default 0) is the time of the start. With "
     "constraints the start must lie on them, and its velocity be tangent: project = true moves "
     "it to the nearest such state in the metric of the mass. The Lagrangian is traced anew, so "
     "changed upvalues are picked up.\n"
     "watch = { \"q1\", \"energy\", r = function(q, v, t, p) ... end }: rows hold t and these "
     "numbers instead of q and p (a function that gives several has the columns r1, r2, ...); "
     "\"lambda\" stands for system:multipliers at the state; on groups entries of the element are "
     "watched, too (\"R33\", of factor k \"R33_k\"). record = { \"lambda\", ... }: such "
     "columns beside q and p. NaN in a column ends the run; gaps = true keeps it. "
     "record = { \"impulses\" }: multipliers of the steps, in units of "
     "momentum: what the end of one step and the start of the next give the momentum at the row, "
     "along the rows of constraint and rolling (reaction); so the first and the last row have a "
     "half of it. For rules of one stage that is the multiplier of the discrete Euler-Lagrange "
     "equations; over h it is a force to order 2; rules with s constraint intervals (gauss(s), "
     "lobatto(s + 1)) share h among the nodes of a Lobatto rule, so over 2 h / (s (s + 1)). "
     "\"inner\": those between as well, of the step that begins at the row. path.lambda[i], "
     "path.impulses[i] are vectors. file = \"rows.npy\": rows go there as they come, the path "
     "keeps the last one, failure.path those that a full disk did not take (of fields on meshes "
     "t, q and p, a row of q an array). events = { name = "
     "function(q, v, t, p) ... end } or { name = { g = f, "
     "direction = \"up\" | \"down\", stop = true } }: zeros of these functions, by steps of "
     "fitting length in between, as path.events[i] = { name, t, q, p }; stop ends the run there; "
     "a zero that is touched but not crossed, or two of one function within a step, are not seen. "
     "checkpoint = file or { file =, every = seconds }: written while it runs (every minute) and "
     "at its end, for dm.resume. energy: that the steps of sem(s, quadrature(r)) are to have, "
     "instead of that of the first. most: steps that a rule with a time of its own may take to the "
     "last of the times `at`. Raises dm.failure with the path so far when a step cannot be "
     "solved, the state stops being finite, a column is NaN, more steps are needed, or on "
     "Ctrl-C."},
    {"step", solver_step,
     "solver:step{q=, v=, p=, q0=, q1=, t0=, project=} -> q, p   or   solver:step(q0, q1) -> q2\n"
     "One step from a state, or the next position after two positions one step apart."},
    {"step_tangent", solver_step_tangent,
     "solver:step_tangent{q=, v= | p=, t0=} -> dm.matrix, q, p\n"
     "The exact derivative of one step in (q, p), 2 dim Q x 2 dim Q, by the rule itself, and the "
     "end of the step: for rules of curve segments without constraints. A choice of substeps is "
     "held. solver:tangent is for all rules and many steps."},
    {"report", solver_report,
     "solver:report() -> table\n"
     "What the last run cost: rule, order, h, backend, operations (of the kernels, per "
     "evaluation), trace_ms, compile_ms (trace to kernels), steps, ns_per_step, solves "
     "(step equations), newton (iterations), matrices (of these, those that took their matrix "
     "anew), newton_per_step, "
     "evaluations; substeps_per_step where they are chosen; condition: the "
     "condition number of the step equation of a dm.multiscale, defect: what its curves miss of "
     "the momentum at their ends, drift: of the energy, over the largest v . L_v; unseen: how "
     "often a "
     "controlled step would have jumped over something; with constraints: "
     "constraint and rolling, the largest |g| and "
     "|phi| at the end of a step."},
    {NULL, NULL, NULL}};
static int system_of(lua_State *L) {
    if (!luaL_testudata(L, 1, DML_SOLVER)) return lua_pushnil(L), 1;
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    return 1;
}

static const dml_row functions[] = {
    {"solver", dml_solver_new,
     "dm.solver{system, rule=, h=, newton={tolerance=, max_iterations=}, backend=, sums=, "
     "threads=} -> dm.solver\n"
     "A solver for a dm.system (rule and h needed: see dm.rules()) or a dm.discrete_lagrangian "
     "(which has its own h; rule \"del\"), or of anything else with a method solver. "
     "newton.tolerance: relative increment at which Newton "
     "stops, 4e-15 unless a looser one is asked for. sums = \"plain\": kicks and drifts without "
     "compensation, for wide ensembles and long chains: fewer operations, and round-off that "
     "grows faster (default \"compensated\"). threads: of a step, of fields on meshes by kicks "
     "and drifts and rattle, and of sums over pairs of 64 bodies or more by kicks and drifts; the "
     "bits are those of one."},
    {"resume", dml_resume,
     "dm.resume(file, system [, {rule=, backend=}]) -> dm.solver   or   dm.resume(path) -> "
     "dm.solver\n"
     "A solver that goes on where a run ended, from path:checkpoint(file) or from the path "
     "itself: solver:run{steps=} gives the bits of a run that never stopped. Rows of every = k are "
     "at every k-th step from there, the first where it goes on. Rule, h and Newton's tolerance "
     "are those of the checkpoint; rule: for a rule that is an object, which a file does not hold. "
     "run{file =} adds its rows to those of the run that it goes on from, and raises where the "
     "file has another state at its time. Raises when the file is not a whole checkpoint or the "
     "system is another one."},
    {"system_of", system_of,
     "core.system_of(x) -> dm.system or nil\n"
     "The system of a solver; nil of anything else."},
    {NULL, NULL, NULL}};

static const dml_row solver_row[] = {{"solver", dml_solver_of,
                                      "system:solver{rule=, h=, newton={tolerance=, "
                                      "max_iterations=}, backend=, sums=} -> dm.solver\n"
                                      "A solver for this system: see dm.solver and dm.rules()."},
                                     {NULL, NULL, NULL}};
static const dml_extension more[] = {
    {DML_SYSTEM, solver_row},
    {DML_DISCRETE, solver_row},
    {NULL, NULL},
};

const dml_class dml_class_solver = {
    .name = DML_SOLVER,
    .doc =
        "dm.solver: a system, a rule and a step, made by system:solver{rule=, h=}\n"
        "fields: system, rule, h, order, tolerance, max_iterations, sums, backend (nil: the usual "
        "one); own_time: what a step covers of t is known when it is taken; lift: of a system on a "
        "group, \"collective\" or \"homogeneous\" where the rule "
        "steps it in coordinates",
    .meta = meta,
    .methods = methods,
    .field = solver_field,
    .functions = functions,
    .more = more,
};
