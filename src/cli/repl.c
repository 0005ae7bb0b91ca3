/* repl.c - read, evaluate, print. */
#include "cli/repl.h"

#include "bind/core/bind_terminal.h"
#include "bind/core/missing_key.h"
#include "cli/call.h"
#include "cli/history.h"
#include "cli/line.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct {
    lua_State *L;
    const char *history; /* file, or NULL */
} session;

/* The user's start-up file, before the first prompt; an error there does not end the session. */
void dml_startup(lua_State *L) {
    dml_history_path(L, "XDG_CONFIG_HOME", ".config", "init.lua");
    const char *path = lua_tostring(L, -1);
    if (path && access(path, R_OK) == 0) {
        int status = luaL_loadfile(L, path);
        if (status == LUA_OK) status = dml_call(L, 0, 0);
        dml_report(L, status);
    }
    lua_pop(L, 1);
}

/* ---- reading an entry ---- */

/* push the prompt: the global _PROMPT or _PROMPT2 if there is one, through tostring */
static const char *push_prompt(lua_State *L, int first) {
    if (lua_getglobal(L, first ? "_PROMPT" : "_PROMPT2") != LUA_TNIL) {
        const char *own = luaL_tolstring(L, -1, NULL);
        lua_remove(L, -2);
        return own;
    }
    lua_pop(L, 1);
    const int colour = dml_terminal_colour(1) && isatty(STDIN_FILENO);
    lua_pushfstring(L, colour ? "\001\x1b[1;32m\002%s\001\x1b[0m\002" : "%s", first ? "> " : ">> ");
    return lua_tostring(L, -1);
}

/* The first line of an entry, or one that goes on. */
static int prompted_line(lua_State *L, int first) {
    const char *prompt = push_prompt(L, first);
    const dml_line_result got = dml_line_read(L, prompt);
    lua_remove(L, got == DML_LINE ? -2 : -1);
    return (int)got;
}

/* does the message on top say that the text ended too early? */
static int is_incomplete(lua_State *L, int status) {
    static const char mark[] = "<eof>";
    size_t n;
    const char *message = lua_tolstring(L, -1, &n);
    const size_t m = sizeof mark - 1;
    return status == LUA_ERRSYNTAX && n >= m && strcmp(message + n - m, mark) == 0;
}

/* Push the function of the entry at `text`, as an expression or else as a statement, or a
 * message. A text that ends too early either way has *more set. */
static int compile(lua_State *L, int text, int *more) {
    const char *entry = lua_tostring(L, text);
    const char *expression = lua_pushfstring(L, "return %s", entry);
    int status = luaL_loadbuffer(L, expression, strlen(expression), "=stdin");
    lua_remove(L, -2);
    *more = 0;
    if (status == LUA_OK) return status;
    *more = is_incomplete(L, status);
    lua_pop(L, 1);
    status = luaL_loadbuffer(L, entry, strlen(entry), "=stdin");
    *more = status != LUA_OK && (*more || is_incomplete(L, status));
    return status;
}

/* ?x: the rest of the line is what to explain */
static int explain(lua_State *L) {
    if (dml_push_function(L, "dm.session.help", "ask") != LUA_OK) return lua_error(L);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_call(L, 1, 0);
    return 0;
}

/* !cmd: a command of the shell, whose status is told where it is not 0 */
static int run_command(lua_State *L) {
    const char *command = lua_tostring(L, lua_upvalueindex(1));
    fflush(stdout);
    const int status = system(command);
    if (status == -1) return luaL_error(L, "!: no shell");
    if (WIFEXITED(status) && WEXITSTATUS(status)) {
        lua_pushfstring(L, "status %d", WEXITSTATUS(status));
        dml_message(NULL, lua_tostring(L, -1));
    }
    return 0;
}

/* Of "x?" where x is a name, as path.drift, the length of x; else 0. */
static size_t asked_behind(const char *text) {
    const size_t n = strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                  "0123456789_.:");
    return n && text[n] == '?' && text[n + 1 + strspn(text + n + 1, " \t")] == '\0' ? n : 0;
}

/* push the function of a line that is no Lua: ?x, x? or !cmd; 0 where it is none of these */
static int push_special(lua_State *L, const char *text) {
    const size_t n = asked_behind(text);
    if (*text != '?' && *text != '!' && !n) return 0;
    if (n)
        lua_pushlstring(L, text, n);
    else
        lua_pushstring(L, text + 1);
    lua_pushcclosure(L, *text == '!' ? run_command : explain, 1);
    return 1;
}

