/* bind_journal.c - the file of a journal: locked by the process that writes it, read and written
 * through one descriptor, on the disk when `sync` returns. What its bytes mean is told by
 * lua/dm/data/journal.lua. */
#include "bind/core/bind.h"
#include "bind/core/new_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define TNAME "dm.journal_file"

/* The lock is lost when any descriptor of the file is closed: it is read through the same one. */
typedef struct {
    int fd; /* -1: closed */
} file;

/* The file at 1, which is open. */
static file *check(lua_State *L) {
    file *f = luaL_checkudata(L, 1, TNAME);
    if (f->fd < 0) luaL_error(L, "the journal is closed");
    return f;
}

/* nil, why */
static int failed(lua_State *L, const char *why) {
    luaL_pushfail(L);
    lua_pushstring(L, why);
    return 2;
}

/* (name [, write]) -> file   or   nil, why */
static int open_file(lua_State *L) {
    const char *name = dml_filename(L, 1);
    const int writes = lua_toboolean(L, 2);
    struct stat s;
    file *f = lua_newuserdatauv(L, sizeof *f, 0);
    f->fd = open(name, (writes ? O_RDWR | O_CREAT : O_RDONLY) | O_CLOEXEC | O_NONBLOCK, 0666);
    luaL_setmetatable(L, TNAME);
    if (f->fd < 0) return failed(L, strerror(errno));
    if (fstat(f->fd, &s) != 0) return failed(L, strerror(errno));
    if (!S_ISREG(s.st_mode)) return failed(L, "not a file");
    const char *why = writes ? dml_lockfile(L, f->fd) : NULL;
    if (why) return failed(L, why);
    lua_pushvalue(L, 3);
    return 1;
}

/* (file) -> bytes */
static int size_of(lua_State *L) {
    struct stat s;
    if (fstat(check(L)->fd, &s) != 0) return failed(L, strerror(errno));
    lua_pushinteger(L, (lua_Integer)s.st_size);
    return 1;
}

/* (file, offset, count) -> bytes, fewer at the end */
static int read_file(lua_State *L) {
    const file *f = check(L);
    const lua_Integer offset = dml_checkinteger(L, 2), count = dml_checkinteger(L, 3);
    luaL_argcheck(L, offset >= 0, 2, "must be >= 0");
    luaL_argcheck(L, count >= 0, 3, "must be >= 0");
    luaL_Buffer b;
    char *to = luaL_buffinitsize(L, &b, (size_t)count + 1);
    size_t done = 0;
    while (done < (size_t)count) {
        const ssize_t got = pread(f->fd, to + done, (size_t)count - done, offset + (off_t)done);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        done += (size_t)got;
    }
    luaL_pushresultsize(&b, done);
    return 1;
}

static int write_all(int fd, const char *from, size_t left) {
    while (left) {
        const ssize_t wrote = write(fd, from, left);
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote < 0) return 0;
        from += wrote;
        left -= (size_t)wrote;
    }
    return 1;
}

/* (file, bytes ...) -> true   or   nil, why. One call for a whole record: Ctrl-C and SIGTERM stop
 * Lua between two calls. */
static int append(lua_State *L) {
    const file *f = check(L);
    const int last = lua_gettop(L);
    luaL_checkstring(L, 2);
    for (int i = 3; i <= last; i++) luaL_checkstring(L, i);
    if (lseek(f->fd, 0, SEEK_END) < 0) return failed(L, strerror(errno));
    for (int i = 2; i <= last; i++) {
        size_t size;
        const char *bytes = lua_tolstring(L, i, &size);
        if (!write_all(f->fd, bytes, size)) return failed(L, strerror(errno));
    }
    lua_pushboolean(L, 1);
    return 1;
}

/* (file, size) -> true   or   nil, why */
static int truncate_file(lua_State *L) {
    const file *f = check(L);
    if (ftruncate(f->fd, (off_t)dml_checkinteger(L, 2)) != 0) return failed(L, strerror(errno));
    lua_pushboolean(L, 1);
    return 1;
}

/* (file) -> true   or   nil, why: it may be full only now */
static int sync_file(lua_State *L) {
    if (fsync(check(L)->fd) != 0) return failed(L, strerror(errno));
    lua_pushboolean(L, 1);
    return 1;
}

