/* line.c - reading a line with readline's callbacks, so that Ctrl-C can drop the entry. */
#include "cli/line.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifdef DM_READLINE

#include "cli/complete.h"

#include <readline/history.h>
#include <readline/readline.h>
#include <sys/select.h>

static char *line; /* as the user left it; NULL at the end of the input */
static int finished;
static volatile sig_atomic_t interrupted;

static void note_interrupt(int signal) {
    (void)signal;
    interrupted = 1;
}

static void take(char *text) {
    rl_callback_handler_remove();
    line = text;
    finished = 1;
}

void dml_line_open(lua_State *L) {
    rl_readline_name = "dmlua";
    rl_catch_signals = 1;
    dml_complete_open(L);
}

/*
** SIGINT is blocked except inside pselect, so none is missed between the test and the wait.
** Readline catches it there, and hands it on to note_interrupt when it has cleaned up.
*/
static void wait_and_read(const sigset_t *waiting) {
    fd_set input;
    FD_ZERO(&input);
    FD_SET(STDIN_FILENO, &input);
    const int ready = pselect(STDIN_FILENO + 1, &input, NULL, NULL, NULL, waiting);
    if (ready < 0) {
        sigset_t before;
        sigprocmask(SIG_SETMASK, waiting, &before);
        rl_check_signals();
        sigprocmask(SIG_SETMASK, &before, NULL);
    } else {
        rl_callback_read_char();
    }
}

static void read_with_readline(const char *prompt) {
    struct sigaction action = {0}, before;
    sigset_t blocked, waiting;
    action.sa_handler = note_interrupt;
    sigemptyset(&action.sa_mask);
    sigemptyset(&blocked);
    sigaddset(&blocked, SIGINT);
    sigaction(SIGINT, &action, &before);
    sigprocmask(SIG_BLOCK, &blocked, &waiting);
    interrupted = 0;
    finished = 0;
    line = NULL;
    rl_callback_handler_install(prompt, take);
    while (!finished && !interrupted) wait_and_read(&waiting);
    if (!finished) rl_callback_handler_remove();
    sigaction(SIGINT, &before, NULL);
    sigprocmask(SIG_SETMASK, &waiting, NULL);
}

dml_line_result dml_line_read(lua_State *L, const char *prompt) {
    fflush(stdout);
    read_with_readline(prompt);
    if (!finished) {
        fputs("\n", rl_outstream ? rl_outstream : stdout);
        return DML_LINE_CANCELLED;
    }
    if (!line) return DML_LINE_END;
    lua_pushstring(L, line);
    free(line);
    return DML_LINE;
}

void dml_line_before(const char *text) {
    dml_complete_before(text);
}

/* an entry equal to the last one is not kept twice */
void dml_line_remember(const char *entry) {
    const HIST_ENTRY *last =
        history_length ? history_get(history_base + history_length - 1) : NULL;
    if (!last || strcmp(last->line, entry) != 0) add_history(entry);
}

#else

#include <lauxlib.h>

static volatile sig_atomic_t interrupted;

static void note_interrupt(int signal) {
    (void)signal;
    interrupted = 1;
}

void dml_line_open(lua_State *L) {
    (void)L;
}

/* 1 when a line, or a last one without newline, is in the buffer */
static int fill(luaL_Buffer *b) {
    char piece[512];
    int some = 0;
    while (fgets(piece, sizeof piece, stdin)) {
        const size_t n = strcspn(piece, "\n");
        luaL_addlstring(b, piece, n);
        some = 1;
        if (piece[n] == '\n') break;
    }
    return some;
}

dml_line_result dml_line_read(lua_State *L, const char *prompt) {
    struct sigaction action = {0}, before;
    luaL_Buffer b;
    action.sa_handler = note_interrupt;
    sigemptyset(&action.sa_mask);
    fputs(prompt, stdout);
    fflush(stdout);
    luaL_buffinit(L, &b);
    interrupted = 0;
    sigaction(SIGINT, &action, &before);
    const int some = fill(&b);
    sigaction(SIGINT, &before, NULL);
    luaL_pushresult(&b);
    if (some && !interrupted) return DML_LINE;
    lua_pop(L, 1);
    if (!interrupted) return DML_LINE_END;
    clearerr(stdin);
    puts("");
    return DML_LINE_CANCELLED;
}

void dml_line_before(const char *text) {
    (void)text;
}

void dml_line_remember(const char *entry) {
    (void)entry;
}

#endif
