/* path_quantities.c - energy, velocity and drifts along a recorded path. */
#include "base/largest.h"
#include "bind/model/model_sums.h"
#include "bind/model/space_group.h"
#include "bind/run/bind_path.h"
#include "bind/run/checkpoint.h"
#include "bind/value/array.h"
#include "run/drift.h"

#include <math.h>
#include <string.h>

/* The path at stack index 1. */
static dml_path *check(lua_State *L) {
    return luaL_checkudata(L, 1, DML_PATH);
}

/* Kept by the path. */
dml_model *dml_path_kernels(lua_State *L, unsigned want) {
    lua_getiuservalue(L, 1, DML_PATH_MODEL);
    dml_model *m = dml_standin(L, -1, want);
    lua_getiuservalue(L, 1, DML_PATH_SYSTEM);
    const dml_system *s = dml_checksystem(L, -1);
    if (s->pair || s->stand_in)
        luaL_error(L, "a discrete Lagrangian alone has no energy and no velocity: make the path "
                      "from a dm.system, or compute them from path.q and path.p");
    lua_pop(L, 2);
    dml_want(L, m, want | dml_legendre_wants(m, want), NULL);
    return m;
}

/* On a group p has zeros behind it, which rows leave out. */
dm_status dml_path_row(const dml_path *p, const dml_model *m, long i, double *x, double *work) {
    const double *row = p->data + (size_t)i * dml_path_width(p);
    memcpy(x, row + 1, p->n * sizeof *x);
    x[2 * p->n] = row[0];
    double *full = work + dm_legendre_work(&m->model);
    memset(full, 0, p->n * sizeof *full);
    memcpy(full, row + 1 + p->n, p->momenta * sizeof *full);
    return dm_legendre_inverse(&m->model, x + p->n, row + 1, full, row[0], work);
}

double *dml_path_scratch(lua_State *L, const dml_path *p, const dml_model *m) {
    const size_t size = 3 * (size_t)p->n + 1 + dm_legendre_work(&m->model);
    double *x = lua_newuserdatauv(L, size * sizeof *x, 0);
    memset(x, 0, size * sizeof *x);
    if (p->rows) memcpy(x + p->n, p->data + 1 + p->n, p->momenta * sizeof *x);
    return x;
}

/* Raises with the number of the row, from 1. */
static void check_row(lua_State *L, dml_model *m, dm_status status, long i) {
    dml_rethrow(L, m);
    if (status != DM_OK)
        luaL_error(L, "row %d has no velocity: %s (is d2L/dv2 singular there?)", (int)i + 1,
                   dm_status_text(status));
}

/* of a run that watched: the column, if it is one */
static int watched_energy(lua_State *L) {
    const dml_path *p = check(L);
    lua_getiuservalue(L, 1, DML_PATH_NAMES);
    for (lua_Integer i = 1; i <= (lua_Integer)p->width; i++, lua_pop(L, 1)) {
        lua_rawgeti(L, -1, i);
        if (strcmp(lua_tostring(L, -1), "energy") != 0) continue;
        double *E = dml_pushvector(L, (uint32_t)p->rows);
        for (long k = 0; k < p->rows; k++) E[k] = p->data[(size_t)k * p->width + (size_t)i - 1];
        return 1;
    }
    return 0;
}

/* E = p . v - L at every row, v from p by the inverse Legendre transform. */
int dml_path_energy(lua_State *L) {
    if (check(L)->watched && watched_energy(L)) return 1;
    const dml_path *p = dml_path_states(L, "the energy");
    dml_model *m = dml_path_kernels(L, DM_WANT_ENERGY);
    double *x = dml_path_scratch(L, p, m), *work = x + 2 * p->n + 1;
    double *E = dml_pushvector(L, (uint32_t)p->rows);
    for (long i = 0; i < p->rows; i++) {
        check_row(L, m, dml_path_row(p, m, i, x, work), i);
        if (m->hamiltonian) /* of p, not of v */
            memcpy(x + p->n, work + dm_legendre_work(&m->model), p->n * sizeof *x);
        dm_kernel_prepare(&m->model.energy, E + i);
        dm_kernel_eval(&m->model.energy, x, E + i);
    }
    dml_rethrow(L, m);
    return 1;
}

/* largest of |y[i]|; NaN stays */
static double largest(double so_far, const double *y, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) so_far = dm_largest(so_far, y[i]);
    return so_far;
}

