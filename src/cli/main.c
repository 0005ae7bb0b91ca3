/* main.c - dmlua: a Lua 5.4 interpreter with dm, and with lua's command line. */
#include "bind/core/bind_terminal.h"
#include "bind/core/state.h"
#include "cli/call.h"
#include "cli/coroutine.h"
#include "cli/home.h"
#include "cli/machine.h"
#include "cli/options.h"
#include "cli/repl.h"

#include <lualib.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

/* arg[0] is the script, what stands before it has negative indices */
static void make_arg(lua_State *L, char **argv, int argc, int script) {
    if (script == argc) script = 0;
    lua_createtable(L, argc - script - 1 > 0 ? argc - script - 1 : 0, script + 1);
    for (int i = 0; i < argc; i++) {
        lua_pushstring(L, argv[i]);
        lua_rawseti(L, -2, i - script);
    }
    lua_setglobal(L, "arg");
}

/* ---- pieces to execute ---- */

static int do_chunk(lua_State *L, int status) {
    if (status == LUA_OK) status = dml_call(L, 0, 0);
    return dml_report(L, status);
}

static int do_file(lua_State *L, const char *file) {
    return do_chunk(L, luaL_loadfile(L, file));
}

static int do_string(lua_State *L, const char *text, const char *name) {
    const int status = luaL_loadbuffer(L, text, strlen(text), name);
    if (status == LUA_ERRSYNTAX) dml_explain_syntax(L, text, NULL);
    return do_chunk(L, status);
}

/* help(x) and its like, whose module (upvalue 1) is loaded when they are called */
static int call_word(lua_State *L) {
    const char *module = lua_tostring(L, lua_upvalueindex(1));
    const char *name = lua_tostring(L, lua_upvalueindex(2));
    if (dml_push_function(L, module, name) != LUA_OK) return lua_error(L);
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
    return lua_gettop(L);
}

/* the words of a session, for what -e executes; a name that is taken stays */
static void open_words(lua_State *L) {
    static const char *const words[][2] = {{"dm.session.help", "help"},
                                           {"dm.session.help", "apropos"},
                                           {"dm.session.demo", "demo"}};
    for (size_t k = 0; k < sizeof words / sizeof *words; k++) {
        const int taken = lua_getglobal(L, words[k][1]) != LUA_TNIL;
        lua_pop(L, 1);
        if (taken) continue;
        lua_pushstring(L, words[k][0]);
        lua_pushstring(L, words[k][1]);
        lua_pushcclosure(L, call_word, 2);
        lua_setglobal(L, words[k][1]);
    }
}

/* -l mod, or -l g=mod */
static int do_library(lua_State *L, const char *argument) {
    const char *equals = strchr(argument, '=');
    const char *module = equals ? equals + 1 : argument;
    lua_pushlstring(L, argument, equals ? (size_t)(equals - argument) : strlen(argument));
    lua_getglobal(L, "require");
    lua_pushstring(L, module);
    const int status = dml_call(L, 1, 1);
    if (status == LUA_OK) {
        lua_pushglobaltable(L);
        lua_pushvalue(L, -3);
        lua_pushvalue(L, -3);
        lua_settable(L, -3);
        lua_pop(L, 3);
    }
    return dml_report(L, status);
}

/* help and its like; without lua/dm there are none */
static void set_globals(lua_State *L) {
    const int top = lua_gettop(L);
    if (dml_push_function(L, "dm.session.globals", "later") == LUA_OK) lua_pcall(L, 0, 0, 0);
    lua_settop(L, top);
}

/* In the order in which they stand, as lua does. */
static int do_options(lua_State *L, char **argv, int n) {
    int set = 0;
    for (int i = 1; i < n; i++) {
        if (argv[i][0] != '-') continue; /* what belongs to --part or --where */
        const char option = argv[i][1];
        if (option == 'W') lua_warning(L, "@on", 0);
        if (option != 'e' && option != 'l') continue;
        const char *argument = argv[i][2] ? argv[i] + 2 : argv[++i];
        if (option == 'e' && !set++) set_globals(L);
        const int status =
            option == 'e' ? do_string(L, argument, "=(command line)") : do_library(L, argument);
        if (status != LUA_OK) return 0;
    }
    return 1;
}

/* LUA_INIT, unless -E. */
static int do_init(lua_State *L) {
    const char *name = "=LUA_INIT" LUA_VERSUFFIX;
    const char *init = getenv(name + 1);
    if (!init) init = getenv((name = "=LUA_INIT") + 1);
    if (!init) return LUA_OK;
    return init[0] == '@' ? do_file(L, init + 1) : do_string(L, init, name);
}

