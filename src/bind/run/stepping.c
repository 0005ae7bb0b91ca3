/* stepping.c - from the options of a run to an open stepper and its first state. */
#include "bind/run/stepping.h"
#include "bind/dec/bind_sparse.h"
#include "bind/model/model_constraints.h"
#include "bind/model/model_map.h"
#include "bind/model/model_sums.h"
#include "bind/model/named.h"
#include "bind/model/space_group.h"
#include "bind/rule/bind_rule.h"
#include "bind/rule/bind_step.h"
#include "bind/rule/rule_sum.h"
#include "bind/run/start_constraints.h"
#include "bind/trace/bind_root.h"

#include <math.h>
#include <string.h>

/* Of the solver at 1; NULL: whatever is best here. */
static const char *backend_name(lua_State *L) {
    lua_getiuservalue(L, 1, DML_SOLVER_BACKEND);
    const char *name = lua_tostring(L, -1); /* kept by the solver */
    lua_pop(L, 1);
    return name;
}

/* its address is the registry key of the block of a run that has ended */
static const char spare_key;
enum { LARGEST_SPARE = 1 << 22, LINE = 64 }; /* bytes */

/* a userdata of that size: the last run's where that is large enough, less for the collector */
static void *push_block(lua_State *L, size_t size) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, &spare_key);
    if (lua_rawlen(L, -1) < size) {
        lua_pop(L, 1);
        return lua_newuserdatauv(L, size, 0);
    }
    lua_pushnil(L); /* a run inside this one needs its own */
    lua_rawsetp(L, LUA_REGISTRYINDEX, &spare_key);
    return lua_touserdata(L, -1);
}

/* Its size is kept with it: the next run takes it where that fits. */
void dml_stepping_leave(lua_State *L, const dml_stepping *r) {
    if (lua_rawlen(L, r->block_at) > LARGEST_SPARE) return;
    lua_pushvalue(L, r->block_at);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &spare_key);
}

/* one block: workspace of the rule, state, inputs, scratch */
static void take_memory(lua_State *L, dml_stepping *r) {
    const dml_solver *s = r->solver;
    const dm_model *m = &r->model->model;
    const dm_model *stepped = r->inputs ? &r->inputs->model : m;
    const size_t work = dm_rule_engine(s->nodes, stepped)->work(s->nodes, stepped),
                 state = dm_state_size(s->n);
    const size_t mass = s->n * (m->structure & DM_DIAGONAL_MASS ? 0 : (size_t)s->n);
    const size_t scratch = s->pair ? m->pair.outputs : dm_legendre_work(m) + s->n + mass + state;
    const size_t rest = state + 2 * s->n + 1 + scratch + dml_start_work(m);
    r->stepper.work = push_block(L, (work + rest) * sizeof(double) + LINE);
    r->block_at = lua_gettop(L);
    r->state = r->stepper.work + work; /* at the beginning of a line of the cache */
    r->state += (LINE - (uintptr_t)r->state % LINE) % LINE / sizeof(double);
    memset(r->state, 0, rest * sizeof(double)); /* open lays out what is before */
    r->x = r->state + state;
    r->work = r->x + 2 * s->n + 1;
    r->metric = r->work + scratch;
}

/* functions of the rule for this system; their kernels stay on the stack */
static const void *bring(lua_State *L, dml_stepping *r) {
    lua_getiuservalue(L, 1, DML_SOLVER_OBJECT);
    const void *brought = dml_torule(L, -1)->bring(L, -1, r->system, backend_name(L), r->solver->h);
    r->brought_at = lua_gettop(L);
    return brought;
}

/* the library of sparse solvers, where it is asked for; values without mass do without */
static const dm_solvers *solvers_for(const dml_stepping *r) {
    const char *why;
    return r->wants & DM_WANT_CURVATURE && !r->model->model.massless ? dml_solvers(&why) : NULL;
}

