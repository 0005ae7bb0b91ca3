/* bind_path.c - `dm.path`: the rows that a run recorded.
 */
#include "bind/run/checkpoint.h"
#include "bind/value/array.h"
#include "run/drift.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* The path at stack index 1, as of every method here. */
static dml_path *check(lua_State *L) {
    return luaL_checkudata(L, 1, DML_PATH);
}

/* What is refused is a path of `watch`, whose rows hold t and what was watched. */
dml_path *dml_path_states(lua_State *L, const char *what) {
    dml_path *p = check(L);
    if (p->watched)
        luaL_error(L,
                   "%s needs q and p, but this run recorded only what it watched: leave 'watch' "
                   "out, or watch it",
                   what);
    return p;
}

/* Bytes; half of it is the most that rows may take. */
static double memory_of_machine(void) {
    return (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
}

/* The rows stand behind the header in one block of Lua, so that nothing is left to free when a run
 * fails. */
dml_path *dml_pushpath(lua_State *L, int system, uint32_t n, long rows, uint32_t width) {
    static const double small = 1e6; /* bytes: no need to ask the system */
    const double bytes = (double)rows * width * sizeof(double);
    if (bytes > small && bytes > 0.5 * memory_of_machine()) {
        char size[48];
        snprintf(size, sizeof size, "%.6g rows needs %.3g GB", (double)rows, bytes * 1e-9);
        luaL_error(L,
                   "recording %s, more than half of this machine's memory: keep fewer with a "
                   "larger 'every', watch less, or write them to a file (file = \"rows.npy\")",
                   size);
    }
    const size_t doubles = (size_t)rows * width;
    dml_path *p = lua_newuserdatauv(L, sizeof *p + doubles * sizeof(double), DML_PATH_VALUES);
    const dml_system *s = dml_checksystem(L, system);
    *p = (dml_path){.n = n,
                    .momenta = s->momenta,
                    .placed = s->placed,
                    .width = width,
                    .until = INFINITY,
                    .every = 1,
                    .data = (double *)(p + 1)};
    luaL_setmetatable(L, DML_PATH);
    lua_pushvalue(L, system);
    lua_setiuservalue(L, -2, DML_PATH_SYSTEM);
    return p;
}

/* 1234567 -> 1,234,567 */
static void add_grouped(luaL_Buffer *b, long n) {
    char digits[32];
    const int length = snprintf(digits, sizeof digits, "%ld", n);
    for (int i = 0; i < length; i++) {
        if (i && (length - i) % 3 == 0) luaL_addchar(b, ',');
        luaL_addchar(b, digits[i]);
    }
}

/* ", no drift", ", drift 2e-9 per unit of time", or nothing where the rows leave it open; rows that
 * are sparser than the steps may show an oscillation as a slow one */
static void add_drift(luaL_Buffer *b, const dm_drift *d, dm_drift_verdict verdict, int sparse) {
    char text[128];
    if (verdict == DM_DRIFT_NONE) luaL_addstring(b, ", no drift");
    if (verdict != DM_DRIFT_FOUND) return;
    snprintf(text, sizeof text, ", %s %.2g per unit of time%s", sparse ? "slope" : "drift",
             d->slope, sparse ? " (a drift, or an oscillation faster than the rows)" : "");
    luaL_addstring(b, text);
}

/* ": energy off by 6.4e-05, no drift", with the drift, or from when on where it jumped, or a
 * question where it grows; how much it changes where the system does not keep it */
static void add_energy(luaL_Buffer *b, const double *E, const dml_path *p, int keeps) {
    char text[128];
    dm_drift d;
    for (long i = 0; i < p->rows; i++) {
        if (isfinite(E[i])) continue;
        luaL_addstring(b, ": energy beyond all bounds");
        return;
    }
    dm_drift_fit(&d, p->data, dml_path_width(p), E, p->rows);
    const int sparse = p->rows <= p->steps;
    const char *where = sparse ? " at these rows" : "";
    const long jump = dm_drift_jump(E, p->rows);
    const int is_seen = d.largest > 1e-10 * fabs(E[0]);
    if (!keeps) {
        snprintf(text, sizeof text, ": energy changes by up to %.2g%s", d.largest, where);
        luaL_addstring(b, text);
        return;
    }
    snprintf(text, sizeof text, ": energy off by %.2g%s", d.largest, where);
    luaL_addstring(b, text);
    if (is_seen && dm_drift_grows(E, p->rows)) {
        luaL_addstring(b, " and growing: is h beyond the limit of stability?");
        return;
    }
    if (jump && is_seen) {
        snprintf(text, sizeof text, " from t = %.4g on", p->data[(size_t)jump * dml_path_width(p)]);
        luaL_addstring(b, text);
        return;
    }
    const size_t width = dml_path_width(p);
    add_drift(b, &d, dm_drift_judge(&d, p->data, width, E, p->rows), sparse);
}

/* ": discrete energy off by 2e-16, h from 0.04 to 0.15, 2 of 60 steps without a root" */
static void add_sem(luaL_Buffer *b, const dm_energy_report *r) {
    char text[160];
    if (!r->steps) return;
    snprintf(text, sizeof text, "; discrete energy off by %.2g, h from %.4g to %.4g known to %.1g",
             r->defect, r->least, r->largest, r->conditioning);
    luaL_addstring(b, text);
    snprintf(text, sizeof text, ", %ld of %ld steps without a root", r->fallbacks, r->steps);
    if (r->fallbacks) luaL_addstring(b, text);
}

/* of a dm.multiscale: the condition of its equations, what its curves miss of the momentum at their
 * ends, what the energy moves by, and a question where that is much */
static void add_defect(luaL_Buffer *b, const dml_path *p) {
    char text[160];
    if (!(p->condition > 0.0)) return;
    snprintf(text, sizeof text,
             "; condition of a step %.2g, momentum at the ends of curves off by %.2g, energy by "
             "%.2g of the largest v . L_v",
             p->condition, p->defect, p->drift);
    luaL_addstring(b, text);
    if (p->defect > 0.5 || p->drift > 0.01)
        luaL_addstring(b, ": is the frequency right and the only fast one, and h times it no "
                          "multiple of pi?");
}

/* path.sem: what became of the energy that chose the steps */
static int push_sem(lua_State *L, const dm_energy_report *r) {
    const struct {
        const char *key;
        double value;
    } numbers[] = {{"energy", r->energy},
                   {"defect", r->defect},
                   {"least", r->least},
                   {"largest", r->largest},
                   {"conditioning", r->conditioning}};
    if (!r->steps) return 0;
    lua_createtable(L, 0, 6);
    dml_setresult(L);
    lua_pushinteger(L, r->fallbacks), lua_setfield(L, -2, "fallbacks");
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        lua_pushnumber(L, numbers[i].value), lua_setfield(L, -2, numbers[i].key);
    return 1;
}

/* energies of the path as a vector on the stack, NULL when it has none */
static const double *try_energy(lua_State *L, const dml_path *p) {
    lua_pushcfunction(L, dml_path_energy);
    lua_pushvalue(L, 1);
    if (p->rows < 3 || !dml_try(L, 1, 1)) return NULL;
    const dml_array *E = dml_toarray(L, -1, 1);
    return E && dml_size(E) == (uint32_t)p->rows ? dml_numbersof(E) : NULL;
}

/* The ending of a word that is counted. */
static const char *plural(long count) {
    return count == 1 ? "" : "s";
}

/* "; 100 rows, 2 columns q, 2 columns p", or what was watched, and where the rows are */
static void add_columns(lua_State *L, luaL_Buffer *b, const dml_path *p) {
    char text[128], aside[32] = "";
    const uint32_t beside = p->width - 1 - p->n - p->momenta;
    const char *rows = plural(p->rows), *more = plural(p->n);
    if (beside) snprintf(aside, sizeof aside, ", %u beside", beside);
    if (!p->watched)
        snprintf(text, sizeof text, "; %ld row%s, %u column%s q, %u column%s p%s", p->rows, rows,
                 p->n, more, p->momenta, plural(p->momenta), aside);
    else
        snprintf(text, sizeof text, "; %ld row%s of %u column%s that were watched", p->rows, rows,
                 p->width, plural(p->width));
    luaL_addstring(b, text);
    if (lua_getiuservalue(L, 1, DML_PATH_FILE) == LUA_TNIL) {
        lua_pop(L, 1);
        return;
    }
    lua_pushfstring(L, p->unfiled ? ", those before them in %s" : ", all of them in %s",
                    lua_tostring(L, -1));
    lua_remove(L, -2);
    luaL_addvalue(b);
}

/* (system) -> does the exact motion keep the energy: no time in L, no force? */
static int keeps_energy(lua_State *L) {
    if (dml_checksystem(L, 1)->hyperdual) return lua_pushboolean(L, 1), 1;
    const dm_model *m = &dml_pushmodel(L, 1)->model;
    lua_pushboolean(L,
                    (m->structure & DM_AUTONOMOUS) && !(m->constraints && m->constraints->forced));
    return 1;
}

/* 0 also where L fails by now */
static int try_keeps(lua_State *L, int system) {
    lua_pushcfunction(L, keeps_energy);
    lua_pushvalue(L, system);
    const int keeps = dml_try(L, 1, 1) && lua_toboolean(L, -1);
    lua_pop(L, 1);
    return keeps;
}

/* the last time, and the one that was asked for where no number of steps gives it */
static void add_end(luaL_Buffer *b, const dml_path *p) {
    char text[128];
    snprintf(text, sizeof text, " to t = %.6g", p->t);
    luaL_addstring(b, text);
    if (!isfinite(p->until) || p->t < p->until || p->t - p->until < 1e-6 * p->h) return;
    snprintf(text, sizeof text, " (h = %.6g does not divide the way to %.6g)", p->h, p->until);
    luaL_addstring(b, text);
}

/* rows that are fewer than somebody may think */
static void add_every(luaL_Buffer *b, const dml_path *p) {
    char text[128];
    if (p->every <= p->steps || p->every == 1) return;
    snprintf(text, sizeof text, " (every = %ld is more than the %ld step%s: start and end alone)",
             p->every, p->steps, plural(p->steps));
    luaL_addstring(b, text);
}

/* Equations of first order y' = f(y) are those of H = p . f(y) with p = 0: their H is 0 whatever
 * the rule does. */
static int is_of_first_order(const dml_path *p, const dml_system *s, const double *E) {
    double largest = 0.0;
    if (!s->hamiltonian || p->width < 1 + p->n + p->momenta) return 0;
    for (long i = 0; i < p->rows; i++) {
        const double *momenta = p->data + (size_t)i * dml_path_width(p) + 1 + p->n;
        largest = fmax(largest, fabs(E[i]));
        for (uint32_t k = 0; k < p->momenta; k++) largest = fmax(largest, fabs(momenta[k]));
    }
    return largest == 0.0;
}

/* One line: steps, rule, last time, what became of the energy, rows and columns. */
static int path_tostring(lua_State *L) {
    const dml_path *p = check(L);
    char text[128];
    luaL_Buffer b;
    lua_getiuservalue(L, 1, DML_PATH_SYSTEM);
    const int system = lua_gettop(L);
    const dml_system *s = dml_checksystem(L, system);
    const double *E = s->pair || s->stand_in ? NULL : try_energy(L, p);
    const int keeps = E && try_keeps(L, system);
    luaL_buffinit(L, &b);
    luaL_addstring(&b, "path of ");
    add_grouped(&b, p->steps);
    luaL_addstring(&b, p->steps == 1 ? " step of " : " steps of ");
    luaL_addstring(&b, p->rule);
    add_end(&b, p);
    snprintf(text, sizeof text, " (%.3g ns/step)", p->ns_per_step);
    if (p->ns_per_step > 0.0) luaL_addstring(&b, text);
    if (E && !is_of_first_order(p, s, E)) add_energy(&b, E, p, keeps);
    add_sem(&b, &p->sem);
    add_defect(&b, p);
    add_columns(L, &b, p);
    add_every(&b, p);
    luaL_pushresult(&b);
    return 1;
}

/* #path: rows that are kept, not steps. */
static int path_len(lua_State *L) {
    lua_pushinteger(L, check(L)->rows);
    return 1;
}

/* "name: rule, h = 0.1 s", for pictures: few digits, and the unit of time where it is known */
static void push_title(lua_State *L, const dml_path *p) {
    char h[32];
    lua_getiuservalue(L, 1, DML_PATH_SYSTEM);
    const int system = lua_gettop(L);
    dml_systemfield(L, system, "name");
    const char *name = lua_tostring(L, -1), *unit = NULL;
    if (dml_systemfield(L, system, "units") == LUA_TTABLE &&
        lua_getfield(L, -1, "t") == LUA_TSTRING)
        unit = lua_tostring(L, -1);
    snprintf(h, sizeof h, "%.4g", p->h);
    lua_pushfstring(L, "%s%s%s, h = %s%s%s", name ? name : "", name ? ": " : "", p->rule, h,
                    unit ? " " : "", unit ? unit : "");
}

/* path.lambda, path.impulses: columns that were recorded beside q and p */
static int recorded(lua_State *L, const char *key, const char *stem) {
    uint32_t first = 0;
    const uint32_t count = dml_path_group(L, stem, &first);
    if (!count)
        luaL_error(L,
                   "path.%s: this run did not record it; run it with record = { \"%s\" }, or take "
                   "path:multipliers(), those at its states",
                   key, key);
    return dml_path_columns(L, key, first, count);
}

/* path.q1, path.energy of a run that watched: what path:column gives, here a copy that cannot be
 * set, where no method has the name */
static int named_column(lua_State *L, const char *key) {
    const int top = lua_gettop(L);
    luaL_getmetafield(L, 1, "methods");
    const int is_method = lua_getfield(L, -1, key) != LUA_TNIL;
    lua_settop(L, top);
    if (is_method || !dml_path_has(L, key)) return 0;
    dml_path_column(L);
    dml_mark_copy(L);
    return 1;
}

/* Fields of the path at 1 by the key at 2; 0 results: a method is looked for. */
static int path_field(lua_State *L) {
    const dml_path *p = check(L);
    const char *key = luaL_checkstring(L, 2);
    if (strcmp(key, "lambda") == 0) return recorded(L, "lambda", "lambda");
    if (strcmp(key, "impulses") == 0) return recorded(L, "impulses", "impulse");
    if (strcmp(key, "t") == 0) return dml_path_columns(L, "t", 0, 1);
    if (strcmp(key, "q") == 0)
        return dml_path_states(L, "path.q"), dml_path_columns(L, "q", 1, p->n);
    if (strcmp(key, "p") == 0)
        return dml_path_states(L, "path.p"), dml_path_columns(L, "p", 1 + p->n, p->momenta);
    if (p->placed && strcmp(key, "mu") == 0)
        return dml_path_states(L, "path.mu"), dml_path_columns(L, "mu", 1 + p->n, p->momenta);
    if (p->placed && strcmp(key, "a") == 0 && !dml_path_has(L, key)) {
        lua_getiuservalue(L, 1, DML_PATH_END);
        dml_pushcarried(L, lua_touserdata(L, -1));
        return dml_mark_copy(L), 1;
    }
    if (strcmp(key, "columns") == 0)
        return dml_path_names(L), dml_lock(L, "the list of the columns of a path"), 1;
    if (strcmp(key, "steps") == 0)
        lua_pushinteger(L, p->steps);
    else if (strcmp(key, "h") == 0)
        lua_pushnumber(L, p->h);
    else if (strcmp(key, "ns_per_step") == 0)
        lua_pushnumber(L, p->ns_per_step);
    else if (strcmp(key, "rule") == 0)
        lua_pushstring(L, p->rule);
    else if (strcmp(key, "title") == 0)
        push_title(L, p);
    else if (strcmp(key, "system") == 0)
        lua_getiuservalue(L, 1, DML_PATH_SYSTEM);
    else if (strcmp(key, "solver") == 0)
        lua_getiuservalue(L, 1, DML_PATH_SOLVER);
    else if (strcmp(key, "events") == 0)
        lua_getiuservalue(L, 1, DML_PATH_EVENTS);
    else if (strcmp(key, "watched") == 0)
        lua_pushboolean(L, p->watched);
    else if (strcmp(key, "file") == 0)
        lua_getiuservalue(L, 1, DML_PATH_FILE);
    else if (strcmp(key, "sem") == 0)
        return push_sem(L, &p->sem);
    else if (strcmp(key, "units") == 0)
        lua_getiuservalue(L, 1, DML_PATH_SYSTEM), dml_systemfield(L, -1, "units");
    else
        return named_column(L, key);
    return 1;
}

static const dml_row meta[] = {{"__len", path_len, NULL},
                               {"__tostring", path_tostring, NULL},
                               {NULL, NULL, NULL}};

const dml_class dml_class_path = {
    .name = DML_PATH,
    .doc = "dm.path: what a run recorded, one row per kept step\n"
           "fields: t[i] (number), q[i], p[i] (vectors), lambda[i], impulses[i] (of runs that "
           "recorded them), a (the quantity that dm.euler_poincare carries along, at the start), "
           "columns (names), any column "
           "by its name (path.q1, path.p_x), steps, h, rule, system, solver, title, units, "
           "ns_per_step, events (of a run that looked for some), file (of a run that wrote its "
           "rows), sem (of sem rules: energy, fallbacks, defect, least, largest h, conditioning); "
           "#path rows.\n"
           "Printed, it says how far the energy was off at its rows (\"at these rows\" where not "
           "every step was kept), from when on where it jumped to another level, and whether it "
           "drifts: \"no drift\" within three standard errors, \"drift\" beyond six, nothing "
           "between or with fewer than 12 rows; \"slope\" where rows are sparser than steps, "
           "which may show a fast oscillation as a slow one. path:drift gives the numbers.",
    .meta = meta,
    .methods = dml_path_quantities,
    .field = path_field,
    .functions = dml_path_functions,
};
