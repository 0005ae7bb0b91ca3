/* interrupt [ROUNDS] - sends SIGINT at random moments to a dmlua that runs a busy script. It must
 * end by itself with exit code 0, or with 1 or 130 and a message, or by that very signal when it
 * came before the handler stood; never by another signal, and never hang. Two signals at once are
 * one: but where the machine lets the child wait between them it cannot know that, so most of
 * these rounds must end by themselves, not all. */
#define _DEFAULT_SOURCE
#include "bind/core/bind.h"
#include "check.h"

#include <lualib.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static int rounds = 60, by_itself, by_signal, doubles, doubles_killed;
static unsigned seed = 12345;

static unsigned below(unsigned n) {
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % n;
}

static void nap(unsigned milliseconds) {
    const struct timespec t = {.tv_sec = milliseconds / 1000,
                               .tv_nsec = 1000000L * (milliseconds % 1000)};
    nanosleep(&t, NULL);
}

/* the child writes to `from` as soon as its script runs, and messages to `said` */
static pid_t start(const char *dmlua, const char *script, int *from, int *said) {
    int ends[2], words[2];
    if (pipe(ends) != 0 || pipe(words) != 0) return -1;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        dup2(ends[1], STDOUT_FILENO);
        dup2(words[1], STDERR_FILENO);
        execl(dmlua, dmlua, script, (char *)NULL);
        _exit(9);
    }
    close(ends[1]), close(words[1]);
    *from = ends[0], *said = words[0];
    return child;
}

/* wait status of the child; after `limit` ms it is killed, which the caller sees as SIGKILL */
static int end_of(pid_t child, unsigned limit) {
    int status = 0;
    for (unsigned waited = 0; waitpid(child, &status, WNOHANG) == 0; waited += 5) {
        if (waited > limit) kill(child, SIGKILL);
        nap(5);
    }
    return status;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* are these signals one press of a key? Where this process had to wait between them they are not */
static int press(pid_t child, unsigned signals) {
    const double before = now();
    kill(child, SIGINT);
    if (signals == 2) nap(below(3)), kill(child, SIGINT);
    return now() - before < 0.04;
}

/* one round: with `early` the signal may come before the interpreter stands */
static int interrupt(int early, unsigned signals, unsigned moment) {
    const char *dmlua = getenv("DMLUA");
    int from = -1, said = -1;
    char byte;
    const pid_t child = start(dmlua ? dmlua : "build/dmlua", "tests/lua/busy.lua", &from, &said);
    if (child <= 0) return 0; /* and -1 would be everybody */
    if (!early && read(from, &byte, 1) != 1) moment = 0;
    nap(moment);
    const int at_once = press(child, signals);
    const int status = end_of(child, 20000);
    const int silent = read(said, &byte, 1) != 1;
    close(from), close(said);
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    const int ended = code == 0 || ((code == 1 || code == 128 + SIGINT) && !silent);
    const int killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGINT;
    const int is_double = signals == 2 && at_once && !early;
    const int fine = ended || (killed && (early || signals == 2));
    doubles += is_double;
    doubles_killed += is_double && killed;
    by_itself += ended;
    by_signal += killed;
    if (!fine)
        printf("# %u signals, %u ms after the %s: wait status %d%s\n", signals, moment,
               early ? "start" : "script began", status, silent ? ", no message" : "");
    return fine;
}

static void random_moments(void) {
    for (int i = 0; i < rounds; i++) {
        const unsigned signals = 1 + below(2), moment = below(100);
        CHECK(interrupt(i % 4 == 0, signals, moment));
    }
    printf("# %d rounds: %d ended by themselves, %d by the signal\n", rounds, by_itself, by_signal);
    CHECK(2 * doubles_killed <= doubles);
}

/* loops that look at the flag themselves: no hook stands in this state */
static void loops_see_the_flag(void) {
    static const char *const chunks[] =
        {"return a * a", "return a * v", "return a:solve(a)",
         "return dm.derivative(function(x) return (a * x):dot(x) end, 2) { 1, 2 }"};
    lua_State *L = luaL_newstate();
    CHECK(L != NULL);
    luaL_openlibs(L);
    lua_pushcfunction(L, luaopen_dm_core);
    lua_call(L, 0, 1);
    lua_setglobal(L, "dm");
    CHECK(luaL_dostring(L, "a, v = dm.identity(2), dm.vector { 1, 2 }") == LUA_OK);
    for (size_t k = 0; k < sizeof chunks / sizeof *chunks; k++) {
        dml_stop = 1;
        CHECK(luaL_dostring(L, chunks[k]) != LUA_OK);
        CHECK(strstr(lua_tostring(L, -1), "interrupted!") && !dml_stop);
        CHECK(luaL_dostring(L, chunks[k]) == LUA_OK);
    }
    lua_close(L);
}

int main(int argc, char **argv) {
    if (argc > 1) rounds = atoi(argv[1]);
    /* what a shell starts in the background ignores it, and so would children until their handler
     * stands */
    signal(SIGINT, SIG_DFL);
    RUN(loops_see_the_flag, "Ctrl-C ends products of matrices and solutions with them");
    RUN(random_moments, "Ctrl-C at random moments ends a script in order");
    return check_finish();
}
