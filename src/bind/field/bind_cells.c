/* bind_cells.c - sums over the cells of a mesh. While a Lagrangian is traced the term is called
 * once, with symbols of its own for what it asks of a cell, and the sum stays a loop
 * (algebra/body_sum.h). While the trace is compared with the function some cells are. Lua
 * (dm.dec.fields) says what a cell has; here is what a column of the loop is. */
#include "bind/dec/bind_mesh.h"
#include "bind/model/bind_system.h"
#include "bind/trace/apart.h"
#include "bind/trace/given.h"
#include "bind/trace/traced_call.h"
#include "bind/value/array.h"
#include "bind/value/trace_log.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

#define TABLE "dm.cell_table"

/* the graph's inputs that a column reads, by name, or the virtual displacement of an entry of q; a
 * vector is data */
enum { OF_Q = 1, OF_V = 2, VARIED = 3 };

enum { KINDS = 8 };
enum { DATA = 16 }; /* vectors of data in one sum that may change: others are copied again */

/* one call of core.cell_sum */
typedef struct {
    uint32_t cells, n; /* n: entries of q, and of v */
    dml_frame *outer;  /* the trace that the sum is of; NULL: numbers */
    dm_column *column; /* [DM_SUM_COLUMNS] */
    uint32_t columns;
    const double *q, *v; /* numbers: the arguments */
    double *in;          /* numbers: what the columns were in this round */
    uint32_t round;
    const void *copied[DATA]; /* vectors whose numbers the arena of the trace has a copy of */
    const double *copy[DATA];
    uint32_t copies;
} request;

/* ---- tables of faces ---- */

/* core.cell_faces(mesh, k, set): bit j of set is vertex j of a cell of degree k */
static int cell_faces(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), count = m->K.count[k];
    const uint32_t set = (uint32_t)dml_checkinteger(L, 3);
    luaL_argcheck(L, set > 0 && set < 2u << k, 3, "a set of vertices of a cell expected");
    uint32_t *face = lua_newuserdatauv(L, (size_t)count * sizeof *face + 1, 1);
    for (uint32_t i = 0; i < count; i++) face[i] = dm_complex_face(&m->K, k, i, set);
    luaL_setmetatable(L, TABLE);
    return 1;
}

/* core.cell_list(vector): numbers of cells, from 1 */
static int cell_list(lua_State *L) {
    const long n = dml_length(L, 1);
    const dml_array *a = dml_toarray(L, 1, 1);
    luaL_argcheck(L, a && dml_kindof(a).kind == DML_NUMBER, 1, "a vector of numbers expected");
    uint32_t *cell = lua_newuserdatauv(L, (size_t)n * sizeof *cell + 1, 1);
    for (long i = 0; i < n; i++) cell[i] = (uint32_t)dml_get(a, (uint32_t)i).as.number - 1;
    luaL_setmetatable(L, TABLE);
    return 1;
}

/* the number of the face of cell i, both from 1 */
static int table_index(lua_State *L) {
    const uint32_t *face = luaL_checkudata(L, 1, TABLE);
    const lua_Integer i = dml_checkinteger(L, 2);
    if (i < 1 || (size_t)i > lua_rawlen(L, 1) / sizeof *face) return 0;
    lua_pushinteger(L, (lua_Integer)face[i - 1] + 1);
    return 1;
}

/* core.is_symbol(x) */
static int is_symbol(lua_State *L) {
    dml_scalar x;
    lua_pushboolean(L, dml_toscalar(L, 1, &x) && x.kind != DML_NUMBER);
    return 1;
}

/* core.entries(matrix): row by row */
static int entries(lua_State *L) {
    const dml_array *a = dml_checkarray(L, 1, 2);
    double *out = dml_pushvector(L, dml_size(a));
    for (uint32_t i = 0; i < dml_size(a); i++) out[i] = dml_get(a, i).as.number;
    return 1;
}

/* core.marks(vector): one byte an entry */
static int marks_new(lua_State *L) {
    const long n = dml_length(L, 1);
    luaL_argcheck(L, n >= 0, 1, "a vector expected");
    uint8_t *mark = lua_newuserdatauv(L, (size_t)n + 1, 0);
    const dml_array *a = dml_toarray(L, 1, 1);
    luaL_argcheck(L, a && dml_kindof(a).kind == DML_NUMBER, 1, "a vector of numbers expected");
    for (long i = 0; i < n; i++) mark[i] = (uint8_t)dml_get(a, (uint32_t)i).as.number;
    return 1;
}

/* ---- columns ---- */

