/* line.c - reading a line with readline, in such a way that Ctrl-C always drops the entry. */
#include "cli/line.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t interrupted;

static void note_interrupt(int signal) {
    (void)signal;
    interrupted = 1;
}

#ifdef DM_READLINE

#include "cli/complete.h"

#include <errno.h>
#include <fcntl.h>
#include <readline/history.h>
#include <readline/readline.h>
#include <sys/select.h>

static int keyboard = STDIN_FILENO;
static sigset_t waiting; /* signals blocked while a key is awaited: not SIGINT */
static int keys_given;   /* for the user, after an interrupt */

/* let readline act on a signal that it has caught, and hand SIGINT on to note_interrupt */
static void pass_signals(void) {
    sigset_t before;
    sigprocmask(SIG_SETMASK, &waiting, &before);
    rl_check_signals();
    sigprocmask(SIG_SETMASK, &before, NULL);
}

/* The next key. SIGINT is blocked except inside pselect, so none is missed between a test and
 * the wait. After one, the entry is ended by Return; Ctrl-G in between leaves what does not take
 * that, such as a question. Ctrl-C also drops what was typed ahead, so a key that was there may
 * be gone. */
static int next_key(FILE *in) {
    (void)in;
    for (;;) {
        unsigned char key;
        fd_set input;
        if (interrupted) return keys_given++ % 2 ? '\a' : '\n';
        FD_ZERO(&input);
        FD_SET(keyboard, &input);
        if (pselect(keyboard + 1, &input, NULL, NULL, NULL, &waiting) < 0) {
            if (errno != EINTR) return EOF;
            pass_signals();
            continue;
        }
        const ssize_t n = read(keyboard, &key, 1);
        if (n == 1) return key;
        if (n == 0 || (errno != EAGAIN && errno != EINTR)) return EOF;
    }
}

/* a description of the terminal of our own, whose reads do not wait for a key that is gone */
static void open_keyboard(void) {
    const char *name = isatty(STDIN_FILENO) ? ttyname(STDIN_FILENO) : NULL;
    const int fd = name ? open(name, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC) : -1;
    if (fd >= 0) keyboard = fd;
}

void dml_line_open(lua_State *L) {
    rl_readline_name = "dmlua";
    rl_catch_signals = 1;
    rl_getc_function = next_key;
    open_keyboard();
    dml_complete_open(L);
}

/* the line as memory of the caller's; NULL at the end of the input */
static char *read_with_readline(const char *prompt) {
    struct sigaction action = {0}, before;
    sigset_t blocked;
    action.sa_handler = note_interrupt;
    sigemptyset(&action.sa_mask);
    sigemptyset(&blocked);
    sigaddset(&blocked, SIGINT);
    interrupted = 0;
    keys_given = 0;
    sigaction(SIGINT, &action, &before);
    sigprocmask(SIG_BLOCK, &blocked, &waiting);
    char *line = readline(prompt);
    sigaction(SIGINT, &before, NULL);
    sigprocmask(SIG_SETMASK, &waiting, NULL);
    return line;
}

dml_line_result dml_line_read(lua_State *L, const char *prompt) {
    fflush(stdout);
    char *line = read_with_readline(prompt);
    if (interrupted) {
        free(line);
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
    const HIST_ENTRY *last = history_length ? history_get(history_base + history_length - 1) : NULL;
    if (!last || strcmp(last->line, entry) != 0) add_history(entry);
}

#else

#include <lauxlib.h>

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
