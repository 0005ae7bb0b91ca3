/* open.c - `require "dm.core"`: every class of classes.def, docs, and the door for Lua
 * modules. */
#include "bind/core/bind.h"
#include "bind/core/missing_key.h"
#include "bind/core/new_file.h"
#include "bind/core/read_file.h"
#include "bind/rule/discrete_rule.h"

/* Push the metatable of the class at 1 and its methods. */
static void push_class(lua_State *L) {
    const char *name = luaL_checkstring(L, 1);
    if (luaL_getmetatable(L, name) != LUA_TTABLE || lua_getfield(L, -1, "methods") != LUA_TTABLE)
        luaL_error(L,
                   "unknown class '%s': give the name that tostring and help use, for instance "
                   "\"dm.path\"",
                   name);
}

/* A class of that name that a load which failed began goes on as the same table, with the fields of
 * the one at 1: modules that were loaded meanwhile have put their methods there. */
static void go_on(lua_State *L, const char *name) {
    if (luaL_getmetatable(L, name) != LUA_TTABLE) {
        lua_pop(L, 1);
        return;
    }
    for (lua_pushnil(L); lua_next(L, 1);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, -4);
    }
    lua_replace(L, 1);
}

static int begin_class(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    luaL_checkstring(L, 2);
    lua_settop(L, 2);
    lua_getfield(L, 1, "__name");
    const char *name = luaL_checkstring(L, -1);
    go_on(L, name);
    dml_setdoc(L, -1, lua_tostring(L, 2));
    lua_pushvalue(L, 1);
    if (lua_getfield(L, 1, "__index") == LUA_TNIL) {
        lua_pop(L, 1);
        dml_setindex(L, name, NULL);
    } else {
        lua_pop(L, 1);
        luaL_getsubtable(L, -1, "methods");
        lua_pop(L, 1);
    }
    lua_pushvalue(L, -1);
    lua_setfield(L, LUA_REGISTRYINDEX, name);
    return 1;
}

static void set_method(lua_State *L, int methods) {
    luaL_checktype(L, 3, LUA_TFUNCTION);
    const char *doc = luaL_checkstring(L, 4);
    lua_pushvalue(L, 2);
    lua_pushvalue(L, 3);
    lua_settable(L, methods);
    dml_setdoc(L, 3, doc);
}

/* the function that the class has for the name, and its doc */
static int method_of_class(lua_State *L) {
    luaL_checkstring(L, 2);
    lua_settop(L, 4);
    push_class(L);
    const int methods = lua_gettop(L);
    if (!lua_isnil(L, 3)) set_method(L, methods);
    luaL_getsubtable(L, LUA_REGISTRYINDEX, "dm_docs");
    lua_pushvalue(L, 2);
    lua_gettable(L, methods);
    lua_pushvalue(L, -1);
    lua_rawget(L, -3);
    return 2;
}

/* f(...), which gives one value; upvalues: f, what it is called */
static int call_one(lua_State *L) {
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    dml_callone(L, lua_gettop(L) - 1, lua_tostring(L, lua_upvalueindex(2)));
    return 1;
}

static int one(lua_State *L) {
    luaL_checkstring(L, 2);
    lua_settop(L, 2);
    if (lua_type(L, 1) == LUA_TFUNCTION)
        lua_pushcclosure(L, call_one, 2);
    else
        lua_settop(L, 1);
    return 1;
}

static int arity(lua_State *L) {
    const int most = dml_arity(luaL_checkstring(L, 1));
    if (most < 0) return 0;
    lua_pushinteger(L, most);
    return 1;
}

static int until_stop(lua_State *L) {
    luaL_checkany(L, 1);
    const int fine = lua_pcall(L, lua_gettop(L) - 1, LUA_MULTRET, 0) == LUA_OK;
    dml_raised = 0;
    lua_pushboolean(L, fine);
    lua_insert(L, 1);
    return lua_gettop(L);
}

static int make_result(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_settop(L, 1);
    dml_setresult(L);
    return 1;
}

