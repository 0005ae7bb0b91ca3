/* trace_check.c - a kernel against plain calls of the function it was traced from. */
#include "bind/core/state.h"
#include "bind/trace/apart.h"
#include "bind/trace/traced_call.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* a function of more operations or inputs is compared at the start and in one point near it */
enum { LONG = 2000, MANY = 1000 };
enum {
    POINTS = 3,      /* at each scale */
    MOST_MOVES = 256 /* groups of inputs that are moved together */
};
static const double scales[] = {0.1, 1e-3, 1.0};
enum { SCALES = sizeof scales / sizeof *scales };

/* Tracing and rewriting the expression change round-off only: differences are measured
 * against the size of the terms, |f| + sum_i |x_i df/dx_i|, since L = T - V may cancel. */
static const double tolerance = 1e-8, nudge = 1e-6;

/* An argument that is zero, or was to be and is what rounding left, has no size of its own there:
 * velocities of others that cancel inside may be of any. Then it has the size of made-up points, 1
 * or that of the list it is in, and what may differ is round-off of terms of that size. */
static const double round_off = 1e3 * DBL_EPSILON;

/* What moves by more than an eighth of a difference where arguments do by their last bits has no
 * digit there: cos of 1e28. */
static const double last_bits = 4 * DBL_EPSILON, scattered = 8.0;

/* arguments of values that are looked at for scatter: so many, so far apart. Few values may scatter
 * by less than the two roads differ: units of the last place of large terms, of which they take
 * different ones. */
enum { ROW = 9 };
static const double apart = 1e-4, scatters_more = 64.0;

typedef struct {
    const dml_signature *s;
    const dm_kernel *kernel;
    dml_given *given; /* numbers for sums, or NULL */
    int fn;
    double *x, *plain, *kernel_out, *moved, *kept;
    int compared; /* points with a number on either road */
} check;

/* uniform in [-1, 1), the same numbers in every run (xorshift64*, Vigna 2016) */
static double next_random(uint64_t *state) {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    const uint64_t bits = (*state * 0x2545F4914F6CDD1Du) >> 11;
    return (double)bits * 0x1p-52 - 1.0;
}

/* The kernel at c->x. */
static void eval(const check *c, double *out) {
    dm_kernel_prepare(c->kernel, out);
    dm_kernel_eval(c->kernel, c->x, out);
}

/* size that argument i is taken to have: its own, or that of made-up points */
static double size_of_argument(const check *c, uint32_t i, int made_up) {
    const int *length = c->s->length;
    uint32_t first = 0, count = 0;
    double size = 1.0;
    if (!made_up) return c->kept[i];
    for (int k = 0; k < c->s->arguments && i >= first + count; k++) {
        first += count;
        count = length[k] == DML_SCALAR_ARGUMENT ? 1 : (uint32_t)length[k];
    }
    for (uint32_t k = first; k < first + count; k++) size = fmax(size, fabs(c->kept[k]));
    return c->kept[i] < 0 ? -size : size;
}

/* The kernel where the arguments of a group have moved by a small part of their size, each with its
 * own sign; of very many inputs every so many'th one moves. */
static void eval_moved(const check *c, uint32_t group, uint32_t groups, double part, int made_up) {
    const uint32_t n = c->kernel->inputs;
    for (uint32_t i = group; i < n; i += groups) {
        const double move = part * size_of_argument(c, i, made_up);
        c->x[i] += i / groups * 7 % 5 % 2 ? -move : move;
    }
    eval(c, c->moved);
    for (uint32_t i = group; i < n; i += groups) c->x[i] = c->kept[i];
}

static uint32_t begin_moves(const check *c) {
    const uint32_t n = c->kernel->inputs;
    memcpy(c->kept, c->x, n * sizeof *c->x);
    return n < MOST_MOVES ? n : MOST_MOVES;
}

/* how far f_k moves where the arguments do, each by this part of it */
static double way_of(const check *c, uint32_t k, double part) {
    const uint32_t groups = begin_moves(c);
    double way = 0.0;
    for (uint32_t group = 0; group < groups; group++) {
        eval_moved(c, group, groups, part, 0);
        if (isfinite(c->moved[k])) way += fabs(c->moved[k] - c->kernel_out[k]);
    }
    return way;
}

/* |f_k| + sum_i |x_i df_k/dx_i| by differences of the kernel */
static double size_of_terms(const check *c, uint32_t k) {
    return fabs(c->kernel_out[k]) + fabs(c->plain[k]) + way_of(c, k, nudge) / nudge;
}

