/* bind_wave.c - `dm.wave_equation`: a Schroedinger equation in space, for lua/dm/wave. */
#include "bind/wave/bind_wave.h"
#include "bind/value/array.h"
#include "wave/wave_stepper.h"

#include <math.h>
#include <string.h>

/* by the numbers of dm_wave_space */
static const char *const spaces[] = {"collocation", "galerkin", "walls", NULL};

/* What stands behind a wave does not change once it is open. */
const dm_wave *dml_checkwave(lua_State *L, int arg) {
    return luaL_checkudata(L, arg, DML_WAVE);
}

/* Kernels leave nothing behind that is not in an arena, so that raising is safe. */
void dml_wavefail(lua_State *L, dm_status status) {
    if (status == DM_OK) return;
    if (status == DM_STOPPED) dml_checkstop(L);
    luaL_error(L, "%s", dm_status_text(status));
}

/* Two vectors become one array of pairs, as transforms want them. */
void dml_wavevalues(lua_State *L, int arg, double *psi, uint32_t n) {
    double *part = lua_newuserdatauv(L, n * sizeof *part, 0);
    for (int which = 0; which < 2; which++) {
        dml_vectorarg(L, arg + which, which ? "im" : "re", part, n);
        for (size_t j = 0; j < n; j++) psi[2 * j + (size_t)which] = part[j];
    }
    lua_pop(L, 1);
}

/* And back: scripts see parts, not pairs. */
void dml_pushwave(lua_State *L, const double *psi, uint32_t n) {
    for (size_t part = 0; part < 2; part++) {
        double *out = dml_pushvector(L, n);
        for (size_t j = 0; j < n; j++) out[j] = psi[2 * j + part];
    }
}

/* core.wave_points(space, from, to, n) */
static int points(lua_State *L) {
    const dm_wave_space space = (dm_wave_space)luaL_checkoption(L, 1, NULL, spaces);
    const double from = dml_checknumber(L, 2), to = dml_checknumber(L, 3);
    const lua_Integer n = dml_checkinteger(L, 4);
    luaL_argcheck(L, n >= 1 && n < (1 << 28), 4, "a number of points is needed");
    double *x = dml_pushvector(L, (uint32_t)n), *weight = dml_pushvector(L, (uint32_t)n);
    dm_wave_points(x, weight, space, from, to, (uint32_t)n);
    return 2;
}

/* core.wave_nodes(space, from, to, n [, values]) */
static int nodes(lua_State *L) {
    const dm_wave_space space = (dm_wave_space)luaL_checkoption(L, 1, NULL, spaces);
    const double from = dml_checknumber(L, 2), to = dml_checknumber(L, 3);
    const lua_Integer count = dml_checkinteger(L, 4);
    luaL_argcheck(L, count >= 1 && count < (1 << 28), 4, "a number of points is needed");
    const uint32_t n = (uint32_t)count;
    lua_settop(L, 5);
    double *x = dml_pushvector(L, n), *weight = dml_pushvector(L, n);
    dm_arena *arena = dml_pusharena(L);
    if (lua_isnil(L, 5)) {
        dml_wavefail(L, dm_wave_nodes(x, weight, space, from, to, n, arena, &dml_stop));
        lua_settop(L, 6);
        return 1;
    }
    double *given = lua_newuserdatauv(L, ((size_t)n + 2) * sizeof *given, 0);
    dml_vectorarg(L, 5, "values", given, n + 2);
    dml_wavefail(L, dm_walls_nodes(x, weight, n, arena, &dml_stop));
    dm_walls_interpolate(weight, x, n, given, n);
    lua_settop(L, 7);
    return 1;
}