void dml_stepping_prepare(lua_State *L, dml_stepping *r, double t0) {
    dml_solver *s = r->solver;
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    r->system = lua_gettop(L);
    r->t0 = t0;
    r->model = r->apart ? dml_pushmodel(L, r->system) : dml_pushlast(L, r->system, backend_name(L));
    r->model_at = lua_gettop(L);
    dml_stepping_checktime(L, r);
    if (r->model->model.structure & DM_NO_VELOCITY)
        luaL_error(L, "L has no velocity in it, so that nothing moves: L(q, v) needs terms in v, "
                      "such as m*v:dot(v)/2 with m not 0");
    dml_refuselinear(L, s, r->model);
    if (r->model->model.group)
        dml_refuse_group(L, r->system, r->model, s->nodes, backend_name(L), r->complete);
    if (r->model->model.structure & DM_CONSTANT_MASS && !r->model->model.inverse_mass &&
        !(s->method->traits & DM_DEGENERATE))
        luaL_error(L,
                   "L is degenerate: d2L/dv2 is constant and singular (system:mass(q, v) shows "
                   "it), and rule '%s' needs a regular Lagrangian",
                   s->nodes[0].name);
    dml_refuseconstraints(L, s, r->model);
    const char *refusal = dm_rule_fits(s->nodes, &r->model->model);
    if (refusal) luaL_error(L, "rule '%s' cannot step this system: %s", s->nodes[0].name, refusal);
    r->wants = dm_rule_engine(s->nodes, &r->model->model)->wants(s->nodes, &r->model->model);
    if (r->complete && r->wants & DM_WANT_STAGE_LATER) r->wants |= DM_WANT_STAGE;
    if (r->model->model.group) dml_place_taus(L, r->system, &r->model->group, r->wants);
    dml_stepping_inputs(L, r);
    if (r->inputs) dml_want(L, r->inputs, DM_WANT_FORCE | DM_WANT_VALUE, backend_name(L));
    const unsigned wants = (r->inputs ? 0 : r->wants) | DM_WANT_VALUE | dml_start_wants(r) |
                           (s->pair ? DM_WANT_PAIR : dml_legendre_wants(r->model, r->wants));
    r->model = dml_standin(L, r->model_at, wants);
    dml_want(L, r->model, wants, backend_name(L));
    r->stepper = (dm_stepper){.model = r->inputs ? &r->inputs->model : &r->model->model,
                              .params = r->inputs ? r->given + 2 * s->n + 1 : NULL,
                              .rule = s->nodes,
                              .plain = s->plain,
                              .threads = r->apart ? 1 : s->threads,
                              .solvers = solvers_for(r),
                              .tolerance = s->tolerance,
                              .max_iterations = s->max_iterations};
    if (s->method->traits & DM_OF_FUNCTIONS) r->stepper.brought = bring(L, r);
    if (s->own == 0.0) s->own = dml_rule_sum(L, r->brought_at, s->nodes, r->stepper.brought);
    take_memory(L, r);
}