/* largest |g| or |phi| over the rows: the outputs that a kernel of the constraints begins with */
static double worst_of_rows(lua_State *L, const dml_path *p, int rolling) {
    dml_model *m = dml_path_kernels(L, rolling ? DM_WANT_ROLLING : DM_WANT_HOLONOMIC);
    const dm_constraints *t = m->model.constraints;
    const dm_kernel *kernel = rolling ? &t->rolling_kernel : &t->holonomic_kernel;
    double *x = dml_path_scratch(L, p, m), *work = x + 2 * p->n + 1, worst = 0.0;
    double *y = lua_newuserdatauv(L, kernel->outputs * sizeof *y, 0);
    dm_kernel_prepare(kernel, y);
    for (long i = 0; i < p->rows; i++) {
        check_row(L, m, dml_path_row(p, m, i, x, work), i);
        dm_kernel_eval(kernel, x, y);
        worst = largest(worst, y, rolling ? t->rolling : t->holonomic);
    }
    return worst;
}

/* The largest |g| or |phi| that the solver saw, at every step, not at rows alone. */
static int path_worst(lua_State *L) {
    const dml_path *p = dml_path_states(L, "the worst defect");
    const char *of = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
    const int rolling = !strcmp(of, "rolling");
    if (!rolling && strcmp(of, "constraint") != 0)
        luaL_error(L,
                   "path:worst takes \"constraint\" or \"rolling\" (got %s); path:drift has the "
                   "error of the energy or of a column",
                   *of ? of : luaL_typename(L, 2));
    lua_getiuservalue(L, 1, DML_PATH_MODEL);
    const dml_model *m = lua_touserdata(L, -1);
    if (!m->model.constraints || !(rolling ? m->constraints.rolling : m->constraints.holonomic))
        luaL_error(L, "the system of this path has no %s",
                   rolling ? "rolling constraint" : "constraint");
    const double seen = rolling ? p->rolling : p->constraint;
    lua_getiuservalue(L, 1, DML_PATH_SYSTEM);
    const dml_system *s = dml_checksystem(L, -1);
    if (s->pair || s->stand_in) /* their rules look in every step */
        return lua_pushnumber(L, seen), 1;
    lua_pushnumber(L, largest(seen, (double[]){worst_of_rows(L, p, rolling)}, 1));
    return 1;
}

/* of the row whose number is at stack index 2 */
static int velocity_of_row(lua_State *L, const dml_path *p, dml_model *m) {
    const lua_Integer i = dml_checkinteger(L, 2);
    if (i < 1 || i > p->rows)
        luaL_error(L, "path:velocity: there are rows 1 to %d (got %I)", (int)p->rows,
                   (LUAI_UACINT)i);
    double *x = dml_path_scratch(L, p, m), *v = dml_pushvector(L, p->momenta);
    check_row(L, m, dml_path_row(p, m, (long)i - 1, x, x + 2 * p->n + 1), (long)i - 1);
    memcpy(v, x + p->n, p->momenta * sizeof *v);
    return 1;
}

/* v of all rows as a matrix, or of the row at 2. */
static int path_velocity(lua_State *L) {
    const dml_path *p = dml_path_states(L, "the velocity");
    dml_model *m = dml_path_kernels(L, 0);
    if (m->model.structure & DM_LINEAR_IN_V)
        luaL_error(L, "L is linear in v: no momentum determines a velocity");
    if (!lua_isnoneornil(L, 2)) return velocity_of_row(L, p, m);
    double *x = dml_path_scratch(L, p, m), *work = x + 2 * p->n + 1;
    double *v = dml_pushmatrix(L, (uint32_t)p->rows, p->momenta);
    for (long i = 0; i < p->rows; i++) {
        check_row(L, m, dml_path_row(p, m, i, x, work), i);
        memcpy(v + (size_t)i * p->momenta, x + p->n, p->momenta * sizeof *v);
    }
    return 1;
}

/* q[n] of the argument at 2, on a group of an element */
static void position_argument(lua_State *L, const dml_path *p, double *q) {
    const int top = lua_gettop(L);
    lua_getiuservalue(L, 1, DML_PATH_SYSTEM);
    lua_newtable(L);
    lua_pushvalue(L, 2);
    lua_setfield(L, -2, "q");
    dml_place_options(L, top + 1, top + 2, "start");
    lua_getfield(L, top + 2, "q");
    dml_vectorarg(L, top + 3, "q", q, p->n);
    lua_settop(L, top);
}

