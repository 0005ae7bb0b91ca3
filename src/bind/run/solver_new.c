/* solver_new.c - from a table of options to a solver. */
#include "bind/rule/bind_rule.h"
#include "bind/rule/bind_step.h"
#include "bind/rule/discrete_rule.h"
#include "bind/run/start_constraints.h"
#include "bind/run/stepping.h"
#include "bind/trace/backend.h"
#include "integ/registry.h"

#include <string.h>

typedef dml_solver solver;

/* Those for a system, or (pair) for a discrete Lagrangian. */
static void add_known_rules(lua_State *L, luaL_Buffer *b, int pair) {
    const char *separator = "";
    (void)L;
    for (const dm_method *const *m = dm_methods; *m; m++) {
        if (!((*m)->traits & DM_FOR_PAIRS) != !pair) continue;
        luaL_addstring(b, separator);
        luaL_addstring(b, (*m)->signature);
        separator = ", ";
    }
}

/* Raises with the nearest name, and all names. */
static void unknown_rule(lua_State *L, const char *text, const char *nearest) {
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    if (nearest)
        lua_pushfstring(L, "unknown rule '%s'; did you mean '%s'? known rules: ", text, nearest);
    else
        lua_pushfstring(L, "unknown rule '%s'; known rules: ", text);
    luaL_addvalue(&b);
    add_known_rules(L, &b, 0);
    luaL_pushresult(&b);
    luaL_error(L, "%s", lua_tostring(L, -1));
}

static void check_rule(lua_State *L, solver *s, const char *text, const char *nearest) {
    const char *wrong;
    s->method = s->nodes[0].method;
    if (!s->method) unknown_rule(L, text, nearest);
    if (!(s->method->traits & DM_FOR_PAIRS) != !s->pair)
        luaL_error(L,
                   s->pair ? "rule '%s' steps a Lagrangian; a discrete Lagrangian is stepped by "
                             "'del'"
                           : "rule '%s' steps a discrete Lagrangian Ld(q0, q1), not a Lagrangian",
                   text);
    if ((wrong = dm_rule_check(s->nodes)))
        luaL_error(L, "field 'rule': '%s': %s; it is written %s", text, wrong,
                   s->method->signature);
}

/* the rule on top of the stack, a string or a dm.rule; what the solver keeps of it takes its
 * place */
static void read_rule(lua_State *L, solver *s) {
    const dml_rule *object = dml_torule(L, -1);
    const char *nearest = NULL;
    if (object) {
        s->nodes[0] = object->rule;
        s->nodes[0].data = dml_ruledata(L, lua_gettop(L), s->n);
        if (object->rule.method == &dm_method_step)
            s->nodes[0].method = dml_step_method(L, lua_gettop(L), 2);
        lua_pushvalue(L, -1);
        lua_setiuservalue(L, 3, DML_SOLVER_OBJECT);
        lua_getiuservalue(L, -1, 2);
        lua_replace(L, -2);
    } else if (lua_type(L, -1) == LUA_TSTRING) {
        const char *wrong = dm_rule_read(s->nodes, lua_tostring(L, -1), &nearest);
        if (wrong) luaL_error(L, "field 'rule': '%s': %s", lua_tostring(L, -1), wrong);
        const char *text = lua_tostring(L, -1); /* others look at how it begins */
        lua_pushstring(L, text + strspn(text, " \t\n\v\f\r"));
        lua_replace(L, -2);
    } else {
        luaL_error(L,
                   "field 'rule' must be the name of a rule, for instance \"verlet\" or "
                   "\"gauss(2)\", or a dm.rule as dm.galerkin makes them (got %s)",
                   luaL_typename(L, -1));
    }
    check_rule(L, s, lua_tostring(L, -1), nearest);
}

/* newton = { tolerance =, max_iterations = } of the options at 1 */
static void read_newton(lua_State *L, solver *s) {
    static const char *const known[] = {"tolerance", "max_iterations", NULL};
    s->tolerance = 4e-15;
    s->max_iterations = 50;
    if (lua_getfield(L, 1, "newton") != LUA_TNIL) {
        const int at = lua_gettop(L);
        if (!lua_istable(L, at))
            luaL_error(L, "field 'newton' must be a table { tolerance =, max_iterations = }");
        dml_options(L, at, known);
        s->tolerance = dml_positive(L, at, "tolerance", s->tolerance);
        const long most = dml_count(L, at, "max_iterations", 1, s->max_iterations);
        if (most > 1000000) luaL_error(L, "field 'max_iterations' must be at most 1000000");
        s->max_iterations = (int)most;
    }
    lua_pop(L, 1);
}

/* sums = "compensated" or "plain" */
static void read_sums(lua_State *L, solver *s) {
    const char *kind = lua_getfield(L, 1, "sums") == LUA_TNIL ? "compensated" : lua_tostring(L, -1);
    if (!kind || (strcmp(kind, "plain") != 0 && strcmp(kind, "compensated") != 0))
        luaL_error(L, "field 'sums' must be \"compensated\" (the default) or \"plain\"");
    s->plain = strcmp(kind, "plain") == 0;
    lua_pop(L, 1);
}

