/* watch.c - `watch = { "q1", "energy", r = function(q, v, t, p) ... end }`: what a run records
 * beside t. */
#include "bind/model/space_group.h"
#include "bind/rule/bind_step.h"
#include "bind/run/bind_path.h"
#include "bind/run/observables.h"
#include "integ/constrained/constrained.h"
#include "integ/method/lift.h"
#include "mech/constraints.h"

#include <stdio.h>
#include <string.h>

/* entry of (q, p) that is called `name`, -1: none */
static int find_entry(lua_State *L, const dml_stepping *r, const char *name) {
    const uint32_t n = r->solver->n, momenta = dml_checksystem(L, r->system)->momenta;
    char kind, rest;
    unsigned i;
    int found = -1;
    for (uint32_t k = 0; k < n && found < 0; k++, lua_pop(L, 1)) {
        const char *coordinate = dml_coordinate(L, r->system, k);
        if (strcmp(coordinate, name) == 0) found = (int)k;
        if (strncmp(name, "p_", 2) == 0 && strcmp(coordinate, name + 2) == 0) found = (int)(n + k);
    }
    if (found < 0 && sscanf(name, "%c%u%c", &kind, &i, &rest) == 2 && i >= 1 &&
        ((kind == 'q' && i <= n) || (kind == 'p' && i <= momenta)))
        found = (int)(kind == 'q' ? i - 1 : n + i - 1);
    return found;
}

/* where entries are read from, and what they add to */
typedef struct {
    const char *field;
    int table, names, taken; /* stack indices; taken: name -> true */
    dm_impulses *impulses;
} reading;

/* Begin the list on top of the stack. */
static void begin_names(lua_State *L, reading *in) {
    in->names = lua_gettop(L);
    lua_newtable(L);
    in->taken = in->names + 1;
    for (lua_Integer i = 1; i <= (lua_Integer)lua_rawlen(L, in->names); i++) {
        lua_rawgeti(L, in->names, i);
        lua_pushboolean(L, 1);
        lua_rawset(L, in->taken);
    }
}

/* Two columns of one name could not be told apart later. */
static void add_name(lua_State *L, const reading *in, const char *name) {
    if (lua_getfield(L, in->taken, name) != LUA_TNIL)
        luaL_error(L, "field '%s': there is a column '%s' already; choose another name", in->field,
                   name);
    lua_pop(L, 1);
    lua_pushboolean(L, 1);
    lua_setfield(L, in->taken, name);
    lua_pushstring(L, name);
    lua_rawseti(L, in->names, (lua_Integer)lua_rawlen(L, in->names) + 1);
}

/* the multipliers at a state, as a function that is traced (lua/dm/measure/multipliers.lua) */
static void add_lambda(lua_State *L, dml_observables *o, const dml_stepping *r) {
    lua_getfield(L, 2, "vary");
    if (!lua_isnil(L, -1))
        luaL_error(L, "field 'watch': \"lambda\" is that of the system as it is, and does not go "
                      "with 'vary'");
    lua_pop(L, 1);
    lua_getglobal(L, "require");
    lua_pushliteral(L, "dm.measure.multipliers");
    lua_call(L, 1, 1);
    lua_getfield(L, -1, "watched");
    lua_remove(L, -2);
    lua_pushvalue(L, r->system);
    lua_call(L, 1, 1);
    dml_observables_add(L, o, r, "lambda", 1);
}

/* ---- parts: numbers of its own that a rule has at a state ---- */

/* push { { "h", 1 }, { "E_d", 1 } } of "h E_d" */
static void push_names(lua_State *L, const char *names) {
    lua_newtable(L);
    for (lua_Integer i = 1; *names; i++) {
        const size_t length = strcspn(names, " ");
        lua_createtable(L, 2, 0);
        lua_pushlstring(L, names, length), lua_rawseti(L, -2, 1);
        lua_pushinteger(L, 1), lua_rawseti(L, -2, 2);
        lua_rawseti(L, -2, i);
        names += length + (names[length] == ' ');
    }
}

/* push the list of the parts, { name, count } each, of a row of the list or of a step that a script
 * wrote; 0, and nothing is pushed, where there are none */
