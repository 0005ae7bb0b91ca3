/* root_trouble.c - why an implicit function has no value, in words. */
#include "bind/trace/bind_root.h"

#include <stdio.h>

enum { SHOWN = 6 };

/* At most SHOWN numbers. */
static void add_point(luaL_Buffer *b, const double *x, uint32_t n) {
    char text[40];
    luaL_addchar(b, '(');
    for (uint32_t i = 0; i < n && i < SHOWN; i++) {
        snprintf(text, sizeof text, i ? ", %.9g" : "%.9g", x[i]);
        luaL_addstring(b, text);
    }
    luaL_addstring(b, n > SHOWN ? ", ...)" : ")");
}

/* pattern takes one double. */
static void add_number(luaL_Buffer *b, const char *pattern, double x) {
    char text[96];
    snprintf(text, sizeof text, pattern, x);
    luaL_addstring(b, text);
}

/* what was found instead of a root */
static void add_outcome(luaL_Buffer *b, const dm_implicit *f) {
    const dm_root_trouble *t = f->trouble;
    if (t->outcome == DM_ROOT_BRANCH)
        add_number(b, "there are roots, but the branch condition, which must be > 0, is %.3g",
                   t->branch);
    else if (t->outcome == DM_ROOT_SINGULAR)
        add_number(b, "the equations do not determine y: dF/dy is singular (condition number %.2g)",
                   t->condition);
    else
        luaL_addstring(b, "Newton's method found no root from any start");
    luaL_addstring(b, "; at y = ");
    add_point(b, t->y, f->unknowns);
    add_number(b, " the residual is %.3g", t->residual);
}

/* Name, point, outcome and advice as one sentence. */
static void push_trouble(lua_State *L, const dm_implicit *f) {
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    luaL_addstring(&b, f->name);
    luaL_addstring(&b, f->inputs ? " has no value at " : " has no value");
    if (f->inputs) add_point(&b, f->trouble->x, f->inputs);
    luaL_addstring(&b, ": ");
    add_outcome(&b, f);
    if (f->advice) luaL_addstring(&b, "; ");
    luaL_addstring(&b, f->advice ? f->advice : "");
    luaL_pushresult(&b);
}

/* The newest of them, where several had none. */
const char *dml_roottrouble(lua_State *L, const dm_graph *g) {
    const dm_implicit *f = g ? dm_root_troubled(g) : NULL;
    if (!f) return lua_pushliteral(L, "");
    luaL_checkstack(L, 8, NULL);
    push_trouble(L, f);
    return lua_pushfstring(L, "; %s", lua_tostring(L, -1));
}

/* With the place of the script in front. */
void dml_raiseroot(lua_State *L, const dm_implicit *f) {
    luaL_checkstack(L, 8, NULL);
    luaL_where(L, 1);
    push_trouble(L, f);
    lua_concat(L, 2);
    lua_error(L);
}
