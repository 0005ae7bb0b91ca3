/* checkpoint_file.c - a checkpoint as a text of names and numbers, the numbers in hexadecimal, so
 * with all their bits:  dmlua checkpoint 4 / rule gauss(2) / n, h, tolerance, ... / state ... /
 * carried ... of a reduced system that carries something along / memory ... / end and a checksum of
 * all lines before. Nothing that is read is believed: numbers are looked at one by one, and what
 * methods take for a count or a pivot in their memory they look at themselves. */
#include "bind/core/new_file.h"
#include "bind/core/read_file.h"
#include "bind/run/checkpoint.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *const HEAD = "dmlua checkpoint 4";
enum { LINE = 4096 };

/* ---- to a file ---- */

/* a file, and the checksum of the lines that it has so far */
typedef struct {
    FILE *f;
    uint64_t sum;
    int fine;
} writer;

/* FNV-1a, 64 bits (Fowler, Noll, Vo): a changed line is seen; it is no seal */
static uint64_t add_to_sum(uint64_t sum, const char *text) {
    for (; *text; text++) sum = (sum ^ (unsigned char)*text) * 0x100000001b3u;
    return sum;
}
static const uint64_t EMPTY_SUM = 0xcbf29ce484222325u;

/* one line of at most LINE bytes */
static void put(writer *w, const char *format, ...) {
    char text[LINE];
    va_list values;
    va_start(values, format);
    const int length = vsnprintf(text, sizeof text, format, values);
    va_end(values);
    w->fine = w->fine && length > 0 && length < LINE && fputs(text, w->f) != EOF;
    if (w->fine) w->sum = add_to_sum(w->sum, text);
}

/* "name count", then a number a line. */
static void put_numbers(writer *w, const char *name, const double *x, size_t count) {
    put(w, "%s %zu\n", name, count);
    for (size_t i = 0; i < count && w->fine; i++) put(w, "%a\n", x[i]);
}

/* The order of the lines is that of read_checkpoint. 0: not all could be written. */
static int write_all(FILE *f, const dml_checkpoint *c, const dml_solver *s, const char *rule) {
    const size_t size = dm_state_size(c->n);
    writer w = {f, EMPTY_SUM, 1};
    put(&w, "%s\n", HEAD);
    put(&w, "rule %s\n", rule);
    put(&w, "sums %s\n", s->plain ? "plain" : "compensated");
    put(&w, "n %u\n", (unsigned)c->n);
    put(&w, "h %a\n", s->h);
    put(&w, "tolerance %a\n", s->tolerance);
    put(&w, "max_iterations %d\n", s->max_iterations);
    put(&w, "t0 %a\n", c->t0);
    put(&w, "steps %ld\n", c->steps);
    put_numbers(&w, "check", c->check, DML_CHECKS);
    put_numbers(&w, "state", c->state, size);
    if (c->carried) put_numbers(&w, "carried", c->state + size + c->memory, c->carried);
    put_numbers(&w, "memory", c->state + size, c->memory);
    put(&w, "end %016llx\n", (unsigned long long)w.sum);
    return w.fine;
}

/* Is that what this program reads or prints to, as /dev/stdout is where it goes to a file? */
static int is_own_stream(const struct stat *at) {
    struct stat own;
    for (int stream = 0; stream <= 2; stream++)
        if (fstat(stream, &own) == 0 && own.st_dev == at->st_dev && own.st_ino == at->st_ino)
            return 1;
    return 0;
}

/* What is written goes to a new file in the same folder, so that it is the folder which must let
 * us. */
int dml_checkpoint_try(const char *file) {
    char folder[4096];
    struct stat at;
    const int there = stat(file, &at) == 0;
    /* a checkpoint takes the place of what has its name: of a file, not of /dev/null */
    if (!*file || (there && (!S_ISREG(at.st_mode) || is_own_stream(&at)))) {
        errno = !*file ? ENOENT : S_ISDIR(at.st_mode) ? EISDIR : EPERM;
        return 0;
    }
    const char *slash = strrchr(file, '/');
    const int length = slash ? (int)(slash - file) + 1 : 1;
    snprintf(folder, sizeof folder, "%.*s", length, slash ? file : ".");
    return access(folder, W_OK) == 0;
}

/* A file that cannot be written whole leaves the old one as it was. */
int dml_checkpoint_write(const dml_checkpoint *c, const dml_solver *s, const char *rule,
                         const char *file) {
    char name[DML_FILE_NAME];
    FILE *f = dml_checkpoint_try(file) ? dml_newfile(file, 0666, name) : NULL;
    return f && dml_endfile(f, write_all(f, c, s, rule), name, file);
}

/* ---- from a file ---- */

typedef struct {
    lua_State *L;
    FILE *f; /* closed by the collector when an error is raised */
    const char *file;
    long line;
    uint64_t sum, before; /* of the lines so far, and without the last one */
} reader;

/* Raises with the number of the line that was read last. */
static void fail(const reader *r, const char *expected) {
    luaL_error(r->L, "%s, line %d: not a whole checkpoint (%s expected)", r->file, (int)r->line,
               *expected ? expected : "a number");
}

/* the rest of the next line after `name ` */
static char *read_line(reader *r, char text[LINE], const char *name) {
    const size_t length = strlen(name);
    r->line++;
    if (!fgets(text, LINE, r->f) || !strchr(text, '\n')) fail(r, name);
    r->before = r->sum;
    r->sum = add_to_sum(r->sum, text);
    *strchr(text, '\n') = '\0';
    if (strncmp(text, name, length) != 0) fail(r, name);
    return text[length] == ' ' ? text + length + 1 : text + length;
}

