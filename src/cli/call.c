/* call.c - protected calls, Ctrl-C, messages. */
#include "cli/call.h"

#include "bind/core/bind.h"
#include "bind/core/bind_terminal.h"
#include "bind/core/missing_key.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

const char *dml_program = "dmlua";

static lua_State *volatile running;           /* the thread, for the signal handler */
static volatile sig_atomic_t was_terminated;  /* by SIGTERM, which ends as Ctrl-C does */
static volatile sig_atomic_t was_interrupted; /* by SIGINT */
static volatile sig_atomic_t over;            /* SIGTERM came a second ago: nothing goes on */
static int ended_by_stop;                     /* has Ctrl-C ended what was called last? */

/* ---- Ctrl-C ---- */

/* is the Lua function that runs, or has called what runs, one of our modules? */
static int in_module(lua_State *L) {
    lua_Debug ar;
    for (int level = 0; lua_getstack(L, level, &ar); level++) {
        lua_getinfo(L, "S", &ar);
        if (*ar.what != 'C') return strstr(ar.source, "lua/dm/") != NULL;
    }
    return 0;
}

/* Runs before the next instruction after Ctrl-C. A C loop that polls dml_stop answers itself, and
 * has answered when dml_stop is clear again. What was raised is raised again where one of our
 * modules has caught it, as they try things under pcall; a pcall of the user may keep it, and
 * core.until_stop of what has something to show: Ctrl-C for good, SIGTERM for a second. */
static void interrupt(lua_State *L, lua_Debug *ar) {
    (void)ar;
    if (dml_holds_stops()) return;
    const int inside = in_module(L);
    /* until a function of the user goes on */
    dml_raised = dml_stop || over || (dml_raised && inside);
    dml_stop = over;
    alarm(was_terminated ? 1 : 0);
    if (dml_raised && inside) lua_pushliteral(L, "interrupted!"), lua_error(L);
    if (dml_raised) luaL_error(L, "interrupted!"); /* with the place in the script */
    lua_sethook(L, NULL, 0, 0);
}

/* Without SA_RESTART: a read of the terminal ends by Ctrl-C. SIGINT and SIGTERM wait for each
 * other. */
static void set_signal(int number, void (*handler)(int), struct sigaction *before) {
    struct sigaction action = {0};
    action.sa_handler = handler;
    sigemptyset(&action.sa_mask);
    sigaddset(&action.sa_mask, SIGINT);
    sigaddset(&action.sa_mask, SIGTERM);
    sigaction(number, &action, before);
}

/* before the next instruction of what runs */
static void set_hook(void) {
    lua_sethook(running, interrupt, LUA_MASKCALL | LUA_MASKRET | LUA_MASKLINE | LUA_MASKCOUNT, 1);
}

/* every second until Ctrl-C is answered: it may have come just before a read of the terminal, or
 * a change of the thread; after SIGTERM until the script ends */
static void wake(int signal) {
    (void)signal;
    if (was_terminated) {
        over = 1;
        dml_tell_stop();
    }
    if (!dml_stop && !dml_holds_stops()) return;
    set_hook();
    alarm(1);
}

/* One press of Ctrl-C may come as several signals, of the terminal and of a parent that hands its
 * own on: those of less than SAME_PRESS s are one. Afterwards the default action kills. */
static const double SAME_PRESS = 0.05;
static double pressed = -INFINITY; /* s of the clock: when what runs was told to stop */

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* a signal after the one that stopped what runs */
static void repeat(int signal) {
    if (now() - pressed < SAME_PRESS) return;
    set_signal(signal, SIG_DFL, NULL);
    raise(signal);
}

static void stop(int signal) {
    set_signal(signal, repeat, NULL);
    pressed = now();
    if (signal == SIGTERM) was_terminated = 1;
    if (signal == SIGINT) was_interrupted = 1;
    dml_tell_stop();
    set_hook();
    set_signal(SIGALRM, wake, NULL);
    alarm(1);
}

static void drop(int signal) {
    (void)signal;
}

lua_State *dml_running(lua_State *co) {
    lua_State *before = running;
    running = co;
    return before;
}

int dml_interrupted(void) {
    if (dml_raised) set_hook();
    return dml_raised;
}

int dml_terminated(void) {
    return was_terminated;
}

int dml_ended_by_interrupt(void) {
    return was_interrupted && ended_by_stop;
}

void dml_drop_interrupts(void) {
    set_signal(SIGINT, drop, NULL);
}

/* Where the default action would kill, the rest of a press that has stopped something waits for
 * its message. */
static void set_back(int signal, const struct sigaction *before) {
    const int came = signal == SIGINT ? was_interrupted : was_terminated;
    if (came && before->sa_handler == SIG_DFL)
        set_signal(signal, repeat, NULL);
    else
        sigaction(signal, before, NULL);
}