/* "=x", as in Lua 5.2, is the expression x; the text on top is replaced */
static void drop_equals(lua_State *L) {
    const char *text = lua_tostring(L, -1);
    if (text[0] != '=') return;
    lua_pushfstring(L, "return %s", text + 1);
    lua_remove(L, -2);
}

/* add lines to the text at `entry` until it compiles or is wrong; a status, or -1 when dropped */
static int finish_entry(lua_State *L, int entry) {
    int more, status;
    while ((status = compile(L, entry, &more)) != LUA_OK && more) {
        dml_line_before(lua_tostring(L, entry));
        const int got = prompted_line(L, 0);
        dml_line_before(NULL);
        if (got == DML_LINE_CANCELLED) return -1;
        if (got == DML_LINE_END) break;
        lua_remove(L, -2); /* the message */
        lua_pushfstring(L, "%s\n%s", lua_tostring(L, entry), lua_tostring(L, -1));
        lua_replace(L, entry);
        lua_pop(L, 1);
    }
    return status;
}

static void remember(const session *s, const char *entry) {
    if (entry[strspn(entry, " \t\n")] == '\0') return;
    dml_line_remember(entry);
    if (s->history) dml_history_append(s->L, s->history, entry);
}

/* "exit" and "quit" leave like the end of the input, unless the user has something of that name */
static int is_farewell(lua_State *L, const char *text) {
    static const char *const words[] = {"exit", "quit"};
    for (int i = 0; i < 2; i++) {
        const size_t n = strlen(words[i]);
        if (strncmp(text, words[i], n) != 0) continue;
        const char *rest = text + n + (strncmp(text + n, "()", 2) == 0 ? 2 : 0);
        if (rest[strspn(rest, " \t")] != '\0') continue;
        lua_pushglobaltable(L);
        lua_pushstring(L, words[i]);
        const int unused = lua_rawget(L, -2) == LUA_TNIL;
        lua_pop(L, 2);
        return unused;
    }
    return 0;
}

/* Leave the text and the function (or message) of one entry on the stack. A status, -1 when there
 * is nothing to do, -2 at the end of the input. */
static int read_entry(const session *s) {
    lua_State *L = s->L;
    lua_settop(L, 0);
    const int got = prompted_line(L, 1);
    if (got != DML_LINE) return got == DML_LINE_END ? -2 : -1;
    const char *text = lua_tostring(L, 1);
    const char *first = text + strspn(text, " \t");
    if (push_special(L, first)) {
        remember(s, text);
        return LUA_OK;
    }
    if (is_farewell(L, first)) return -2;
    drop_equals(L);
    const int status = finish_entry(L, 1);
    if (status >= 0) remember(s, lua_tostring(L, 1));
    if (status == LUA_ERRSYNTAX) dml_explain_syntax(L, lua_tostring(L, 1), NULL);
    return status;
}

/* ---- printing ---- */

/* keep the value at `index` as _ and as the next of out; a nil leaves what was there */
static void keep(lua_State *L, int index) {
    if (lua_isnil(L, index)) return;
    index = lua_absindex(L, index);
    lua_pushvalue(L, index);
    lua_setglobal(L, "_");
    lua_getfield(L, LUA_REGISTRYINDEX, "dm_out");
    lua_pushvalue(L, index);
    lua_rawseti(L, -2, (lua_Integer)lua_rawlen(L, -2) + 1);
    lua_pop(L, 1);
}

static int keep_protected(lua_State *L) {
    keep(L, 1);
    return 0;
}

/* does the entry end in a ; outside of strings and comments? */
static int is_silent(lua_State *L, const char *entry) {
    int silent = 0;
    if (dml_push_function(L, "dm.session.complete", "is_silent") == LUA_OK) {
        lua_pushstring(L, entry);
        silent = lua_pcall(L, 1, 1, 0) == LUA_OK && lua_toboolean(L, -1);
    }
    lua_pop(L, 1);
    return silent;
}

/* the results from index 3 on, as texts, through the global print */
static void print_results(lua_State *L) {
    const int n = lua_gettop(L) - 2;
    int status = dml_push_function(L, "dm.session.pretty", "texts");
    if (status == LUA_OK) {
        lua_insert(L, 3);
        status = dml_call(L, n, LUA_MULTRET);
    }
    if (dml_report(L, status) != LUA_OK) return;
    lua_getglobal(L, "print");
    lua_insert(L, 3);
    if (lua_pcall(L, lua_gettop(L) - 3, 0, 0) == LUA_OK) return;
    lua_pushfstring(L, "error calling 'print' (%s)", lua_tostring(L, -1));
    dml_message(NULL, lua_tostring(L, -1));
}

