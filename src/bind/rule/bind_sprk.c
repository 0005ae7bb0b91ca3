/* bind_sprk.c - `dm.sprk`: a symplectic pair of Runge-Kutta tableaus of a user. */
#include "bind/rule/bind_rule.h"
#include "bind/value/value.h"
#include "integ/rules/sprk.h"

#include <math.h>

static const long double SAME = 1e-13L;

static int has(lua_State *L, const char *key) {
    const int there = lua_getfield(L, 1, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

/* s numbers of the table in the field `key`, in long double: coefficients are kept to more
 * digits than a double has. */
static void read_row(lua_State *L, const char *key, long double *out, int s) {
    double x[DM_SPRK_STAGES];
    dml_numbers(L, 1, key, x, (uint32_t)s);
    for (int i = 0; i < s; i++) out[i] = (long double)x[i];
}

/* s rows of s numbers, or a matrix of dm */
static void read_matrix(lua_State *L, const char *key,
                        long double out[DM_SPRK_STAGES][DM_SPRK_STAGES], int s) {
    lua_getfield(L, 1, key);
    if (lua_isnumber(L, -1) || dml_length(L, -1) != s)
        luaL_error(L, "field '%s' must be a table of %d rows, one a stage", key, s);
    for (int i = 0; i < s; i++) {
        double x[DM_SPRK_STAGES];
        const char *what = lua_pushfstring(L, "row %d of field '%s'", i + 1, key);
        lua_geti(L, -2, i + 1);
        dml_vectorarg(L, lua_gettop(L), what, x, (uint32_t)s);
        lua_pop(L, 2);
        for (int j = 0; j < s; j++) out[i][j] = (long double)x[j];
    }
    lua_pop(L, 1);
}

/* A consistent tableau has weights that add up to 1. */
static void check_weights(lua_State *L, const char *key, const long double *b, int s) {
    long double sum = 0.0L;
    for (int i = 0; i < s; i++) sum += b[i];
    if (fabsl(sum - 1.0L) > SAME)
        luaL_error(L, "the weights '%s' must add up to 1: they are off by %f", key,
                   (double)(sum - 1.0L));
}

/* b_i A_ij + B_j a_ji = b_i B_j, and the i, j where it fails most (HLW VI.4.6). */
static void check_symplectic(lua_State *L, const dm_tableau *t) {
    int i, j;
    const long double defect = dm_tableau_defect(t, &i, &j);
    if (fabsl(defect) <= SAME) return;
    luaL_error(L,
               "this pair is not symplectic: b_i A_ij + B_j a_ji - b_i B_j = %f at i = %d, j = %d; "
               "leave A and B out for the partner of a and b",
               (double)defect, i + 1, j + 1);
}

/* b = B, unless it is a table of kicks and drifts */
static void check_kind(lua_State *L, const dm_tableau *t, const dm_sprk *m) {
    if (m->staged || m->split) return;
    for (int i = 0; i < t->s; i++) {
        if (fabsl(t->b[i] - t->B[i]) > SAME)
            luaL_error(L,
                       "b and B must be the same: B_%d - b_%d = %f (they may differ where a and A "
                       "are triangles of kicks and drifts, which is for L = T(v) - V(q) alone)",
                       i + 1, i + 1, (double)(t->B[i] - t->b[i]));
        if (fabsl(t->b[i]) < SAME)
            luaL_error(L,
                       "the weight b_%d is zero: stage %d has no say in the action, and its "
                       "velocity is not determined; leave the stage out",
                       i + 1, i + 1);
    }
}

/* A and B as given, or the partner; c as given, or the sums of the rows of a */
static void read_pair(lua_State *L, dm_tableau *t) {
    read_matrix(L, "a", t->a, t->s);
    if (has(L, "A") != has(L, "B"))
        luaL_error(L, "give A and B together, or leave both out for the partner of a and b");
    for (int i = 0; i < t->s; i++)
        for (int j = 0; j < t->s; j++) t->c[i] += t->a[i][j];
    if (has(L, "c")) read_row(L, "c", t->c, t->s);
    check_weights(L, "b", t->b, t->s);
    if (has(L, "A")) {
        read_row(L, "B", t->B, t->s);
        read_matrix(L, "A", t->A, t->s);
        check_weights(L, "B", t->B, t->s);
        check_symplectic(L, t);
        return;
    }
    for (int i = 0; i < t->s; i++) t->B[i] = t->b[i];
    for (int i = 0; i < t->s; i++)
        if (fabsl(t->b[i]) < SAME)
            luaL_error(L,
                       "the weight b_%d is zero: then A does not follow from a and b; give A and B",
                       i + 1);
    dm_tableau_partner(t);
}

/* the times of the stages as a quadrature: below its order a pair errs where L depends on t */
static void check_times(lua_State *L, const dm_tableau *t, int order) {
    const long double loose = 1e-9L; /* numbers of a user have some digits */
    for (int k = 1; k < order; k++) {
        long double sum = 0.0L;
        for (int i = 0; i < t->s; i++) sum += t->b[i] * powl(t->c[i], k);
        if (fabsl(sum - 1.0L / (k + 1)) > loose)
            luaL_error(L,
                       "field 'c': the times do not fit an order of %d: sum b_i c_i^%d is %f, not "
                       "1/%d; leave c out for the sums of the rows of a",
                       order, k, (double)sum, k + 1);
    }
}

/* The partner is computed from the tableau, or checked where it is given too. */
static int sprk_new(lua_State *L) {
    static const char *const known[] = {"a", "b", "A", "B", "c", "name", NULL};
    lua_settop(L, 1);
    luaL_checktype(L, 1, LUA_TTABLE);
    dml_options(L, 1, known);
    lua_getfield(L, 1, "b");
    const long s = dml_length(L, -1);
    if (s < 1 || s > DM_SPRK_STAGES)
        luaL_error(L, "field 'b' must be a table of weights, one a stage, 1 to %d of them (got %s)",
                   DM_SPRK_STAGES, luaL_typename(L, -1));
    dm_tableau *t = lua_newuserdatauv(L, sizeof *t, 0);
    *t = (dm_tableau){.s = (int)s};
    read_row(L, "b", t->b, t->s);
    read_pair(L, t);
    const char *own = lua_pushfstring(L, "sprk(own, %d)", t->s);
    lua_getfield(L, 1, "name");
    const char *text = luaL_optstring(L, -1, own);
    dm_sprk *m = lua_newuserdatauv(L, sizeof *m, 0);
    dm_sprk_of(m, t);
    check_kind(L, t, m);
    if (m->order < 1)
        luaL_error(L, "the pair is symplectic but has no order: one step errs as much as no step; "
                      "are the rows of a and A right?");
    if (has(L, "c")) check_times(L, t, m->order);
    dml_pushrule(L, "sprk", m, text);
    return 1;
}

static const dml_row functions[] =
    {{"sprk", sprk_new,
      "dm.sprk{a=, b=, A=, B=, c=, name=} -> dm.rule\n"
      "A symplectic partitioned Runge-Kutta method for rule =: positions by (a, b), momenta by (A, "
      "B), s rows of s numbers and s weights, c the times of the stages (left out: the sums of the "
      "rows of a). A and B left out: the partner, A_ij = b_j (1 - a_ji / b_i). Raises when b_i "
      "A_ij + B_j a_ji = b_i B_j or b = B is violated, with the defect and where; b and B may "
      "differ in tables of kicks and drifts, which step L = T(v) - V(q). Its order is measured "
      "when it is made (HLW VI.4)."},
     {NULL, NULL, NULL}};

const dml_class dml_class_sprk = {
    .functions = functions,
};