static int push_parts(lua_State *L, const dml_stepping *r) {
    const char *names = r->solver->method->parts;
    if (names) return push_names(L, names), 1;
    if (!(r->solver->method->traits & DM_OF_FUNCTIONS)) return 0;
    lua_getiuservalue(L, 1, DML_SOLVER_OBJECT);
    dml_step_parts(L, -1);
    lua_remove(L, -2);
    if (lua_istable(L, -1) && lua_rawlen(L, -1)) return 1;
    lua_pop(L, 1);
    return 0;
}

/* entry i of the list on top: its name stays on the stack, its numbers are returned */
static uint32_t push_part(lua_State *L, lua_Integer i) {
    lua_geti(L, -1, i);
    lua_geti(L, -1, 2);
    const uint32_t count = (uint32_t)lua_tointeger(L, -1);
    lua_pop(L, 1);
    lua_geti(L, -1, 1);
    lua_remove(L, -2);
    return count;
}

/* the part that is called `name`, E or an entry F2 of a longer one; 0: there is none */
static int add_part(lua_State *L, dml_observables *o, const dml_stepping *r, const char *name) {
    const int top = lua_gettop(L);
    uint32_t first = 0, found = 0, at = 0;
    if (!push_parts(L, r)) return 0;
    for (lua_Integer i = 1; i <= (lua_Integer)lua_rawlen(L, top + 1) && !found; i++) {
        const uint32_t count = push_part(L, i);
        for (uint32_t k = 0; k < count && !found; k++) {
            const char *own = lua_tostring(L, -1);
            if (count > 1) own = lua_pushfstring(L, "%s%d", own, (int)k + 1);
            if (strcmp(own, name) == 0) found = 1, at = first + k;
            if (count > 1) lua_pop(L, 1);
        }
        first += count;
        lua_pop(L, 1);
    }
    lua_settop(L, top);
    if (found) dml_observables_parts(L, o, r, at, 1);
    return (int)found;
}

/* an entry of the element or a momentum by the names of lua/dm/measure/observed.lua; 0: there is
 * none of this name, or the system is on no group */
static int add_of_element(lua_State *L, dml_observables *o, const dml_stepping *r,
                          const char *name) {
    const int top = lua_gettop(L);
    if (!dml_placed(L, r->system) || r->solver->pair) return 0;
    lua_getglobal(L, "require");
    lua_pushliteral(L, "dm.measure.observed");
    lua_call(L, 1, 1);
    lua_getfield(L, -1, "of");
    dml_systemfield(L, r->system, "place");
    lua_pushstring(L, name);
    lua_call(L, 2, 1);
    lua_remove(L, top + 1);
    if (lua_isnil(L, -1)) return lua_settop(L, top), 0;
    dml_observables_add(L, o, r, name, 1);
    return 1;
}

/* a name alone: a column, the energy or the multipliers */
static void add_column(lua_State *L, dml_observables *o, const dml_stepping *r, const char *field,
                       const char *name) {
    const int entry = find_entry(L, r, name);
    if (strcmp(name, "energy") == 0)
        dml_observables_energy(L, o, r);
    else if (entry >= 0)
        dml_observables_entry(L, o, (uint32_t)entry);
    else if (add_part(L, o, r, name) || add_of_element(L, o, r, name))
        return;
    else if (strcmp(name, "lambda") == 0 && r->solver->alone)
        luaL_error(L,
                   "field '%s': a discrete Lagrangian has no equations at a state; the multipliers "
                   "of its steps are record = { \"impulses\" }",
                   field);
    else if (strcmp(name, "lambda") == 0)
        add_lambda(L, o, r);
    else
        luaL_error(L,
                   "field '%s': no column '%s'; %s coordinates (\"%s\"), momenta (\"p1\"), %s"
                   "\"energy\", \"lambda\" (multipliers), or name = function(q, v, t, p) ... end",
                   field, name, field, dml_coordinate(L, r->system, 0),
                   dml_placed(L, r->system) ? "entries of elements (\"R11\", of factor k "
                                              "\"R11_k\"), "
                                            : "");
}

/* r, or r1, r2, ... of several numbers */
static void add_names(lua_State *L, const reading *in, const char *name, uint32_t count) {
    if (count == 1) {
        add_name(L, in, name);
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        add_name(L, in, lua_pushfstring(L, "%s%d", name, (int)i + 1));
        lua_pop(L, 1);
    }
}