/* a new input of the term */
static dm_node new_input(lua_State *L, request *r, const dm_column *c, dm_graph *term) {
    if (r->columns == DM_SUM_COLUMNS)
        luaL_error(L, "the function of K:sum reads more than %d numbers of a cell", DM_SUM_COLUMNS);
    r->column[r->columns] = *c;
    return dm_input(term, r->columns++);
}

/* the column of input `input` of the outer graph, the same in all rounds */
static dm_node scalar_input(lua_State *L, request *r, dm_graph *term, uint32_t input) {
    for (uint32_t c = 0; c < r->columns; c++) {
        const dm_column *k = r->column + c;
        if (!k->data && !k->index && !k->step && k->first == input) return dm_input(term, c);
    }
    return new_input(L, r, &(dm_column){.first = input}, term);
}

/* Node `node` of the outer graph, a scalar such as t, inside of the term: its own inputs become
 * columns. Operands have smaller numbers than their users; inside[node + 1], 0: not yet. */
static dm_node carry(lua_State *L, request *r, const dm_graph *from, dm_graph *term, dm_node node,
                     dm_node *inside) {
    const dm_expr e = *dm_graph_at(from, node);
    dm_node arg[3] = {0, 0, 0};
    if (inside[node] || node == 0) return inside[node];
    if (e.op == DM_OP_INPUT && e.as.input >= dm_sum_first(from))
        luaL_error(L, "a sum over cells stands inside of the function of another one: make it "
                      "outside of sums");
    if (e.op == DM_OP_IMPLICIT)
        luaL_error(L, "an implicit function is not known inside of a sum over cells");
    for (int k = 0; k < dm_op_operands(e.op); k++)
        arg[k] = carry(L, r, from, term, e.as.arg[k], inside);
    if (e.op == DM_OP_INPUT)
        inside[node] = scalar_input(L, r, term, e.as.input);
    else if (e.op == DM_OP_CONSTANT)
        inside[node] = dm_constant(term, e.as.value);
    else
        inside[node] = dm_apply(term, e.op, arg[0], arg[1], arg[2]);
    return inside[node];
}

/* dml_frame.capture of the trace of a term */
static dm_node capture(lua_State *L, dml_frame *f, uint32_t serial, dm_node node) {
    request *r = f->request;
    if (!r->outer || serial != r->outer->serial)
        luaL_error(L, "symbols of two traces meet in the function of a sum over cells");
    dm_node *inside = dm_arena_take(f->arena, (node + 1) * sizeof *inside);
    if (!inside) luaL_error(L, "not enough memory");
    memset(inside, 0, (node + 1) * sizeof *inside);
    return carry(L, r, r->outer->graph, f->own, node, inside);
}

/* a copy of the numbers of a vector, which may change, in the arena of the trace */
static const double *copy_of(lua_State *L, request *r, const dml_array *a) {
    for (uint32_t i = 0; i < r->copies; i++)
        if (r->copied[i] == a) return r->copy[i];
    double *copy = dm_arena_take(r->outer->arena, (a->rows + 1) * sizeof *copy);
    if (!copy) luaL_error(L, "not enough memory");
    memcpy(copy, dml_numbersof(a), a->rows * sizeof *copy);
    if (r->copies < DATA) {
        r->copied[r->copies] = a;
        r->copy[r->copies++] = copy;
    }
    return copy;
}

/* column(source, first, step, table, stays): what a cell has at entry first + step * face of q
 * (source 1), v (2) or a vector; without a table the face is the cell; stays: the vector is kept
 * and never changes. A symbol in a trace, a number while it is compared. */
static int column(lua_State *L) {
    request *r = lua_touserdata(L, lua_upvalueindex(1));
    const dml_array *a = lua_isinteger(L, 1) ? NULL : dml_toarray(L, 1, 1);
    const int source = a ? 0 : (int)dml_checkinteger(L, 1);
    dm_column c = {.first = (uint32_t)dml_checkinteger(L, 2),
                   .step = (uint32_t)dml_checkinteger(L, 3)};
    if (!lua_isnoneornil(L, 4)) c.index = luaL_checkudata(L, 4, TABLE);
    if (a) c.data = r->outer && !lua_toboolean(L, 5) ? copy_of(L, r, a) : dml_numbersof(a);
    c.varied = source == VARIED;
    if (r->outer) {
        if (source == OF_V) c.first += r->n;
        dml_frame *f = dml_getstate(L)->frames;
        dml_scalar x = {.kind = DML_SYMBOL, .serial = f->serial};
        x.as.node = new_input(L, r, &c, f->own);
        dml_pushscalar(L, &x);
        return 1;
    }
    const double *from = a ? c.data : source == OF_Q ? r->q : r->v;
    if (r->columns == DM_SUM_COLUMNS)
        luaL_error(L, "the function of K:sum reads more than %d numbers of a cell", DM_SUM_COLUMNS);
    const size_t face = c.index ? c.index[r->round] : r->round;
    lua_pushnumber(L, r->in[r->columns++] = from[c.first + c.step * face]);
    return 1;
}