/* The global arg and the arguments of the script. */
static int push_arguments(lua_State *L) {
    if (lua_getglobal(L, "arg") != LUA_TTABLE) luaL_error(L, "'arg' is not a table");
    const int n = (int)luaL_len(L, -1);
    luaL_checkstack(L, n + 3, "too many arguments to script");
    for (int i = 1; i <= n; i++) lua_rawgeti(L, -i, i);
    lua_remove(L, -n - 1);
    return n;
}

/* "-" is stdin, but after "--" a file of that name */
static int do_script(lua_State *L, char **argv) {
    const int is_stdin = strcmp(argv[0], "-") == 0 && strcmp(argv[-1], "--") != 0;
    int status = luaL_loadfile(L, is_stdin ? NULL : argv[0]);
    if (status == LUA_OK) status = dml_call(L, push_arguments(L), LUA_MULTRET);
    if (status == LUA_ERRSYNTAX && !is_stdin) dml_explain_syntax(L, NULL, argv[0]);
    return dml_report(L, status);
}

/* the name of a demonstration and number=value ..., or nothing */
static int do_demo(lua_State *L, char **argv, int n) {
    const int skip = n > 0 && strncmp(argv[0], DML_DEMO_IS, 7) == 0 ? 7 : 0;
    int status = dml_push_function(L, "dm.session.demo", "command");
    luaL_checkstack(L, n, "too many words after --demo");
    for (int i = 0; i < n; i++) lua_pushstring(L, i == 0 ? argv[i] + skip : argv[i]);
    if (status == LUA_OK) status = dml_call(L, n, 0);
    return dml_report(L, status);
}

/* --join OUT FILE ... */
static int do_join(lua_State *L, char **argv, int n) {
    int status = dml_push_function(L, "dm.sweep.join", "command");
    luaL_checkstack(L, n, "too many files after --join");
    for (int i = 0; i < n; i++) lua_pushstring(L, argv[i]);
    if (status == LUA_OK) status = dml_call(L, n, 0);
    return dml_report(L, status);
}

/* --part k/n */
static int do_part(lua_State *L, const char *part) {
    int status = dml_push_function(L, "dm.sweep.part", "set");
    lua_pushstring(L, part);
    if (status == LUA_OK) status = dml_call(L, 1, 0);
    return dml_report(L, status);
}

/* --where name */
static int do_where(lua_State *L, const char *name) {
    int status = dml_push_function(L, "dm.session.where", "command");
    lua_pushstring(L, name);
    if (status == LUA_OK) status = dml_call(L, 1, 0);
    return dml_report(L, status);
}

/* --jupyter=PREFIX */
static int do_jupyter(lua_State *L, const char *prefix) {
    int status = dml_push_function(L, "dm.notebook.install", "command");
    lua_pushstring(L, prefix);
    if (status == LUA_OK) status = dml_call(L, 1, 0);
    return dml_report(L, status);
}

/* ---- the whole ---- */

/* options that only print something; 1 when there was one */
static int only_prints(const dml_command *c, char **argv) {
    if (c->flags & DML_BAD_OPTION)
        dml_command_wrong(dml_program, argv[c->script]);
    else if (c->flags & DML_HELP)
        dml_command_help(dml_program, 0);
    else if (c->flags & DML_ONLY_VERSION)
        dml_version_line();
    else
        return 0;
    return 1;
}

/* The standard ones, then dm, before any script runs. */
static void open_libraries(lua_State *L, const dml_command *c) {
    if (c->flags & DML_NO_ENVIRONMENT) {
        lua_pushboolean(L, 1);
        lua_setfield(L, LUA_REGISTRYINDEX, "LUA_NOENV");
    }
    luaL_openlibs(L);
    dml_open_coroutines(L);
    if (dml_open_home(L) != LUA_OK) {
        dml_message(dml_program, "dm is not available:");
        dml_report(L, LUA_ERRRUN);
    }
}

static int session_follows(const dml_command *c, int argc) {
    if (c->flags & DML_INTERACTIVE) return 1;
    const int nothing_given =
        !(c->flags & (DML_EXECUTE | DML_VERSION_LINE | DML_JUPYTER)) && !c->machine && !c->where;
    return c->script == argc && nothing_given && isatty(STDIN_FILENO);
}

