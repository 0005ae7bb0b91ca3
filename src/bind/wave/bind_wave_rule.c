/* bind_wave_rule.c - what a rule of the table is for a wave: kicks and drifts, Gauss nodes, or
 * nothing that keeps the norm. */
#include "bind/value/value.h"
#include "bind/wave/bind_wave.h"
#include "integ/registry.h"
#include "integ/split/splitting.h"
#include "wave/unitarity.h"
#include "wave/wave_stepper.h"

#include <math.h>
#include <string.h>

/* "split" and its table as two vectors */
static int push_split(lua_State *L, const dm_splitting *t) {
    lua_pushliteral(L, "split");
    memcpy(dml_pushvector(L, (uint32_t)t->stages + 1), t->b,
           ((size_t)t->stages + 1) * sizeof(double));
    memcpy(dml_pushvector(L, (uint32_t)t->stages), t->a, (size_t)t->stages * sizeof(double));
    return 3;
}

/* core.wave_rule(text, theta) */
static int wave_rule(lua_State *L) {
    const char *text = luaL_checkstring(L, 1), *nearest = NULL;
    const double theta = dml_checknumber(L, 2);
    dm_rule nodes[DM_RULE_NODES];
    /* the rule is read as for systems: one grammar, one list of names */
    const char *wrong = dm_rule_read(nodes, text, &nearest);
    const dm_method *m = wrong ? NULL : nodes[0].method;
    if (!wrong && m) wrong = dm_rule_check(nodes);
    if (wrong || !m) {
        lua_pushnil(L);
        lua_pushstring(L, wrong);
        lua_pushstring(L, nearest);
        return 3;
    }
    dm_splitting split;
    if (m->splitting && m->splitting(&split, nodes)) return push_split(L, &split);
    /* rules of stages are polynomials in time with a quadrature of the action; nothing else is */
    dm_galerkin g = {.s = 0};
    if (m->basis) m->basis(&g, nodes);
    if (g.s == 0 || g.tableau) return lua_pushliteral(L, "none"), 1;
    lua_pushstring(L, dm_is_gauss(&g) ? "stages" : "loses");
    lua_pushinteger(L, g.s);
    lua_pushnumber(L, dm_wave_growth(&g, theta));
    return 3;
}

/* core.gauss_phase(s, theta): how far that of s Gauss nodes is from theta */
static int gauss_phase(lua_State *L) {
    const lua_Integer s = dml_checkinteger(L, 1);
    const double theta = dml_checknumber(L, 2);
    luaL_argcheck(L, s >= 1 && s <= 100000, 1, "a degree is needed");
    const double turn = dm_gauss_phase((int)s, theta) + theta;
    lua_pushnumber(L, fabs(remainder(turn, 6.283185307179586477)));
    return 1;
}

static const dml_row functions[] =
    {{"wave_rule", wave_rule,
      "core.wave_rule(text, theta) -> \"split\", kicks, drifts   or   \"stages\", degree   or   "
      "\"loses\", degree, growth   or   \"none\"   or   nil, why, nearest\n"
      "What a rule of the table is for waves; growth: of |psi| in a step at h E/hbar = theta."},
     {"gauss_phase", gauss_phase,
      "core.gauss_phase(s, theta) -> number\n"
      "The error of the phase after a step of s Gauss nodes on a mode with h E/hbar = theta, "
      "modulo 2 pi."},
     {NULL, NULL, NULL}};

const dml_class dml_class_wave_rule = {.functions = functions};