/* the entries of a vector of numbers at arg, kept by it */
static const double *entries_at(lua_State *L, int arg) {
    const dml_array *a = dml_toarray(L, arg, 1);
    luaL_argcheck(L, a && dml_kindof(a).kind == DML_NUMBER, arg, "a vector of numbers expected");
    return dml_numbersof(a);
}

/* ---- sums of a trace ---- */

/* the term of upvalue 1 with the columns of upvalue 2 */
static int call_term(lua_State *L) {
    lua_settop(L, 0);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_pushvalue(L, lua_upvalueindex(2));
    dml_callone(L, 1, "the function of a sum over cells");
    return 1;
}

/* push the term as a function without arguments, or of nil */
static void push_term(lua_State *L, int fn, request *r) {
    lua_pushvalue(L, fn);
    lua_pushlightuserdata(L, r);
    lua_pushcclosure(L, column, 1);
    lua_pushcclosure(L, call_term, 2);
}

/* the sum as a leaf of the outer graph */
static int trace_sum(lua_State *L, request *r, dm_sum *s, int fn) {
    dml_frame *frame = r->outer;
    dml_traced traced;
    const dml_signature sig = {.what = "the function of a sum over cells",
                               .arguments = 1,
                               .length = {DM_SUM_COLUMNS},
                               .outputs = DML_SCALAR_ARGUMENT,
                               .lazy = 1,
                               .capture = capture,
                               .request = r};
    r->column = dm_arena_take(frame->arena, DM_SUM_COLUMNS * sizeof *r->column);
    if (!r->column) return luaL_error(L, "not enough memory");
    dm_graph *own = dml_owngraph(L, frame);
    push_term(L, fn, r);
    dml_trace(L, -1, &sig, frame->arena, &traced);
    lua_pop(L, 1);
    s->term = traced.graph;
    s->value = traced.out[0];
    s->column = r->column;
    s->columns = r->columns;
    dml_scalar x = {.kind = DML_SYMBOL, .serial = frame->serial};
    x.as.node = dm_sum_leaf(own, s);
    dml_checkgraph(L, frame);
    dml_pushscalar(L, &x);
    return 1;
}

/* ---- on numbers ---- */

/* the term on cell `round`, from 0 */
static double call_on(lua_State *L, request *r, int fn, uint32_t round) {
    r->round = round;
    r->columns = 0;
    push_term(L, fn, r);
    lua_call(L, 0, 1);
    if (lua_type(L, -1) != LUA_TNUMBER)
        luaL_error(L, "the function of a sum over cells must return a number, got %s",
                   luaL_typename(L, -1));
    const double x = lua_tonumber(L, -1);
    lua_pop(L, 1);
    return x;
}

/* all cells, with compensation */
static int sum_numbers(lua_State *L, request *r, int fn) {
    double sum = 0.0, low = 0.0;
    for (uint32_t i = 0; i < r->cells; i++) dm_sum_add(&sum, &low, call_on(L, r, fn, i));
    lua_pushnumber(L, sum + low);
    return 1;
}

/* the sum that this call became in the trace, or NULL; newer ones are made of it */
static const dm_sum *find_given(const dml_given *given, uint32_t cells) {
    const dm_sum *found = NULL;
    for (const dm_sum *s = dm_sums(given->graph); s; s = s->next)
        if (s->call == given->calls) found = s;
    return found && found->cells && found->bodies == cells ? found : NULL;
}

/* one cell, plain and as it was traced; x: the inputs of the trace */
static void compare_cell(lua_State *L, request *r, dml_given *given, const dm_sum *s,
                         const double *x, int fn, uint32_t round) {
    double in[DM_SUM_COLUMNS] = {0};
    const double a = call_on(L, r, fn, round);
    for (uint32_t c = 0, own = 0; c < s->columns; c++) {
        const dm_column *k = s->column + c;
        const int captured = !k->data && !k->index && !k->step && k->first >= 2 * r->n;
        in[c] = captured ? x[k->first] : r->in[own++];
    }
    double *work = lua_newuserdatauv(L, (s->value + 1) * sizeof *work, 0);
    const double traced = dm_sum_term(s, in, work);
    lua_pop(L, 1);
    dml_given_compare(given, "K:sum", round, r->cells, a, traced);
}

