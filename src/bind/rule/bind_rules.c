/* bind_rules.c - `dm.rules`: the table of methods. */
#include "bind/core/bind.h"
#include "integ/method/method.h"
#include "integ/registry.h"

#include <stdio.h>
#include <string.h>

static void set_text(lua_State *L, const char *key, const char *text) {
    lua_pushstring(L, text);
    lua_setfield(L, -2, key);
}

static void set_count(lua_State *L, const char *key, int n) {
    lua_pushinteger(L, n);
    lua_setfield(L, -2, key);
}

/* Traits as fields true or false of the table on top. */
static void set_traits(lua_State *L, unsigned traits) {
    static const struct {
        const char *key;
        unsigned trait;
    } known[] = {{"symmetric", DM_SYMMETRIC}, {"symplectic", DM_SYMPLECTIC},
                 {"explicit", DM_EXPLICIT},   {"on_groups", DM_ON_GROUPS},
                 {"for_pairs", DM_FOR_PAIRS}, {"formula", DM_FORMULA},
                 {"own_time", DM_OWN_TIME}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        lua_pushboolean(L, (traits & known[i].trait) != 0);
        lua_setfield(L, -2, known[i].key);
    }
}

/* push { rule =, order =, stages =, forces =, ... } of "gauss(2):2:0"; the order is that of the
 * method */
static void push_instance(lua_State *L, const char *text, size_t length) {
    dm_rule nodes[DM_RULE_NODES];
    int stages = 0, forces = 0;
    const char *colon = memchr(text, ':', length);
    lua_createtable(L, 0, 8);
    const char *rule = lua_pushlstring(L, text, (size_t)(colon - text));
    dm_rule_read(nodes, rule, NULL);
    lua_setfield(L, -2, "rule");
    sscanf(colon, ":%d:%d", &stages, &forces);
    set_count(L, "order", dm_rule_order(nodes));
    set_count(L, "stages", stages);
    set_count(L, "forces", forces);
    set_traits(L, dm_rule_traits(nodes));
}

/* The rules on which the tests measure what a row says. */
static void push_instances(lua_State *L, const char *text) {
    lua_newtable(L);
    for (lua_Integer i = 1; *text; i++) {
        const size_t length = strcspn(text, ";");
        push_instance(L, text, length);
        lua_rawseti(L, -2, i);
        text += length;
        text += strspn(text, "; ");
    }
}

/* One table a method, in the order of methods.def. */
static int rules(lua_State *L) {
    lua_Integer i = 0;
    lua_newtable(L);
    dml_setresult(L);
    for (const dm_method *const *m = dm_methods; *m; m++) {
        lua_createtable(L, 0, 13);
        dml_setresult(L);
        set_text(L, "name", (*m)->name);
        set_text(L, "signature", (*m)->signature);
        set_text(L, "doc", (*m)->doc);
        set_text(L, "order", (*m)->orders);
        set_text(L, "stages", (*m)->stages);
        set_text(L, "cost", (*m)->cost);
        set_traits(L, (*m)->traits);
        push_instances(L, (*m)->instances);
        lua_setfield(L, -2, "instances");
        lua_rawseti(L, -2, ++i);
    }
    return 1;
}

static const dml_row functions[] =
    {{"rules", rules,
      "dm.rules() -> table of {name, signature, doc, order, stages, cost, symmetric, symplectic, "
      "explicit, on_groups, for_pairs, formula, own_time, instances}\n"
      "Every rule that a solver can use. order and stages as formulas, cost a step with n "
      "coordinates; on_groups: it steps groups by itself, not by their lift; formula: its discrete "
      "Lagrangian is a formula in L; own_time: what a step covers of t is known when it is taken; "
      "instances: {rule, order, "
      "stages, forces, symmetric, symplectic ...}, rules on which all this is measured by the "
      "tests (forces a step when L = T(v) - V(q), 0 where the "
      "rule stays implicit)."},
     {NULL, NULL, NULL}};

const dml_class dml_class_rules = {
    .functions = functions,
};
