/* root_entry.c - implicit functions of arguments of any kind: nodes for symbols, values for
 * numbers, two more Newton iterations for hyper-dual numbers. */
#include "bind/trace/bind_root.h"
#include "bind/value/array.h"
#include "bind/value/trace_log.h"
#include "code/tape/tape.h"

#include <math.h>
#include <string.h>

/* F as it was traced against a plain call of the equations at the same (y, x): 1e-8 of the size
 * of the terms, which
 * |F_y| |y| and |F| stand for */
int dml_rootdiffers(const dml_root_shape *s, const double *plain) {
    const dm_root_solver *solver = &s->solver;
    const uint32_t r = s->unknowns;
    memcpy(solver->in, s->y, r * sizeof *s->y);
    memcpy(solver->in + r, s->chosen, s->uses * sizeof *s->x);
    if (s->value.eval) {
        const double S = dml_rootvalue(s);
        return fabs(S - *plain) > 1e-8 * fmax(1.0, fmax(fabs(S), fabs(*plain)));
    }
    dm_kernel_eval(&solver->equation, solver->in, solver->out);
    for (uint32_t i = 0; i < r; i++) {
        double size = 1.0;
        for (uint32_t k = 0; k < r; k++)
            size += fabs(solver->out[r + i * (size_t)r + k]) * (1.0 + fabs(s->y[k]));
        if (!(fabs(plain[i] - solver->out[i]) <= 1e-8 * size)) return 1;
    }
    return 0;
}

double dml_rootvalue(const dml_root_shape *s) {
    double out = 0.0;
    memcpy(s->solver.in, s->y, s->unknowns * sizeof *s->y);
    memcpy(s->solver.in + s->unknowns, s->chosen, s->uses * sizeof *s->x);
    dm_kernel_prepare(&s->value, &out);
    dm_kernel_eval(&s->value, s->solver.in, &out);
    return out;
}

static dm_node entry_in(dm_graph *g, const dm_implicit *f, const dm_node *a, uint32_t m,
                        uint32_t k) {
    const dm_node leaf = dm_implicit_leaf(g, f);
    return dm_implicit_root(g, dm_implicit_with(g, leaf, a, m), k);
}

static dm_node *nodes_of(lua_State *L, dm_arena *arena, uint32_t m) {
    dm_node *nodes = dm_arena_take(arena, (m + (size_t)1) * sizeof *nodes);
    if (!nodes) luaL_error(L, "not enough memory");
    return nodes;
}

static dml_scalar of_symbols(lua_State *L, const dm_implicit *f, const dml_scalar *a, uint32_t m,
                             uint32_t k) {
    dml_frame *frame = NULL;
    dml_scalar like = {.kind = DML_NUMBER};
    for (uint32_t i = 0; i < m; i++) like = dml_common(L, &like, a + i);
    frame = dml_findframe(L, like.serial);
    if (!frame) luaL_error(L, "a symbol was used after its trace had ended");
    dm_node *nodes = nodes_of(L, frame->arena, m);
    for (uint32_t i = 0; i < m; i++) nodes[i] = dml_lift(L, a + i, &like).as.node;
    like.as.node = entry_in(dml_owngraph(L, frame), f, nodes, m, k);
    dml_checkgraph(L, frame);
    return like;
}

/* a graph of constants, evaluated */
static dml_scalar of_numbers(lua_State *L, const dm_implicit *f, const dml_scalar *a, uint32_t m,
                             uint32_t k) {
    dm_arena *arena = dml_pusharena(L);
    dm_kernel kernel;
    double out = NAN;
    dm_graph *g = dm_graph_new(arena, 0);
    if (!g) luaL_error(L, "not enough memory");
    dm_node *nodes = nodes_of(L, arena, m);
    for (uint32_t i = 0; i < m; i++) nodes[i] = dm_constant(g, a[i].as.number);
    const dm_node root = entry_in(g, f, nodes, m, k);
    if (dm_tape_build(&kernel, g, &root, 1, arena) != DM_OK) luaL_error(L, "not enough memory");
    dm_kernel_eval(&kernel, NULL, &out);
    const dm_implicit *troubled = dm_root_troubled(g);
    if (troubled) dml_raiseroot(L, troubled);
    lua_pop(L, 1);
    return (dml_scalar){.kind = DML_NUMBER, .as.number = out};
}