/* A line that holds more than the number, or less, is refused. */
static double read_number(reader *r, const char *name) {
    char text[LINE], *end, *start = read_line(r, text, name);
    const double x = strtod(start, &end);
    if (end == start || *end) fail(r, name);
    return x;
}

/* Times and states: infinite ones come from no run that can go on. */
static double read_finite(reader *r, const char *name) {
    const double x = read_number(r, name);
    if (!isfinite(x)) fail(r, "a finite number");
    return x;
}

/* Steps and tolerances. */
static double read_positive(reader *r, const char *name) {
    const double x = read_finite(r, name);
    if (!(x > 0.0)) fail(r, "a number > 0");
    return x;
}

/* A whole number in 0 .. most: it is used as a size. */
static long read_count(reader *r, const char *name, double most) {
    const double x = read_number(r, name);
    if (!(x >= 0 && x <= most && x == floor(x))) fail(r, name);
    return (long)x;
}

/* Memory of a method, where NaN can stand for "not known". */
static void read_numbers(reader *r, double *x, size_t count) {
    for (size_t i = 0; i < count; i++) x[i] = read_number(r, "");
}

/* the last line, and nothing behind it */
static void read_end(reader *r) {
    char text[LINE], sum[24];
    const char *written = read_line(r, text, "end");
    snprintf(sum, sizeof sum, "%016llx", (unsigned long long)r->before);
    if (text[strlen("end")] != ' ' || strcmp(written, sum) != 0)
        luaL_error(r->L,
                   "%s: its lines do not have the checksum that it ends with: it was changed since "
                   "dmlua wrote it",
                   r->file);
    if (fgetc(r->f) != EOF) r->line++, fail(r, "its end");
}

/* push what a reduced system carries along, which few files have; how many numbers */
static uint32_t push_carried(reader *r) {
    enum { MOST = 1 << 20 };
    const int c = fgetc(r->f);
    ungetc(c, r->f);
    const uint32_t count = c == 'c' ? (uint32_t)read_count(r, "carried", MOST) : 0;
    double *x = lua_newuserdatauv(r->L, (count + 1) * sizeof *x, 0);
    for (uint32_t i = 0; i < count; i++) x[i] = read_finite(r, "");
    return count;
}

/* option `key` of the table on top */
static void set_number(lua_State *L, const char *key, double x) {
    lua_pushnumber(L, x);
    lua_setfield(L, -2, key);
}

/* the options of the solver are pushed, then the checkpoint */
static dml_checkpoint *read_checkpoint(reader *r) {
    enum { MOST = 1 << 28 };
    lua_State *L = r->L;
    char text[LINE];
    read_line(r, text, HEAD);
    lua_newtable(L);
    lua_pushstring(L, read_line(r, text, "rule"));
    lua_setfield(L, -2, "rule");
    lua_pushstring(L, read_line(r, text, "sums"));
    lua_setfield(L, -2, "sums");
    const long n = read_count(r, "n", MOST);
    set_number(L, "h", read_positive(r, "h"));
    lua_newtable(L);
    set_number(L, "tolerance", read_positive(r, "tolerance"));
    set_number(L, "max_iterations", (double)read_count(r, "max_iterations", INT_MAX));
    lua_setfield(L, -2, "newton");
    const double t0 = read_finite(r, "t0");
    const long steps = read_count(r, "steps", 9e15);
    double check[DML_CHECKS];
    const long checks = read_count(r, "check", MOST);
    if (checks < DML_CHECK_FAR || checks > DML_CHECKS) fail(r, "how many numbers tell the system");
    check[DML_CHECK_FAR] = check[DML_CHECK_RULE] = NAN; /* of a dmlua that did not look there */
    read_numbers(r, check, (size_t)checks);
    const size_t size = (size_t)read_count(r, "state", MOST);
    if (size != dm_state_size((uint32_t)n)) fail(r, "the size of the state");
    double *state = lua_newuserdatauv(L, size * sizeof *state, 0);
    for (size_t i = 0; i < size; i++) state[i] = read_finite(r, "");
    const uint32_t carried = push_carried(r);
    const double *what = lua_touserdata(L, -1);
    const size_t memory = (size_t)read_count(r, "memory", MOST);
    const size_t doubles = size + memory + carried;
    dml_checkpoint *c = lua_newuserdatauv(L, sizeof *c + doubles * sizeof(double), 0);
    *c = (dml_checkpoint){.t0 = t0,
                          .steps = steps,
                          .n = (uint32_t)n,
                          .carried = carried,
                          .memory = memory,
                          .checked = 1};
    memcpy(c->check, check, sizeof check);
    memcpy(c->state, state, size * sizeof *state);
    memcpy(dml_checkpoint_carried(c), what, carried * sizeof *what);
    read_numbers(r, c->state + size, memory);
    read_end(r);
    lua_replace(L, -3);
    lua_pop(L, 1);
    return c;
}

/* The file is closed by the collector where a line is refused. */
void dml_checkpoint_read(lua_State *L, const char *file) {
    FILE *f = dml_openfile(L, file);
    if (!f) luaL_error(L, "dm.resume: %s", lua_tostring(L, -1));
    luaL_Stream *s = lua_touserdata(L, -1);
    reader r = {.L = L, .f = f, .file = file, .sum = EMPTY_SUM};
    read_checkpoint(&r);
    s->closef = NULL;
    fclose(s->f);
}
