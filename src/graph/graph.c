/* graph.c - making nodes. What stays true between calls: node 0 is the constant zero, so that
 * "is it zero everywhere" is a comparison with 0; operands have smaller numbers than their
 * users; no two nodes of a graph have the same content, so that equal expressions are equal
 * numbers; an input has its node in `leaf`, everything else is found by the table of
 * node_table.c.
 *
 * Nodes are never changed and, but for dm_graph_forget, never taken away. A graph that has
 * failed (no memory, too many nodes) answers every call with node 0 and says so in its status,
 * so that code that builds expressions need not test each call. */
#include "graph/graph.h"

#include "graph/nodes.h"
#include "numbers/fma.h"
#include "numbers/functions.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* room of a new graph */
enum { FIRST_NODES = 256 };

/* from the list of operations */
static const struct {
    const char *text;
    int operands;
} operations[] = {
#define X(name, operands, text, c) {text, operands},
#include "graph/ops.def"
#undef X
};

const char *dm_op_text(dm_op op) {
    return operations[op].text;
}

int dm_op_operands(dm_op op) {
    return operations[op].operands;
}

void dm_graph_verbatim(dm_graph *g, int on) {
    g->verbatim = on;
}

void dm_graph_exact(dm_graph *g, int on) {
    g->exact = on;
}

dm_status dm_graph_status(const dm_graph *g) {
    return g->status;
}

uint32_t dm_graph_size(const dm_graph *g) {
    return g->size;
}

uint32_t dm_graph_inputs(const dm_graph *g) {
    return g->inputs;
}

dm_arena *dm_graph_arena(dm_graph *g) {
    return g->arena;
}

const dm_expr *dm_graph_at(const dm_graph *g, dm_node n) {
    assert(n < g->size);
    return g->nodes + n;
}

dm_node dm_graph_fail(dm_graph *g, dm_status why) {
    if (g->status == DM_OK) g->status = why;
    return 0;
}

/* room for `want` nodes, a power of two; the table is made anew when it is asked next */
static int grow(dm_graph *g, size_t want) {
    const size_t held = g->capacity;
    if (held >= DM_GRAPH_LIMIT) return dm_graph_fail(g, DM_TOO_LARGE), 0;
    dm_expr *nodes = dm_arena_grow(g->arena, g->nodes, held * sizeof *nodes, want * sizeof *nodes);
    if (nodes) g->nodes = nodes;
    uint32_t *mark = dm_arena_grow(g->arena, g->mark, held * sizeof *mark, want * sizeof *mark);
    uint8_t *nonnegative = dm_arena_grow(g->arena, g->nonnegative, held, want);
    if (mark) g->mark = mark;
    if (nonnegative) g->nonnegative = nonnegative;
    if (!nodes || !mark || !nonnegative) return dm_graph_fail(g, DM_NO_MEMORY), 0;
    memset(mark + held, 0, (want - held) * sizeof *mark);
    g->capacity = (uint32_t)want;
    g->tabled = 0;
    return 1;
}

dm_graph *dm_graph_new(dm_arena *arena, uint32_t inputs) {
    return dm_graph_sized(arena, inputs, inputs + FIRST_NODES);
}

dm_graph *dm_graph_lazy(dm_arena *arena, uint32_t inputs) {
    return dm_graph_sized(arena, inputs, FIRST_NODES);
}

dm_graph *dm_graph_sized(dm_arena *arena, uint32_t inputs, uint32_t nodes) {
    size_t room = FIRST_NODES;
    dm_graph *g = dm_arena_take(arena, sizeof *g);
    if (!g) return NULL;
    *g = (dm_graph){.arena = arena, .inputs = inputs};
    while (room < nodes) room *= 2;
    if (!grow(g, room)) return NULL;
    g->nodes[0] = (dm_expr){.op = DM_OP_CONSTANT, .as.value = 0.0};
    g->nonnegative[0] = 1;
    g->size = 1;
    return g;
}

/* the sign of a result that is known from its operands; NaN is left out of the promise */
static uint8_t sign_of(const dm_graph *g, const dm_expr *e) {
    const dm_node a = e->as.arg[0], b = e->as.arg[1], c = e->as.arg[2];
    switch (e->op) {
    case DM_OP_CONSTANT:
        return e->as.value >= 0.0;
    case DM_OP_ABS:
    case DM_OP_SQRT:
    case DM_OP_RSQRT:
    case DM_OP_RSQRT3:
    case DM_OP_EXP:
    case DM_OP_ACOS:
    case DM_OP_COSH:
        return 1;
    case DM_OP_MUL:
        return a == b || (g->nonnegative[a] && g->nonnegative[b]);
    case DM_OP_ADD:
    case DM_OP_DIV:
    case DM_OP_MIN:
    case DM_OP_MAX:
        return g->nonnegative[a] && g->nonnegative[b];
    case DM_OP_POW:
        return g->nonnegative[a];
    case DM_OP_WHERE:
        return g->nonnegative[b] && g->nonnegative[c];
    case DM_OP_FMA:
        return (a == b || (g->nonnegative[a] && g->nonnegative[b])) && g->nonnegative[c];
    default:
        return 0;
    }
}