/* What an entry returned, as dm.pretty shows it; _ and out keep it. */
static void show_results(lua_State *L) {
    luaL_checkstack(L, LUA_MINSTACK, "too many results to print");
    lua_pushcfunction(L, keep_protected);
    lua_pushvalue(L, 3);
    if (dml_report(L, dml_call(L, 1, 0)) != LUA_OK) return;
    if (!is_silent(L, lua_tostring(L, 1))) print_results(L);
}

/* a dm.failure on top: say what happened, and keep the path of a stopped run, else the failure */
static int show_failure(lua_State *L) {
    lua_settop(L, 1);
    const int stopped =
        lua_getfield(L, 1, "code") == LUA_TSTRING && strcmp(lua_tostring(L, -1), "stopped") == 0;
    const int has_path = lua_getfield(L, 1, "path") != LUA_TNIL;
    lua_getfield(L, 1, "message");
    if (!stopped || !has_path) {
        keep(L, 1);
        dml_message(NULL, luaL_tolstring(L, -1, NULL));
        dml_message(NULL, has_path ? "_ is this failure, _.path what was computed before"
                                   : "_ is this failure");
        return 0;
    }
    keep(L, -2);
    if (!luaL_testudata(L, -2, "dm.path")) { /* many runs: no one step */
        dml_message(NULL, "stopped; _ is what was computed before");
        return 0;
    }
    lua_getfield(L, 1, "step");
    const char *step = luaL_tolstring(L, -1, NULL);
    lua_getfield(L, 1, "time");
    const char *time = luaL_tolstring(L, -1, NULL);
    dml_message(NULL, lua_pushfstring(L, "stopped after step %s, t = %s; _ is the path so far",
                                      step, time));
    return 0;
}

/* An error keeps the session; a failure of dm gives its path so far to _. */
static void report_entry(lua_State *L, int status) {
    if (!dml_is_failure(L, -1)) {
        dml_report(L, status);
        return;
    }
    lua_pushcfunction(L, show_failure);
    lua_insert(L, -2);
    dml_report(L, dml_call(L, 1, 0));
}

/* ---- the loop ---- */

/* out, and the globals of a session that dm.help knows; a name that is taken stays */
static void set_globals(lua_State *L) {
    lua_newtable(L);
    lua_pushvalue(L, -1);
    lua_setfield(L, LUA_REGISTRYINDEX, "dm_out");
    lua_setglobal(L, "out");
    int status = dml_push_function(L, "dm.session.help", "open");
    if (status == LUA_OK) status = dml_call(L, 0, 0);
    dml_report(L, status);
}

/* a nil that the entry at 1 gave: which name is not there, where one is not */
static void explain_nil(lua_State *L) {
    if (dml_push_function(L, "dm.session.missing", "of_entry") != LUA_OK) return;
    lua_pushvalue(L, 1);
    if (dml_call(L, 1, 1) == LUA_OK && lua_isstring(L, -1)) dml_message(NULL, lua_tostring(L, -1));
}

/* Runs the function on top and shows its results, which then stand from index 3 on. */
static void evaluate(lua_State *L) {
    dml_forget(L);
    const int status = dml_call_keeping(L, 0, LUA_MULTRET);
    if (status != LUA_OK)
        report_entry(L, status);
    else if (lua_gettop(L) > 1) {
        const int is_nil = lua_gettop(L) == 2 && lua_isnil(L, 2);
        lua_pushnil(L); /* results stand from index 3 on */
        lua_insert(L, 2);
        show_results(L);
        if (is_nil) explain_nil(L);
    }
}

/* Reads, runs and shows until the end of input. */
void dml_session(lua_State *L, int environment) {
    session s = {.L = L};
    const char *program = dml_program;
    dml_program = NULL;
    lua_settop(L, 0);
    dml_drop_interrupts();
    set_globals(L);
    dml_line_open(L);
    if (environment && isatty(STDIN_FILENO)) {
        dml_history_path(L, "XDG_STATE_HOME", ".local/state", "history");
        s.history = lua_tostring(L, -1);
        lua_setfield(L, LUA_REGISTRYINDEX, "dm_history");
        if (s.history) dml_history_load(L, s.history);
    }
    for (int status; (status = read_entry(&s)) != -2;) {
        if (status == LUA_OK)
            evaluate(L);
        else if (status > 0)
            dml_report(L, status);
    }
    lua_settop(L, 0);
    puts("");
    fflush(stdout);
    dml_program = program;
}