/* the same with the size of made-up points for x_i, of whichever outputs have the largest terms:
 * they are made of one another's parts */
static double size_of_all_terms(const check *c) {
    const uint32_t groups = begin_moves(c), m = c->kernel->outputs;
    double size = 0.0;
    for (uint32_t k = 0; k < m; k++)
        if (isfinite(c->plain[k])) size = fmax(size, fabs(c->plain[k]));
    for (uint32_t group = 0; group < groups; group++) {
        double largest = 0.0;
        eval_moved(c, group, groups, nudge, 1);
        for (uint32_t k = 0; k < m; k++) {
            const double moved = fabs(c->moved[k] - c->kernel_out[k]);
            if (isfinite(moved)) largest = fmax(largest, moved);
        }
        size += largest / nudge;
    }
    return size;
}

/* the output where kernel and function differ, or -1. Entries are made of one another's parts:
 * what is round-off of the largest is none. */
static long mismatch(const check *c) {
    double largest = 0.0;
    for (uint32_t k = 0; k < c->kernel->outputs; k++)
        if (isfinite(c->plain[k])) largest = fmax(largest, fabs(c->plain[k]));
    for (uint32_t k = 0; k < c->kernel->outputs; k++) {
        const double a = c->kernel_out[k], b = c->plain[k], difference = fabs(a - b);
        if (!isfinite(a) || !isfinite(b)) continue;
        if (difference <= DBL_MIN) continue; /* smaller numbers have lost digits */
        if (difference <= 8 * DBL_EPSILON * largest) continue;
        if (difference <= tolerance * fmax(fabs(a), fabs(b))) continue;
        if (difference <= tolerance * size_of_terms(c, k)) continue;
        if (difference <= scattered * way_of(c, k, last_bits)) continue;
        if (difference > round_off * size_of_all_terms(c)) return (long)k;
    }
    return -1;
}

/* ---- messages ---- */

/* push "(q = ...)": the arguments as a call shows them */
static const char *push_point(lua_State *L, const check *c) {
    const double *x = c->x;
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    luaL_addchar(&b, '(');
    for (int k = 0; k < c->s->arguments; k++) {
        const int scalar = c->s->length[k] == DML_SCALAR_ARGUMENT;
        const int n = scalar ? 1 : c->s->length[k], shown = n > 6 ? 6 : n;
        if (k) luaL_addstring(&b, ", ");
        if (!scalar) luaL_addchar(&b, '{');
        for (int i = 0; i < shown; i++) {
            lua_pushfstring(L, i ? ", %f" : "%f", x[i]);
            luaL_addvalue(&b);
        }
        if (shown < n) luaL_addstring(&b, ", ...");
        if (!scalar) luaL_addchar(&b, '}');
        x += n;
    }
    luaL_addchar(&b, ')');
    luaL_pushresult(&b);
    return lua_tostring(L, -1);
}

/* the function on numbers, sums being given */
static void call_plain(lua_State *L, check *c, int fn) {
    if (c->given) c->given->calls = 0;
    dml_call_numbers(L, fn, c->s, c->x, c->plain, c->kernel->outputs);
}

/* `point`: the arguments as a call shows them. */
static void raise_difference(lua_State *L, const check *c, const char *what, double plain,
                             double traced, const char *point) {
    luaL_error(L,
               "%s is not what its trace says: %f when called, %f when traced, at %s. Likely "
               "causes: == or ~= between a number and an argument, a truth test, type() or "
               "tostring() of an argument (these see a symbol while tracing), random numbers, a "
               "global that changes, or a difference in which nearly all digits cancel "
               "(simplifying then changes the rest). Use dm.where(c, a, b), dm.abs or dm.max%s",
               what, plain, traced, point,
               c->s->may_branch ? ", or derivatives = \"hyperdual\"" : "");
}

/* The function is called once more: one that gives another value now is told apart. */
static void raise_mismatch(lua_State *L, check *c, long k) {
    const char *what = c->s->what, *point = push_point(L, c);
    const double plain = c->plain[k], traced = c->kernel_out[k];
    call_plain(L, c, c->fn);
    if (c->plain[k] != plain)
        luaL_error(L,
                   "%s gives different values for the same arguments: %f and then %f at %s; it "
                   "must not use random numbers or the time, nor change globals or upvalues",
                   what, plain, c->plain[k], point);
    raise_difference(L, c, what, plain, traced, point);
}

