/* bind_bundle.c - `dm.bundle`: discrete tangent bundles made of curve segments. */
#include "bind/rule/bind_bundle.h"

#include <math.h>
#include <string.h>

static dml_bundle *check(lua_State *L) {
    return luaL_checkudata(L, 1, DML_BUNDLE);
}

/* ---- evaluation ---- */

void dml_bundle_raise(lua_State *L, dm_status status, const char *what) {
    if (status == DM_SINGULAR)
        luaL_error(L,
                   "%s: the kernels of T d- and T d+ meet here (bundle:check tells from which h "
                   "on): try a smaller h",
                   what);
    if (status == DM_NO_CONVERGENCE)
        luaL_error(L,
                   "%s: no element of the bundle has these ends (Newton's method did not "
                   "converge): are they one step of h apart?",
                   what);
    if (status != DM_OK) luaL_error(L, "%s: %s", what, dm_status_text(status));
}

/* The kernels are of the system as it is now: a changed upvalue of L is seen. The userdata keeps
 * the model alive, which keeps the kernels. */
dm_bundle *dml_pushbundle(lua_State *L) {
    const dml_bundle *b = check(L);
    lua_getiuservalue(L, 1, DML_BUNDLE_SYSTEM);
    dml_model *m = dml_pushlast(L, lua_gettop(L), NULL);
    if (!m->graph)
        luaL_error(L, "a bundle needs a Lagrangian that can be traced; this one runs on hyper-dual "
                      "numbers");
    if (m->model.structure & DM_LINEAR_IN_V ||
        (m->model.structure & DM_CONSTANT_MASS && !m->model.inverse_mass))
        luaL_error(L, "L is degenerate, it has no second-order field for the segments to follow");
    dml_want(L, m, DM_WANT_VALUE | DM_WANT_MASS, NULL);
    const size_t work = dm_bundle_work(b->curve, &m->model);
    dm_bundle *out = lua_newuserdatauv(L, sizeof *out + work * sizeof(double), 1);
    memset(out + 1, 0, work * sizeof(double));
    lua_insert(L, -2);
    lua_setiuservalue(L, -2, 1); /* the model */
    lua_remove(L, -2);
    const dm_status status =
        dm_bundle_open(out, b->curve, &m->model, b->h, (double *)(void *)(out + 1));
    dml_bundle_raise(L, status, "the bundle");
    return out;
}

/* (q, v) at `arg` and the next, t behind them; leaves a userdata on the stack */
static dm_element element_at(lua_State *L, int arg, int time) {
    const uint32_t n = check(L)->n;
    double *y = lua_newuserdatauv(L, 2 * (size_t)n * sizeof *y, 0);
    dml_vectorarg(L, arg, "q", y, n);
    dml_vectorarg(L, arg + 1, "v", y + n, n);
    return (dm_element){y, y + n, dml_optnumber(L, time, 0.0)};
}

/* d-(y) or d+(y) of the element (q, v) at 2, 3, at the time at 4. */
static int push_end(lua_State *L, int plus) {
    lua_settop(L, 4);
    const dm_element e = element_at(L, 2, 4);
    dm_bundle *b = dml_pushbundle(L);
    double *other = lua_newuserdatauv(L, b->n * sizeof *other, 0);
    double *out = dml_pushvector(L, b->n);
    dml_bundle_raise(L,
                     plus ? dm_bundle_ends(b, other, out, &e) : dm_bundle_ends(b, out, other, &e),
                     "the segment");
    return 1;
}

static int bundle_minus(lua_State *L) {
    return push_end(L, 0);
}

static int bundle_plus(lua_State *L) {
    return push_end(L, 1);
}

/* Both ends of a segment from one evaluation. */
static int bundle_pair(lua_State *L) {
    lua_settop(L, 4);
    const dm_element e = element_at(L, 2, 4);
    dm_bundle *b = dml_pushbundle(L);
    double *minus = dml_pushvector(L, b->n), *plus = dml_pushvector(L, b->n);
    dml_bundle_raise(L, dm_bundle_ends(b, minus, plus, &e), "the segment");
    return 2;
}

/* T d-(y) or T d+(y), a matrix of n rows: columns of dq, then of dv. */
static int push_tangent(lua_State *L, int plus) {
    lua_settop(L, 4);
    const dm_element e = element_at(L, 2, 4);
    dm_bundle *b = dml_pushbundle(L);
    const size_t half = 2 * (size_t)b->n * b->n;
    double *D = lua_newuserdatauv(L, 2 * half * sizeof *D, 0);
    dml_bundle_raise(L, dm_bundle_tangents(b, D, &e), "the segment");
    memcpy(dml_pushmatrix(L, b->n, 2 * b->n), D + (plus ? half : 0), half * sizeof *D);
    return 1;
}

static int bundle_tangent_minus(lua_State *L) {
    return push_tangent(L, 0);
}

static int bundle_tangent_plus(lua_State *L) {
    return push_tangent(L, 1);
}

