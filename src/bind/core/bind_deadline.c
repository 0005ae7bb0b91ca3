/* bind_deadline.c - `core.within`: a call that is ended when its CPU time is over, by the same road
 * as Ctrl-C: runs look at dml_stop between bursts of steps. */
#include "bind/core/bind.h"
#include "bind/core/child_process.h"

#include <math.h>
#include <time.h>

/* A process has one clock of CPU time. `until`: when it rings, s of that clock; infinite: never.
 * The timer is one of real time, at which that clock is looked at: while a timer of CPU time is
 * set the system counts CPU time by ticks of 4 ms, and nothing short could be timed. */
static struct {
    timer_t timer;
    int made;
    double until;
} deadline = {.until = INFINITY};

static const double SOONEST = 1e-3; /* s from look to look */
static const double PART = 0.25;    /* of the CPU time that is left: several threads use it up */

static volatile sig_atomic_t late; /* it has rung, and no call has ended by it yet */

/* look again when the time that is left may be over; never where there is no end */
static void set_timer(double left) {
    struct itimerspec when = {0};
    if (left < 1e9) {
        const double wait = fmax(SOONEST, PART * left), whole = floor(wait);
        when.it_value.tv_sec = (time_t)whole;
        when.it_value.tv_nsec = (long)(1e9 * (wait - whole));
    }
    timer_settime(deadline.timer, 0, &when, NULL);
}

/* What is tried under a pcall may keep a stop to itself: it is told again until the call ends. */
static void tell(double left) {
    static const double AGAIN = 0.2;
    if (left <= 0.0) {
        late = 1;
        dml_tell_stop();
    }
    set_timer(left > 0.0 ? left : AGAIN);
}

static void look(int signal) {
    (void)signal;
    tell(deadline.until - dml_cpu());
}

/* false where the system has no such timer: then nothing is ended */
static int make_timer(void) {
    struct sigaction action = {.sa_handler = look, .sa_flags = SA_RESTART};
    struct sigevent event = {.sigev_notify = SIGEV_SIGNAL, .sigev_signo = SIGRTMIN};
    if (deadline.made) return 1;
    sigemptyset(&action.sa_mask);
    if (sigaction(SIGRTMIN, &action, NULL) != 0) return 0;
    return deadline.made = timer_create(CLOCK_MONOTONIC, &event, &deadline.timer) == 0;
}

/* ring at this time of the clock; one that is over rings at once */
static void set_deadline(double until) {
    const double left = until - dml_cpu();
    deadline.until = until;
    if (make_timer()) tell(left);
}

/* An outer call that has less time left ends the inner one too, and then itself. */
static int within(lua_State *L) {
    const double seconds = dml_checknumber(L, 1), before = deadline.until;
    luaL_checkany(L, 2);
    set_deadline(fmin(before, dml_cpu() + fmax(seconds, 0.0)));
    const int status = lua_pcall(L, lua_gettop(L) - 2, LUA_MULTRET, 0);
    set_deadline(INFINITY); /* it does not ring any more */
    const int rung = late;
    if (rung) late = dml_stop = 0;
    set_deadline(before);
    if (status != LUA_OK && !(rung && dml_is_stop(L, -1))) return lua_error(L);
    lua_pushboolean(L, status == LUA_OK);
    lua_replace(L, 1);
    return lua_gettop(L);
}

static int pass_stop(lua_State *L) {
    dml_checkstop(L);
    return 0;
}

static const dml_row functions[] =
    {{"within", within,
      "core.within(seconds, f, ...) -> true, results   or   false, error\n"
      "Call f and end it when it has used so many seconds of CPU time, of all threads: the run in "
      "hand stops as by Ctrl-C, and what that raised is the error. Other errors pass. Between runs "
      "nothing is ended: loops of Lua look at dm.cpu() themselves, or call core.pass_stop()."},
     {"pass_stop", pass_stop,
      "core.pass_stop()\n"
      "Raise what a stop raises where one waits, by Ctrl-C or the end of core.within: for loops of "
      "Lua that may take long."},
     {NULL, NULL, NULL}};

const dml_class dml_class_deadline = {
    .functions = functions,
};
