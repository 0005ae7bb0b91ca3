/* arity.c - how many arguments a function takes, read off the signature that begins its doc. */
#include "bind/core/bind.h"

#include <string.h>

/* The arguments between the brackets that open at *at, which is left behind the closing one.
 * Brackets [ ] around optional ones do not count; what stands inside of { } or ( ) is one
 * argument. -1: "..." is among them. */
static int count_arguments(const char **at) {
    const int is_table = **at == '{'; /* f{a=, b=}: one */
    int depth = 0, count = 0, any = 0, empty = 1;
    for (const char *c = *at; *c && *c != '\n'; c++) {
        if (*c == '(' || *c == '{') depth++;
        if (*c == ')' || *c == '}') depth--;
        if (depth == 0) {
            *at = c + 1;
            break;
        }
        if (depth > 1 || c == *at) {
            if (c != *at) empty = 0;
            continue;
        }
        if (*c == ',') count++;
        if (strncmp(c, "...", 3) == 0) any = 1;
        if (*c != ' ') empty = 0;
    }
    if (is_table) return 1;
    return any ? -1 : empty ? 0 : count + 1;
}

/* the next alternative of the signature, NULL: there is none */
static const char *next_alternative(const char *doc) {
    const char *end = strchr(doc, '\n'), * or = strstr(doc, "   or   ");
    return or &&(!end || or < end) ? or +8 : NULL;
}

int dml_arity(const char *doc) {
    int most = 0;
    for (; doc; doc = next_alternative(doc)) {
        const size_t name = strcspn(doc, "({\n");
        if (doc[name] != '(' && doc[name] != '{') continue;
        const char *at = doc + name;
        const int count = count_arguments(&at);
        if (count < 0) return -1;
        const int self = memchr(doc, ':', name) != NULL;
        if (count + self > most) most = count + self;
    }
    return most;
}

void dml_checksurplus(lua_State *L, int most, const char *doc) {
    int top = lua_gettop(L);
    while (top > most && lua_isnil(L, top)) top--;
    if (top <= most) return;
    const size_t line = strcspn(doc, "\n");
    const char *arrow = strstr(doc, " ->");
    const size_t length = arrow && (size_t)(arrow - doc) < line ? (size_t)(arrow - doc) : line;
    lua_pushlstring(L, doc, length);
    luaL_argerror(L, most + 1, lua_pushfstring(L, "a surplus argument: %s", lua_tostring(L, -1)));
}