/* Is option `key` of the table at 2 given? */
static int has(lua_State *L, const char *key) {
    const int there = lua_getfield(L, 2, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

/* n numbers of the start */
static void numbers(lua_State *L, const dml_stepping *r, const char *key, double *out) {
    dml_start_numbers(L, r->system, 2, key, out, r->solver->n);
}

#define NO_ROW ", or is a row of the constraints, which alone make d2L/dv2 regular, zero there"
/* Where d2L/dv2 is singular there is no p for v, or no v for p. */
static void check_legendre(lua_State *L, dml_stepping *r, dm_status status) {
    const unsigned structure = r->model->model.structure;
    dml_rethrow(L, r->model);
    if (status != DM_OK && structure & DM_HAMILTONIAN)
        luaL_error(L, "no start: no momentum has dH/dp = v (%s): give 'p' instead of 'v'",
                   dm_status_text(status));
    if (status == DM_SINGULAR)
        luaL_error(L, "no start: d2L/dv2 is singular at the given q: L is degenerate there, or the "
                      "coordinates are");
    if (status != DM_OK)
        luaL_error(L,
                   "no start: %s in the Legendre transform at the given q; is it inside the domain "
                   "of L%s?%s",
                   dm_status_text(status), structure & DM_SADDLE ? NO_ROW : "",
                   dml_modeltrouble(L, r->model));
}

/* L = alpha(q) . v - H: p = alpha(q) whatever v is; a p that is given must be it */
static void start_on_alpha(lua_State *L, dml_stepping *r) {
    const uint32_t n = r->solver->n;
    double *p = r->state + n, distance = 0.0, size = 0.0;
    dml_checkmodel(L, r->system, r->model, r->x);
    check_legendre(L, r, dm_legendre(&r->model->model, p, r->state, r->x + n, r->t0, r->work));
    if (!has(L, "p")) return;
    numbers(L, r, "p", r->work);
    for (uint32_t k = 0; k < n; k++) {
        distance = fmax(distance, fabs(p[k] - r->work[k]));
        size = fmax(size, fabs(p[k]));
    }
    if (distance > 1e-9 * size)
        luaL_error(L,
                   "no start: L is linear in v, so that p must be dL/dv = alpha(q); the given p is "
                   "off by %f: leave it out",
                   distance);
}

/* q and v, or q and p, of a system that is stepped by its H; x = (q, p, t) is where the trace is
 * checked */
static void start_in_phase(lua_State *L, dml_stepping *r) {
    const uint32_t n = r->solver->n;
    double *p = r->state + n;
    if (has(L, "v"))
        check_legendre(L, r, dm_legendre(&r->model->model, p, r->state, r->x + n, r->t0, r->work));
    memcpy(r->x + n, p, n * sizeof *p);
    dml_checkmodel(L, r->system, r->model, r->x);
}

/* q and v, or q and p; x = (q, v, t) is where the trace is checked */
static void start_here(lua_State *L, dml_stepping *r) {
    const uint32_t n = r->solver->n;
    const dm_model *m = &r->model->model;
    double *q = r->state, *p = q + n, *v = r->x + n;
    numbers(L, r, "q", q);
    memcpy(r->x, q, n * sizeof *q);
    r->x[2 * n] = r->t0;
    if (m->structure & DM_LINEAR_IN_V) {
        start_on_alpha(L, r);
        return;
    }
    if (r->solver->alone && (has(L, "v") || !has(L, "p")))
        luaL_error(L, "a discrete Lagrangian knows no velocity: start it from q and the momentum "
                      "p, on a group that of two elements is Ld:legendre_minus(g0, g1) at g0");
    if (has(L, "v") == has(L, "p"))
        luaL_error(L,
                   "give the start as q and v, as q and p, or as q0 and q1: one of 'v' (velocity) "
                   "and 'p' (momentum) is needed, %d numbers",
                   (int)dm_momenta(m));
    numbers(L, r, has(L, "v") ? "v" : "p", has(L, "v") ? v : p);
    if (m->structure & DM_HAMILTONIAN) {
        start_in_phase(L, r);
        return;
    }
    if (has(L, "v")) {
        dml_checkmodel(L, r->system, r->model, r->x);
        check_legendre(L, r, dm_legendre(m, p, q, v, r->t0, r->work));
        dml_check_velocity(L, r, r->state, r->x + n, "");
        dml_start_on_constraints(L, r, "", 0);
        return;
    }
    check_legendre(L, r, dm_legendre_inverse(m, v, q, p, r->t0, r->work));
    dml_checkmodel(L, r->system, r->model, r->x);
    dml_start_on_constraints(L, r, "", 1);
}

/* two positions of a discrete Lagrangian: p0 = -D1 Ld(q0, q1) - F1 */
static void start_pair(lua_State *L, dml_stepping *r) {
    const uint32_t n = r->solver->n;
    const dm_kernel *pair = &r->model->model.pair;
    numbers(L, r, "q1", r->x);
    dml_check_on_constraints(L, r, "q1: ");
    numbers(L, r, "q0", r->state);
    numbers(L, r, "q1", r->x + n);
    memcpy(r->x, r->state, n * sizeof(double));
    dml_checkmodel(L, r->system, r->model, r->x);
    dml_check_on_constraints(L, r, "q0: ");
    dm_kernel_prepare(pair, r->work);
    dm_kernel_eval(pair, r->x, r->work);
    dml_rethrow(L, r->model);
    for (uint32_t i = 0; i < n; i++) r->state[n + i] = -r->work[i];
    dml_addforces(L, r->model, r->x, r->state + n, NULL);
    dml_check_rolling_pair(L, r);
    r->stepper.toward = r->x + n;
}

/* q and p of a discrete Lagrangian: the trace is checked near (q, q + h p) */
static void start_momentum(lua_State *L, dml_stepping *r) {
    const uint32_t n = r->solver->n;
    if (has(L, "v") || !has(L, "p"))
        luaL_error(L, "a discrete Lagrangian knows no velocity: start it from q and the momentum "
                      "p, or from two positions q0 and q1");
    numbers(L, r, "q", r->state);
    numbers(L, r, "p", r->state + n);
    dml_checkmodel(L, r->system, r->model, NULL);
    memcpy(r->x, r->state, n * sizeof(double));
    dml_check_on_constraints(L, r, "");
}

/* p += M v of a mass that is a list of numbers. */
static void add_diagonal(double *p, const double *mass, const double *v, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) p[i] += mass[i] * v[i];
}

/* p += M v, M row by row. */
static void add_product(double *p, const double *mass, const double *v, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) p[i] += mass[i * (size_t)n + j] * v[j];
}