/* node 0 is it, whatever its sign */
static int is_zero(const dm_expr *e) {
    return e->op == DM_OP_CONSTANT && e->as.value == 0.0;
}

dm_node dm_node_find(dm_graph *g, const dm_expr *e) {
    if (is_zero(e)) return 0;
    if (e->op == DM_OP_INPUT) return dm_leaf_of(g, e->as.input);
    const dm_node *place = dm_table_place(g, e);
    return place ? *place : 0;
}

/* where the node of input i is kept: not in the table, as there may be very many in a row */
static dm_node *place_of_input(dm_graph *g, uint32_t i) {
    const uint32_t page = i / DM_LEAVES;
    if (page >= g->pages) {
        const size_t held = g->pages, want = g->inputs / DM_LEAVES + (size_t)1;
        dm_node **leaf = dm_arena_grow(g->arena, g->leaf, held * sizeof *leaf, want * sizeof *leaf);
        if (!leaf) return dm_graph_fail(g, DM_NO_MEMORY), NULL;
        for (size_t k = held; k < want; k++) leaf[k] = NULL;
        g->leaf = leaf;
        g->pages = (uint32_t)want;
    }
    if (!g->leaf[page]) {
        dm_node *own = dm_arena_take(g->arena, DM_LEAVES * sizeof *own);
        if (!own) return dm_graph_fail(g, DM_NO_MEMORY), NULL;
        memset(own, 0, DM_LEAVES * sizeof *own);
        g->leaf[page] = own;
    }
    return g->leaf[page] + i % DM_LEAVES;
}

/* where the number of the node with this content is, or will be */
static dm_node *place_of(dm_graph *g, const dm_expr *e) {
    return e->op == DM_OP_INPUT ? place_of_input(g, e->as.input) : dm_table_place(g, e);
}

/* without a look whether it is there already, or whether there is room */
static dm_node append(dm_graph *g, const dm_expr *e, uint8_t nonnegative) {
    g->nodes[g->size] = *e;
    g->nonnegative[g->size] = nonnegative;
    return g->size++;
}

dm_node dm_node_make(dm_graph *g, const dm_expr *e) {
    if (g->status != DM_OK || is_zero(e)) return 0;
    dm_node *place = place_of(g, e);
    if (!place) return 0;
    if (*place) return *place;
    if (g->size == g->capacity) {
        if (!grow(g, 2 * (size_t)g->capacity) || !(place = place_of(g, e))) return 0;
    }
    g->tabled += g->tabled == g->size;
    return *place = append(g, e, sign_of(g, e));
}

dm_node dm_node_copy(dm_graph *g, const dm_expr *e, uint8_t nonnegative) {
    if (e->op == DM_OP_INPUT || g->status != DM_OK || is_zero(e)) return dm_node_make(g, e);
    if (g->size == g->capacity && !grow(g, 2 * (size_t)g->capacity)) return 0;
    return append(g, e, nonnegative);
}

void dm_graph_forget(dm_graph *g, uint32_t size) {
    dm_table_forget(g, size);
    for (dm_node n = size; n < g->size; n++)
        if (g->nodes[n].op == DM_OP_INPUT) *place_of_input(g, g->nodes[n].as.input) = 0;
    if (size < g->size) g->size = size;
}

dm_node dm_node_plain(dm_graph *g, dm_op op, dm_node a, dm_node b, dm_node c) {
    return dm_node_make(g, &(dm_expr){.op = op, .as.arg = {a, b, c}});
}

dm_node dm_constant(dm_graph *g, double value) {
    return dm_node_make(g, &(dm_expr){.op = DM_OP_CONSTANT, .as.value = value});
}

dm_node dm_input(dm_graph *g, uint32_t i) {
    assert(i < g->inputs);
    const dm_node leaf = dm_leaf_of(g, i);
    if (leaf && g->status == DM_OK) return leaf;
    return dm_node_make(g, &(dm_expr){.op = DM_OP_INPUT, .as.input = i});
}

/* as dm_input one by one: the same numbers in the same order */
void dm_inputs(dm_graph *g, dm_node *out, uint32_t first, uint32_t count) {
    uint32_t i = 0;
    assert((uint64_t)first + count <= g->inputs);
    for (; i < count && g->status == DM_OK && g->size < g->capacity; i++) {
        dm_node *leaf = place_of_input(g, first + i);
        if (!leaf) break;
        if (!*leaf) {
            g->nodes[g->size] = (dm_expr){.op = DM_OP_INPUT, .as.input = first + i};
            g->nonnegative[g->size] = 0;
            *leaf = g->size++;
        }
        out[i] = *leaf;
    }
    for (; i < count; i++) out[i] = dm_input(g, first + i);
}

