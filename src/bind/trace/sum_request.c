#include "bind/trace/sum_request.h"

#include "bind/trace/traced_call.h"
#include "bind/value/array.h"

#include <math.h>

static const char *const what = "the function of dm.sum_over";

/* The last function among the arguments; what stands behind it is the table of options. */
static void find_function(lua_State *L, dml_sum_request *r) {
    const int top = lua_gettop(L);
    for (r->fn = 1; r->fn <= top && !lua_isfunction(L, r->fn); r->fn++) {}
    if (r->fn > top || r->fn == 1)
        luaL_error(L, "dm.sum_over needs vectors and then a function of what one body has of them: "
                      "dm.sum_over(q, v, function(x, u) return u^2/2 - x^4 end)");
    r->given = r->fn - 1;
    if (r->given > DML_SUM_VECTORS)
        luaL_error(L, "dm.sum_over takes at most %d vectors (got %d)", DML_SUM_VECTORS, r->given);
    if (top > r->fn + 1)
        luaL_error(L,
                   "dm.sum_over takes vectors, a function and one table of options (got %d "
                   "arguments)",
                   top);
    lua_settop(L, r->fn + 1);
}

/* a side of the box: infinite is none; 2 (within + margin) itself is large enough, as rounded as a
 * script may have it */
static void read_side(lua_State *L, dml_sum_request *r, uint32_t axis) {
    const double side = lua_tonumber(L, -1);
    if (lua_type(L, -1) != LUA_TNUMBER || !(side > 0.0))
        luaL_error(L, "field 'box' must be a side > 0, or a list of %d of them (math.huge: open)",
                   (int)r->axes);
    r->box[axis] = isfinite(side) ? side : 0.0;
    if (r->box[axis] > 0.0 && r->box[axis] < 2.0 * (r->within + r->margin) * (1.0 - 1e-15))
        luaL_error(L,
                   "the box is too small: its side %f must be at least 2 (within + margin) = %f, "
                   "else a body would meet two images of another one",
                   r->box[axis], 2.0 * (r->within + r->margin));
}