/* what is to be executed, in lua's order; 0 after an error that decides the exit status */
static int execute(lua_State *L, const dml_command *c, char **argv, int argc) {
    const int session = session_follows(c, argc), environment = !(c->flags & DML_NO_ENVIRONMENT);
    if (environment && do_init(L) != LUA_OK) return 0;
    if ((session || c->machine) && environment && !(c->flags & DML_NO_STARTUP)) dml_startup(L);
    if (c->flags & DML_EXECUTE && !session && c->script == argc) open_words(L);
    if (c->part && do_part(L, c->part) != LUA_OK) return 0;
    if (!do_options(L, argv, c->script)) return 0;
    if (c->flags & DML_JOIN) return do_join(L, argv + c->script, argc - c->script) == LUA_OK;
    if (c->flags & DML_DEMO) return do_demo(L, argv + c->script, argc - c->script) == LUA_OK;
    if (c->where) return do_where(L, c->where) == LUA_OK;
    if (c->flags & DML_JUPYTER) return do_jupyter(L, c->prefix) == LUA_OK;
    if (c->machine) return dml_machine(L, c->machine);
    if (c->script < argc && do_script(L, argv + c->script) != LUA_OK) return 0;
    if (session) {
        if (!(c->flags & (DML_VERSION_LINE | DML_QUIET))) dml_banner();
        dml_session(L, environment);
    } else if (c->script == argc && !(c->flags & (DML_EXECUTE | DML_VERSION_LINE))) {
        do_file(L, NULL);
    }
    return 1;
}

/* (argc, argv) -> did all go well? */
static int protected_main(lua_State *L) {
    const int argc = (int)lua_tointeger(L, 1);
    char **argv = lua_touserdata(L, 2);
    const dml_command c = dml_command_read(argv);
    luaL_checkversion(L);
    if (argv[0] && argv[0][0]) dml_program = argv[0];
    if (only_prints(&c, argv)) {
        lua_pushboolean(L, !(c.flags & DML_BAD_OPTION));
        return 1;
    }
    dml_terminal_choose(c.colour, !(c.flags & DML_NO_ENVIRONMENT));
    if (c.flags & DML_INTERACTIVE && !(c.flags & DML_QUIET))
        dml_banner();
    else if (c.flags & DML_VERSION_LINE && !(c.flags & DML_INTERACTIVE))
        dml_version_line();
    open_libraries(L, &c);
    make_arg(L, argv, argc, c.script);
    lua_gc(L, LUA_GCGEN, 0, 0);
    lua_gc(L, LUA_GCSTEP, -DML_ROOM);
    lua_pushboolean(L, execute(L, &c, argv, argc));
    return 1;
}

/* Memory that is free stays with the process: every run makes a path, and pages that go back to
 * the system are cleared anew, half a microsecond each, for the next one. */
static void keep_memory(void) {
#ifdef __GLIBC__
    enum { LARGEST_KEPT = 32 << 20, MOST_KEPT = 256 << 20 }; /* bytes */
    mallopt(M_MMAP_THRESHOLD, LARGEST_KEPT);
    mallopt(M_TRIM_THRESHOLD, MOST_KEPT);
#endif
}

enum { STACK_ROOM = 1 << 20 }; /* bytes */

/* A frame of its own, which takes the room before its first line. */
__attribute__((noinline)) static void touch_stack(void) {
    volatile size_t far = 0; /* stacks grow down; were it a constant, clang would keep one byte */
    volatile char room[STACK_ROOM], *const end = room + far;
    *end = 0;
}

/* Room on the stack that is there from the start, but where it may not be large. Where memory ends
 * (ulimit -v) a stack that cannot grow is a segmentation fault, and no error as any other;
 * ensembles take a fifth of it at once. */
static void keep_stack(void) {
    struct rlimit limit;
    if (getrlimit(RLIMIT_STACK, &limit) == 0 && limit.rlim_cur >= 4 * (rlim_t)STACK_ROOM)
        touch_stack();
}

/* What print left in a buffer is written last, where nobody asks whether it could be. */
static void close_output(void) {
    if (!fflush(stdout) && !ferror(stdout)) return;
    dml_message(dml_program, "the standard output is not complete: it could not be written (is the "
                             "disk full, or its reader gone?)");
    _exit(EXIT_FAILURE);
}

/* Everything else runs protected: what is raised ends in a message and a status. */
int main(int argc, char **argv) {
    keep_memory();
    keep_stack();
    atexit(close_output);
    signal(SIGXFSZ, SIG_IGN); /* behind ulimit -f writing fails, and a run keeps its rows */
    lua_State *L = luaL_newstate();
    if (!L) {
        dml_message(argv[0], "cannot create state: not enough memory");
        return EXIT_FAILURE;
    }
    lua_pushcfunction(L, protected_main);
    lua_pushinteger(L, argc);
    lua_pushlightuserdata(L, argv);
    const int status = lua_pcall(L, 2, 1, 0), fine = lua_toboolean(L, -1);
    dml_report(L, status);
    lua_close(L);
    if (dml_terminated()) return 128 + SIGTERM;
    if (!fine && dml_ended_by_interrupt()) return 128 + SIGINT;
    return fine && status == LUA_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
