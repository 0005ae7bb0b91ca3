/* bind_terminal.c - `core.terminal`, `core.clock`, and the line of progress. */
#include "bind/core/bind_terminal.h"

#include "bind/core/child_process.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

/* a process has one terminal, so this is not kept per Lua state */
static struct {
    int colour, no_environment;
    double began; /* of the running progress, s; 0: none */
    int drawn;
} terminal;

void dml_terminal_choose(int colour, int environment) {
    terminal.colour = colour;
    terminal.no_environment = !environment;
}

/* value of a variable that is set and not empty, else NULL */
static const char *variable(const char *name) {
    const char *value = terminal.no_environment ? NULL : getenv(name);
    return value && *value ? value : NULL;
}

int dml_terminal_colour(int fd) {
    if (terminal.colour != DML_COLOUR_AUTO) return terminal.colour == DML_COLOUR_ALWAYS;
    const char *force = variable("FORCE_COLOR"), *term = getenv("TERM");
    if (force) return strcmp(force, "0") != 0;
    if (variable("NO_COLOR")) return 0;
    return isatty(fd) && term && strcmp(term, "dumb") != 0;
}

void dml_terminal_size(int *width, int *height) {
    struct winsize size;
    const int fd = isatty(STDOUT_FILENO) ? STDOUT_FILENO : STDERR_FILENO;
    const int known = isatty(fd) && ioctl(fd, TIOCGWINSZ, &size) == 0;
    *width = known && size.ws_col ? size.ws_col : 80;
    *height = known && size.ws_row ? size.ws_row : 24;
}

/* ---- progress ---- */

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* 81300 -> "81.3 k" */
static void scaled(char *out, size_t size, double x) {
    static const char *const prefix[] = {"", "k", "M", "G", "T"};
    int k = 0;
    while (x >= 1000 && k < 4) x /= 1000, k++;
    snprintf(out, size, "%.3g %s", x, prefix[k]);
}

/* 3720 -> "1 h 2 min" */
static void duration(char *out, size_t size, double s) {
    if (!(s < 1e9))
        snprintf(out, size, "a long time");
    else if (s < 100)
        snprintf(out, size, "%.0f s", ceil(s));
    else if (s < 6000)
        snprintf(out, size, "%.0f min %.0f s", floor(s / 60), fmod(s, 60));
    else
        snprintf(out, size, "%.0f h %.0f min", floor(s / 3600), fmod(s / 60, 60));
}

void dml_progress(lua_State *L, const char *what, double fraction, double rate,
                  double seconds_left) {
    char per_second[32], left[64];
    (void)L;
    if (terminal.began <= 0) terminal.began = now();
    if (!isatty(STDERR_FILENO) || now() - terminal.began < 0.5) return;
    scaled(per_second, sizeof per_second, rate);
    duration(left, sizeof left, seconds_left);
    fprintf(stderr, "\r%s: %3.0f %%, %sstep/s, %s left (Ctrl-C stops)\x1b[K", what,
            floor(100 * fraction), per_second, left);
    fflush(stderr);
    terminal.drawn = 1;
}

void dml_progress_end(lua_State *L) {
    (void)L;
    if (terminal.drawn) {
        fputs("\r\x1b[K", stderr);
        fflush(stderr);
    }
    terminal.drawn = 0;
    terminal.began = 0;
}

/* ---- what Lua sees ---- */

static void set_flag(lua_State *L, const char *key, int value) {
    lua_pushboolean(L, value);
    lua_setfield(L, -2, key);
}

static int describe(lua_State *L) {
    static const char *const names[] = {"stdout", "stderr", "stdin", NULL};
    static const int descriptors[] = {STDOUT_FILENO, STDERR_FILENO, STDIN_FILENO};
    const int fd = descriptors[luaL_checkoption(L, 1, "stdout", names)];
    int width, height;
    dml_terminal_size(&width, &height);
    lua_createtable(L, 0, 4);
    dml_setresult(L);
    set_flag(L, "tty", isatty(fd));
    set_flag(L, "colour", dml_terminal_colour(fd));
    lua_pushinteger(L, width);
    lua_setfield(L, -2, "width");
    lua_pushinteger(L, height);
    lua_setfield(L, -2, "height");
    return 1;
}

static int clock_now(lua_State *L) {
    lua_pushnumber(L, now());
    return 1;
}

static int cpu_now(lua_State *L) {
    lua_pushnumber(L, dml_cpu());
    return 1;
}

/* load of the machine over a minute, 0 where it is not told */
static int load_now(lua_State *L) {
    FILE *f = fopen("/proc/loadavg", "r");
    double load = 0.0;
    if (f && fscanf(f, "%lf", &load) != 1) load = 0.0;
    if (f) fclose(f);
    lua_pushnumber(L, load);
    return 1;
}

static const dml_row functions[] =
    {{"terminal", describe,
      "dm.terminal([stream]) -> {tty, colour, width, height}\n"
      "What \"stdout\" (the default), \"stderr\" or \"stdin\" is: a terminal or not, whether to "
      "write colours to it (the option --color, FORCE_COLOR, NO_COLOR), and the characters of a "
      "line and lines of the screen (80 and 24 when unknown)."},
     {"clock", clock_now,
      "dm.clock() -> number\n"
      "Seconds of a clock that never goes back; only differences mean something."},
     {"cpu", cpu_now,
      "dm.cpu() -> number\nSeconds of CPU time that the process has used, also for factors of "
      "large matrices, which are made in a process of their own."},
     {"load_average", load_now,
      "dm.load_average() -> number\n"
      "Load of the machine over the last minute, 0 where the system does not tell."},
     {NULL, NULL, NULL}};

const dml_class dml_class_terminal = {
    .functions = functions,
};
