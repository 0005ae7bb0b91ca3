/* new_file.c - files that replace others when they are whole. */
#define _DEFAULT_SOURCE
#include "bind/core/new_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { TRIES = 64, LETTERS = 12 };
enum { STALE = 3600 }; /* s since a file was written to that nobody finishes any more */

static const char letters[] = "0123456789abcdefghijklmnopqrstuv"; /* 32: no bias */
static const char mark[] = ".dmlua-";                             /* between name and letters */

static int silent;

void dml_silencefiles(void) {
    silent = 1;
}

int dml_issilent(void) {
    return silent;
}

/* fcntl tells the process where flock would not */
const char *dml_lockfile(lua_State *L, int fd) {
    struct flock all = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    if (fcntl(fd, F_SETLK, &all) == 0) return NULL;
    if (errno != EACCES && errno != EAGAIN) return strerror(errno);
    const char *who = "in use";
    if (fcntl(fd, F_GETLK, &all) == 0 && all.l_type != F_UNLCK)
        who = lua_pushfstring(L, "in use by process %d", (int)all.l_pid);
    errno = EAGAIN;
    return who;
}

/* random letters; 0: the system has none */
static int draw(char out[LETTERS + 1]) {
    unsigned char bytes[LETTERS];
    const int source = open("/dev/urandom", O_RDONLY | O_CLOEXEC);
    const int fine = source >= 0 && read(source, bytes, sizeof bytes) == (ssize_t)sizeof bytes;
    if (source >= 0) close(source);
    for (int i = 0; i < LETTERS; i++) out[i] = letters[fine ? bytes[i] % 32 : 0];
    out[LETTERS] = '\0';
    return fine;
}

static const char *base_of(const char *file) {
    const char *slash = strrchr(file, '/');
    return slash ? slash + 1 : file;
}

/* ".png", which tells some programs what to write; "" without one */
static const char *ending(const char *file) {
    const char *dot = strrchr(base_of(file), '.');
    return dot ? dot : "";
}

/* Is that the name, in the same folder, of a new file for `file`? */
static int is_new(const char *name, const char *file) {
    const char *base = base_of(file);
    const size_t length = strlen(base);
    if (strncmp(name, base, length) != 0) return 0;
    name += length;
    if (strncmp(name, mark, sizeof mark - 1) != 0) return 0;
    name += sizeof mark - 1;
    return strspn(name, letters) == LETTERS && strcmp(name + LETTERS, ending(file)) == 0;
}

/* What runs that were killed have left beside `file`: our own new files for it, which nobody has
 * written to for long. */
static void remove_stale(const char *file) {
    char folder[DML_FILE_NAME];
    const size_t length = (size_t)(base_of(file) - file);
    struct stat s;
    if (length >= sizeof folder) return;
    snprintf(folder, sizeof folder, "%.*s", length ? (int)length : 1, length ? file : ".");
    DIR *all = opendir(folder);
    for (const struct dirent *at; all && (at = readdir(all));) {
        if (!is_new(at->d_name, file) || fstatat(dirfd(all), at->d_name, &s, AT_SYMLINK_NOFOLLOW))
            continue;
        if (S_ISREG(s.st_mode) && s.st_uid == geteuid() && time(NULL) - s.st_mtime > STALE)
            unlinkat(dirfd(all), at->d_name, 0);
    }
    if (all) closedir(all);
}

FILE *dml_newfile(const char *file, mode_t mode, char name[DML_FILE_NAME]) {
    int descriptor = -1;
    const char *end = ending(file);
    remove_stale(file);
    for (int k = 0; k < TRIES && descriptor < 0; k++) {
        char drawn[LETTERS + 1];
        if (!draw(drawn)) return NULL;
        if (snprintf(name, DML_FILE_NAME, "%s%s%s%s", file, mark, drawn, end) >= DML_FILE_NAME) {
            errno = ENAMETOOLONG;
            return NULL;
        }
        descriptor = open(name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
        if (descriptor < 0 && errno != EEXIST) return NULL;
    }
    FILE *f = descriptor < 0 ? NULL : fdopen(descriptor, "wb");
    if (!f && descriptor >= 0) close(descriptor), remove(name);
    return f;
}

/* the bytes are on the disk before the name is: a crash must not leave an empty file */
int dml_endfile(FILE *f, int whole, const char *name, const char *file) {
    whole = whole && fflush(f) == 0 && fsync(fileno(f)) == 0;
    const int why = errno;
    const int closed = fclose(f) == 0;
    if (silent) return remove(name) == 0;
    if (whole && closed && rename(name, file) == 0) return 1;
    const int later = whole ? errno : why;
    remove(name);
    errno = later;
    return 0;
}

/* ---- for modules in Lua ---- */

const char *dml_filename(lua_State *L, int arg) {
    size_t length;
    const char *name = luaL_checklstring(L, arg, &length);
    luaL_argcheck(L, strlen(name) == length, arg, "the name of a file has no zero bytes");
    return name;
}

/* a pipe, a terminal, a link (as /dev/stdout is): there is no file to replace */
static int leads_elsewhere(const char *file) {
    struct stat s;
    return lstat(file, &s) == 0 && !S_ISREG(s.st_mode);
}

/* A file that is protected is not replaced, one in a folder that is protected is written through,
 * others keep their mode. */
int dml_core_new_file(lua_State *L) {
    const char *file = dml_filename(L, 1);
    const int through = lua_toboolean(L, 2);
    char name[DML_FILE_NAME];
    struct stat old;
    lua_settop(L, 1);
    if (through && leads_elsewhere(file)) return 1;
    const int there = through && stat(file, &old) == 0;
    if (there && access(file, W_OK) != 0) return luaL_fileresult(L, 0, file);
    FILE *f = dml_newfile(file, 0666, name);
    if (!f && there && errno == EACCES) return 1;
    const int fine = f && (!there || fchmod(fileno(f), (old.st_mode & 0777) | 0600) == 0);
    if (!f || fclose(f) != 0 || !fine) return luaL_fileresult(L, 0, file);
    lua_pushstring(L, name);
    return 1;
}

int dml_core_is_silent(lua_State *L) {
    lua_pushboolean(L, silent);
    return 1;
}

int dml_core_end_file(lua_State *L) {
    const char *name = dml_filename(L, 1), *file = dml_filename(L, 2);
    if (strcmp(name, file) == 0) return luaL_fileresult(L, 1, file);
    FILE *f = fopen(name, "ab");
    return luaL_fileresult(L, f && dml_endfile(f, 1, name, file), file);
}

int dml_core_cut_file(lua_State *L) {
    const char *file = dml_filename(L, 1);
    const lua_Integer bytes = dml_checkinteger(L, 2);
    luaL_argcheck(L, bytes >= 0, 2, "a number of bytes >= 0 is needed");
    if (truncate(file, (off_t)bytes) != 0 && errno != EINVAL) /* a device has no length */
        return luaL_error(L, "cannot write %s: %s", file, strerror(errno));
    return 0;
}

int dml_core_lock_file(lua_State *L) {
    const luaL_Stream *s = luaL_checkudata(L, 1, LUA_FILEHANDLE);
    luaL_argcheck(L, s->closef, 1, "an open file is needed");
    const char *why = dml_lockfile(L, fileno(s->f));
    if (!why || errno != EAGAIN) {
        lua_pushboolean(L, 1);
        return 1;
    }
    luaL_pushfail(L);
    lua_pushstring(L, why);
    return 2;
}
