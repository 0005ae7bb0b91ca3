/* machine.c - frames are read and written by dm.notebook.machine; here is what needs C: the two
 * descriptors, which child processes must not inherit, and calls that Ctrl-C ends. */
#include "cli/machine.h"

#include "cli/call.h"

#include <lauxlib.h>

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>

static int close_file(lua_State *L) {
    luaL_Stream *stream = luaL_checkudata(L, 1, LUA_FILEHANDLE);
    return luaL_fileresult(L, fclose(stream->f) == 0, NULL);
}

/* push a file of the io library on a descriptor, or nil */
static void push_file(lua_State *L, int descriptor, const char *mode) {
    FILE *file = NULL;
    if (fcntl(descriptor, F_SETFD, FD_CLOEXEC) == 0) file = fdopen(descriptor, mode);
    if (!file) {
        lua_pushnil(L);
        return;
    }
    luaL_Stream *stream = lua_newuserdatauv(L, sizeof *stream, 0);
    stream->f = file;
    stream->closef = close_file;
    luaL_setmetatable(L, LUA_FILEHANDLE);
}

/* dm.notebook.machine.open(in, out) */
static int open_ends(lua_State *L, const char *ends) {
    char *comma, *end;
    const long in = strtol(ends, &comma, 10);
    const long out = *comma == ',' ? strtol(comma + 1, &end, 10) : -1;
    if (in < 0 || in > 65535 || out < 0 || out > 65535 || *end != '\0') return 0;
    if (dml_push_function(L, "dm.notebook.machine", "open") != LUA_OK) return 0;
    push_file(L, (int)in, "r");
    push_file(L, (int)out, "w");
    if (lua_isnil(L, -1) || lua_isnil(L, -2)) return 0;
    return lua_pcall(L, 2, 0, 0) == LUA_OK;
}

/* the function of the next cell on top; 0 at the end. Ctrl-C between cells is nothing. */
static int next_cell(lua_State *L) {
    lua_settop(L, 0);
    int status = dml_push_function(L, "dm.notebook.machine", "next");
    if (status == LUA_OK) status = lua_pcall(L, 0, 1, 0);
    return dml_report(L, status) == LUA_OK && !lua_isnil(L, -1);
}

/* what the cell gave, or its error, is shown by dm.notebook.machine.done(fine, ...) */
static void finish_cell(lua_State *L, int fine) {
    luaL_checkstack(L, LUA_MINSTACK, "too many results to show");
    const int given = lua_gettop(L);
    if (dml_push_function(L, "dm.notebook.machine", "done") != LUA_OK) return;
    lua_insert(L, 1);
    lua_pushboolean(L, fine);
    lua_insert(L, 2);
    if (dml_call(L, given + 1, 0) == LUA_OK) return;
    lua_pushboolean(L, 0); /* showing it raised: that is what is shown */
    lua_insert(L, 1);
    if (dml_push_function(L, "dm.notebook.machine", "done") != LUA_OK) return;
    lua_insert(L, 1);
    dml_report(L, dml_call(L, 2, 0));
}

int dml_machine(lua_State *L, const char *ends) {
    if (!open_ends(L, ends)) {
        dml_message(dml_program, "--machine needs two open descriptors, as --machine=3,4");
        return 0;
    }
    dml_drop_interrupts();
    while (next_cell(L)) {
        const int fine = dml_call_keeping(L, 0, LUA_MULTRET) == LUA_OK;
        finish_cell(L, fine);
    }
    return 1;
}