/* two vectors (dq, dv) with the given images */
static int push_lift(lua_State *L, const dm_element *e, const double *minus, const double *plus) {
    dm_bundle *b = dml_pushbundle(L);
    const int bundle = lua_gettop(L);
    double *y = lua_newuserdatauv(L, 2 * (size_t)b->n * sizeof *y, 0);
    dml_bundle_raise(L, dm_bundle_lift(b, y, minus ? minus : b->zero, plus ? plus : b->zero, e),
                     "the variation");
    memcpy(dml_pushvector(L, b->n), y, b->n * sizeof *y);
    memcpy(dml_pushvector(L, b->n), y + b->n, b->n * sizeof *y);
    lua_remove(L, bundle + 1);
    lua_remove(L, bundle);
    return 2;
}

/* The element that one end keeps and the other moves by a tangent vector. */
static int vertical(lua_State *L, int plus) {
    lua_settop(L, 5);
    const dm_element e = element_at(L, 2, 5);
    double *dq = lua_newuserdatauv(L, check(L)->n * sizeof *dq, 0);
    dml_vectorarg(L, 4, "dq", dq, check(L)->n);
    return push_lift(L, &e, plus ? NULL : dq, plus ? dq : NULL);
}

static int bundle_vertical_minus(lua_State *L) {
    return vertical(L, 0);
}

static int bundle_vertical_plus(lua_State *L) {
    return vertical(L, 1);
}

/* T d-, T d+ of (dq, dv), lifted back one by one */
static int bundle_split(lua_State *L) {
    const uint32_t n = check(L)->n, N = 2 * n;
    lua_settop(L, 6);
    const dm_element e = element_at(L, 2, 6);
    double *y = lua_newuserdatauv(L, N * sizeof *y, 0);
    dml_vectorarg(L, 4, "dq", y, n);
    dml_vectorarg(L, 5, "dv", y + n, n);
    dm_bundle *b = dml_pushbundle(L);
    double *D = lua_newuserdatauv(L, ((size_t)N * N + N) * sizeof *D, 0), *end = D + N * N;
    dml_bundle_raise(L, dm_bundle_tangents(b, D, &e), "the segment");
    for (uint32_t i = 0; i < N; i++) {
        end[i] = 0.0;
        for (uint32_t j = 0; j < N; j++) end[i] += D[i * N + j] * y[j];
    }
    push_lift(L, &e, NULL, end + n);
    push_lift(L, &e, end, NULL);
    return 4;
}

/* p- and p+ of an element: the Legendre transforms of Ld at it. */
static int bundle_momenta(lua_State *L) {
    double action;
    lua_settop(L, 4);
    const dm_element e = element_at(L, 2, 4);
    dm_bundle *b = dml_pushbundle(L);
    double *p0 = dml_pushvector(L, b->n), *p1 = dml_pushvector(L, b->n);
    dml_bundle_raise(L, dm_bundle_momenta(b, p0, p1, &action, &e), "the Legendre transforms");
    return 2;
}

/* Ld(y): the action along the segment. */
static int bundle_action(lua_State *L) {
    double action;
    lua_settop(L, 4);
    const dm_element e = element_at(L, 2, 4);
    dm_bundle *b = dml_pushbundle(L);
    double *p = lua_newuserdatauv(L, 2 * (size_t)b->n * sizeof *p, 0);
    const dm_status status = dm_bundle_momenta(b, p, p + b->n, &action, &e);
    dml_bundle_raise(L, status == DM_SINGULAR ? DM_OK : status, "the action");
    lua_pushnumber(L, action);
    return 1;
}

/* The element whose ends are q0 and q1: found by Newton's method. */
static int bundle_velocity(lua_State *L) {
    const uint32_t n = check(L)->n;
    lua_settop(L, 4);
    double *y = lua_newuserdatauv(L, 2 * (size_t)n * sizeof *y, 0);
    dml_vectorarg(L, 2, "q0", y, n);
    dml_vectorarg(L, 3, "q1", y + n, n);
    const double *ends[2] = {y, y + n};
    dm_bundle *b = dml_pushbundle(L);
    double *q = dml_pushvector(L, n), *v = dml_pushvector(L, n);
    dml_bundle_raise(L, dm_bundle_find(b, q, v, ends, dml_optnumber(L, 4, 0.0)), "velocity");
    return 2;
}

static int bundle_tostring(lua_State *L) {
    const dml_bundle *b = check(L);
    lua_getiuservalue(L, 1, DML_BUNDLE_SYSTEM);
    dml_systemfield(L, -1, "Q");
    const char *Q = luaL_tolstring(L, -1, NULL);
    lua_pushfstring(L,
                    "discrete tangent bundle of %s: segments by '%s', bias %f, h = %f, dim V = %d",
                    Q, b->curve->name, b->curve->bias, b->h, (int)(2 * b->n));
    return 1;
}

