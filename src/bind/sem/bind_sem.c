/* bind_sem.c - discrete energies of single steps, from which lua/dm/sem says whether steps that
 * choose h can be made. */
#include "bind/run/stepping.h"
#include "integ/sem/sem.h"

#include <math.h>

/* energy v . L_v - L of the start */
static double energy_of(const dml_stepping *r) {
    const dm_kernel *kernel = &r->stepper.model->energy;
    double energy = NAN;
    dm_kernel_prepare(kernel, &energy);
    dm_kernel_eval(kernel, r->x, &energy);
    return energy;
}

/* E_d of every length in the vector h[count] of the stack at `at`, NaN where there is no step */
static void push_energies(lua_State *L, dml_stepping *r, const double *h, uint32_t count) {
    double *out = dml_pushvector(L, count);
    for (uint32_t i = 0; i < count; i++)
        if (dm_sem_energy(&r->stepper, r->state, h[i], out + i) != DM_OK) out[i] = NAN;
}

/* (solver, { q =, v = }, { h, ... }) -> energies, H */
static int sem_energies(lua_State *L) {
    static const char *const known[] = {"q", "v", "p", NULL};
    dml_stepping r = {.solver = luaL_checkudata(L, 1, DML_SOLVER)};
    lua_settop(L, 3);
    luaL_checktype(L, 2, LUA_TTABLE);
    dml_options(L, 2, known);
    if (!(r.solver->method->traits & DM_BY_ENERGY))
        luaL_error(L,
                   "solver:solvability is for rules that choose their steps by the energy, "
                   "sem(s, quadrature(r)); this one is '%s'",
                   r.solver->nodes[0].name);
    const long count = dml_length(L, 3);
    luaL_argcheck(L, count >= 1, 3, "must be a list of lengths");
    double *h = lua_newuserdatauv(L, (size_t)count * sizeof *h, 0);
    dml_vectorarg(L, 3, "h", h, (uint32_t)count);
    dml_stepping_prepare(L, &r, 0.0);
    dml_stepping_start(L, &r);
    push_energies(L, &r, h, (uint32_t)count);
    const double H = energy_of(&r);
    dml_stepping_end(&r);
    lua_pushnumber(L, H);
    return 2;
}

static const dml_row functions[] =
    {{"sem_energies", sem_energies,
      "core.sem_energies(solver, {q=, v= | p=}, {h, ...}) -> dm.vector, number\n"
      "The discrete energies E_d of single steps of these lengths from a state, NaN where a step "
      "cannot be made, and the energy H of the state. The solver has a sem rule."},
     {NULL, NULL, NULL}};

const dml_class dml_class_sem = {
    .functions = functions,
};