/* Ctrl-C and SIGTERM become an error of Lua while this runs, and is nothing afterwards. */
static int guarded_call(lua_State *L, lua_CFunction handler, int arguments, int results) {
    const int base = lua_gettop(L) - arguments;
    struct sigaction before, before_end;
    lua_pushcfunction(L, handler);
    lua_insert(L, base);
    dml_running(L);
    dml_stop = dml_raised = 0;
    set_signal(SIGINT, stop, &before);
    set_signal(SIGTERM, stop, &before_end);
    const int status = lua_pcall(L, arguments, results, base);
    set_back(SIGINT, &before);
    set_back(SIGTERM, &before_end);
    if (was_terminated || lua_gethook(L) == interrupt) alarm(0);
    dml_stop = over = 0;
    if (lua_gethook(L) == interrupt) lua_sethook(L, NULL, 0, 0);
    lua_remove(L, base);
    return status;
}

/* ---- messages ---- */

/* from the end of a line back to its start, the newline before it */
static const char *line_start(const char *text, const char *at) {
    while (at > text && *at != '\n') at--;
    return at;
}

/* The traceback on top without lines inside our modules, and `error` and tail calls beside them:
 * they are no lines of the script. All of them stay where the message itself is about such a line:
 * the mistake is there. */
static void leave_out_modules(lua_State *L) {
    static const char raised[] = "\n\t[C]: in function 'error'", tail[] = "\n\t(...tail calls...)";
    static const char mark[] = "/lua/dm/";
    const size_t before = sizeof raised - 1, after = sizeof tail - 1;
    const char *text = lua_tostring(L, -1), *from = text,
               *trace = strstr(text, "\nstack traceback:");
    const char *first = strstr(text, mark);
    if (!trace || (first && first < trace)) return;
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    for (const char *at = trace; (at = strstr(at, mark)) != NULL;) {
        const char *start = line_start(text, at);
        if ((size_t)(start - from) >= before && strncmp(start - before, raised, before) == 0)
            start -= before;
        luaL_addlstring(&b, from, (size_t)(start - from));
        from = at += strcspn(at, "\n");
        if (strncmp(at, tail, after) == 0) from = at += after;
    }
    luaL_addstring(&b, from);
    luaL_pushresult(&b);
    lua_replace(L, -2);
}

int dml_is_failure(lua_State *L, int index) {
    if (!lua_istable(L, index) || !lua_getmetatable(L, index)) return 0;
    luaL_getmetatable(L, "dm.failure");
    const int same = lua_rawequal(L, -1, -2) && !lua_isnil(L, -1);
    lua_pop(L, 2);
    return same;
}

/* The message handler of scripts: an object with __tostring gives its text, all else gets a
 * traceback. */
static int add_traceback(lua_State *L) {
    ended_by_stop = dml_is_stop(L, 1);
    if (!lua_tostring(L, 1)) {
        if (luaL_callmeta(L, 1, "__tostring") && lua_type(L, -1) == LUA_TSTRING) return 1;
        lua_pushfstring(L, "(error object is a %s value)", luaL_typename(L, 1));
        lua_replace(L, 1);
    }
    lua_settop(L, 1);
    dml_explain(L);
    luaL_traceback(L, L, lua_tostring(L, 1), 1);
    leave_out_modules(L);
    return 1;
}

static int keep_failure(lua_State *L) {
    return dml_is_failure(L, 1) ? 1 : add_traceback(L);
}

int dml_call(lua_State *L, int arguments, int results) {
    return guarded_call(L, add_traceback, arguments, results);
}

int dml_call_keeping(lua_State *L, int arguments, int results) {
    return guarded_call(L, keep_failure, arguments, results);
}

void dml_message(const char *program, const char *text) {
    const int colour = !program && dml_terminal_colour(2);
    fflush(stdout);
    if (program) fprintf(stderr, "%s: ", program);
    fprintf(stderr, colour ? "\x1b[31m%s\x1b[0m\n" : "%s\n", text);
    fflush(stderr);
}

/* To stderr, as lua does. */
int dml_report(lua_State *L, int status) {
    if (status == LUA_OK) return status;
    const char *text = lua_tostring(L, -1);
    dml_message(dml_program, text ? text : "(error object is not a string)");
    lua_pop(L, 1);
    return status;
}

/* ---- our own modules ---- */

/* Protected: a module that cannot be loaded is an error like any other. */
static int find_function(lua_State *L) {
    const char *name = lua_tostring(L, 1), *field = lua_tostring(L, 2);
    luaL_getsubtable(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
    if (lua_getfield(L, -1, name) != LUA_TTABLE) {
        lua_getfield(L, LUA_REGISTRYINDEX, "dm_require");
        lua_pushstring(L, name);
        lua_call(L, 1, 1);
    }
    if (!lua_istable(L, -1)) luaL_error(L, "module '%s' is damaged", name);
    lua_getfield(L, -1, field);
    return 1;
}

int dml_push_function(lua_State *L, const char *name, const char *field) {
    lua_pushcfunction(L, find_function);
    lua_pushstring(L, name);
    lua_pushstring(L, field);
    return lua_pcall(L, 2, 1, 0);
}

void dml_explain_syntax(lua_State *L, const char *text, const char *file) {
    const int message = lua_gettop(L);
    if (lua_type(L, message) != LUA_TSTRING) return;
    if (dml_push_function(L, "dm.session.syntax", "explain") == LUA_OK) {
        lua_pushvalue(L, message);
        lua_pushstring(L, text);
        lua_pushstring(L, file);
        if (lua_pcall(L, 3, 1, 0) == LUA_OK) lua_copy(L, -1, message);
    }
    lua_settop(L, message);
}