static const dml_row functions[] = {
    {"result", make_result,
     "core.result(t) -> t\n"
     "The table t as what a method returns: print(t) and tostring(t) show its entries, in scripts "
     "as in a session."},
    {"class", begin_class,
     "core.class(metatable, doc) -> metatable\n"
     "Begin a class whose objects are Lua tables with this metatable: its __name is the name, "
     "metatable.methods its methods (core.method adds to them). Without an __index of its own it "
     "gets the one of all classes, which looks among the methods. A class that is begun again, as "
     "by a module whose load failed, is the table that it was, with these fields and the methods "
     "that it had."},
    {"method", method_of_class,
     "core.method(class, name [, f, doc]) -> function, doc\n"
     "The method `name` of a class (\"dm.path\"), nil where it has none. With f and doc "
     "(signature line, then shapes, units, errors) f is that method from now on. Raises on an "
     "unknown class."},
    {"arity", arity,
     "core.arity(doc) -> integer or nil\n"
     "How many arguments the signature that begins a doc allows, the object of a method among "
     "them; nil: any number. More raise."},
    {"one", one,
     "core.one(f, what) -> function\n"
     "The function f of the user, called `what` in messages, which raises where it gives more "
     "than one value; anything else as it is."},
    {"until_stop", until_stop,
     "core.until_stop(f, ...) -> true, results   or   false, error\n"
     "pcall for what has something to show when Ctrl-C ends it: the only one of our modules that "
     "keeps this error."},
    {"with_step", dml_core_with_step,
     "core.with_step(options) -> dm.discrete_lagrangian\n"
     "As dm.discrete_lagrangian, whose map is not compared with Ld: that of a reduced one is the "
     "step of the unreduced equations."},
    {"trace_with", dml_core_trace_with,
     "core.trace_with(system, metatable)\n"
     "Trace the functions of a system whose params are a userdata with that metatable, which "
     "tells what they read; nothing is kept. Raises what they raise, and where nothing is traced."},
    {"miss", dml_core_miss,
     "core.miss(class, key [, names])\n"
     "Note that class has no such key, for the message of an error on the same line; called from "
     "the __index of a class in Lua; names: a table with the keys there are, where methods and "
     "docs do not say."},
    {"open_file", dml_core_open_file,
     "core.open_file(file) -> file   or   nil, why\n"
     "A regular file, or what comes through a pipe up to its end (2^30 bytes at most), open for "
     "reading. Devices and directories are refused: `why` says what it is."},
    {"new_file", dml_core_new_file,
     "core.new_file(file [, through]) -> name   or   nil, why\n"
     "Make an empty file beside `file`, under a name that nobody can foresee, for a program to "
     "write. through: a link, a pipe or a device stays what it is, and its own name comes back."},
    {"is_silent", dml_core_is_silent,
     "core.is_silent() -> boolean\nDo files that are written go nowhere? Those of a rank > 0."},
    {"end_file", dml_core_end_file,
     "core.end_file(name, file) -> true   or   nil, why\n"
     "Put what core.new_file made, whole and on the disk, in the place of `file`."},
    {"cut_file", dml_core_cut_file,
     "core.cut_file(file, bytes)\n"
     "Leave the first `bytes` bytes of a file. Raises where that is not possible."},
    {"lock_file", dml_core_lock_file,
     "core.lock_file(handle) -> true   or   nil, why\n"
     "Take the lock of an open file, until any handle of it is closed: nil where another process "
     "has it. Also true where the file system has no locks."},
    {"nearest", dml_core_nearest,
     "core.nearest(word, names) -> name or nil\n"
     "The name of the list that is spelt most like the word, nil when none is near."},
    {NULL, NULL, NULL}};

#define X(name) extern const dml_class dml_class_##name;
#include "bind/classes.def"
#undef X

int luaopen_dm_core(lua_State *L) {
    lua_newtable(L);
    dml_setfunctions(L, functions);
    luaL_getsubtable(L, LUA_REGISTRYINDEX, "dm_docs");
    lua_setfield(L, -2, "docs");
#define X(name) dml_register(L, &dml_class_##name);
#include "bind/classes.def"
#undef X
    return 1;
}
