/* bind_fft.c - `dm.fft`, `dm.ifft`, and which library makes transforms. */
#include "bind/core/module.h"
#include "bind/value/array.h"
#include "bind/wave/bind_wave.h"

#include <stdio.h>

/* asked for once: the answer stays */
const dm_transforms *dml_transforms(void) {
    static const dm_transforms *table;
    char why[DML_WHY];
    if (table) return table;
    table = dml_module("fft", DM_TRANSFORMS_SYMBOL, "libfftw3-dev", why);
    if (table) return table;
    fprintf(stderr, "dmlua: %s; GSL makes the transforms until then, more slowly\n", why);
    return table = &dm_transforms_gsl;
}

/* so that sizes in bytes stay far from the largest number that counts them */
enum { LONGEST = 1 << 28 };

/* entries `stride` apart of the vector or table at arg */
static void read_part(lua_State *L, int arg, const char *name, double *out, uint32_t n) {
    double *numbers = lua_newuserdatauv(L, n * sizeof *numbers, 0);
    dml_vectorarg(L, arg, name, numbers, n);
    for (size_t i = 0; i < n; i++) out[2 * i] = numbers[i];
    lua_pop(L, 1);
}

/* x [, y] at 1, 2: the transform of x + i y as two vectors, times 1/n for `sign` = 1 */
static int transform(lua_State *L, int sign) {
    const dm_transforms *table = dml_transforms();
    dm_transform *made;
    lua_settop(L, 2);
    const long n = dml_length(L, 1);
    if (n < 1 || n > LONGEST || lua_isnumber(L, 1))
        luaL_argerror(L, 1, "a vector or table of numbers is needed, at least one");
    if (!lua_isnil(L, 2) && dml_length(L, 2) != n)
        luaL_argerror(L, 2, "as many numbers as in the first argument are needed");
    dm_arena *arena = dml_pusharena(L);
    double *in = dm_arena_take(arena, 2 * (size_t)n * sizeof *in);
    double *out = dm_arena_take(arena, 2 * (size_t)n * sizeof *out);
    if (!in || !out) return luaL_error(L, "not enough memory");
    for (long i = 0; i < n; i++) in[2 * i] = in[2 * i + 1] = 0.0;
    if (table->open(&made, (uint32_t)n, sign, 0, in, out, arena) != DM_OK)
        return luaL_error(L, "not enough memory");
    /* making a plan may have written to its arrays */
    for (long i = 0; i < n; i++) in[2 * i] = in[2 * i + 1] = 0.0;
    read_part(L, 1, "the real part", in, (uint32_t)n);
    if (!lua_isnil(L, 2)) read_part(L, 2, "the imaginary part", in + 1, (uint32_t)n);
    table->run(made, out, in);
    for (long i = 0; sign == DM_BACKWARD && i < 2 * n; i++) out[i] /= (double)n;
    dml_pushwave(L, out, (uint32_t)n);
    dm_arena_release(arena);
    return 2;
}

/* dm.fft(x, y) */
static int fft(lua_State *L) {
    return transform(L, DM_FORWARD);
}

/* dm.ifft(re, im) */
static int ifft(lua_State *L) {
    return transform(L, DM_BACKWARD);
}

static const dml_row functions[] = {
    {"fft", fft,
     "dm.fft(x [, y]) -> re, im\n"
     "The discrete Fourier transform of x + i y, n numbers each (y left out: 0), n >= 1: entry k + "
     "1 is sum_j (x_j + i y_j) exp(-2 pi i j k/n), j, k = 0 .. n - 1, as two dm.vectors. By FFTW, "
     "where dm/fft.so was built (libfftw3-dev), else by GSL, which takes n^2 operations for large "
     "prime factors of n. Raises on entries that are not finite and on vectors of two lengths."},
    {"ifft", ifft,
     "dm.ifft(re [, im]) -> x, y\n"
     "The inverse of dm.fft: sum_k (re_k + i im_k) exp(2 pi i j k/n)/n."},
    {NULL, NULL, NULL}};

const dml_class dml_class_fft = {.functions = functions};
