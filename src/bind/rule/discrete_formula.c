/* discrete_formula.c - discrete Lagrangians of a system and a rule with one velocity (q1 - q0)/h:
 * formulas, its L at the nodes. */
#include "bind/rule/discrete_rule.h"
#include "integ/registry.h"

/* call the function on top, of the system at upvalue 1, at ((1 - c) q0 + c q1, (q1 - q0)/h), whose
 * arguments are q0, q1, h and params, of a member those that it varies, at 1, 2, 3, 4 */
static void call_node(lua_State *L, double c, const char *what) {
    lua_pushvalue(L, 2);
    lua_pushvalue(L, 1);
    lua_arith(L, LUA_OPSUB); /* q1 - q0 */
    lua_pushvalue(L, 1);
    lua_pushvalue(L, -2);
    lua_pushnumber(L, c);
    lua_arith(L, LUA_OPMUL);
    lua_arith(L, LUA_OPADD); /* q0 + c (q1 - q0) */
    lua_insert(L, -2);
    lua_pushvalue(L, 3);
    lua_arith(L, LUA_OPDIV);
    lua_pushnumber(L, 0.0);
    if (lua_isnil(L, 4))
        dml_systemfield(L, lua_upvalueindex(1), "params");
    else
        lua_pushvalue(L, 4);
    dml_callone(L, 4, what);
}

/* push L at a node */
static void push_node(lua_State *L, double c) {
    lua_getfield(L, lua_upvalueindex(1), "L");
    call_node(L, c, "L");
}

/* h sum_i b_i L at the nodes: one of weight 1 at c = 1/2, or two of weight 1/2 at the
 * ends; upvalues: the system, is it the latter, the name of the rule */
static int composed(lua_State *L) {
    const int ends = lua_toboolean(L, lua_upvalueindex(2));
    lua_settop(L, 4);
    push_node(L, ends ? 0.0 : 0.5);
    if (ends) {
        push_node(L, 1.0);
        lua_arith(L, LUA_OPADD);
        lua_pushnumber(L, 0.5);
        lua_arith(L, LUA_OPMUL);
    }
    lua_pushvalue(L, 3);
    lua_arith(L, LUA_OPMUL);
    return 1;
}

/* push half of h times the force at a node, a list */
static void push_half(lua_State *L, double c) {
    dml_scalar x;
    dml_systemfield(L, lua_upvalueindex(1), "force");
    call_node(L, c, "force");
    const int at = lua_gettop(L), single = dml_toscalar(L, at, &x);
    const long n = dml_length(L, at); /* 1 of a number */
    lua_newtable(L);
    for (int i = 1; i <= n; i++) {
        lua_pushvalue(L, 3);
        lua_pushnumber(L, 0.5);
        lua_arith(L, LUA_OPMUL);
        if (single)
            lua_pushvalue(L, at);
        else
            lua_geti(L, at, i);
        lua_arith(L, LUA_OPMUL);
        lua_rawseti(L, -2, i);
    }
    lua_replace(L, at);
}

/* { F1, F2 } of the force of the system by the same nodes, of which each works on the positions in
 * its proportions; upvalues as of `composed` */
static int composed_force(lua_State *L) {
    const int ends = lua_toboolean(L, lua_upvalueindex(2));
    lua_settop(L, 4);
    lua_createtable(L, 2, 0);
    push_half(L, ends ? 0.0 : 0.5);
    if (ends)
        push_half(L, 1.0);
    else
        lua_pushvalue(L, -1);
    lua_rawseti(L, -3, 2);
    lua_rawseti(L, -2, 1);
    return 1;
}

/* the rule of the options at 2 has one velocity, (q1 - q0)/h, and nothing is to be solved: its
 * points, else 0 */
int dml_formula_points(lua_State *L) {
    dm_rule nodes[DM_RULE_NODES];
    dm_galerkin g;
    lua_getfield(L, 2, "rule");
    const char *text = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
    const int read = !dm_rule_read(nodes, text, NULL) && nodes[0].method;
    lua_pop(L, 1);
    if (!read || !(nodes[0].method->traits & DM_FORMULA) || dm_rule_check(nodes)) return 0;
    nodes[0].method->basis(&g, nodes);
    return g.q.r;
}

/* push { system =, rule = } of the Ld at 1, nil where it is a formula of the script */
int dml_discrete_source(lua_State *L) {
    const dml_system *s = luaL_checkudata(L, 1, DML_DISCRETE);
    const int ruled = s->ruled;
    dml_systemfield(L, 1, ruled ? "system" : "Ld");
    if (!ruled && lua_tocfunction(L, -1) != composed) return lua_pushnil(L), 1;
    const int at = lua_gettop(L);
    lua_createtable(L, 0, 2);
    if (ruled)
        lua_pushvalue(L, at), dml_systemfield(L, 1, "rule");
    else
        lua_getupvalue(L, at, 1), lua_getupvalue(L, at, 3);
    lua_setfield(L, -3, "rule");
    lua_setfield(L, -2, "system");
    return 1;
}

/* push f as a closure over the system at 1 and the rule of the options at 2 */
static void push_composed(lua_State *L, lua_CFunction f, int points) {
    lua_pushvalue(L, 1);
    lua_pushboolean(L, points == 2);
    lua_getfield(L, 2, "rule");
    lua_pushcclosure(L, f, 3);
}

/* turn (system, { rule =, h = }) on the stack into the options of a discrete Lagrangian
 * at 1 */
void dml_formula_of_system(lua_State *L) {
    static const char *const known[] = {"rule", "h", "name", NULL};
    static const char *const copied[] = {"Q",      "name",       "coordinates", "units",
                                         "params", "constraint", NULL};
    luaL_checktype(L, 2, LUA_TTABLE);
    dml_options(L, 2, known);
    const int points = dml_formula_points(L);
    lua_newtable(L);
    for (const char *const *key = copied; *key; key++)
        dml_systemfield(L, 1, *key), lua_setfield(L, -2, *key);
    lua_getfield(L, 2, "h");
    lua_setfield(L, -2, "h");
    push_composed(L, composed, points);
    lua_setfield(L, -2, "Ld");
    if (dml_systemfield(L, 1, "force") != LUA_TNIL)
        push_composed(L, composed_force, points), lua_setfield(L, -3, "force");
    lua_pop(L, 1);
    lua_replace(L, 1);
}