/* "impulses" and "inner" are no functions of a state */
static int is_impulse(const reading *in, const char *name) {
    const int inner = strcmp(name, "inner") == 0;
    if (!in->impulses || (!inner && strcmp(name, "impulses") != 0)) return 0;
    in->impulses->constraints = 1;
    in->impulses->inner |= inner;
    return 1;
}

/* the name on top */
static void read_name(lua_State *L, dml_observables *o, const dml_stepping *r, const reading *in) {
    const char *name = lua_tostring(L, -1);
    const uint32_t before = o->observer.count;
    if (is_impulse(in, name)) return;
    add_column(L, o, r, in->field, name);
    const dm_observable *added = o->list + before;
    if (added->kernel && added->kernel->outputs > 1)
        add_names(L, in, name, added->kernel->outputs);
    else
        add_name(L, in, name);
}

/* the entry whose key is on top */
static void read_entry(lua_State *L, dml_observables *o, const dml_stepping *r, const reading *in) {
    const int named = lua_type(L, -1) == LUA_TSTRING;
    lua_pushvalue(L, -1);
    lua_gettable(L, in->table);
    if (!named) {
        if (lua_type(L, -1) != LUA_TSTRING)
            luaL_error(L,
                       "field '%s': entry %d must be the name of a column (got %s); a function "
                       "needs a name: %s = { r = function(q, v, t, p) ... end }",
                       in->field, (int)lua_tointeger(L, -2), luaL_typename(L, -1), in->field);
        read_name(L, o, r, in);
        return;
    }
    const char *name = lua_tostring(L, -2);
    const char *what = lua_pushfstring(L, "%s.%s", in->field, name);
    lua_insert(L, -2);
    dml_observables_add(L, o, r, what, 1);
    add_names(L, in, name, o->list[o->observer.count - 1].kernel->outputs);
}

/* all entries of the field; names on the stack under what keeps the kernels */
static void read_all(lua_State *L, dml_observables *o, const dml_stepping *r, reading *in) {
    dml_field(L, 2, in->field);
    in->table = lua_gettop(L);
    if (!lua_istable(L, in->table))
        luaL_error(L,
                   "field '%s' must be a table of names of columns and of functions: { \"%s\", "
                   "\"energy\", r = function(q, v, t, p) ... end } (got %s)",
                   in->field, in->impulses ? "lambda" : "q1", luaL_typename(L, in->table));
    dml_pushkeys(L, in->table, in->field);
    const int keys = lua_gettop(L);
    const lua_Integer count = (lua_Integer)lua_rawlen(L, keys);
    if (!count) luaL_error(L, "field '%s' is empty: leave it out, or name a column", in->field);
    for (lua_Integer i = 1; i <= count; i++) {
        luaL_checkstack(L, 12, NULL);
        lua_rawgeti(L, keys, i);
        read_entry(L, o, r, in);
    }
}

void dml_watch_missed(lua_State *L, const dml_observables *o, int at, dml_stepping *r) {
    const dm_observer *seen = &o->observer;
    const dml_path *path = lua_touserdata(L, at);
    if (!seen->missing) return;
    lua_getiuservalue(L, at, DML_PATH_NAMES);
    lua_rawgeti(L, -1, 1 + (path->watched ? 0 : path->n + path->momenta) + seen->missing);
    r->unseen_at = seen->missed;
    r->unseen = lua_pushfstring(L,
                                "column '%s' is NaN there: is its function inside its domain (a "
                                "logarithm, root or quotient)? dm.where(c, a, b) gives it a value "
                                "elsewhere, gaps = true keeps NaN; failure.path has the rows "
                                "before",
                                lua_tostring(L, -1));
}

/* gaps = true */
static void read_gaps(lua_State *L, dml_observables *o) {
    o->observer.gaps = dml_flag(L, 2, "gaps", 0);
}

void dml_refuse_gaps(lua_State *L) {
    if (dml_flag(L, 2, "gaps", 0))
        luaL_error(L, "field 'gaps' is about NaN in columns of 'watch' or 'record', and none is "
                      "given: NaN in q and p ends every run");
}