/* core.wave(space, from, to, hbar, m, g, V, plan, wisdom) */
static int wave_new(lua_State *L) {
    const dm_transforms *table = NULL;
    lua_settop(L, 9);
    const int measure = lua_toboolean(L, 8);
    const char *wisdom = luaL_optstring(L, 9, NULL);
    dm_wave given = {.space = (dm_wave_space)luaL_checkoption(L, 1, NULL, spaces),
                     .from = dml_checknumber(L, 2),
                     .to = dml_checknumber(L, 3),
                     .hbar = dml_checknumber(L, 4),
                     .m = dml_checknumber(L, 5),
                     .g = dml_checknumber(L, 6)};
    const dml_array *V = dml_checkarray(L, 7, 1);
    given.n = dml_size(V);
    /* the class is set when all is there: an error on the way leaves a plain block */
    dm_wave *w = lua_newuserdatauv(L, sizeof *w, 1);
    dm_arena *arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, 1);
    double *copy = dm_arena_take(arena, given.n * sizeof *copy);
    if (!copy) return luaL_error(L, "not enough memory");
    dml_vectorarg(L, 7, "V", copy, given.n);
    given.V = copy;
    *w = given;
    if (w->space != DM_WALLS) table = dml_transforms();
    /* a file that is not there yet is no error: the plans made now begin it */
    if (table && wisdom && table->recall) table->recall(wisdom);
    const dm_status status = dm_wave_open(w, table, measure, arena, &dml_stop);
    dml_wavefail(L, status);
    if (table && wisdom && table->keep && !table->keep(wisdom))
        return luaL_error(L, "the wisdom of FFTW cannot be written to %s", wisdom);
    luaL_setmetatable(L, DML_WAVE);
    return 1;
}

/* ---- methods ---- */

/* n complex numbers, aligned, in an arena that is left on the stack */
static double *room(lua_State *L, uint32_t n) {
    double *out = dm_arena_take(dml_pusharena(L), 2 * (size_t)n * sizeof *out);
    if (!out) luaL_error(L, "not enough memory");
    return out;
}

/* w:energies(): of all modes, ascending; where there are too many, bounds of them */
static int energies(lua_State *L) {
    const dm_wave *w = dml_checkwave(L, 1);
    const double *rest;
    dm_modes modes;
    dml_wavefail(L, dm_wave_modes(&modes, &rest, w, dml_pusharena(L), &dml_stop));
    double *out = dml_pushvector(L, w->n);
    /* what modes do not have of V moves an energy by no more than its modulus */
    for (uint32_t k = 0; k < w->n; k++) {
        const double V = rest ? rest[k] : 0.0;
        out[k] = modes.energy[k];
        if (rest) out[k] += k % 2 ? fabs(V) : -fabs(V);
    }
    lua_pushboolean(L, rest == NULL);
    return 2;
}

/* psi_k as a row of values: real, its largest value positive */
static void push_mode(lua_State *L, const dm_wave *w, const double *q) {
    double *a = room(L, w->n), *psi = room(L, w->n), largest = 0.0;
    for (uint32_t j = 0; j < w->n; j++) a[2 * j] = q[j], a[2 * j + 1] = 0.0;
    dm_wave_values(psi, w, a);
    for (uint32_t j = 0; j < w->n; j++)
        if (fabs(psi[2 * j]) > 1.000001 * fabs(largest)) largest = psi[2 * j];
    double *out = dml_pushvector(L, w->n);
    for (uint32_t j = 0; j < w->n; j++) out[j] = largest < 0.0 ? -psi[2 * j] : psi[2 * j];
    /* the two arenas below the vector are not needed any more */
    lua_replace(L, -3);
    lua_pop(L, 1);
}

int dml_pushstates(lua_State *L, const dm_wave *w, const double *energy, const double *states,
                   uint32_t count) {
    memcpy(dml_pushvector(L, count), energy, count * sizeof *energy);
    lua_createtable(L, (int)count, 0);
    dml_setresult(L);
    for (uint32_t k = 0; k < count; k++) {
        push_mode(L, w, states + (size_t)k * w->n);
        lua_rawseti(L, -2, k + 1);
    }
    return 2;
}

/* w:eigen(k) */
static int eigen(lua_State *L) {
    const dm_wave *w = dml_checkwave(L, 1);
    const lua_Integer count = dml_checkinteger(L, 2);
    dm_modes modes;
    luaL_argcheck(L, count >= 1 && count <= w->n, 2, "as many states as unknowns there are");
    if (w->n > DM_DENSE_MODES) return luaL_error(L, "too many points for dense eigenvectors");
    dm_arena *arena = dml_pusharena(L);
    double *H = dm_arena_take(arena, (size_t)w->n * w->n * sizeof *H);
    if (!H) return luaL_error(L, "not enough memory");
    dm_wave_matrix(H, w, 1, 1);
    dml_wavefail(L, dm_modes_dense(&modes, H, w->n, arena, &dml_stop));
    return dml_pushstates(L, w, modes.energy, modes.Q, (uint32_t)count);
}

