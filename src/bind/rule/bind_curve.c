/* bind_curve.c - `dm.curve`: an explicit one-step method as the curve segments of a variational
 * rule. */
#include "bind/rule/curve_recipes.h"
#include "code/tape/tape.h"

#include "integ/curve/curve_choice.h"

#include <math.h>
#include <string.h>

const dm_curve *dml_tocurve(lua_State *L, int arg) {
    const dml_rule *r = dml_torule(L, arg);
    return r && r->rule.method->engine == &dm_engine_curve ? r->rule.data : NULL;
}

/* Names what there is: tables of our own, then GSL's steppers. */
static void unknown_method(lua_State *L, const char *name) {
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    lua_pushfstring(L, "unknown one-step method '%s'; known ones: straight", name);
    luaL_addvalue(&b);
    for (int i = 0; dm_curve_name(i, NULL); i++) {
        luaL_addstring(&b, ", ");
        luaL_addstring(&b, dm_curve_name(i, NULL));
    }
    luaL_addstring(&b, ", and GSL's gsl-rk2, gsl-rk4, gsl-rkf45, gsl-rkck, gsl-rk8pd");
    luaL_pushresult(&b);
    luaL_error(L, "%s", lua_tostring(L, -1));
}

static void found_method(lua_State *L, dm_curve *c, const char *name) {
    if (!dm_curve_find(c, name)) unknown_method(L, name);
}

/* The order of a method that no coefficients describe, from its recipe for two coordinates. */
static int measure(lua_State *L, const dm_curve *c) {
    int order = 0;
    dm_arena *arena = dml_pusharena(L);
    const dm_status status = dm_curve_measure_recipe(&order, c, dm_tape_build, arena);
    if (status != DM_OK) luaL_error(L, "the method: %s", dm_status_text(status));
    if (!order)
        luaL_error(L, "the method is not consistent: steps of h and h/2 do not come nearer to the "
                      "solution of x' = f(x)");
    lua_pop(L, 1);
    return order;
}

/* A method written in Lua is traced here: where it is linear in the values of f its coefficients
 * are all that is kept of it. The dm_curve is at 2. */
static void own_method(lua_State *L, dm_curve *c, int fn) {
    const int linear = dml_curve_tableau(L, fn, c);
    if (!linear) {
        lua_getiuservalue(L, 2, 1);
        lua_pushvalue(L, fn);
        lua_setfield(L, -2, "method");
        lua_pop(L, 1);
        memset(c, 0, sizeof *c);
        c->bias = 1.0;
        c->recipe = dml_curve_for(L, 2, 2)->recipe;
    }
    strcpy(c->name, "own method");
    c->order = !linear     ? measure(L, c)
               : c->lifted ? dm_curve_measure(c)
                           : dm_curve_conditions(c, NULL);
    const long claimed = dml_count(L, 1, "order", 1, 1);
    if (claimed > c->order && c->order < 8)
        luaL_error(L, "field 'order' is %d, but the method has order %d only (%s)", (int)claimed,
                   c->order,
                   c->lifted || !linear
                       ? "measured where accelerations depend on q"
                       : "its coefficients satisfy the order conditions up to there");
}

static const void *for_space(lua_State *L, int data, uint32_t n) {
    return dml_curve_for(L, data, n);
}

/* method = a name or a function, of the options at 1 */
static void read_method(lua_State *L, dm_curve *c) {
    lua_getfield(L, 1, "method");
    if (lua_type(L, -1) == LUA_TSTRING)
        found_method(L, c, lua_tostring(L, -1));
    else if (lua_isfunction(L, -1))
        own_method(L, c, lua_gettop(L));
    else
        luaL_error(L,
                   "field 'method' must be the name of a one-step method, for instance \"rk4\", or "
                   "a function(x, f, h) that gives x after a step h of x' = f(x) (got %s)",
                   luaL_typename(L, -1));
    lua_pop(L, 1);
}

/* May all substeps have points of their own, on both sides of the bias? */
static void check_points(lua_State *L, const dm_curve *c) {
    double share[DM_CURVE_STAGES];
    dm_curve all;
    if (c->recipe) return;
    for (int i = 0; i < c->substeps; i++) share[i] = 1.0 / c->substeps;
    if (!dm_curve_compose(&all, c, share) || !dm_curve_bias(&all, c->bias))
        luaL_error(L, "field 'substeps': %d of them with this method take more than %d points",
                   c->substeps, DM_CURVE_STAGES);
}

/* substeps = a function (x, h, t), and most; after the method, before the bias */
static void read_substeps(lua_State *L, dm_curve *c) {
    const int type = lua_getfield(L, 1, "substeps");
    const long most = dml_count(L, 1, "most", 1, 4);
    if (type == LUA_TNIL) {
        lua_pop(L, 1);
        return;
    }
    if (type != LUA_TFUNCTION)
        luaL_error(L,
                   "field 'substeps' must be a function(x, h, t) that gives how many substeps a "
                   "step has, or a list of their weights (got %s)",
                   luaL_typename(L, -1));
    if (most > DM_CURVE_STAGES) luaL_error(L, "field 'most' must be at most %d", DM_CURVE_STAGES);
    lua_getiuservalue(L, 2, 1);
    lua_insert(L, -2);
    lua_setfield(L, -2, "substeps");
    lua_pushnil(L);
    lua_rawseti(L, -2, 2); /* the copy for two coordinates has no choice yet */
    lua_pop(L, 1);
    const dm_curve_choice *choice = dml_curve_for(L, 2, 2)->choice;
    if (!choice->bare && (choice->outputs < 2 || choice->outputs > DM_CURVE_STAGES))
        luaL_error(L, "field 'substeps': a list of weights has 2 to %d of them (got %d)",
                   DM_CURVE_STAGES, choice->outputs);
    c->choice = choice;
    c->substeps = choice->bare ? (int)most : choice->outputs;
}

