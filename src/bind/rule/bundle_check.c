/* bundle_check.c - `bundle:check`: definition 2 and the limit of small h, at an element. */
#include "bind/rule/bind_bundle.h"

#include <math.h>
#include <string.h>

static const double DEGENERATE = 1e-9; /* of singular values that tend to 1 */

typedef struct {
    double minus, plus; /* smallest singular values of T d- and T d+ */
    double transversal; /* of both together, desingularized */
    double limit;       /* order at which that matrix tends to the identity */
    double largest;     /* h at which kernels meet; infinity: not found */
    double *zero;       /* [n] velocity of the element without extent at q */
    int has_zero;
} findings;

/* distance from the identity at h, h/2: the order between them */
static dm_status measure_limit(dm_bundle *b, const dm_element *e, double *order) {
    double least, coarse = 0.0, fine = 0.0;
    const double h = b->h;
    b->h = h / 32.0;
    dm_status status = dm_bundle_transversality(b, &least, &coarse, e);
    b->h = h / 64.0;
    if (status == DM_OK) status = dm_bundle_transversality(b, &least, &fine, e);
    b->h = h;
    *order = coarse > 1e-14 ? log2(coarse / fine) : INFINITY;
    return status;
}

/* The smallest singular values of T d- and T d+: above zero both are submersions. */
static dm_status measure_submersions(dm_bundle *b, findings *f, const dm_element *e, double *D) {
    const dm_status status = dm_bundle_tangents(b, D, e);
    if (status != DM_OK) return status;
    f->minus = dm_bundle_submersion(b, D);
    f->plus = dm_bundle_submersion(b, D + 2 * (size_t)b->n * b->n);
    return DM_OK;
}

/* All findings at one element; tangents of both ends, and the place where kernels meet, lie in
 * one userdata. */
static void measure(lua_State *L, dm_bundle *b, findings *f, const dm_element *e) {
    const uint32_t n = b->n;
    double *D = lua_newuserdatauv(L, (4 * (size_t)n * n + 2 * n) * sizeof *D, 0);
    const double *both[2] = {e->q, e->q};
    f->zero = D + 4 * (size_t)n * n;
    dml_bundle_raise(L, measure_submersions(b, f, e, D), "the segment");
    dml_bundle_raise(L, dm_bundle_transversality(b, &f->transversal, NULL, e), "the segment");
    dml_bundle_raise(L, measure_limit(b, e, &f->limit), "the segment");
    f->has_zero = dm_bundle_find(b, f->zero + n, f->zero, both, e->t) == DM_OK;
    f->largest = dm_bundle_largest_step(b, e);
    if (f->largest == 0.0) f->largest = INFINITY;
}

static int holds(const findings *f) {
    return f->minus > DEGENERATE && f->plus > DEGENERATE && f->transversal > DEGENERATE &&
           f->limit > 0.5 && f->has_zero;
}

static void set(lua_State *L, const char *key, double x) {
    lua_pushnumber(L, x);
    lua_setfield(L, -2, key);
}

/* Findings as fields of a result. */
static void push_table(lua_State *L, const dm_bundle *b, const findings *f) {
    lua_createtable(L, 0, 8);
    dml_setresult(L);
    lua_pushinteger(L, 2 * (lua_Integer)b->n);
    lua_setfield(L, -2, "dimension");
    set(L, "minus", f->minus);
    set(L, "plus", f->plus);
    set(L, "transversal", f->transversal);
    set(L, "limit", f->limit);
    set(L, "largest_h", f->largest);
    if (f->has_zero) {
        memcpy(dml_pushvector(L, b->n), f->zero, b->n * sizeof *f->zero);
        lua_setfield(L, -2, "zero");
    }
    lua_pushboolean(L, holds(f));
    lua_setfield(L, -2, "ok");
}

/* And as one sentence, for a person. */
static void push_sentence(lua_State *L, const dm_bundle *b, const findings *f) {
    const char *what = holds(f) ? "a discrete tangent bundle" : "NO discrete tangent bundle";
    if (isfinite(f->largest))
        lua_pushfstring(L,
                        "%s near this element at h = %f; the kernels of T d- and T d+ first meet "
                        "at h = %f",
                        what, b->h, f->largest);
    else
        lua_pushfstring(L,
                        "%s near this element at h = %f; the kernels of T d- and T d+ do not meet "
                        "up to h = %f",
                        what, b->h, 1000.0 * b->h);
}

int dml_bundle_check(lua_State *L) {
    static const char *const known[] = {"q", "v", "t", NULL};
    const dml_bundle *made = luaL_checkudata(L, 1, DML_BUNDLE);
    lua_settop(L, 2);
    luaL_checktype(L, 2, LUA_TTABLE);
    dml_options(L, 2, known);
    double *y = lua_newuserdatauv(L, 2 * (size_t)made->n * sizeof *y, 0);
    dml_numbers(L, 2, "q", y, made->n);
    dml_numbers(L, 2, "v", y + made->n, made->n);
    const dm_element e = {y, y + made->n, dml_number(L, 2, "t", 0.0)};
    dm_bundle *b = dml_pushbundle(L);
    findings f = {.has_zero = 0};
    measure(L, b, &f, &e);
    push_table(L, b, &f);
    push_sentence(L, b, &f);
    return 2;
}