/* gives the lock back, too */
static int close_file(lua_State *L) {
    file *f = luaL_checkudata(L, 1, TNAME);
    if (f->fd >= 0) close(f->fd);
    f->fd = -1;
    return 0;
}

/* ---- CRC-32, that of zlib: eight bytes at a time by eight tables ---- */

/* [k][i]: what byte i adds when k bytes follow it */
static uint32_t crc_table[8][256];

static void make_table(void) {
    for (uint32_t i = 0; i < 256; i++) {
        uint32_t c = i;
        for (int k = 0; k < 8; k++) c = c & 1 ? 0xedb88320u ^ (c >> 1) : c >> 1;
        crc_table[0][i] = c;
    }
    for (uint32_t i = 0; i < 256; i++)
        for (int k = 1; k < 8; k++) {
            const uint32_t before = crc_table[k - 1][i];
            crc_table[k][i] = crc_table[0][before & 255] ^ (before >> 8);
        }
}

static uint32_t crc(uint32_t c, const unsigned char *at, size_t size) {
    c = ~c;
    for (; size >= 8; size -= 8, at += 8) {
        uint32_t low, high;
        memcpy(&low, at, 4);
        memcpy(&high, at + 4, 4);
        low ^= c;
        c = crc_table[7][low & 255] ^ crc_table[6][low >> 8 & 255] ^ crc_table[5][low >> 16 & 255] ^
            crc_table[4][low >> 24] ^ crc_table[3][high & 255] ^ crc_table[2][high >> 8 & 255] ^
            crc_table[1][high >> 16 & 255] ^ crc_table[0][high >> 24];
    }
    while (size--) c = crc_table[0][(c ^ *at++) & 255] ^ (c >> 8);
    return ~c;
}

/* (bytes [, before]) -> CRC-32 of both */
static int crc32_of(lua_State *L) {
    size_t size;
    const char *bytes = luaL_checklstring(L, 1, &size);
    const lua_Integer before = dml_optinteger(L, 2, 0);
    lua_pushinteger(L, crc((uint32_t)before, (const unsigned char *)bytes, size));
    return 1;
}

/* ---- names ---- */

/* names in a folder, in no order; none where it cannot be read */
static int names_in(lua_State *L) {
    DIR *folder = opendir(luaL_checkstring(L, 1));
    lua_Integer count = 0;
    lua_newtable(L);
    if (!folder) return 1;
    for (const struct dirent *d; (d = readdir(folder)) != NULL;) {
        lua_pushstring(L, d->d_name);
        lua_rawseti(L, -2, ++count);
    }
    closedir(folder);
    return 1;
}

static const dml_row meta[] = {{"__gc", close_file, NULL},
                               {"__close", close_file, NULL},
                               {NULL, NULL, NULL}};
static const dml_row methods[] =
    {{"size", size_of, "journal_file:size() -> integer\nBytes."},
     {"read", read_file,
      "journal_file:read(offset, count) -> string\nBytes from an offset on, fewer at the end."},
     {"append", append,
      "journal_file:append(bytes ...) -> true   or   nil, why\n"
      "Write behind the end: all of it, whatever stops Lua meanwhile."},
     {"truncate", truncate_file,
      "journal_file:truncate(size) -> true   or   nil, why\nCut it to so many bytes."},
     {"sync", sync_file,
      "journal_file:sync() -> true   or   nil, why\nWait until it is on the disk."},
     {"close", close_file, "journal_file:close()\nAlso gives the lock back."},
     {NULL, NULL, NULL}};
static const dml_row functions[] =
    {{"journal_file", open_file,
      "core.journal_file(name [, write]) -> dm.journal_file   or   nil, why\n"
      "Open a file to read it, or to write behind its end under a lock that no other process has."},
     {"crc32", crc32_of,
      "core.crc32(bytes [, before]) -> integer\n"
      "CRC-32 as zlib has it, of what `before` is the sum of and these bytes."},
     {"names_in", names_in,
      "core.names_in(folder) -> table\nNames of what is in a folder, in no order."},
     {NULL, NULL, NULL}};

static void open_journal(lua_State *L) {
    (void)L;
    make_table();
}

const dml_class dml_class_journal = {
    .name = TNAME,
    .doc = "dm.journal_file: the file of a journal, made by core.journal_file(name)\n"
           "It is read and written by the modules of dm.sweep; closed when it is collected.",
    .meta = meta,
    .methods = methods,
    .functions = functions,
    .open = open_journal,
};