/* The bias is the part of a step that lies behind (q, v). With points on both sides there are
 * more of them than the method has stages. */
static void read_bias(lua_State *L, dm_curve *c) {
    const double bias = dml_number(L, 1, "bias", c->bias);
    if (!(bias >= 0.0 && bias <= 1.0))
        luaL_error(L,
                   "field 'bias' must be a number from 0 to 1, the part of a step that lies behind "
                   "(q, v) (got %f)",
                   bias);
    if (!dm_curve_bias(c, bias))
        luaL_error(L,
                   "field 'bias': a method of %d stages can begin or end a segment (bias 1 or 0), "
                   "both sides of (q, v) would take more than %d points",
                   c->s, DM_CURVE_STAGES);
}

/* dm.curve(name, options) -> options with the name at 1 */
static void read_name(lua_State *L) {
    lua_settop(L, 2);
    if (lua_isnil(L, 2)) lua_newtable(L), lua_replace(L, 2);
    luaL_checktype(L, 2, LUA_TTABLE);
    lua_newtable(L);
    for (lua_pushnil(L); lua_next(L, 2);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, 3);
    }
    lua_pushvalue(L, 1);
    lua_setfield(L, 3, "method");
    lua_replace(L, 1);
}

/* The curve lies in a userdata that the rule keeps, so that solvers which have the rule have it
 * too. */
int dml_curve_new(lua_State *L) {
    static const char *const known[] = {"method", "bias", "order", "substeps", "most", NULL};
    if (lua_type(L, 1) == LUA_TSTRING) read_name(L);
    lua_settop(L, 1);
    luaL_checktype(L, 1, LUA_TTABLE);
    dml_options(L, 1, known);
    dm_curve *c = lua_newuserdatauv(L, sizeof *c, 1);
    lua_newtable(L); /* what is traced again for every dim Q */
    lua_setiuservalue(L, 2, 1);
    read_method(L, c);
    read_substeps(L, c);
    read_bias(L, c);
    if (c->choice) check_points(L, c);
    if (c->bias == 1.0)
        lua_pushfstring(L, "curve(%s)", c->name);
    else
        lua_pushfstring(L, "curve(%s, %f)", c->name, c->bias);
    lua_pushvalue(L, 2);
    const int own = c->recipe || c->choice;
    dml_rule *rule = dml_pushrule(L, "curve", c, lua_tostring(L, 3));
    if (own) rule->for_space = for_space;
    return 1;
}

static const dml_row functions[] = {
    {"curve", dml_curve_new,
     "dm.curve(name [, {bias=}]) -> dm.rule   or   dm.curve{method=, bias=, order=}\n"
     "Curve segments for rule =: an explicit one-step method made variational, symplectic and of "
     "the order of the method. Names: straight, euler, midpoint, heun, kutta3, rk4, dopri5, "
     "butcher6, fehlberg7, dop853, and GSL's gsl-rk2, gsl-rk4, gsl-rkf45, gsl-rkck, gsl-rk8pd. "
     "method may be a function(x, f, h) or function(x, f, h, t) that gives the state x = (q, v), "
     "a vector of 2 n entries, after a step h of x' = f(x) (f(x, t) takes the time too). "
     "f:along(x, u, ...) is the derivative of f at x along u, the second one along two "
     "directions, ..., at most four, for Taylor methods: x + h*k + h^2/2*f:along(x, k), k = f(x). "
     "f:along(x, t, u, ...) takes the time too, which goes on at the rate 1 along u and at another "
     "one along { u, rate }: x + h*k + h^2/2*f:along(x, t, k), k = f(x, t). "
     "substeps = function(x, h, t): how many equal substeps of the method a step has (rounded, 1 "
     "to `most`, 4 unless given), or a list of weights of substeps (rounded to whole numbers, 0: "
     "left out), from the state at its start; held for the step, derivatives too, so that a step "
     "is symplectic wherever the choice does not change; solver:report().substeps_per_step. "
     "method and substeps are read here: upvalues of theirs keep the values that they have now. "
     "The order is found, and `order` (optional) checked against it. Methods that are linear in "
     "the values of f, as Runge-Kutta, leapfrog and Nystroem methods are, become tables of "
     "numbers; any other is written out as one expression. bias in [0, 1]: the part of a step "
     "behind (q, v), 1 unless given, 1/2 for "
     "\"straight\" and for symmetric rules; straight segments with bias 1/2 are the midpoint "
     "rule, with 0 and 1 the two symplectic Euler methods. Systems may have force, control, "
     "constraint and rolling. The rule as text: rule = "
     "\"curve(rk4)\", \"curve(rk4, 0.5)\" (Cuell-Patrick 2008)."},
    {NULL, NULL, NULL}};

const dml_class dml_class_curve = {
    .functions = functions,
};