/* Only at the start, which the user gave. */
static void raise_not_finite(lua_State *L, const check *c) {
    for (uint32_t k = 0; k < c->kernel->outputs; k++) {
        const double a = c->plain[k], b = c->kernel_out[k], bad = isfinite(a) ? b : a;
        if (isfinite(bad) || (c->s->may_be_outside && !isfinite(a) && !isfinite(b))) continue;
        luaL_error(L,
                   "%s is %s at the start %s: is the start inside its domain (a logarithm, root or "
                   "quotient)?",
                   c->s->what, isnan(bad) ? "NaN" : "infinite", push_point(L, c));
    }
}

/* ---- the points ---- */

/* a term of a sum that is not what its trace says */
static void check_terms(lua_State *L, check *c) {
    const dml_given *g = c->given;
    if (!g || !g->differs) return;
    const char *what = lua_pushfstring(L, "the function of %s", g->what);
    const char *point = lua_pushfstring(L, "%s, term %I of %I", push_point(L, c),
                                        (lua_Integer)g->round + 1, (lua_Integer)g->rounds);
    raise_difference(L, c, what, g->plain, g->traced, point);
}

/* is output k the same when the function is called again? */
static int is_repeated(lua_State *L, check *c, int fn, long k) {
    const double before = c->plain[k];
    call_plain(L, c, fn);
    return c->plain[k] == before;
}

/* the largest fourth difference of values at equal distances, in units of what it is of random
 * ones of size 1; 0 where they are not finite */
static double scatter(const double *f) {
    double largest = 0.0;
    for (int i = 0; i + 4 < ROW; i++)
        largest = fmax(largest, fabs(f[i] - 4 * f[i + 1] + 6 * f[i + 2] - 4 * f[i + 3] + f[i + 4]));
    return isfinite(largest) ? largest / sqrt(70) : 0.0;
}

/* Is what output k differs by round-off of digits that cancel inside, as in a determinant near a
 * pole of the coordinates? Then the values scatter by it, on either road, where the arguments
 * move a little. The point itself, where == may hold, is not among these. `fn` is called; the
 * values at the point stay. */
static int is_scatter(lua_State *L, check *c, int fn, long k) {
    const size_t n = c->kernel->inputs;
    const double difference = fabs(c->plain[k] - c->kernel_out[k]);
    double plain[ROW], kernel[ROW];
    memcpy(c->kept, c->x, n * sizeof *c->x);
    for (int j = 0; j <= ROW; j++) { /* the last one is the point itself */
        for (size_t i = 0; i < n; i++)
            c->x[i] = c->kept[i] * (1 + (j < ROW ? (j - ROW / 2 + 0.5) * apart : 0));
        call_plain(L, c, fn);
        eval(c, c->kernel_out);
        if (j < ROW) plain[j] = c->plain[k], kernel[j] = c->kernel_out[k];
    }
    return difference <= scatters_more * fmax(scatter(plain), scatter(kernel));
}

/* protected: 1 the check, 2 the function, 3 the output that differs; is that scatter? */
static int scatters(lua_State *L) {
    check *c = lua_touserdata(L, 1);
    const long k = (long)lua_tointeger(L, 3);
    lua_pushboolean(L, !c->given && is_repeated(L, c, 2, k) && is_scatter(L, c, 2, k));
    return 1;
}

/* output k differs at the start: by scatter? The points beside it may be outside of the domain */
static int is_scatter_at(lua_State *L, check *c, long k) {
    lua_pushcfunction(L, scatters);
    lua_pushlightuserdata(L, c);
    lua_pushvalue(L, c->fn);
    lua_pushinteger(L, k);
    const int yes = dml_try(L, 3, 1) && lua_toboolean(L, -1);
    memcpy(c->x, c->kept,
           c->kernel->inputs * sizeof *c->x); /* where it was when terms were sized */
    lua_pop(L, 1);
    return yes;
}

/* At c->x; whatever is wrong there is raised. */
static void check_at(lua_State *L, check *c) {
    call_plain(L, c, c->fn);
    check_terms(L, c);
    eval(c, c->kernel_out);
    const long k = mismatch(c);
    if (k >= 0 && !is_scatter_at(L, c, k)) {
        call_plain(L, c, c->fn);
        eval(c, c->kernel_out);
        raise_mismatch(L, c, k);
    }
    raise_not_finite(L, c);
}

