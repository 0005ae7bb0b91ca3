/* bind_worker.c - `core.worker`: a process of its own for a function of the script, as Lua does not
 * go into threads. It is forked, so it has all that the script has made; messages are strings, each
 * behind its length. */
#include "bind/core/bind.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define TNAME "dm.worker"

/* Descriptors are -1 when it has ended. */
typedef struct {
    pid_t pid; /* 0: this process is the worker */
    int in, out;
} worker;

/* The worker at `at`, whose pipes are open. */
static worker *check(lua_State *L, int at) {
    worker *w = luaL_checkudata(L, at, TNAME);
    if (w->in < 0) luaL_error(L, "the worker has ended");
    return w;
}

/* 0: nobody reads any more; SIGPIPE is ignored. */
static int write_all(int fd, const void *bytes, size_t left) {
    const char *from = bytes;
    while (left) {
        const ssize_t wrote = write(fd, from, left);
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote < 0) return 0;
        from += wrote;
        left -= (size_t)wrote;
    }
    return 1;
}

/* 0: the other end is closed, or Ctrl-C */
static int read_all(int fd, void *bytes, size_t left) {
    char *to = bytes;
    while (left) {
        const ssize_t got = read(fd, to, left);
        if (got < 0 && errno == EINTR && !dml_stop) continue;
        if (got <= 0) return 0;
        to += got;
        left -= (size_t)got;
    }
    return 1;
}

/* worker:send(text) -> boolean: is there somebody who reads it? */
static int send_text(lua_State *L) {
    const worker *w = check(L, 1);
    size_t size;
    const char *text = luaL_checklstring(L, 2, &size);
    const uint64_t length = size;
    lua_pushboolean(L, write_all(w->out, &length, sizeof length) && write_all(w->out, text, size));
    return 1;
}

/* worker:receive() -> text, or nil where the other process has ended */
static int receive(lua_State *L) {
    const worker *w = check(L, 1);
    uint64_t length;
    luaL_Buffer b;
    if (!read_all(w->in, &length, sizeof length)) return 0;
    char *to = luaL_buffinitsize(L, &b, (size_t)length + 1);
    if (!read_all(w->in, to, (size_t)length)) return 0;
    luaL_pushresultsize(&b, (size_t)length);
    return 1;
}

/* ends the process, too */
static int close_worker(lua_State *L) {
    worker *w = luaL_checkudata(L, 1, TNAME);
    if (w->in < 0) return 0;
    close(w->in);
    close(w->out);
    w->in = w->out = -1;
    if (w->pid <= 0) return 0;
    kill(w->pid, SIGKILL);
    while (waitpid(w->pid, NULL, 0) < 0 && errno == EINTR) {}
    return 0;
}

/* What the worker does: f(channel), then it ends without what this process does at its end. */
static void serve(lua_State *L, const worker *channel) {
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    worker *w = lua_newuserdatauv(L, sizeof *w, 0);
    *w = *channel;
    luaL_setmetatable(L, TNAME);
    const int status = lua_pcall(L, 1, 0, 0);
    if (status != LUA_OK) fprintf(stderr, "%s\n", luaL_tolstring(L, -1, NULL));
    fflush(stdout);
    fflush(stderr);
    _exit(status == LUA_OK ? 0 : 1);
}