/* Two positions of a Lagrangian: the momentum p with step(q0, p) = q1, by p += M (q1 - Q(p)) /
 * h, which contracts like h^2; M = d2L/dv2 at the start. */
static dm_status shoot(dml_stepping *r, const double *q1) {
    enum { TRIES = 100 };
    const uint32_t n = r->solver->n;
    const int diagonal = (r->model->model.structure & DM_DIAGONAL_MASS) != 0;
    const double *mass = r->work + n;
    double *end = r->work + n + (diagonal ? 0 : n * (size_t)n), last = INFINITY;
    for (int k = 0; k < TRIES; k++) {
        double gap = 0.0, size = 0.0;
        memcpy(end, r->state, dm_state_size(n) * sizeof *end);
        const dm_status status = r->stepper.engine->step(&r->stepper, end, r->t0, r->solver->h);
        if (status != DM_OK) return status;
        for (uint32_t i = 0; i < n; i++) {
            gap = fmax(gap, fabs(q1[i] - end[i]));
            size = fmax(size, fabs(q1[i]) + fabs(r->state[i]));
        }
        if (gap <= 1e-16 * size || (gap < 1e-13 * size && gap >= last)) return DM_OK;
        last = gap;
        for (uint32_t i = 0; i < n; i++) end[i] = (q1[i] - end[i]) / r->solver->h;
        if (diagonal)
            add_diagonal(r->state + n, r->model->model.mass_matrix, end, n);
        else
            add_product(r->state + n, mass, end, n);
    }
    return DM_NO_CONVERGENCE;
}

/* q0 and q1 of a Lagrangian; the guess v = (q1 - q0)/h gives the first momentum and M */
static void guess_momentum(lua_State *L, dml_stepping *r) {
    const uint32_t n = r->solver->n;
    const dm_kernel *mass = &r->model->model.mass;
    double *q1 = r->x + n;
    numbers(L, r, "q1", r->x);
    dml_check_on_constraints(L, r, "q1: ");
    numbers(L, r, "q0", r->state);
    numbers(L, r, "q1", q1);
    memcpy(r->x, r->state, n * sizeof(double));
    dml_check_on_constraints(L, r, "q0: ");
    for (uint32_t i = 0; i < n; i++) q1[i] = (q1[i] - r->x[i]) / r->solver->h;
    r->x[2 * n] = r->t0;
    dml_checkmodel(L, r->system, r->model, r->x);
    if (mass->eval && !(r->model->model.structure & DM_DIAGONAL_MASS)) {
        dm_kernel_prepare(mass, r->work);
        dm_kernel_eval(mass, r->x, r->work);
        dml_rethrow(L, r->model);
        memcpy(r->state + n, r->work, n * sizeof(double));
    } else {
        check_legendre(L, r, dm_legendre(&r->model->model, r->state + n, NULL, q1, r->t0, r->work));
    }
    numbers(L, r, "q1", q1);
}