/* the first cells with each of a few different numbers in a column of data */
static void compare_kinds(lua_State *L, request *r, dml_given *given, const dm_sum *s,
                          const double *x, int fn, const dm_column *c) {
    double seen[KINDS];
    uint32_t kinds = 0;
    for (uint32_t i = 0; i < r->cells && kinds < KINDS; i++) {
        const double y = c->data[c->first + (size_t)c->step * (c->index ? c->index[i] : i)];
        uint32_t k = 0;
        while (k < kinds && seen[k] != y) k++;
        if (k < kinds) continue;
        seen[kinds++] = y;
        compare_cell(L, r, given, s, x, fn, i);
    }
}

/* the number that stands in the comparison */
static int give(lua_State *L, request *r, dml_given *given, const dm_sum *s, int fn) {
    const double *values = given->values;
    given->values = NULL;
    const double *x = values - dm_sum_first(given->graph);
    const uint32_t stride = dml_given_stride(given, r->cells);
    for (uint32_t i = 0; i + 1 < r->cells; i += stride) compare_cell(L, r, given, s, x, fn, i);
    compare_cell(L, r, given, s, x, fn, r->cells - 1);
    for (uint32_t c = 0; stride > 1 && stride < r->cells && c < s->columns; c++)
        if (s->column[c].data) compare_kinds(L, r, given, s, x, fn, s->column + c);
    given->values = values;
    lua_pushnumber(L, values[s->input - dm_sum_first(given->graph)]);
    return 1;
}

/* core.cell_sum(cells, n, f, held, q, v, sphere, work) */
static int cell_sum(lua_State *L) {
    dml_state *state = dml_getstate(L);
    double in[DM_SUM_COLUMNS];
    request r = {.cells = (uint32_t)dml_checkinteger(L, 1),
                 .n = (uint32_t)dml_checkinteger(L, 2),
                 .in = in};
    const int fn = 3;
    luaL_checktype(L, fn, LUA_TFUNCTION);
    lua_settop(L, 8);
    dm_sum s = {.bodies = r.cells,
                .cells = 1,
                .coordinates = r.n,
                .work = lua_toboolean(L, 8),
                .sphere = (uint32_t)dml_optinteger(L, 7, 0)};
    if (!lua_isnil(L, 4)) s.held = lua_touserdata(L, 4);
    luaL_checkstack(L, 20, NULL);
    if (!lua_isnil(L, 5)) {
        dml_given *given = dml_sumsgiven(state);
        r.q = entries_at(L, 5);
        if (!lua_isnil(L, 6)) r.v = entries_at(L, 6);
        const dm_sum *summed = given ? find_given(given, r.cells) : NULL;
        if (given) given->calls++;
        return summed ? give(L, &r, given, summed, fn) : sum_numbers(L, &r, fn);
    }
    dml_leavedead(state);
    r.outer = state->frames;
    if (r.outer && r.outer->capture)
        return luaL_error(L, "a sum over cells stands inside of the function of another one: make "
                             "it outside");
    if (!r.outer || !r.outer->keeps_sums)
        return luaL_error(L, "no Lagrangian that keeps sums over cells is being traced");
    s.call = r.outer->sums++;
    return trace_sum(L, &r, &s, fn);
}

static const dml_row functions[] = {
    {"cell_faces", cell_faces,
     "core.cell_faces(mesh, k, set) -> table\n"
     "The face with the vertices `set` (bit j: vertex j) of every cell of degree k."},
    {"is_symbol", is_symbol,
     "core.is_symbol(x) -> boolean\nIs x a scalar of a trace, or a hyper-dual number?"},
    {"entries", entries, "core.entries(matrix) -> dm.vector\nIts entries, row by row."},
    {"marks", marks_new,
     "core.marks(vector) -> userdata\nA byte an entry: 1 for one that is held, 2 for one without "
     "mass."},
    {"cell_sum", cell_sum,
     "core.cell_sum(cells, n, f, held, q, v, sphere, work) -> number\n"
     "The sum of f(column) over cells; column(source, first, step, table) is an entry of q (source "
     "1), v (2) or a vector. In a trace (q = nil) it stays a loop. work: a sum of virtual work, "
     "linear in the displacements (source 3)."},
    {"cell_list", cell_list,
     "core.cell_list(vector) -> table\nThe cells of a sum over some cells, by number, ascending."},
    {NULL, NULL, NULL}};

const dml_class dml_class_cells = {
    .name = TABLE,
    .doc = "dm.cell_table: the face of every cell, for sums over cells (core.cell_faces)\n"
           "table[i] is the number of that face of cell i, both from 1",
    .field = table_index,
    .functions = functions,
};