int dm_is_constant(const dm_graph *g, dm_node n, double *value) {
    if (g->nodes[n].op != DM_OP_CONSTANT) return 0;
    *value = g->nodes[n].as.value;
    return 1;
}

/* 1: it was not marked yet, and has operands */
static uint32_t mark_one(dm_graph *g, dm_node n) {
    if (g->mark[n] == g->stamp) return 0;
    g->mark[n] = g->stamp;
    g->marked++;
    return dm_arity(g->nodes[n].op) > 0;
}

uint32_t dm_mark(dm_graph *g, const dm_node *roots, uint32_t m) {
    uint32_t end = 0;
    g->marked = 0;
    if (++g->stamp == 0) { /* wrapped: forget all old marks */
        memset(g->mark, 0, g->capacity * sizeof *g->mark);
        g->stamp = 1;
    }
    uint32_t pending = 0; /* marked nodes whose operands are not */
    for (uint32_t i = 0; i < m; i++) {
        pending += mark_one(g, roots[i]);
        if (roots[i] >= end) end = roots[i] + 1;
    }
    for (uint32_t n = end; pending && n-- > 0;) { /* users have larger numbers than operands */
        const dm_expr *e = g->nodes + n;
        if (g->mark[n] != g->stamp || !dm_arity(e->op)) continue;
        pending--;
        for (int k = 0; k < dm_arity(e->op); k++) pending += mark_one(g, e->as.arg[k]);
    }
    return end;
}

/* operations of three operands */
static double value_of_three(dm_op op, double a, double b, double c) {
    switch (op) {
    case DM_OP_WHERE:
        return a > 0 ? b : c;
    case DM_OP_FMA:
        return dm_fma(a, b, c);
    case DM_OP_FMS:
        return dm_fma(a, b, -c);
    case DM_OP_FNMA:
        return dm_fma(-a, b, c);
    default:
        return NAN; /* leaves have no operands to work on */
    }
}

double dm_op_value(dm_op op, double a, double b, double c) {
    switch (op) {
    case DM_OP_NEG:
        return -a;
    case DM_OP_ABS:
        return fabs(a);
    case DM_OP_SIGN:
        return (double)((a > 0) - (a < 0));
    case DM_OP_SQRT:
        return sqrt(a);
    case DM_OP_RSQRT:
        return dm_rsqrt(a);
    case DM_OP_RSQRT3:
        return dm_rsqrt3(a);
    case DM_OP_EXP:
        return dm_exp(a);
    case DM_OP_LOG:
        return dm_log(a);
    case DM_OP_SIN:
        return dm_sin(a);
    case DM_OP_COS:
        return dm_cos(a);
    case DM_OP_TAN:
        return dm_tan(a);
    case DM_OP_ASIN:
        return asin(a);
    case DM_OP_ACOS:
        return acos(a);
    case DM_OP_ATAN:
        return atan(a);
    case DM_OP_SINH:
        return dm_sinh(a);
    case DM_OP_COSH:
        return dm_cosh(a);
    case DM_OP_TANH:
        return dm_tanh(a);
    case DM_OP_ADD:
        return a + b;
    case DM_OP_SUB:
        return a - b;
    case DM_OP_MUL:
        return a * b;
    case DM_OP_DIV:
        return a / b;
    case DM_OP_POW:
        return pow(a, b);
    case DM_OP_ATAN2:
        return atan2(a, b);
    case DM_OP_MIN:
        return b < a ? b : a;
    case DM_OP_MAX:
        return a < b ? b : a;
    default:
        return value_of_three(op, a, b, c);
    }
}

dm_function_name dm_op_function(dm_op op) {
    static const uint8_t name[DM_OP_COUNT] =
        {[DM_OP_CONSTANT] = DM_FUNCTION_SINCOS, [DM_OP_EXP] = DM_FUNCTION_EXP,
         [DM_OP_LOG] = DM_FUNCTION_LOG,         [DM_OP_SIN] = DM_FUNCTION_SIN,
         [DM_OP_COS] = DM_FUNCTION_COS,         [DM_OP_TAN] = DM_FUNCTION_TAN,
         [DM_OP_ASIN] = DM_FUNCTION_ASIN,       [DM_OP_ACOS] = DM_FUNCTION_ACOS,
         [DM_OP_ATAN] = DM_FUNCTION_ATAN,       [DM_OP_SINH] = DM_FUNCTION_SINH,
         [DM_OP_COSH] = DM_FUNCTION_COSH,       [DM_OP_TANH] = DM_FUNCTION_TANH,
         [DM_OP_POW] = DM_FUNCTION_POW,         [DM_OP_ATAN2] = DM_FUNCTION_ATAN2};
    return (dm_function_name)name[op];
}
