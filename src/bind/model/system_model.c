/* system_model.c - from the Lua function of a system to the kernels of a run. */
#include "algebra/body_sum.h"
#include "bind/core/missing_key.h"
#include "bind/core/state.h"
#include "bind/model/bind_system.h"
#include "bind/model/model_cache.h"
#include "bind/model/model_constraints.h"
#include "bind/model/model_sums.h"
#include "bind/model/space_group.h"
#include "bind/trace/backend.h"
#include "code/native/jit.h"
#include "code/tape/tape.h"
#include "mech/saddle.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

/* Milliseconds of the clock `by`. */
static double now_ms(clockid_t by) {
    struct timespec t;
    clock_gettime(by, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* How L or Ld is called when it is traced. */
static dml_signature signature(lua_State *L, int arg) {
    const dml_system *s = dml_checksystem(L, arg);
    const int n = (int)s->n;
    const int may_branch = !s->placed && !s->hamiltonian && !s->field && !dml_isconstrained(L, arg);
    if (s->pair)
        return (dml_signature){.what = "Ld",
                               .arguments = 2,
                               .length = {n, n},
                               .outputs = DML_SCALAR_ARGUMENT,
                               .may_branch = may_branch,
                               .may_grow = 1};
    return (dml_signature){.what = s->hamiltonian ? "H" : "L",
                           .arguments = 3,
                           .length = {n, n, DML_SCALAR_ARGUMENT},
                           .outputs = DML_SCALAR_ARGUMENT,
                           .keeps_sums = !s->hamiltonian,
                           .lazy = s->field,
                           .may_branch = may_branch,
                           .may_grow = 1};
}

/* push the function of the system at arg, its constant arguments bound */
static void push_function(lua_State *L, int arg, const dml_system *s) {
    arg = lua_absindex(L, arg);
    if (s->pair) return dml_pushboundpair(L, arg, "Ld");
    dml_pushbound(L, arg, s->hamiltonian ? "H" : "L");
}

/* Raises where no kernel could be made. */
static void check_status(lua_State *L, dm_status status) {
    if (status == DM_NO_MEMORY) luaL_error(L, "not enough memory");
    if (status == DM_NOT_FINITE)
        luaL_error(L, "L or a derivative of it is NaN or infinite whatever its arguments are: is "
                      "there a number in it that is 0/0 or overflows?");
    if (status != DM_OK && status != DM_SINGULAR) luaL_error(L, "%s", dm_status_text(status));
}

/* loops are not possible, and written out they would be too large */
static void refuse_dense(lua_State *L, const dml_model *m, const char *why) {
    dml_refusecells(L, m, why);
    luaL_error(L,
               "%s needs the second derivatives of L as a full %d x %d matrix, which is kept up to "
               "%d coordinates in a system with dm.sum_over; explicit rules do without "
               "(\"verlet\", \"blanes-moan(6)\", \"kahan-li(8)\")",
               why, (int)m->n, (int)m->n, DM_MODEL_DENSE);
}

/* coordinates; tables of second derivatives are their square */
enum { LARGEST_WRITTEN_OUT = 2000 };

static void refuse_many(lua_State *L, const dml_model *m) {
    if (m->n <= LARGEST_WRITTEN_OUT || (m->graph && dm_sums(m->graph))) return;
    luaL_error(L,
               "a system of %d coordinates needs tables of %d x %d entries: above %d coordinates "
               "write the sums over bodies or neighbours in L with dm.sum_over, which stay loops",
               (int)m->n, (int)m->n, (int)m->n, LARGEST_WRITTEN_OUT);
}

/* after every dm_model_build, which knows nothing of constraints and groups */
static void attach(dml_model *m) {
    m->model.params = m->params;
    if (m->stepped != m->lagrangian) m->model.structure |= DM_SADDLE;
    m->model.group = m->placed ? &m->group : NULL;
    if (!m->constrained.graph) return;
    m->model.constraints = &m->constraints;
    m->constraints.group = m->model.group;
    if (m->constraints.structure & DM_CONSTRAINTS_TIMED)
        m->model.structure &= ~(unsigned)DM_AUTONOMOUS;
}

/* the kernels `want` of what was traced */
static dm_status build(dml_model *m, unsigned want, dm_compile *compile) {
    if (dm_loops_of(&m->model, m->graph, m->stepped))
        return dm_loops_more(&m->model, want, compile);
    return (m->hamiltonian ? dm_hamiltonian_build : dm_model_build)(&m->model, m->graph, m->stepped,
                                                                    m->n, want, compile, m->arena);
}

/* 0: the graph is too large */
static int read_structure(lua_State *L, dml_model *m, int pair) {
    refuse_many(L, m);
    dm_status status = m->graph ? dm_graph_status(m->graph) : DM_TOO_LARGE;
    if (status == DM_OK && pair)
        m->model.n = m->n;
    else if (status == DM_OK)
        status = build(m, 0, NULL);
    if (status == DM_TOO_LARGE && m->graph && dm_sums(m->graph))
        refuse_dense(L, m, "a kinetic energy that is no sum of m v^2/2 with constant masses");
    if (status == DM_TOO_LARGE) return 0;
    check_status(L, status);
    attach(m);
    return 1;
}

/* a mass that is singular by itself and regular with the constraints: L as mech/saddle.h has it */
static void regularize(lua_State *L, dml_model *m) {
    const dm_constraints *t = &m->constraints;
    const unsigned structure = m->model.structure;
    int needed;
    if (!m->graph || !m->constrained.graph || t->holonomic + t->rolling == 0 || m->params ||
        structure & DM_LINEAR_IN_V || m->model.inverse_mass)
        return;
    dm_arena *scratch = dml_pusharena(L);
    check_status(L, dm_saddle_needed(&needed, m->graph, m->lagrangian, t, scratch));
    if (needed)
        check_status(L, dm_saddle_lagrangian(&m->stepped, m->graph, m->lagrangian, t, scratch));
    dml_sparearena(L, lua_gettop(L));
    lua_pop(L, 1);
    if (needed) read_structure(L, m, 0);
}

void dml_asgiven(lua_State *L, dml_model *m) {
    if (m->stepped == m->lagrangian) return;
    m->stepped = m->lagrangian;
    m->model = (dm_model){0};
    read_structure(L, m, 0);
}

/* derivatives of the constraints; sums in L are written out: a constrained step is dense */
static void read_constraints(lua_State *L, dml_model *m) {
    if (!m->constrained.graph) return;
    if (!m->graph)
        luaL_error(L, "L is too large to trace, and a system with constraints or a force needs its "
                      "exact derivatives: is there a long loop in L?");
    dml_buildconstraints(L, m);
    dml_writeout(L, m);
    m->stepped = m->lagrangian;
    m->traced = dm_graph_size(m->graph);
}

static void go_hyperdual(lua_State *L, dml_model *m, int fn, const dml_signature *sig) {
    m->graph = NULL;
    m->callback = dml_hyperdual_new(L, fn, sig);
    lua_setiuservalue(L, -2, 3);
    m->model = (dm_model){.n = m->n};
    m->backend = "hyperdual";
}

/* from now on the system runs on hyper-dual numbers; said once */
static void warn_too_large(dml_system *s, const char *what) {
    s->hyperdual = 1;
    fprintf(stderr,
            "dmlua: warning: %s makes more than %d operations: too many to trace. It runs on "
            "hyper-dual numbers, which is slow; a shorter loop, or dm.sum_over, would be fast\n",
            what, DM_GRAPH_LIMIT);
}

/* push a model with the arena on top and the function at fn */
static dml_model *new_model(lua_State *L, int arg, int fn, dm_arena *arena) {
    const dml_system *s = dml_checksystem(L, arg);
    /* arena, function, callback, the model with parameters as inputs (model_params.h) or false,
     * the one with tables (dml_standin) */
    dml_model *m = lua_newuserdatauv(L, sizeof *m, 5);
    *m = (dml_model){.n = s->n, .arena = arena, .placed = s->placed};
    m->group.momenta = s->momenta;
    if (s->placed) dml_place_charts(L, arg, &m->group);
    lua_pushvalue(L, -2);
    lua_setiuservalue(L, -2, 1);
    lua_pushvalue(L, fn);
    lua_setiuservalue(L, -2, 2);
    return m;
}

/* Trace the function at fn, *cached (or NULL) behind it: push *cached where it is the same again,
 * else a new model. */
static dml_model *trace_model(lua_State *L, int arg, int fn, dml_model *cached,
                              dm_compile *compile) {
    const dml_system *s = dml_checksystem(L, arg);
    const dml_signature sig = signature(L, arg);
    const dml_traced *last = cached ? &cached->trace : NULL;
    dml_traced traced;
    dm_arena *arena = dml_pusharena(L);
    const int at = lua_gettop(L);
    if (compile)
        dml_retrace(L, fn, &sig, arena, last, &traced);
    else
        dml_trace(L, fn, &sig, arena, &traced);
    int same = last && traced.graph && traced.graph == last->graph;
    if (same && !dml_repeatconstraints(L, arg, cached, arena)) {
        dml_retrace(L, fn, &sig, arena, NULL, &traced); /* of a model of its own */
        same = 0;
    }
    dml_model *m = same ? cached : new_model(L, arg, fn, arena);
    if (!same) {
        dml_refusenans(L, &traced, sig.what);
        m->trace = traced;
        m->hamiltonian = s->hamiltonian;
        m->graph = traced.graph;
        m->lagrangian = m->stepped = traced.out[0];
        m->traced = m->graph ? dm_graph_size(m->graph) : 0;
        dml_traceconstraints(L, arg, m);
        same = cached && m->graph && dml_sametrace(cached, m);
    }
    if (same) dml_sparearena(L, at);
    lua_pushvalue(L, same ? fn + 1 : at + 1);
    lua_replace(L, at);
    lua_settop(L, at);
    return same ? cached : m;
}

/* from the trace of a new model on top to its structure */
static void build_model(lua_State *L, int arg, int fn, dml_model *m) {
    dml_system *s = dml_checksystem(L, arg);
    const dml_signature sig = signature(L, arg);
    if (!s->hyperdual) {
        read_constraints(L, m);
        if (s->pair) dml_checkpairconstraints(L, m);
        if (!read_structure(L, m, s->pair))
            warn_too_large(s, sig.what);
        else if (!s->pair)
            regularize(L, m);
    }
    if (s->hyperdual) go_hyperdual(L, m, fn, &sig);
}

/* compile: by which a model of an earlier run may be kept, or NULL */
static dml_model *push_model(lua_State *L, int arg, dm_compile *compile) {
    arg = lua_absindex(L, arg);
    dml_system *s = dml_checksystem(L, arg);
    if (s->ruled)
        luaL_error(L, "a discrete Lagrangian of a system and a rule is found by solving: it has no "
                      "formula to trace (its L is in the field 'system')");
    push_function(L, arg, s);
    const int fn = lua_gettop(L);
    dml_model *cached = compile && !s->hyperdual ? dml_pushcached(L, arg, compile) : NULL;
    const clockid_t by = cached ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID;
    const double start = now_ms(by); /* asking for CPU time takes as long as five operations */
    dml_model *m = s->hyperdual ? new_model(L, arg, fn, dml_pusharena(L))
                                : trace_model(L, arg, fn, cached, compile);
    if (m != cached) build_model(L, arg, fn, m);
    if (m != cached && m->graph && compile) dml_cachemodel(L, arg, m, compile);
    if (m == cached) m->compile_ms = 0.0;
    m->trace_ms = now_ms(by) - start;
    lua_replace(L, fn);
    lua_settop(L, fn);
    return m;
}

/* Without a cache: what is made for it goes with it. */
dml_model *dml_pushmodel(lua_State *L, int arg) {
    return push_model(L, arg, NULL);
}

/* Parameters that changed are seen: the function is traced every time. */
dml_model *dml_pushlast(lua_State *L, int arg, const char *backend) {
    return push_model(L, arg, dml_findbackend(L, backend)->compile);
}

/* That of the name, or of the environment; hyper-dual numbers have none. */
static const dml_backend *backend_of(lua_State *L, const dml_model *m, const char *backend) {
    return dml_findbackend(L, dml_arenalost(m->arena) ? "tape" : backend);
}

static void want_constraints(lua_State *L, dml_model *m, unsigned want, const char *backend) {
    const unsigned missing = want & DM_WANT_CONSTRAINTS & ~m->constraints.has;
    if (!m->constrained.graph || !missing) return;
    const double start = now_ms(CLOCK_THREAD_CPUTIME_ID);
    check_status(L,
                 dm_constraints_want(&m->constraints, missing, backend_of(L, m, backend)->compile));
    m->compile_ms += now_ms(CLOCK_THREAD_CPUTIME_ID) - start;
}

/* the backend of the kernels that step; the value is on the tape */
static const char *built_by(const dm_model *m, const char *wanted) {
    const dm_kernel *const all[] = {&m->stage, &m->force,  &m->slope, &m->potential, &m->pair,
                                    &m->mass,  &m->energy, &m->field, NULL};
    for (const dm_kernel *const *k = all; *k; k++)
        if ((*k)->eval && (*k)->backend) return (*k)->backend;
    return strcmp(wanted, "jit") == 0 && !dm_jit_lanes() ? "tape" : wanted;
}

/* the step of a discrete Lagrangian that is given as a function */
static void want_map(lua_State *L, dml_model *m, const char *backend) {
    const dml_traced *map = m->constraint + DML_MAP;
    const double start = now_ms(CLOCK_THREAD_CPUTIME_ID);
    if (m->model.has & DM_WANT_MAP) return;
    check_status(L, backend_of(L, m, backend)
                        ->compile(&m->model.map, map->graph, map->out, map->outputs, m->arena));
    m->model.has |= DM_WANT_MAP;
    m->compile_ms += now_ms(CLOCK_THREAD_CPUTIME_ID) - start;
}

/* all kernels of `want`; the value is that of L as it is given, which is what calls of it give */
static dm_status build_kernels(dml_model *m, unsigned want, dm_compile *compile) {
    dm_status status = build(m, want, compile);
    if (status == DM_OK && want & DM_WANT_VALUE && m->stepped != m->lagrangian)
        status = dm_tape_build_exact(&m->model.value, m->graph, &m->lagrangian, 1, m->arena);
    return status;
}

/* Kernels that are there stay, so that their bits do. */
void dml_want(lua_State *L, dml_model *m, unsigned want, const char *backend) {
    if (want & DM_WANT_MAP) {
        dml_want(L, m, want & ~(unsigned)DM_WANT_MAP, backend);
        want_map(L, m, backend);
        return;
    }
    if (want & DM_WANT_ON_GROUP) {
        dml_want(L, m, want & ~(unsigned)DM_WANT_ON_GROUP, backend);
        dml_want_chart(L, m, want & DM_WANT_ON_GROUP, backend_of(L, m, backend)->compile);
        return;
    }
    if (dml_arenalost(m->arena))
        m->model.has = m->constraints.has = 0; /* called by a finalizer: made again, on the tape */
    want_constraints(L, m, want, backend);
    want &= ~(unsigned)DM_WANT_CONSTRAINTS;
    if (m->hamiltonian) want &= DM_WANT_OF_H;
    const unsigned missing = want & ~m->model.has;
    const int pair = (want & DM_WANT_PAIR) != 0;
    if (!missing) return;
    if (m->model.structure & DM_LOOPS && want & DM_WANT_DENSE && dm_sums(m->graph) &&
        (m->n > DM_MODEL_DENSE || m->model.structure & DM_CELLS || dm_sum_over_near(m->graph)))
        refuse_dense(L, m, want & DM_WANT_MASS ? "this" : "this rule");
    const double start = now_ms(CLOCK_THREAD_CPUTIME_ID);
    if (m->callback) {
        dml_hyperdual_model(L, m, missing, pair);
    } else {
        const dml_backend *row = backend_of(L, m, backend);
        const dm_status status = pair ? dm_model_build_pair(&m->model, m->graph, m->lagrangian,
                                                            m->n, row->compile, m->arena)
                                      : build_kernels(m, want | m->model.has, row->compile);
        check_status(L, status);
        attach(m);
        if (m->compile) m->model.source.cache = &m->cache;
        m->backend = built_by(&m->model, row->name);
    }
    m->compile_ms += now_ms(CLOCK_THREAD_CPUTIME_ID) - start;
}

unsigned dml_legendre_wants(const dml_model *m, unsigned want) {
    const unsigned structure = m->model.structure;
    if (structure & DM_HAMILTONIAN) return DM_WANT_FIELD | DM_WANT_FIELD_CURVE;
    if (structure & DM_LOOPS && !(want & DM_WANT_DENSE)) return 0;
    return structure & DM_DIAGONAL_MASS ? 0 : DM_WANT_MASS;
}

static void check_model(lua_State *L, int arg, dml_model *m, const double *x, int may_be_outside) {
    const char *what = m->model.has & DM_WANT_PAIR ? "Ld" : m->hamiltonian ? "H" : "L";
    if (m->callback) {
        if (x) dml_check_callback(L, m, what, x, may_be_outside);
        return;
    }
    const dml_system *s = dml_checksystem(L, arg);
    dml_signature sig = signature(L, arg);
    sig.may_be_outside = may_be_outside;
    push_function(L, arg, s);
    const int fn = lua_gettop(L);
    const dm_kernel *kernel = &m->model.value;
    const double *at = dml_givesums(L, m, &kernel, x);
    if (m->checked)
        dml_trace_check_start(L, fn, &sig, kernel, at);
    else
        dml_trace_check(L, fn, &sig, kernel, at);
    dml_cut(L, fn - 1);
    dml_checkconstraints(L, arg, m, x);
    m->checked = 1;
}

/* x: see bind_system.h; NULL: around 0. */
void dml_checkmodel(lua_State *L, int arg, dml_model *m, const double *x) {
    check_model(L, arg, m, x, 0);
}

/* A member that starts outside fails later, alone. */
void dml_checkmember(lua_State *L, int arg, dml_model *m, const double *x) {
    check_model(L, arg, m, x, 1);
}

/* Nothing where L was traced. */
void dml_rethrow(lua_State *L, dml_model *m) {
    if (m->callback) dml_hyperdual_rethrow(L, m->callback);
}
