/* refuse [SCRIPT] [any] [every] - runs a script again and again in fresh states whose allocator
 * refuses the n-th request, then all from the n-th on, for n = 0, 1, 2, ... (growing strides;
 * `every`: no stride) until the script passes. What must hold: no crash, every byte given back,
 * and an error about memory (`any`: or another one, for scripts that catch errors themselves). */
#define _XOPEN_SOURCE 700 /* realpath */
#include "bind/core/bind.h"
#include "check.h"
#include "cli/compiled.h"

#include <limits.h>
#include <lualib.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct {
    long requests, first, last; /* requests first..last are refused */
    size_t held;                /* bytes not given back */
} purse;

/* Lua counts on shrinking and freeing to succeed */
static void *allocate(void *ud, void *block, size_t old_size, size_t new_size) {
    purse *p = ud;
    if (!block) old_size = 0;
    if (new_size == 0) {
        p->held -= old_size;
        free(block);
        return NULL;
    }
    if (new_size > old_size) {
        const long n = p->requests++;
        if (n >= p->first && n <= p->last) return NULL;
    }
    void *now = realloc(block, new_size);
    if (now) p->held += new_size - old_size;
    return now;
}

static int silence(lua_State *L) {
    (void)L;
    return 0;
}

/* os.exit(true) is a way to pass, told by this address as the error; os.exit(false) is none */
static char exited;
static int leave(lua_State *L) {
    if (!lua_toboolean(L, 1)) return luaL_error(L, "the script gives up: no memory");
    lua_pushlightuserdata(L, &exited);
    return lua_error(L);
}

/* Modules come compiled, as to dmlua: half of what is asked for to read their texts is Lua's own. */
static dml_compiled compiled;
static char path[3 * PATH_MAX];

/* build/tests/refuse: the modules that make compiled, by the names that they have there */
static void find_modules(const char *program) {
    static const char *const up[] = {"..", "../.."};
    char build[PATH_MAX - 64], real[PATH_MAX], file[PATH_MAX];
    snprintf(build, sizeof build, "%s", program);
    for (int i = 0; i < 2; i++) {
        char *slash = strrchr(build, '/');
        if (slash) *slash = '\0';
    }
    if (!realpath(build, real)) return;
    snprintf(file, sizeof file, "%s/modules.luac", build);
    compiled = dml_compiled_open(file);
    for (int i = 0; i < 2 && !*path; i++) {
        snprintf(file, sizeof file, "%.*s/%s/lua", PATH_MAX - 64, real, up[i]);
        if (access(file, R_OK) == 0)
            snprintf(path, sizeof path, "%s/?.lua;%s/?/init.lua;tests/lua/?.lua", file, file);
    }
}

/* in the place of Lua's own searcher of files */
static int find_module(lua_State *L) {
    lua_getglobal(L, "package");
    lua_getfield(L, -1, "searchpath");
    lua_pushvalue(L, 1);
    lua_getfield(L, -3, "path");
    lua_call(L, 2, 2);
    const char *name = lua_tostring(L, -2);
    if (!name) return 1;
    if (dml_compiled_load(L, &compiled, name) != LUA_OK) return lua_error(L);
    lua_pushstring(L, name);
    return 2;
}

/* everything that asks for memory, inside a protected call */
static int script(lua_State *L) {
    luaL_openlibs(L);
    luaL_getsubtable(L, LUA_REGISTRYINDEX, LUA_PRELOAD_TABLE);
    lua_pushcfunction(L, luaopen_dm_core);
    lua_setfield(L, -2, "dm.core");
    lua_getglobal(L, "os");
    lua_pushcfunction(L, leave);
    lua_setfield(L, -2, "exit");
    lua_pushcfunction(L, silence);
    lua_setglobal(L, "print");
    lua_newtable(L);
    lua_pushstring(L, lua_touserdata(L, 1));
    lua_rawseti(L, -2, 0);
    lua_setglobal(L, "arg");
    lua_getglobal(L, "package");
    lua_pushstring(L, path);
    lua_setfield(L, -2, "path");
    lua_getfield(L, -1, "searchers");
    lua_pushcfunction(L, find_module);
    lua_rawseti(L, -2, 2);
    lua_settop(L, 1);
    lua_getglobal(L, "require");
    lua_pushliteral(L, "dm");
    lua_call(L, 1, 1);
    lua_setglobal(L, "dm");
    if (luaL_loadfile(L, lua_touserdata(L, 1)) != LUA_OK) return lua_error(L);
    lua_call(L, 0, 0);
    return 0;
}

/* luaL_checkstack says "stack overflow" where the stack could not grow, too */
static int about_memory(lua_State *L, int status) {
    if (status == LUA_OK || status == LUA_ERRMEM) return 1;
    const char *said = luaL_tolstring(L, -1, NULL);
    return strstr(said, "memory") || strstr(said, "stack overflow");
}

typedef struct {
    int passed, odd;
    long requests;
    size_t leaked; /* bytes */
    char message[200];
} verdict;

static verdict run_once(const char *file, long first, long last) {
    verdict v = {0};
    purse p = {.first = first, .last = last};
    lua_State *L = lua_newstate(allocate, &p);
    if (L) {
        lua_pushcfunction(L, script); /* a light C function: asks for nothing */
        lua_pushlightuserdata(L, (void *)(uintptr_t)file);
        int status = lua_pcall(L, 1, 0, 0);
        if (status != LUA_OK && lua_touserdata(L, -1) == &exited) status = LUA_OK;
        p.last = -1; /* the error is looked at with memory again */
        v.passed = status == LUA_OK;
        v.odd = !about_memory(L, status);
        if (status != LUA_OK)
            snprintf(v.message, sizeof v.message, "%s", luaL_tolstring(L, -1, NULL));
        lua_close(L);
    }
    v.requests = p.requests;
    v.leaked = p.held;
    return v;
}

enum { STRIDE = 100 }; /* n grows by 1 + n / STRIDE */
static const long never = 1L << 60;
static const char *file = "tests/lua/refused.lua";
static int any_error, every_request;

static long next(long n) {
    return n + 1 + (every_request ? 0 : n / STRIDE);
}

static void look(const verdict *v, long n) {
    if (!CHECK(v->leaked == 0)) printf("# request %ld: %zu bytes leaked\n", n, v->leaked);
    if (!any_error && !CHECK(!v->odd)) printf("# request %ld: %s\n", n, v->message);
}

static void all_from_the_nth(void) {
    long runs = 0, n = 0;
    verdict v = {0};
    for (; !v.passed && n < never; n = next(n), runs++) {
        v = run_once(file, n, never);
        look(&v, n);
    }
    printf("# %s: %ld runs, %ld requests\n", file, runs, v.requests);
}

/* two in a row: Lua collects garbage and asks once more */
static void two_alone(void) {
    const verdict whole = run_once(file, never, never);
    if (!CHECK(whole.passed)) printf("# %s\n", whole.message);
    for (long n = 0; n < whole.requests; n = next(n)) {
        const verdict v = run_once(file, n, n + 1);
        look(&v, n);
    }
}

int main(int argc, char **argv) {
    find_modules(argv[0]);
    if (argc > 1) file = argv[1];
    for (int i = 2; i < argc; i++) {
        any_error |= strcmp(argv[i], "any") == 0;
        every_request |= strcmp(argv[i], "every") == 0;
    }
    RUN(two_alone, "a refused request raises an error about memory and leaks nothing");
    RUN(all_from_the_nth, "so it is when all later ones are refused too");
    return check_finish();
}