/* h of the options, or that of a discrete Lagrangian, which has no other. */
static void read_step(lua_State *L, solver *s, const dml_system *system) {
    if (!s->pair) {
        s->h = dml_positive(L, 1, "h", 0);
        return;
    }
    s->h = dml_positive(L, 1, "h", system->h);
    if (s->h != system->h)
        luaL_error(L,
                   "field 'h' is %f, but the discrete Lagrangian was made with h = %f: leave it "
                   "out here",
                   s->h, system->h);
}

static int has_map(lua_State *L) {
    const int there = dml_systemfield(L, 2, "map") != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

/* A rule that does not know what the system has beside L is refused where it is named. */
static void check_constraints(lua_State *L, const solver *s) {
    static const char *const beside[] = {"constraint", "rolling", "force", "control", NULL};
    const int top = lua_gettop(L);
    int some = 0;
    for (const char *const *key = beside; *key; key++)
        some |= dml_systemfield(L, 2, *key) != LUA_TNIL;
    if (some && !s->pair) {
        const dml_model *m = dml_pushlast(L, 2, NULL);
        if (!(m->model.structure & DM_NO_VELOCITY)) { /* else no rule will do, and a run tells it */
            dml_refuselinear(L, s, m);
            dml_refuseconstraints(L, s, m);
        }
    }
    lua_settop(L, top);
}

/* solver options at 1, system at 2 */
static int new_solver(lua_State *L) {
    static const char *const known[] = {"rule", "h", "newton", "backend", "sums", "threads", NULL};
    dml_options(L, 1, known);
    if (dml_checksystem(L, 2)->ruled) dml_unfoldruled(L);
    const dml_system *system = dml_checksystem(L, 2);
    solver *s = lua_newuserdatauv(L, sizeof *s, DML_SOLVER_VALUES);
    memset(s, 0, sizeof *s);
    s->n = system->n;
    s->pair = system->pair;
    s->alone = system->pair || system->stand_in;
    lua_getfield(L, 1, "rule");
    if (lua_isnil(L, -1) && s->pair) lua_pop(L, 1), lua_pushstring(L, has_map(L) ? "map" : "del");
    read_rule(L, s);
    const dm_model none = {0};
    if (s->pair && dm_rule_engine(s->nodes, &none)->wants(s->nodes, &none) & DM_WANT_MAP &&
        !has_map(L))
        luaL_error(L,
                   "rule '%s' takes the step that a discrete Lagrangian brings with it as "
                   "map =, and this one has none: it is stepped by 'del'",
                   s->nodes[0].name);
    check_constraints(L, s);
    lua_setiuservalue(L, 3, DML_SOLVER_RULE);
    read_step(L, s, system);
    read_newton(L, s);
    read_sums(L, s);
    const long threads = dml_count(L, 1, "threads", 1, 1);
    if (threads > 1024) luaL_error(L, "field 'threads' must be at most 1024");
    s->threads = (int)threads;
    lua_getfield(L, 1, "backend");
    if (!lua_isnil(L, -1)) dml_findbackend(L, luaL_tolstring(L, -1, NULL)), lua_pop(L, 1);
    lua_setiuservalue(L, 3, DML_SOLVER_BACKEND);
    lua_pushvalue(L, 2);
    lua_setiuservalue(L, 3, DML_SOLVER_SYSTEM);
    luaL_setmetatable(L, DML_SOLVER);
    return 1;
}

/* Others know solvers of their own, as a field on a line or a discrete Lagrangian on a group: with
 * options at 1 and such a thing at 2, push thing:solver(options). 0: it is none. */
static int push_own(lua_State *L) {
    if (luaL_testudata(L, 2, DML_SYSTEM) || luaL_testudata(L, 2, DML_DISCRETE) ||
        !luaL_getmetafield(L, 2, "__index"))
        return 0;
    if (lua_getfield(L, 2, "solver") != LUA_TFUNCTION) return lua_settop(L, 2), 0;
    lua_pushvalue(L, 2);
    lua_pushvalue(L, 1);
    lua_call(L, 2, 1);
    return 1;
}

/* dm.solver{ system, rule =, h = } */
int dml_solver_new(lua_State *L) {
    lua_settop(L, 1);
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_newtable(L); /* the options without the system at [1] */
    for (lua_pushnil(L); lua_next(L, 1);) {
        if (lua_isinteger(L, -2) && lua_tointeger(L, -2) == 1) {
            lua_pop(L, 1);
            continue;
        }
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, 2);
    }
    if (lua_geti(L, 1, 1) == LUA_TNIL)
        luaL_error(L, "dm.solver needs a system or discrete Lagrangian as its first entry: "
                      "dm.solver{ system, rule = \"verlet\", h = 0.01 }");
    lua_remove(L, 1);
    if (push_own(L)) return 1;
    return new_solver(L);
}

/* system:solver{ rule =, h = } and Ld:solver{} */
int dml_solver_of(lua_State *L) {
    lua_settop(L, 2);
    dml_checksystem(L, 1);
    if (lua_isnil(L, 2)) lua_newtable(L), lua_replace(L, 2);
    if (!lua_istable(L, 2))
        luaL_error(L,
                   "a solver takes a table of options: system:solver { rule = \"verlet\", h = 0.01 "
                   "} (got %s)",
                   luaL_typename(L, 2));
    lua_insert(L, 1);
    return new_solver(L);
}