/* w:matrix() */
static int matrix(lua_State *L) {
    const dm_wave *w = dml_checkwave(L, 1);
    dm_wave_matrix(dml_pushmatrix(L, w->n, w->n), w, 1, 1);
    return 1;
}

/* w:slope(re, im) */
static int slope(lua_State *L) {
    const dm_wave *w = dml_checkwave(L, 1);
    lua_settop(L, 3);
    double *psi = room(L, w->n), *out = room(L, w->n);
    dml_wavevalues(L, 2, psi, w->n);
    dm_wave_slope(out, w, psi);
    dml_pushwave(L, out, w->n);
    return 2;
}

/* w:observe(re, im) */
static int observe(lua_State *L) {
    const dm_wave *w = dml_checkwave(L, 1);
    dm_wave_observed o;
    lua_settop(L, 3);
    double *psi = room(L, w->n), *a = room(L, w->n);
    dml_wavevalues(L, 2, psi, w->n);
    dm_wave_amplitudes(a, w, psi);
    dm_wave_observe(&o, w, a);
    lua_pushnumber(L, o.norm);
    lua_pushnumber(L, o.energy);
    lua_pushnumber(L, o.x);
    lua_pushnumber(L, o.momentum);
    return 4;
}

/* w.fft, w.n */
static int field(lua_State *L) {
    const dm_wave *w = dml_checkwave(L, 1);
    const char *key = luaL_checkstring(L, 2);
    const dm_transforms *table = w->kinetic.transforms;
    if (strcmp(key, "fft") == 0)
        lua_pushstring(L, table ? table->name : "none");
    else if (strcmp(key, "n") == 0)
        lua_pushinteger(L, w->n);
    else
        return 0;
    return 1;
}

/* ---- registration ---- */
static const dml_row methods[] =
    {{"energies", energies,
      "w:energies() -> dm.vector, exact\n"
      "The energies of all modes of H, without g; beyond 1200 unknowns bounds of them, exact = "
      "false."},
     {"eigen", eigen,
      "w:eigen(k) -> values, list of dm.vector\n"
      "The k least energies of H and values of real eigenfunctions of norm 1 at the points; up to "
      "1200 unknowns."},
     {"matrix", matrix,
      "w:matrix() -> dm.matrix\nH of the amplitudes sqrt(weight) psi, real symmetric, without g."},
     {"slope", slope, "w:slope(re, im) -> re, im\nThe derivative in x at the points."},
     {"observe", observe,
      "w:observe(re, im) -> norm, energy, x, momentum\n"
      "The integral of |psi|^2, the energy, and means of x and p."},
     {NULL, NULL, NULL}};

static const dml_row functions[] =
    {{"wave_points", points,
      "core.wave_points(space, from, to, n) -> x, weight\n"
      "The points of the unknowns and what integrals weigh them by; space: \"collocation\", "
      "\"galerkin\" (rings), \"walls\"."},
     {"wave_nodes", nodes,
      "core.wave_nodes(space, from, to, n [, values]) -> dm.vector\n"
      "The points at which V is wanted: between walls they are not those of psi. values: of a "
      "function at the n + 2 Chebyshev points between walls, which is interpolated to them."},
     {"wave", wave_new,
      "core.wave(space, from, to, hbar, m, g, V [, measure, wisdom]) -> dm.wave_equation\n"
      "i hbar psi_t = -hbar^2/2m psi_xx + (V + g |psi|^2) psi with V at core.wave_nodes; measure: "
      "plans "
      "of FFTW by timing, kept in the file `wisdom`."},
     {NULL, NULL, NULL}};

const dml_class dml_class_wave = {
    .name = DML_WAVE,
    .doc = "dm.wave_equation: the equation behind a dm.schroedinger\n"
           "fields: n (unknowns), fft (who makes transforms)",
    .methods = methods,
    .field = field,
    .functions = functions,
};