/* ---- hyper-dual numbers ---- */

static dml_scalar hyper(const dml_scalar *x) {
    if (x->kind == DML_HYPERDUAL) return *x;
    return (dml_scalar){.kind = DML_HYPERDUAL, .as.hyper = {.f = x->as.number}};
}

/* y -= J^-1 F(y, x): the parts along one direction are right after the first time, those along
 * both after the second */
static void correct(lua_State *L, const dm_implicit *f, const double *inverse, dml_scalar *in,
                    dml_scalar *F) {
    const uint32_t r = f->unknowns;
    dml_replay(L, f->graph, f->equation, r, in, F);
    for (uint32_t i = 0; i < r; i++)
        for (uint32_t k = 0; k < r; k++) {
            const double J = inverse[i * (size_t)r + k];
            const dml_scalar Fk = hyper(F + k);
            in[i].as.hyper.a -= J * Fk.as.hyper.a;
            in[i].as.hyper.b -= J * Fk.as.hyper.b;
            in[i].as.hyper.ab -= J * Fk.as.hyper.ab;
        }
}

void dml_roothyper(lua_State *L, const dm_implicit *f, dm_root_solver *solver, const dml_scalar *x,
                   dml_scalar *y) {
    const uint32_t r = f->unknowns, n = f->inputs, top = (uint32_t)lua_gettop(L);
    const size_t numbers = n + r + (size_t)r * r;
    double *real = lua_newuserdatauv(L, (numbers + 1) * sizeof *real, 0);
    double *root = real + n, *inverse = root + r;
    dml_scalar *in = lua_newuserdatauv(L, (4 * (size_t)r + n) * sizeof *in, 0);
    memset(in, 0, (4 * (size_t)r + n) * sizeof *in);
    for (uint32_t i = 0; i < n; i++) {
        in[r + i] = hyper(x + i);
        real[i] = in[r + i].as.hyper.f;
    }
    if (dm_root_solve(solver, real, root, inverse) != DM_ROOT_FOUND) dml_raiseroot(L, f);
    for (uint32_t i = 0; i < r; i++)
        in[i] = (dml_scalar){.kind = DML_HYPERDUAL, .as.hyper = {.f = root[i]}};
    for (int k = 0; k < 2; k++) correct(L, f, inverse, in, in + 3 * (size_t)r + n);
    memcpy(y, in, r * sizeof *y);
    lua_settop(L, (int)top);
}

/* y, or S at y; of a function that has no solver of its own at hand */
static dml_scalar of_hyperduals(lua_State *L, const dm_implicit *f, const dml_scalar *a, uint32_t m,
                                uint32_t k) {
    const uint32_t r = f->unknowns, n = f->inputs;
    const int top = lua_gettop(L);
    dm_root_solver solver;
    dml_scalar out;
    if (m > n)
        luaL_error(L,
                   "a derivative of %s is asked for on hyper-dual numbers, which go to second "
                   "order only: use a traced function",
                   f->name);
    dm_arena *arena = dml_pusharena(L);
    dml_scalar *in = lua_newuserdatauv(L, (n + 3 * (size_t)r) * sizeof *in, 0);
    memset(in, 0, (n + 3 * (size_t)r) * sizeof *in);
    if (dm_root_solver_build(&solver, f, dm_tape_build, dm_tape_build, arena, 1) != DM_OK)
        luaL_error(L, "not enough memory");
    memcpy(in + r, a, n * sizeof *a);
    dml_roothyper(L, f, &solver, a, in);
    out = in[k < r ? k : 0];
    if (k == r) dml_replay(L, f->graph, f->value, 1, in, &out);
    lua_settop(L, top);
    return out;
}

dml_scalar dml_rootentry(lua_State *L, const dm_implicit *f, const dml_scalar *a, uint32_t m,
                         uint32_t k) {
    dml_kind kind = DML_NUMBER;
    luaL_checkstack(L, 20, NULL);
    for (uint32_t i = 0; i < m; i++)
        if (a[i].kind != DML_NUMBER) kind = a[i].kind;
    if (kind == DML_SYMBOL) return of_symbols(L, f, a, m, k);
    return kind == DML_NUMBER ? of_numbers(L, f, a, m, k) : of_hyperduals(L, f, a, m, k);
}