/* From here on the stepper may hold what only dml_stepping_end gives back: no error may pass. */
void dml_stepping_open(lua_State *L, dml_stepping *r) {
    const dml_solver *s = r->solver;
    dml_forgetroots(r->model);
    if (r->inputs) dml_forgetroots(r->inputs);
    if (r->inputs && !dml_stepping_agrees(r)) {
        dml_want(L, r->model, r->wants, backend_name(L));
        r->stepper.model = &r->model->model;
    }
    const dm_status status = dm_stepper_open(&r->stepper);
    if (status == DM_OK) dml_stepping_checkplain(L, r);
    if (status == DM_OK) return;
    dml_stepping_end(r);
    if (status == DM_NO_START) dml_refusestages(L, s->nodes[0].name);
    luaL_error(L, "rule '%s' cannot start: %s", s->nodes[0].name, dm_status_text(status));
}

/* Two positions of a discrete Lagrangian: p = D2 Ld(q0, q1) at q1. */
static void start_between(lua_State *L, dml_stepping *r) {
    guess_momentum(L, r);
    dml_stepping_open(L, r);
    dm_status status = shoot(r, r->x + r->solver->n);
    if (status == DM_OK) status = dml_tangent_momentum(r);
    if (status == DM_OK) return;
    dml_stepping_end(r);
    dml_rethrow(L, r->model);
    luaL_error(L,
               "no start: no momentum takes q0 to q1 in one step (%s); are q0 and q1 one step "
               "apart?",
               dm_status_text(status));
}

/* L is compared with its trace at the start before any step is made. */
void dml_stepping_start(lua_State *L, dml_stepping *r) {
    const int two = has(L, "q0") || has(L, "q1");
    if (two && (has(L, "q") || has(L, "v") || has(L, "p")))
        luaL_error(L, "give the start as q and v, as q and p, or as q0 and q1, not a mixture");
    if (two && r->solver->method->traits & DM_OWN_TIME)
        luaL_error(L,
                   "rule '%s' has a time of its own, its steps are not h apart: give q and v or q "
                   "and p",
                   r->solver->nodes[0].name);
    if (two && r->model->model.structure & DM_HAMILTONIAN)
        luaL_error(L, "this H has no Lagrangian, so that two positions are no start: give q and p");
    if (two && r->model->model.structure & DM_LINEAR_IN_V && !r->solver->pair)
        luaL_error(L, "L is linear in v: a position q alone is a start");
    if (two && !r->solver->pair) {
        start_between(L, r);
        return;
    }
    if (!r->solver->pair)
        start_here(L, r);
    else if (two)
        start_pair(L, r);
    else
        start_momentum(L, r);
    if (r->wants & DM_WANT_MAP) dml_checkmap(L, r->system, r->model, r->state, 1, 0);
    dml_step_compare(L, r->brought_at, r->solver->method, r->state, r->t0, r->solver->h);
    dml_stepping_open(L, r);
}

/* Sums of states are compensated unless somebody asks for plain ones. */
void dml_stepping_checkplain(lua_State *L, dml_stepping *r) {
    if (!r->solver->plain || r->stepper.report.plain) return;
    dml_stepping_end(r);
    luaL_error(L,
               "field 'sums': rule '%s' always compensates on this system; plain sums are for "
               "explicit kicks and drifts of a traced, separable L of few coordinates, or of sums "
               "over equal bodies and neighbours (dm.sum_over)",
               r->solver->nodes[0].name);
}

/* May be called once; what it gives back is not Lua's. */
void dml_stepping_end(dml_stepping *r) {
    dm_stepper_close(&r->stepper);
    r->stepper.outside = NULL;
}