/* one side for all axes, or one for each */
static void read_box(lua_State *L, dml_sum_request *r, int options) {
    const int type = lua_getfield(L, options, "box");
    if (type != LUA_TNIL && type != LUA_TNUMBER && dml_length(L, -1) != (long)r->axes)
        luaL_error(L, "field 'box' must be a side > 0, or a list of %d of them (got %s)",
                   (int)r->axes, luaL_typename(L, -1));
    for (uint32_t a = 0; type != LUA_TNIL && a < r->axes; a++) {
        if (type == LUA_TNUMBER)
            lua_pushvalue(L, -1);
        else
            lua_geti(L, -1, (lua_Integer)a + 1);
        read_side(L, r, a);
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
}

/* within, margin and box of pairs; the first vector has the positions */
static void read_near(lua_State *L, dml_sum_request *r, int options, int pairs) {
    static const char *const own[] = {"margin", "box"};
    r->within = dml_positive(L, options, "within", INFINITY);
    if (!isfinite(r->within)) r->within = 0.0;
    for (size_t k = 0; k < 2; k++) {
        const int given = lua_getfield(L, options, own[k]) != LUA_TNIL;
        lua_pop(L, 1);
        if (given && !(r->within > 0.0))
            luaL_error(L, "'%s' goes with 'within', the distance of near pairs", own[k]);
    }
    if (!(r->within > 0.0)) return;
    if (!pairs) luaL_error(L, "'within' goes with pairs = true: pairs nearer than that distance");
    r->margin = dml_number(L, options, "margin", 0.1 * r->within);
    if (!(r->margin >= 0.0)) luaL_error(L, "field 'margin' must be >= 0 (got %f)", r->margin);
    for (int k = 1; k <= r->given && !r->axes; k++) r->axes = r->width[k];
    if (r->axes > 3)
        luaL_error(L,
                   "'within' takes positions of 1 to 3 coordinates, those of the first vector "
                   "(block = %d)",
                   (int)r->axes);
    read_box(L, r, options);
}

/* shift, periodic, pairs, once the number of bodies is known */
static void read_pattern(lua_State *L, dml_sum_request *r, int options) {
    const int pairs = dml_flag(L, options, "pairs", 0);
    const long shift = dml_count(L, options, "shift", 0, 0);
    r->periodic = dml_flag(L, options, "periodic", 0);
    if (pairs && (shift || r->periodic))
        luaL_error(L, "'pairs' stands alone: all pairs of bodies have no 'shift' and no 'periodic' "
                      "end");
    if (r->periodic && !shift)
        luaL_error(L, "'periodic' joins the last body to the first: give 'shift' (1: the next "
                      "neighbour) too");
    if (shift && shift >= (long)r->bodies)
        luaL_error(L, "field 'shift' must be from 1 to %d for %d bodies (got %d)",
                   (int)r->bodies - 1, (int)r->bodies, (int)shift);
    read_near(L, r, options, pairs);
    r->from = pairs ? 1 : (uint32_t)shift;
    r->to = pairs ? r->bodies - 1 : (uint32_t)shift;
}

/* how much of argument k a body has; the first vector says how many bodies there are */
static void read_vector(lua_State *L, dml_sum_request *r, int k) {
    dml_scalar x;
    if (dml_toscalar(L, k, &x)) {
        r->width[k] = 0;
        return;
    }
    if (dml_length(L, k) < 0)
        luaL_error(L,
                   "dm.sum_over: argument %d must be a vector, a table of numbers or a number (got "
                   "%s)",
                   k, luaL_typename(L, k));
    const uint32_t n = dml_vectorat(L, k)->rows;
    if (!r->bodies) {
        if (n == 0 || n % r->block)
            luaL_error(L,
                       "dm.sum_over: argument %d has %d entries, which is no number of bodies with "
                       "%d each",
                       k, (int)n, (int)r->block);
        r->bodies = n / r->block;
    }
    if (n != r->bodies && n != r->bodies * r->block)
        luaL_error(L,
                   "dm.sum_over: argument %d has %d entries, but there are %d bodies (block = %d)",
                   k, (int)n, (int)r->bodies, (int)r->block);
    r->width[k] = n / r->bodies;
}

/* arguments of the function: those of the body, of its partner, then scalars */
static void add_arguments(lua_State *L, dml_sum_request *r, int scalars) {
    for (int k = 1; k <= r->given; k++) {
        if ((r->width[k] == 0) != scalars) continue;
        if (r->signature.arguments == DML_MAX_ARGUMENTS)
            luaL_error(L, "dm.sum_over: the function would take more than %d arguments",
                       DML_MAX_ARGUMENTS);
        r->signature.length[r->signature.arguments++] =
            r->width[k] > 1 ? (int)r->width[k] : DML_SCALAR_ARGUMENT;
    }
}

/* a Lua function that names fewer or more arguments than it gets is a mistake */
static void check_arity(lua_State *L, const dml_sum_request *r) {
    lua_Debug about;
    if (lua_iscfunction(L, r->fn)) return;
    lua_pushvalue(L, r->fn);
    lua_getinfo(L, ">u", &about);
    if (about.isvararg) return;
    if (about.nparams != r->signature.arguments)
        luaL_error(L, "%s takes %d argument%s, but gets %d: what a body has of each vector%s", what,
                   about.nparams, about.nparams == 1 ? "" : "s", r->signature.arguments,
                   r->from ? ", then the same of its partner, then numbers" : ", then numbers");
}

/* Raises where shapes do not fit; r->given vectors and numbers stand from 1 on. */
void dml_read_sum(lua_State *L, dml_sum_request *r) {
    static const char *const known[] = {"shift",  "periodic", "pairs", "block",
                                        "within", "margin",   "box",   NULL};
    find_function(L, r);
    const int options = r->fn + 1, plain = lua_isnil(L, options);
    if (!plain) luaL_checktype(L, options, LUA_TTABLE);
    if (!plain) dml_options(L, options, known);
    const long block = plain ? 1 : dml_count(L, options, "block", 1, 1);
    if (block > INT32_MAX) luaL_error(L, "field 'block' must be at most %d", INT32_MAX);
    r->block = (uint32_t)block;
    for (int k = 1; k <= r->given; k++) read_vector(L, r, k);
    if (!r->bodies) luaL_error(L, "dm.sum_over: one argument before the function must be a vector");
    if (!plain) read_pattern(L, r, options);
    r->signature = (dml_signature){.what = what, .outputs = DML_SCALAR_ARGUMENT};
    add_arguments(L, r, 0);
    if (r->from) add_arguments(L, r, 0); /* a partner's, also where one body has none */
    add_arguments(L, r, 1);
    check_arity(L, r);
}