/* protected: 1 the check, 2 the function; returns nothing, or the output that differs */
static int compare(lua_State *L) {
    check *c = lua_touserdata(L, 1);
    call_plain(L, c, 2);
    eval(c, c->kernel_out);
    c->compared += isfinite(c->plain[0]) && isfinite(c->kernel_out[0]);
    long k = mismatch(c);
    if (k >= 0 && !c->given && is_repeated(L, c, 2, k) && is_scatter(L, c, 2, k)) k = -1;
    lua_pushinteger(L, k);
    return 1;
}

/* errors of the function at a made-up point are not the user's fault */
static void check_near(lua_State *L, check *c) {
    lua_pushcfunction(L, compare);
    lua_pushlightuserdata(L, c);
    lua_pushvalue(L, c->fn);
    const long k = dml_try(L, 2, 1) ? (long)lua_tointeger(L, -1) : -1;
    lua_pop(L, 1);
    check_terms(L, c);
    if (k >= 0) raise_mismatch(L, c, k);
}

/* Made-up points around the start, the same in every run; of a long function, whose plain call
 * takes time, as many as are compared with the start two points in all. */
static void check_around(lua_State *L, check *c, const double *at) {
    const size_t n = c->kernel->inputs;
    const int is_long = n > MANY || c->kernel->operations > LONG;
    const int enough = is_long ? (at ? 1 : 2) : POINTS * SCALES;
    uint64_t random = 0x9E3779B97F4A7C15u;
    for (int k = 0; k < POINTS * SCALES && c->compared < enough; k++) {
        for (size_t i = 0; i < n; i++) {
            const double centre = at ? at[i] : 0.0;
            c->x[i] = centre + scales[k % SCALES] * (1 + fabs(centre)) * next_random(&random);
        }
        check_near(L, c);
    }
}

/* one made-up point near `at` where there are numbers, else `at` itself; only the first inputs
 * are moved */
static void check_beside(lua_State *L, check *c, const double *at, size_t moved) {
    uint64_t random = 0x9E3779B97F4A7C15u;
    for (int k = 0; k < POINTS && c->compared == 0; k++) {
        for (size_t i = 0; i < moved; i++)
            c->x[i] = at[i] + scales[0] * (1 + fabs(at[i])) * next_random(&random);
        check_near(L, c);
    }
    memcpy(c->x, at, moved * sizeof *at);
    if (c->compared == 0) check_at(L, c);
}

enum { START, AROUND, BESIDE };

/* The stack is left as it was; sums are given where the kernel has inputs for them. */
static void check_points(lua_State *L, int fn, const dml_signature *s, const dm_kernel *kernel,
                         const double *at, int where, size_t moved) {
    const size_t n = kernel->inputs, m = kernel->outputs;
    const size_t inputs = dml_signature_inputs(s);
    /* of a kernel that takes sums, or of a comparison around this one */
    dml_given *given = dml_getstate(L)->given;
    const int top = lua_gettop(L);
    fn = lua_absindex(L, fn);
    luaL_checkstack(L, 12, NULL);
    dml_pushapart(L);
    double *block = lua_newuserdatauv(L, (2 * n + 3 * m + 1) * sizeof *block, 0);
    check c = {s,
               kernel,
               n > inputs ? given : NULL,
               fn,
               block,
               block + n,
               block + n + m,
               block + n + 2 * m,
               block + n + 3 * m,
               0};
    for (size_t i = 0; i < n; i++) c.x[i] = at ? at[i] : 0.0;
    if (given) given->values = c.given ? c.x + inputs : NULL;
    if (at && where != BESIDE) check_at(L, &c);
    if (where == AROUND) check_around(L, &c, at);
    if (where == BESIDE) check_beside(L, &c, at, moved);
    dml_cut(L, top);
}

void dml_trace_check(lua_State *L, int fn, const dml_signature *s, const dm_kernel *kernel,
                     const double *at) {
    check_points(L, fn, s, kernel, at, AROUND, 0);
}

void dml_trace_check_start(lua_State *L, int fn, const dml_signature *s, const dm_kernel *kernel,
                           const double *at) {
    check_points(L, fn, s, kernel, at, START, 0);
}

void dml_trace_check_beside(lua_State *L, int fn, const dml_signature *s, const dm_kernel *kernel,
                            const double *at, size_t moved) {
    check_points(L, fn, s, kernel, at, BESIDE, moved);
}