/* core.worker(f): both ends of two pipes, one for each direction; each process keeps one of each */
static int fork_worker(lua_State *L) {
    int to[2], from[2];
    luaL_checktype(L, 1, LUA_TFUNCTION);
    lua_settop(L, 1);
    worker *w = lua_newuserdatauv(L, sizeof *w, 0);
    *w = (worker){.in = -1, .out = -1};
    luaL_setmetatable(L, TNAME);
    if (pipe(to) != 0) return luaL_error(L, "no worker: %s", strerror(errno));
    if (pipe(from) != 0) {
        const int why = errno;
        close(to[0]), close(to[1]);
        return luaL_error(L, "no worker: %s", strerror(why));
    }
    fflush(NULL); /* or both would write what is waiting */
    signal(SIGPIPE, SIG_IGN);
    const pid_t pid = fork();
    if (pid == 0) {
        close(to[1]), close(from[0]);
        lua_pushvalue(L, 1);
        serve(L, &(worker){.in = to[0], .out = from[1]});
    }
    close(to[0]), close(from[1]);
    *w = (worker){.pid = pid, .in = from[0], .out = to[1]};
    if (pid < 0) {
        close(w->in), close(w->out);
        w->in = -1;
        return luaL_error(L, "no worker: %s", strerror(errno));
    }
    return 1;
}

/* core.wait(workers) -> index of one that has something to say, or has ended; nil: Ctrl-C */
static int wait_for(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    const int count = (int)luaL_len(L, 1);
    struct pollfd *fds = lua_newuserdatauv(L, (size_t)count * sizeof *fds + 1, 0);
    for (int i = 0; i < count; i++) {
        lua_rawgeti(L, 1, i + 1);
        const worker *w = luaL_testudata(L, -1, TNAME);
        fds[i] = (struct pollfd){.fd = w ? w->in : -1, .events = POLLIN};
        lua_pop(L, 1);
    }
    while (poll(fds, (nfds_t)count, -1) < 0)
        if (errno != EINTR || dml_stop) return 0;
    for (int i = 0; i < count; i++)
        if (fds[i].revents) return lua_pushinteger(L, i + 1), 1;
    return 0;
}

/* core.end_process(status): a script that has done its part ends, files and all */
static int end_process(lua_State *L) {
    lua_getglobal(L, "os");
    lua_getfield(L, -1, "exit");
    lua_pushvalue(L, 1);
    lua_pushboolean(L, 1);
    lua_call(L, 2, 0);
    return 0;
}

/* core.nap(seconds), less where a signal comes */
static int nap(lua_State *L) {
    const double s = dml_checknumber(L, 1);
    struct timespec t = {.tv_sec = (time_t)s, .tv_nsec = (long)((s - (double)(time_t)s) * 1e9)};
    nanosleep(&t, NULL);
    return 0;
}

/* core.cores() */
static int cores(lua_State *L) {
    const long count = sysconf(_SC_NPROCESSORS_ONLN);
    lua_pushinteger(L, count < 1 ? 1 : count);
    return 1;
}

static const dml_row meta[] = {{"__gc", close_worker, NULL},
                               {"__close", close_worker, NULL},
                               {NULL, NULL, NULL}};
static const dml_row methods[] =
    {{"send", send_text, "worker:send(text) -> boolean\nIs there somebody who reads it?"},
     {"receive", receive,
      "worker:receive() -> string or nil\nWait for a text; nil: the other process has ended."},
     {"close", close_worker, "worker:close()\nEnd the process."},
     {NULL, NULL, NULL}};
static const dml_row functions[] =
    {{"worker", fork_worker,
      "core.worker(f) -> dm.worker\n"
      "A process that calls f(channel), where channel:receive() and channel:send(text) speak with "
      "the worker of this one."},
     {"wait", wait_for,
      "core.wait(workers) -> integer or nil\n"
      "Number of a worker of the list that has something to say, or has ended; nil: interrupted."},
     {"end_process", end_process, "core.end_process(status)\nos.exit, with all closed."},
     {"nap", nap, "core.nap(seconds)\nWait."},
     {"cores", cores, "core.cores() -> integer\nProcessors of this machine."},
     {NULL, NULL, NULL}};

const dml_class dml_class_worker = {
    .name = TNAME,
    .doc = "dm.worker: another process, made by core.worker(f)\n"
           "Members of dm.sweep run in such ones; it is ended when it is collected.",
    .meta = meta,
    .methods = methods,
    .functions = functions,
};