/* b.h, b.bias, b.dimension, b.segments, b.system. */
static int bundle_field(lua_State *L) {
    const dml_bundle *b = check(L);
    const char *key = luaL_checkstring(L, 2);
    if (strcmp(key, "h") == 0)
        lua_pushnumber(L, b->h);
    else if (strcmp(key, "bias") == 0)
        lua_pushnumber(L, b->curve->bias);
    else if (strcmp(key, "dimension") == 0)
        lua_pushinteger(L, 2 * (lua_Integer)b->n);
    else if (strcmp(key, "segments") == 0)
        lua_getiuservalue(L, 1, DML_BUNDLE_SEGMENTS);
    else if (strcmp(key, "system") == 0)
        lua_getiuservalue(L, 1, DML_BUNDLE_SYSTEM);
    else
        return 0;
    return 1;
}

static const dml_row meta[] = {{"__tostring", bundle_tostring, NULL}, {NULL, NULL, NULL}};
static const dml_row methods[] =
    {{"minus", bundle_minus,
      "bundle:minus(q, v [, t]) -> dm.vector\n"
      "The boundary map d-: where the segment of (q, v) begins. t (default 0) is the time at q."},
     {"plus", bundle_plus,
      "bundle:plus(q, v [, t]) -> dm.vector\n"
      "The boundary map d+: where the segment of (q, v) ends."},
     {"pair", bundle_pair,
      "bundle:pair(q, v [, t]) -> q0, q1\n"
      "Both ends of the segment: the Moser-Veselov pair that (q, v) stands for."},
     {"velocity", bundle_velocity,
      "bundle:velocity(q0, q1 [, t]) -> q, v\n"
      "The element (q, v) whose segment goes from q0 to q1, the inverse of pair; for q0 = q1 the "
      "zero of the bundle there. Raises when there is none near straight motion."},
     {"tangent_minus", bundle_tangent_minus,
      "bundle:tangent_minus(q, v [, t]) -> dm.matrix, n x 2n\n"
      "T d-, the exact derivative of minus; columns dq, dv."},
     {"tangent_plus", bundle_tangent_plus,
      "bundle:tangent_plus(q, v [, t]) -> dm.matrix, n x 2n\n"
      "T d+, the exact derivative of plus; columns dq, dv."},
     {"vertical_minus", bundle_vertical_minus,
      "bundle:vertical_minus(q, v, dq [, t]) -> dq, dv\n"
      "The variation dq^- of (q, v) that moves the beginning by dq and leaves the end: T d-(dq^-) "
      "= dq, T d+(dq^-) = 0."},
     {"vertical_plus", bundle_vertical_plus,
      "bundle:vertical_plus(q, v, dq [, t]) -> dq, dv\n"
      "The variation dq^+ of (q, v) that moves the end by dq and leaves the beginning: T d+(dq^+) "
      "= dq, T d-(dq^+) = 0."},
     {"split", bundle_split,
      "bundle:split(q, v, dq, dv [, t]) -> dq+, dv+, dq-, dv-\n"
      "The variation (dq, dv) as a sum of one that leaves the beginning, (dq+, dv+), and one that "
      "leaves the end, (dq-, dv-)."},
     {"action", bundle_action,
      "bundle:action(q, v [, t]) -> number\n"
      "The discrete Lagrangian: the action along the segment, by the weights of its method."},
     {"momenta", bundle_momenta,
      "bundle:momenta(q, v [, t]) -> p0, p1\n"
      "Both discrete Legendre transforms: dLd = p1 dq1 - p0 dq0. A path of the rule has p1 of a "
      "step equal to p0 of the next."},
     {"check", dml_bundle_check,
      "bundle:check{q=, v=, t=} -> table, sentence\n"
      "Is it a discrete tangent bundle at (q, v)? dimension = 2 dim Q; minus, plus: smallest "
      "singular values of T d- and T d+ (submersions); transversal: that of ((T d+ + T d-)/2, (T "
      "d+ - T d-)/h), 0 where the kernels meet; zero: the element without extent at q; limit: the "
      "order in h at which that matrix tends to the identity (at least 1; infinity: it is the "
      "identity); largest_h: the first h up to 1000 of its own at which the kernels meet, or "
      "infinity; ok: all of it holds (Cuell-Patrick 2008, definition 2, proposition 1)."},
     {NULL, NULL, NULL}};
static const dml_row functions[] =
    {{"bundle", dml_bundle_new,
      "dm.bundle{system=, h=, segments=, bias=} -> dm.bundle   or   dm.bundle{Q=, h=, bias=}\n"
      "A discrete tangent bundle: to every (q, v) belongs a curve segment of duration h. segments: "
      "\"straight\" (the default), the name of a one-step method that follows the field of the "
      "system, or a dm.curve; bias (1/2 for straight segments, else 1): the part of h behind q. "
      "With straight segments and Q alone: Moser-Veselov pairs."},
     {NULL, NULL, NULL}};

const dml_class dml_class_bundle = {
    .name = DML_BUNDLE,
    .doc = "dm.bundle: a discrete tangent bundle (V, d-, d+) of curve segments, made by "
           "dm.bundle{system=, h=}\n"
           "fields: system, segments, h, bias, dimension",
    .meta = meta,
    .methods = methods,
    .field = bundle_field,
    .functions = functions,
};
