/* bind_rule.c - `dm.rule`: what dm.galerkin and its like give to `rule =`. */
#include "bind/rule/bind_rule.h"

#include "integ/registry.h"

#include <string.h>

/* `data` lies in the userdata on top, which the rule keeps: what points into it lives as long. */
dml_rule *dml_pushrule(lua_State *L, const char *name, const void *data, const char *text) {
    dml_rule *r = lua_newuserdatauv(L, sizeof *r, 2);
    *r = (dml_rule){.rule = {.method = dm_method_find(name, NULL), .data = data}};
    strncpy(r->rule.name, name, DM_RULE_NAME - 1);
    lua_insert(L, -2);
    lua_setiuservalue(L, -2, 1);
    lua_pushstring(L, text);
    lua_setiuservalue(L, -2, 2);
    luaL_setmetatable(L, DML_RULE);
    return r;
}

const dml_rule *dml_torule(lua_State *L, int arg) {
    return luaL_testudata(L, arg, DML_RULE);
}

const void *dml_ruledata(lua_State *L, int arg, uint32_t n) {
    const dml_rule *r = luaL_checkudata(L, arg, DML_RULE);
    if (!r->for_space) return r->rule.data;
    lua_getiuservalue(L, arg, 1);
    const void *data = r->for_space(L, lua_gettop(L), n);
    lua_pop(L, 1);
    return data;
}

static int rule_tostring(lua_State *L) {
    luaL_checkudata(L, 1, DML_RULE);
    lua_getiuservalue(L, 1, 2);
    lua_pushfstring(L, "rule %s", lua_tostring(L, -1));
    return 1;
}

/* What holds of a rule is asked of its method, with its arguments. */
static int rule_field(lua_State *L) {
    const dml_rule *r = luaL_checkudata(L, 1, DML_RULE);
    const char *key = luaL_checkstring(L, 2);
    if (strcmp(key, "name") == 0) {
        lua_getiuservalue(L, 1, 2);
    } else if (strcmp(key, "order") == 0) {
        lua_pushinteger(L, dm_rule_order(&r->rule));
    } else if (strcmp(key, "symmetric") == 0) {
        lua_pushboolean(L, (dm_rule_traits(&r->rule) & DM_SYMMETRIC) != 0);
    } else if (strcmp(key, "symplectic") == 0) {
        lua_pushboolean(L, (dm_rule_traits(&r->rule) & DM_SYMPLECTIC) != 0);
    } else if (strcmp(key, "linear") == 0) {
        lua_pushboolean(L, r->for_space == NULL);
    } else if (strcmp(key, "own") == 0) {
        const unsigned step = DM_OF_FUNCTIONS | DM_ON_GROUPS; /* trial spaces are for R^n */
        lua_pushboolean(L, (dm_rule_traits(&r->rule) & step) == step);
    } else {
        return 0;
    }
    return 1;
}

static const dml_row meta[] = {{"__tostring", rule_tostring, NULL}, {NULL, NULL, NULL}};

const dml_class dml_class_rule = {
    .name = DML_RULE,
    .doc = "dm.rule: a rule with coefficients of its own, made by dm.galerkin and its like, for "
           "rule = in a solver\n"
           "fields: name, order, symmetric, symplectic, linear (false: curves by a method that is "
           "not linear in the values of f, or with substeps that are chosen), own (true: of the "
           "functions of a dm.step)",
    .meta = meta,
    .field = rule_field,
};