/* d2L/dv2 at (q, 0, t): of systems whose mass does not depend on v. */
static int path_mass(lua_State *L) {
    const dml_path *p = dml_path_states(L, "the mass matrix");
    const double t = dml_optnumber(L, 3, p->t0);
    dml_model *m = dml_path_kernels(L, DM_WANT_MASS);
    if (m->hamiltonian) luaL_error(L, "this H has no Lagrangian, and hence no mass matrix");
    const dm_kernel *mass = &m->model.mass;
    double *x = dml_path_scratch(L, p, m), *y = lua_newuserdatauv(L, mass->outputs * sizeof *y, 0);
    position_argument(L, p, x);
    memset(x + p->n, 0, p->n * sizeof *x);
    x[2 * p->n] = t;
    dm_kernel_prepare(mass, y);
    dm_kernel_eval(mass, x, y);
    dml_rethrow(L, m);
    for (uint32_t i = p->n; i < mass->outputs; i++)
        if (!isfinite(y[i]))
            luaL_error(L, "the mass matrix is not finite at this q: is it inside the domain of L?");
    double *M = dml_pushmatrix(L, p->momenta, p->momenta);
    for (size_t i = 0; i < p->momenta; i++)
        memcpy(M + i * p->momenta, y + p->n + i * p->n, p->momenta * sizeof *y);
    return 1;
}

/* push a column that only paths of fields have; 0: this is none */
static int field_column(lua_State *L, const char *name) {
    const int top = lua_gettop(L);
    lua_getiuservalue(L, 1, DML_PATH_SYSTEM);
    if (dml_checksystem(L, -1)->field) {
        dml_systemfield(L, -1, "field");
        lua_getfield(L, -1, "column");
        lua_pushvalue(L, 1);
        lua_pushstring(L, name);
        lua_call(L, 2, 1);
        if (!lua_isnil(L, -1)) return 1;
    }
    lua_settop(L, top);
    return 0;
}

/* (path, name) -> vector */
int dml_path_column(lua_State *L) {
    const dml_path *p = check(L);
    const char *name = luaL_checkstring(L, 2);
    if (!p->watched && field_column(L, name)) return 1;
    if (!p->watched && strcmp(name, "energy") == 0) return dml_path_energy(L);
    lua_getiuservalue(L, 1, DML_PATH_SYSTEM);
    if (!p->watched && dml_place_column(L, -1, name)) return 1;
    const uint32_t c = dml_path_find(L, name);
    double *out = dml_pushvector(L, (uint32_t)p->rows);
    for (long i = 0; i < p->rows; i++) out[i] = p->data[(size_t)i * dml_path_width(p) + c];
    return 1;
}

/* A table of what a straight line through the numbers says. */
static void push_drift(lua_State *L, const dm_drift *d) {
    const struct {
        const char *key;
        double value;
    } fields[] = {{"per_time", d->slope},
                  {"error", d->error},
                  {"mean", d->mean},
                  {"largest", d->largest}};
    lua_createtable(L, 0, 4);
    dml_setresult(L);
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        lua_pushnumber(L, fields[i].value);
        lua_setfield(L, -2, fields[i].key);
    }
}

/* push the column, quantity or vector named by argument 2 as `rows` doubles */
static const double *quantity(lua_State *L, const dml_path *p) {
    double *y = lua_newuserdatauv(L, (size_t)p->rows * sizeof *y, 0);
    if (lua_type(L, 2) == LUA_TSTRING) {
        dml_path_column(L);
        lua_replace(L, 2);
    }
    if (dml_length(L, 2) != p->rows)
        luaL_error(L,
                   "a column name (\"energy\", \"q1\") or a vector of %d numbers (one a row) is "
                   "needed, for instance M:column(1) of a matrix (got %s)",
                   (int)p->rows, dml_kindname(L, 2));
    dml_vectorarg(L, 2, "quantity", y, (uint32_t)p->rows);
    return y;
}

/* (path, name or vector): per unit of time, with the standard error of the slope. */
static int path_drift(lua_State *L) {
    const dml_path *p = check(L);
    lua_settop(L, 2);
    if (p->rows < 3)
        return luaL_error(L, "a drift needs at least 3 recorded rows (this path has %d)",
                          (int)p->rows);
    const double *y = quantity(L, p);
    dm_drift drift;
    dm_drift_fit(&drift, p->data, dml_path_width(p), y, p->rows);
    push_drift(L, &drift);
    return 1;
}