/* Rows hold t and these, in the order of dml_pushkeys. */
void dml_watch_read(lua_State *L, dml_observables *o, const dml_stepping *r) {
    lua_newtable(L);
    reading in = {.field = "watch"};
    begin_names(L, &in);
    add_name(L, &in, "t");
    dml_observables_start(o, r);
    read_gaps(L, o);
    read_all(L, o, r, &in);
    dml_observables_end(L, o);
}

/* all parts, in front of what is asked for */
static void add_parts(lua_State *L, dml_observables *o, const dml_stepping *r, const reading *in) {
    uint32_t first = 0;
    if (!push_parts(L, r)) return;
    for (lua_Integer i = 1; i <= (lua_Integer)lua_rawlen(L, -1); i++, lua_pop(L, 1)) {
        const uint32_t count = push_part(L, i);
        add_names(L, in, lua_tostring(L, -1), count);
        dml_observables_parts(L, o, r, first, count);
        first += count;
    }
    lua_pop(L, 1);
}

/* Parts are columns of every run that does not watch something else. */
int dml_records(lua_State *L, const dml_stepping *r) {
    const int asked = lua_getfield(L, 2, "record") != LUA_TNIL;
    lua_pop(L, 1);
    const int parts = !asked && push_parts(L, r);
    if (parts) lua_pop(L, 1);
    if (!asked && !parts) dml_refuse_gaps(L);
    return asked || parts;
}

/* how many impulses the constraints have, at how many points of a step; raises where there are
 * none */
static void read_impulses(lua_State *L, const dml_stepping *r, dm_impulses *out) {
    const dm_constraints *constraints = r->model->model.constraints;
    const dm_method *method = r->solver->method;
    dm_galerkin basis;
    if (!constraints || constraints->holonomic + constraints->rolling == 0)
        luaL_error(L, "field 'record': this system has no constraint, so steps have no impulses of "
                      "constraints");
    const dm_model *m = &r->model->model;
    if (dm_rule_engine(r->solver->nodes, m) == &dm_engine_lift)
        m = dm_lifted_model(r->solver->nodes, m);
    if (!dm_rule_engine(r->solver->nodes, m)->impulses)
        luaL_error(L,
                   "field 'record': rule '%s' is made of several steps, whose impulses belong to "
                   "no node; record \"lambda\", the multipliers at the state",
                   r->solver->nodes[0].name);
    out->constraints = constraints->holonomic + constraints->rolling;
    out->points = 2;
    if (!method->basis) return;
    method->basis(&basis, r->solver->nodes);
    out->points = dm_constrained_nodes(&basis);
}

/* behind all others: impulse1 ... of the node, inner1_1 ... of the points inside the step;
 * impulse, inner1 where there is one constraint */
static void add_impulse_names(lua_State *L, const dm_impulses *i, const reading *in) {
    for (uint32_t c = 1; c <= i->constraints; c++, lua_pop(L, 1)) {
        lua_pushfstring(L, i->constraints > 1 ? "impulse%d" : "impulse", (int)c);
        add_name(L, in, lua_tostring(L, -1));
    }
    for (uint32_t k = 1; i->inner && k + 1 < i->points; k++)
        for (uint32_t c = 1; c <= i->constraints; c++, lua_pop(L, 1)) {
            lua_pushfstring(L, i->constraints > 1 ? "inner%d_%d" : "inner%d", (int)k, (int)c);
            add_name(L, in, lua_tostring(L, -1));
        }
}

void dml_record_read(lua_State *L, dml_observables *o, const dml_stepping *r,
                     dm_impulses *impulses) {
    dml_state_names(L, r->system, r->solver->n, dml_checksystem(L, r->system)->momenta);
    reading in = {.field = "record", .impulses = impulses};
    begin_names(L, &in);
    dml_observables_start(o, r);
    read_gaps(L, o);
    add_parts(L, o, r, &in);
    if (lua_getfield(L, 2, "record") != LUA_TNIL) read_all(L, o, r, &in);
    dml_observables_end(L, o);
    if (!impulses->constraints) return;
    read_impulses(L, r, impulses);
    add_impulse_names(L, impulses, &in);
    const size_t size = (size_t)impulses->points * impulses->constraints;
    impulses->step = lua_newuserdatauv(L, size * sizeof(double), 0);
    memset(impulses->step, 0, size * sizeof(double));
}
