/* bind_galerkin.c - `dm.galerkin`: curves of any degree with a user's nodes and weights. */
#include "bind/rule/bind_rule.h"
#include "bind/value/value.h"
#include "integ/rules/galerkin.h"

#include <math.h>

static const double EXACT = 1e-13; /* of a moment: nodes are given as doubles */

/* the table or vector in field `key` as *count numbers; 0 when it is nil */
static int read_numbers(lua_State *L, const char *key, long double *out, int *count) {
    double x[DM_QUADRATURE_NODES];
    const int there = lua_getfield(L, 1, key) != LUA_TNIL;
    if (there) {
        const long length = dml_length(L, -1);
        if (length < 1 || length > DM_QUADRATURE_NODES)
            luaL_error(L, "field '%s' must be a table or vector of 1 to %d numbers (got %s)", key,
                       DM_QUADRATURE_NODES, luaL_typename(L, -1));
        *count = (int)length;
        dml_numbers(L, 1, key, x, (uint32_t)length);
        for (int i = 0; i < *count; i++) out[i] = (long double)x[i];
    }
    lua_pop(L, 1);
    return there;
}

/* Nodes ascend and lie in [0, 1], so that a curve passes them in order. */
static void check_nodes(lua_State *L, const dm_quadrature *q) {
    for (int i = 0; i < q->r; i++) {
        const double c = (double)q->c[i];
        if (c < 0.0 || c > 1.0)
            luaL_error(L, "field 'nodes': entry %d is %f; nodes lie in [0, 1], the step as unit",
                       i + 1, c);
        if (i && q->c[i] <= q->c[i - 1])
            luaL_error(L, "field 'nodes' must hold growing numbers (entry %d is %f)", i + 1, c);
    }
}

/* nodes, and weights as given (their sum made 1 to the last bit) or those of highest degree */
static void read_quadrature(lua_State *L, dm_quadrature *q) {
    int weights = 0;
    long double sum = 0.0L;
    if (!read_numbers(L, "nodes", q->c, &q->r))
        luaL_error(L, "field 'nodes' is missing: give the nodes of the quadrature, numbers in [0, "
                      "1]");
    check_nodes(L, q);
    if (!read_numbers(L, "weights", q->b, &weights)) {
        dm_quadrature_interpolate(q);
        return;
    }
    if (weights != q->r)
        luaL_error(L, "field 'weights' has %d entries for %d nodes", weights, q->r);
    for (int i = 0; i < q->r; i++) sum += q->b[i];
    if (!(fabsl(sum - 1.0L) <= (long double)EXACT))
        luaL_error(L,
                   "field 'weights': their sum must be 1, it is off by %f: weights are those of "
                   "[0, 1]",
                   (double)(sum - 1.0L));
    for (int i = 0; i < q->r; i++) q->b[i] /= sum;
}

/* the quadrature must tell the polynomials of degree s - 1 from each other, and integrate them */
static void check_degree(lua_State *L, int s, const dm_quadrature *q) {
    const int degree = dm_quadrature_degree(q, EXACT);
    if (q->r < s)
        luaL_error(L, "field 'degree' is %d: curves of degree %d need %d nodes at least (got %d)",
                   s, s, s, q->r);
    if (degree < s - 1)
        luaL_error(L,
                   "curves of degree %d need a quadrature exact to degree %d; these weights are "
                   "exact to degree %d (leave 'weights' out for the best ones of these nodes)",
                   s, s - 1, degree);
}

/* functions = or curve =: a space of one's own (lua/dm/trial) */
static int is_space(lua_State *L) {
    const int there = dml_field(L, 1, "functions") | dml_field(L, 1, "curve");
    lua_pop(L, 2);
    return there;
}

static int push_space(lua_State *L) {
    lua_getglobal(L, "require");
    lua_pushliteral(L, "dm.trial");
    lua_call(L, 1, 1);
    lua_getfield(L, -1, "own_space");
    lua_pushvalue(L, 1);
    if (!dml_try(L, 1, 1)) luaL_error(L, "%s", lua_tostring(L, -1)); /* with the caller's line */
    return 1;
}

/* Nodes and weights become the data of a rule; degree and quadrature decide its order. */
static int galerkin_new(lua_State *L) {
    static const char *const known[] = {"degree", "nodes", "weights", NULL};
    dm_quadrature q = {0};
    lua_settop(L, 1);
    luaL_checktype(L, 1, LUA_TTABLE);
    if (is_space(L)) return push_space(L);
    dml_options(L, 1, known);
    const long degree = dml_count(L, 1, "degree", 1, 0);
    if (degree > DM_QUADRATURE_NODES)
        luaL_error(L, "field 'degree' must be at most %d", DM_QUADRATURE_NODES);
    const int s = (int)degree;
    read_quadrature(L, &q);
    check_degree(L, s, &q);
    const char *text = lua_pushfstring(L, "galerkin(%d, %d own nodes)", s, q.r);
    dm_galerkin *g = lua_newuserdatauv(L, sizeof *g, 0);
    dm_galerkin_of(g, s, &q);
    if (!dm_galerkin_is_regular(g))
        luaL_error(L,
                   "with these weights the kinetic energy of a curve of degree %d is degenerate: "
                   "the step equation would be singular; use other weights, or a lower degree",
                   s);
    dml_pushrule(L, "galerkin", g, text);
    return 1;
}

static const dml_row functions[] =
    {{"galerkin", galerkin_new,
      "dm.galerkin{degree=, nodes=, weights=} -> dm.rule   or   dm.galerkin{functions= | curve=, "
      "parameters=, start=, quadrature=} -> dm.rule\n"
      "A Galerkin variational integrator for rule =: curves of that degree, the action by a "
      "quadrature with these nodes in [0, 1] (growing) and weights (sum 1; left out: those exact "
      "to the highest degree). Quadratures with names need no object: rule = \"galerkin(3, "
      "lobatto(4))\". Raises, with the degree, when the quadrature is not exact enough (Marsden & "
      "West 2001, 2.6; HLW VI.6).\n"
      "functions = function(t, h) return { 1, t, math.cos(t) } end: curves in the space of these "
      "functions, t from 0 to h, for every coordinate, or a list of such functions, one a "
      "coordinate. Or any curve: curve = function(t, z, h) -> the coordinates, z of `parameters` "
      "numbers, for which start = function(q, v, h) gives the first guess. quadrature: a name, "
      "\"gauss(8)\", { nodes =, weights = }, or { \"gauss(4)\", pieces = 5 }. A step solves for z "
      "and the momentum at its end (Leok 5.2). Raises for functions that depend on each other, "
      "that leave an end no freedom, or that the quadrature does not tell apart."},
     {NULL, NULL, NULL}};

const dml_class dml_class_galerkin = {
    .functions = functions,
};