/* dm.drift(t, y): of any two columns */
static int drift_of(lua_State *L) {
    dm_drift drift;
    const long rows = dml_length(L, 1);
    luaL_argcheck(L, rows >= 3, 1, "at least 3 times are needed");
    luaL_argcheck(L, dml_length(L, 2) == rows, 2, "one number for each time is needed");
    double *t = lua_newuserdatauv(L, 2 * (size_t)rows * sizeof *t, 0), *y = t + rows;
    dml_vectorarg(L, 1, "t", t, (uint32_t)rows);
    dml_vectorarg(L, 2, "y", y, (uint32_t)rows);
    dm_drift_fit(&drift, t, 1, y, rows);
    push_drift(L, &drift);
    return 1;
}

const dml_row dml_path_functions[] =
    {{"path", dml_path_new,
      "dm.path{system=, h=, rule=, steps=, columns = {t, q1, ..., p1, ...}} -> dm.path\n"
      "A path from numbers that were computed elsewhere: 1 + 2 dim Q columns of one number a row, "
      "growing times first; h: the step, rule: what made it (a text), steps: how many (default: "
      "rows - 1). It has energy, drift, plots and files like that of a run."},
     {"drift", drift_of,
      "dm.drift(t, y) -> {per_time, error, mean, largest}\n"
      "What path:drift finds, for numbers y at growing times t (vectors of at least 3 entries)."},
     {NULL, NULL, NULL}};

const dml_row dml_path_quantities[] =
    {{"worst", path_worst,
      "path:worst(\"constraint\" | \"rolling\") -> number\n"
      "The largest |g(q, t)| or |phi(q, v, t)| at the rows (v from the momentum) and, where the "
      "rule looks at it in every step, over all of its steps."},
     {"column", dml_path_column,
      "path:column(name) -> dm.vector of #path entries\n"
      "A column by its name (see path.columns; \"time\" and \"energy\" too)."},
     {"energy", dml_path_energy,
      "path:energy() -> dm.vector of #path entries\n"
      "v . dL/dv - L at every row, v from p by the inverse Legendre transform."},
     {"velocity", path_velocity,
      "path:velocity([row]) -> dm.matrix, #path x dim Q, or dm.vector of one row\n"
      "The velocity at every row, or at that one, from p by the inverse Legendre transform."},
     {"mass", path_mass,
      "path:mass(q [, t]) -> dm.matrix, dim Q x dim Q\n"
      "d2L/dv2 at (q, v = 0, t) by the kernels of the run, where system:mass traces L again; t: "
      "default that of the first row. Raises where it is not finite."},
     {"momentum", dml_path_momentum,
      "path:momentum(group [, {block=, side=, action=}]) -> dm.vector   or   (generator) -> "
      "dm.vector\n"
      "Noether's momentum map at every row: of a group by its standard action on blocks of "
      "coordinates (dm.SO(2), dm.SO(3), dm.R(n); a matrix #path x dim G when dim G > 1), or p . "
      "xi(q) of a generator xi(q), a Lua function that returns dim Q numbers. Of coordinates that "
      "are angles (dm.T), or whose kinetic energy is another where they are turned (r and phi), "
      "groups that act on vectors are refused. On a group G, of G itself the "
      "spatial momentum ({ side = \"right\" }: the body momentum), of SO(3), SO(2) and "
      "R(n) that of rotations and translations of space, of any group that of its action on "
      "elements, { action = function(k, g) ... end }; a generator returns the body velocity of its "
      "field."},
     {"drift", path_drift,
      "path:drift(name | vector) -> {per_time, error, mean, largest}\n"
      "Least squares slope of a column, of \"energy\" or of any vector of #path entries against "
      "time: slope per unit of time, its standard error from block means, the mean, and the "
      "largest distance from the first row."},
     {"checkpoint", dml_path_checkpoint,
      "path:checkpoint(file) -> file name\n"
      "Write where the run ended: the state with its low-order parts, what the rule keeps from "
      "step to step, rule, step and time, as a text with all bits. dm.resume(file, system) goes on "
      "from it bit for bit. Raises when the file cannot be written; an old one is replaced only by "
      "a whole one."},
     {NULL, NULL, NULL}};
