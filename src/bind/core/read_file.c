/* read_file.c - files that are read. */
#define _DEFAULT_SOURCE
#include "bind/core/read_file.h"
#include "bind/core/new_file.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    MOST = 1 << 30, /* bytes through a pipe */
    BLOCK = 1 << 16,
    LOOK = 100 /* ms between two looks at Ctrl-C */
};

/* Is there something, or the end? 0 on Ctrl-C. A pipe that nobody has opened yet is waited for. */
static int wait_for(int fd) {
    struct pollfd at = {.fd = fd, .events = POLLIN};
    while (!dml_stop && poll(&at, 1, LOOK) <= 0) {}
    return !dml_stop;
}

/* What comes through a pipe, in a file without a name; NULL: *why says. */
static FILE *gather(int fd, const char **why) {
    char block[BLOCK];
    size_t all = 0;
    ssize_t got = 1;
    FILE *f = tmpfile();
    *why = f ? NULL : strerror(errno);
    while (f && !*why && got && wait_for(fd)) {
        got = read(fd, block, sizeof block);
        if (got < 0 && (errno == EAGAIN || errno == EINTR)) continue;
        if (got < 0 || fwrite(block, 1, (size_t)got, f) != (size_t)got) *why = strerror(errno);
        if (got > 0 && (all += (size_t)got) > MOST) *why = "more than 2^30 bytes come through it";
    }
    if (f && !*why) rewind(f);
    if (f && *why) fclose(f), f = NULL;
    return f;
}

static const char *kind_of(mode_t mode) {
    return S_ISDIR(mode)                    ? strerror(EISDIR)
           : S_ISCHR(mode) || S_ISBLK(mode) ? "it is a device, which may have no end, and no file"
                                            : "it is no file";
}

/* *opened: there is something of this name */
static FILE *open_any(const char *name, int *opened, const char **why) {
    struct stat s;
    FILE *f = NULL;
    const int fd = open(name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    *opened = fd >= 0;
    if (fd < 0 || fstat(fd, &s) != 0)
        *why = strerror(errno);
    else if (S_ISREG(s.st_mode)) {
        f = fdopen(fd, "rb");
        if (f) return f;
        *why = strerror(errno);
    } else if (S_ISFIFO(s.st_mode))
        f = gather(fd, why);
    else
        *why = kind_of(s.st_mode);
    if (fd >= 0) close(fd);
    return f;
}

/* How Lua closes it. */
static int close_file(lua_State *L) {
    luaL_Stream *s = luaL_checkudata(L, 1, LUA_FILEHANDLE);
    return luaL_fileresult(L, fclose(s->f) == 0, NULL);
}

FILE *dml_openfile(lua_State *L, const char *name) {
    const char *why = NULL;
    int opened;
    luaL_Stream *s = lua_newuserdatauv(L, sizeof *s, 0);
    s->closef = NULL; /* closed, until it is open */
    luaL_setmetatable(L, LUA_FILEHANDLE);
    s->f = open_any(name, &opened, &why);
    if (s->f) s->closef = close_file;
    dml_checkstop(L);
    if (s->f) return s->f;
    lua_pushfstring(L, "cannot %s %s: %s", opened ? "read" : "open", name, why);
    lua_remove(L, -2);
    return NULL;
}

int dml_core_open_file(lua_State *L) {
    if (dml_openfile(L, dml_filename(L, 1))) return 1;
    lua_pushnil(L);
    lua_insert(L, -2);
    return 2;
}
