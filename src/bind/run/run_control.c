/* run_control.c - the option `control` of a run: steps as long as their error allows. */
#include "bind/run/stepping.h"
#include "bind/trace/function.h"

#include <math.h>
#include <string.h>

/* the model, if it tells the velocity by the momentum alone */
static const dm_model *of_velocity(const dml_stepping *r) {
    const dm_model *m = &r->model->model;
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    if (m->params || m->structure & (DM_HAMILTONIAN | DM_LINEAR_IN_V)) return NULL;
    return m->has & DM_WANT_MASS || (m->structure & simple) == simple ? m : NULL;
}

/* the forces f and what of them may be narrow, with room for all that is found of them */
static void open_hidden(lua_State *L, dm_hidden *x, const dml_function *f, uint32_t watched,
                        const dml_stepping *r) {
    const uint32_t count = dml_outputs(f), size = dm_graph_size(f->alone), n = r->solver->n;
    const uint32_t forces = count - watched;
    const size_t inputs = 2 * (size_t)n + 1;
    dm_node *roots = lua_newuserdatauv(L, ((size_t)count + size) * sizeof *roots, 0);
    memcpy(roots, f->alone_roots, count * sizeof *roots);
    unsigned char *rough = lua_newuserdatauv(L, size, 0);
    const uint32_t parts = dm_hidden_parts(f->alone, roots + count, rough), all = count + parts;
    dm_interval *room = lua_newuserdatauv(L, (3 * (size + inputs) + all) * sizeof *room, 0);
    const dm_model *own = &r->model->model;
    const int in_phase_space = own->structure & DM_HAMILTONIAN || own->group != NULL;
    const dm_model *m = in_phase_space ? NULL : of_velocity(r);
    const size_t samples = dm_hidden_samples(all), work = m ? dm_legendre_work(m) : 0;
    double *more = lua_newuserdatauv(L, (size + samples + 15 * (size_t)n + work) * sizeof *more, 0);
    *x = (dm_hidden){.graph = f->alone,
                     .roots = roots,
                     .n = n,
                     .count = count,
                     .parts = parts,
                     .impulses = forces > n ? forces - n : forces,
                     .in_phase_space = in_phase_space,
                     .watched = watched,
                     .value = room,
                     .rate = room + size,
                     .bend = room + 2 * (size_t)size,
                     .in = room + 3 * (size_t)size,
                     .rate_in = room + 3 * (size_t)size + inputs,
                     .bend_in = room + 3 * (size_t)size + 2 * inputs,
                     .found = room + 3 * (size + inputs),
                     .weight = more,
                     .samples = more + size,
                     .curve = (double(*)[6])(more + size + samples),
                     .velocity = more + size + samples + 12 * (size_t)n,
                     .model = m,
                     .work = more + size + samples + 15 * (size_t)n};
}

/* the forces, a traced function of (q, v, t) or (q, p, t), in the table at `at`; it stays on the
 * stack */
static void read_hidden(lua_State *L, int at, dml_run_control *c, const dml_stepping *r) {
    const uint32_t n = r->solver->n;
    const double negligible = dml_positive(L, at, "negligible", 1e-9);
    if (lua_getfield(L, at, "hidden") == LUA_TNIL) return;
    dml_function *f = luaL_testudata(L, -1, DML_FUNCTION);
    if (!f || f->s.arguments != 3 || f->s.length[0] != (int)n || f->s.length[1] != (int)n ||
        f->s.length[2] != DML_SCALAR_ARGUMENT)
        luaL_error(L,
                   "field 'control.hidden' must be dm.trace(f, %d, %d, \"number\"), the forces as "
                   "a function of (q, v, t); of (q, p, t) on groups and of H",
                   (int)n, (int)n);
    dml_function_alone(L, f);
    lua_getfield(L, at, "watched");
    const lua_Integer watched = dml_optinteger(L, -1, 0);
    lua_pop(L, 1);
    if (watched < 0 || watched > (lua_Integer)dml_outputs(f))
        luaL_error(L, "field 'control.watched' must be how many of the last entries of "
                      "'control.hidden' are watched");
    open_hidden(L, &c->hidden, f, (uint32_t)watched, r);
    c->hidden.negligible = negligible;
    c->control.hidden = &c->hidden;
}

/* growing times in the field `ends` of the table at `at` */
static void read_ends(lua_State *L, int at, dm_control *c) {
    if (lua_getfield(L, at, "ends") == LUA_TNIL) return;
    const long count = dml_length(L, -1);
    if (count < 0) luaL_error(L, "field 'control.ends' must be a list of growing times");
    double *ends = lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *ends, 0);
    for (long i = 0; i < count; i++) {
        const dml_scalar x = dml_entry(L, -2, (uint32_t)i);
        ends[i] = x.kind == DML_NUMBER ? x.as.number : NAN;
        if (!(ends[i] > (i ? ends[i - 1] : -INFINITY)))
            luaL_error(L, "field 'control.ends' must hold growing times (entry %d)", (int)i + 1);
    }
    c->ends = ends;
    c->end_count = count;
}

/* the time that steps are made for: the end of the run, or a later one in the field `reach` of the
 * table at `at`, so that a run to an earlier time has the same steps */
static double read_reach(lua_State *L, int at, double until) {
    if (lua_getfield(L, at, "reach") == LUA_TNIL) return until;
    const double reach = lua_tonumber(L, -1);
    if (lua_type(L, -1) != LUA_TNUMBER || !isfinite(reach))
        luaL_error(L, "field 'control.reach' must be a time (got %s)", luaL_typename(L, -1));
    return fmax(until, reach);
}

dm_control *dml_control_read(lua_State *L, dml_run_control *c, const dml_stepping *r,
                             double until) {
    static const char *const known[] = {"tolerance", "largest",    "ends",  "hidden",
                                        "watched",   "negligible", "reach", NULL};
    const uint32_t n = r->solver->n;
    lua_getfield(L, 2, "control");
    const int at = lua_gettop(L);
    if (!lua_istable(L, at))
        luaL_error(L, "field 'control' must be a table { tolerance =, largest =, ends = } (got %s)",
                   luaL_typename(L, at));
    dml_options(L, at, known);
    if (r->solver->alone || r->solver->method->traits & DM_OWN_TIME)
        luaL_error(L, "field 'control': steps of rule '%s' on this system cannot be chosen",
                   r->solver->nodes[0].name);
    if (!isfinite(until))
        luaL_error(L, "field 'control': give 't' or 'at', the time that the run goes to");
    c->control = (dm_control){.tolerance = dml_positive(L, at, "tolerance", 1e-9),
                              .largest = dml_positive(L, at, "largest", INFINITY),
                              .reach = read_reach(L, at, until)};
    read_ends(L, at, &c->control);
    read_hidden(L, at, c, r);
    c->control.room = lua_newuserdatauv(L, dm_control_room(n) * sizeof(double), 0);
    return &c->control;
}

long dml_control_most(const dml_solver *s, int ended) {
    enum { MOST = 200000, BYTES = 1 << 28 };
    const size_t row = (1 + 2 * dm_state_size(s->n)) * sizeof(double); /* t, q and p */
    const long fit = (long)(BYTES / row);
    return ended && fit > MOST ? fit : MOST;
}
