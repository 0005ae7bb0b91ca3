/* nodes.h - the inside of a graph, for the files of this room only. */
#ifndef DM_NODES_H
#define DM_NODES_H

#include "graph/graph.h"

#include <string.h>

/* a place of a table of nodes; node 0 is found without it, and says that this one is free */
typedef struct {
    dm_node node;
    uint32_t hash; /* so that most other nodes need not be looked at */
} dm_slot;

/* df/dx_i for n inputs from the first on */
typedef struct {
    dm_node f;
    uint32_t first, n;
    const dm_node *of; /* [n]; NULL: nothing is kept */
} dm_gradient_cache;

/* inputs of a page: of very many of them only some pages are there */
enum { DM_LEAVES = 128 };

/* The graph; see the head of graph.c for what stays true of it. */
struct dm_graph {
    dm_arena *arena;
    dm_expr *nodes;
    uint32_t size, capacity;
    dm_slot *table; /* node_table.c: open addressing by content */
    uint32_t mask;
    uint32_t tabled; /* nodes below are in the table, but for inputs; 0: none, and it has no room */
    dm_node **leaf; /* [pages] the nodes of DM_LEAVES inputs each, 0: not made yet; NULL: none is */
    uint32_t pages;
    uint32_t inputs;                     /* with the leaves of sums behind them */
    struct dm_sum *sums;                 /* sum.h */
    struct dm_extremum *extrema;         /* extremum.h */
    const struct dm_implicit *implicits; /* implicit.h, newest first */
    uint32_t *mark;         /* [capacity] scratch of one sweep: marked when equal to `stamp` */
    uint32_t stamp, marked; /* marked: nodes with it */
    uint8_t *nonnegative;   /* [capacity] 1 where the value is >= 0 whenever it is a number */
    dm_status status;
    dm_node source[2];          /* the last function prepared for derivatives, and what it became */
    dm_gradient_cache gradient; /* the last one */
    struct dm_compacted *compacted; /* compact.c, newest first */
    int verbatim, exact;
};

/* A graph with room for so many nodes from the start. */
dm_graph *dm_graph_sized(dm_arena *arena, uint32_t inputs, uint32_t nodes);

/* The node of input i, 0: there is none. */
static inline dm_node dm_leaf_of(const dm_graph *g, uint32_t i) {
    const uint32_t page = i / DM_LEAVES;
    return page < g->pages && g->leaf[page] ? g->leaf[page][i % DM_LEAVES] : 0;
}

/* dm_op_operands where it is asked for in every loop. */
static inline int dm_arity(dm_op op) {
    static const uint8_t operands[DM_OP_COUNT] = {
#define X(name, count, text, c) count,
#include "graph/ops.def"
#undef X
    };
    return operands[op];
}

/* The same operation of the same nodes; constants bit for bit. */
static inline int dm_same_expr(const dm_expr *a, const dm_expr *b) {
    if (a->op != b->op) return 0;
    if (a->op == DM_OP_CONSTANT || a->op == DM_OP_IMPLICIT)
        return memcmp(&a->as.value, &b->as.value, sizeof a->as.value) == 0;
    if (a->op == DM_OP_INPUT) return a->as.input == b->as.input;
    for (int k = 0; k < dm_arity(a->op); k++)
        if (a->as.arg[k] != b->as.arg[k]) return 0;
    return 1;
}

/* The node with exactly this content, made when missing. No simplification. */
dm_node dm_node_make(dm_graph *g, const dm_expr *e);

/* The same, but 0 when there is none yet. */
dm_node dm_node_find(dm_graph *g, const dm_expr *e);

/* The same for content that is known to be new, which is not looked for, and of which the sign
 * is known. */
dm_node dm_node_copy(dm_graph *g, const dm_expr *e, uint8_t nonnegative);

/* node_table.c: where the number of this node is, or belongs (0); not for inputs and the
 * constant zero. NULL: no memory, and the graph has failed. */
dm_node *dm_table_place(dm_graph *g, const dm_expr *e);

/* op(a, b, c) as it stands. */
dm_node dm_node_plain(dm_graph *g, dm_op op, dm_node a, dm_node b, dm_node c);

/* Take the newest nodes away, which nothing refers to, until so many are left. */
void dm_graph_forget(dm_graph *g, uint32_t size);

/* node_table.c: the same for the table alone. */
void dm_table_forget(dm_graph *g, uint32_t size);

/* Stop building: the first reason is kept. Returns node 0. */
dm_node dm_graph_fail(dm_graph *g, dm_status why);

/* Mark what the roots need; afterwards dm_is_marked holds until the next sweep.
 * Returns one past the largest marked number. */
uint32_t dm_mark(dm_graph *g, const dm_node *roots, uint32_t m);

static inline int dm_is_marked(const dm_graph *g, dm_node n) {
    return g->mark[n] == g->stamp;
}

static inline const dm_expr *dm_at(const dm_graph *g, dm_node n) {
    return g->nodes + n;
}

static inline int dm_is_op(const dm_graph *g, dm_node n, dm_op op) {
    return g->nodes[n].op == op;
}

#endif
