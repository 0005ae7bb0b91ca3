/* compiled.c - the file of compiled modules, in the layout that lua/dm/session/compiled.lua writes:
 * "dmlua modules", the ident of Lua (both end in 0), n, then n rows of four offsets, then bytes.
 * Numbers are size_t. Between the offsets of a row are a file's name, its text and its code. */
#include "cli/compiled.h"

#include <lauxlib.h>

#include <fcntl.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

static const char MAGIC[] = "dmlua modules";

typedef struct {
    size_t name, text, code, end;
} row;

/* size of what stands in front of n */
static size_t head_size(void) {
    return sizeof MAGIC + strlen(lua_ident) + 1;
}

static size_t number_of_rows(const dml_compiled *c) {
    size_t n;
    memcpy(&n, c->bytes + head_size(), sizeof n);
    return n;
}

static size_t rows_at(void) {
    return head_size() + sizeof(size_t);
}

static row row_of(const dml_compiled *c, size_t i) {
    row r;
    memcpy(&r, c->bytes + rows_at() + i * sizeof r, sizeof r);
    return r;
}

/* Does each row lie within the file? */
static int is_whole(const dml_compiled *c) {
    const size_t first = rows_at();
    if (c->size < first || memcmp(c->bytes, MAGIC, sizeof MAGIC) != 0) return 0;
    if (memcmp(c->bytes + sizeof MAGIC, lua_ident, strlen(lua_ident) + 1) != 0) return 0;
    const size_t n = number_of_rows(c);
    if (n > (c->size - first) / sizeof(row)) return 0;
    for (size_t i = 0; i < n; i++) {
        const row r = row_of(c, i);
        if (r.name > r.text || r.text > r.code || r.code > r.end || r.end > c->size) return 0;
    }
    return 1;
}

dml_compiled dml_compiled_open(const char *file) {
    dml_compiled c = {0};
    struct stat about;
    const int descriptor = open(file, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return c;
    if (fstat(descriptor, &about) == 0 && S_ISREG(about.st_mode) && about.st_size > 0) {
        const size_t size = (size_t)about.st_size;
        void *bytes = mmap(NULL, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
        if (bytes != MAP_FAILED) c = (dml_compiled){bytes, size};
    }
    close(descriptor);
    if (c.bytes && !is_whole(&c)) {
        munmap((void *)(uintptr_t)c.bytes, c.size);
        c = (dml_compiled){0};
    }
    return c;
}

/* Is the text of an open file what stands from `text` to `end`? */
static int is_text(int descriptor, const char *text, const char *end) {
    char buffer[4096];
    ssize_t n;
    while ((n = read(descriptor, buffer, sizeof buffer)) > 0) {
        if (n > end - text || memcmp(buffer, text, (size_t)n) != 0) return 0;
        text += n;
    }
    return n == 0 && text == end;
}

static int is_current(const dml_compiled *c, const row *r, const char *file) {
    const int descriptor = open(file, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return 0;
    const int same = is_text(descriptor, c->bytes + r->text, c->bytes + r->code);
    close(descriptor);
    return same;
}

/* the row of a file, if it has one of its name and its text */
static int find(const dml_compiled *c, const char *file, row *out) {
    const size_t length = strlen(file);
    const size_t n = c->bytes ? number_of_rows(c) : 0;
    for (size_t i = 0; i < n; i++) {
        const row r = row_of(c, i);
        if (r.text - r.name != length || memcmp(c->bytes + r.name, file, length) != 0) continue;
        *out = r;
        return is_current(c, out, file);
    }
    return 0;
}

int dml_compiled_load(lua_State *L, const dml_compiled *from, const char *file) {
    row r;
    if (!find(from, file, &r)) return luaL_loadfile(L, file);
    const char *name = lua_pushfstring(L, "@%s", file);
    const int status = luaL_loadbufferx(L, from->bytes + r.code, r.end - r.code, name, "b");
    lua_remove(L, -2);
    return status;
}
