/* graph.h - the expression graph: a hash-consed, simplified DAG of scalar operations.
 * Nodes are numbered in the order they are made, so operands have smaller numbers
 * than what uses them: a forward or backward sweep over numbers is topological.
 * The graph lives in the caller's arena. Failure is sticky: after an allocation is
 * refused or the graph grows past its limit every call returns node 0 and
 * dm_graph_status tells why, so that builders need not test each call. */
#ifndef DM_GRAPH_H
#define DM_GRAPH_H

#include "base/arena.h"
#include "base/status.h"
#include "numbers/functions.h"

#include <stdint.h>

typedef uint32_t dm_node;
typedef struct dm_graph dm_graph;

typedef enum {
#define X(name, operands, text, c) DM_OP_##name,
#include "graph/ops.def"
#undef X
    DM_OP_COUNT
} dm_op;

/* One node: an operation and its operands, or a leaf and its number. */
typedef struct {
    dm_op op;
    union {
        dm_node arg[3]; /* operands; unused ones are 0 */
        double value;   /* DM_OP_CONSTANT; DM_OP_IMPLICIT: serial number of the function */
        uint32_t input; /* DM_OP_INPUT: number of the input, from 0 */
    } as;
} dm_expr;

enum { DM_GRAPH_LIMIT = 1 << 21 }; /* nodes */

/* A graph with inputs 0 .. inputs-1; node 0 is the constant zero. NULL: no memory. */
dm_graph *dm_graph_new(dm_arena *arena, uint32_t inputs);

/* The same with room for few nodes: most of very many inputs are never asked for. */
dm_graph *dm_graph_lazy(dm_arena *arena, uint32_t inputs);

dm_status dm_graph_status(const dm_graph *g);
uint32_t dm_graph_size(const dm_graph *g); /* nodes so far */
uint32_t dm_graph_inputs(const dm_graph *g);
dm_arena *dm_graph_arena(dm_graph *g);

const dm_expr *dm_graph_at(const dm_graph *g, dm_node n); /* valid until the next node is made */
/* Of the list of operations: the text of an operation, and how many operands it has. */
const char *dm_op_text(dm_op op);
int dm_op_operands(dm_op op);

/* Leaves. */
dm_node dm_constant(dm_graph *g, double value);
dm_node dm_input(dm_graph *g, uint32_t i);
void dm_inputs(dm_graph *g, dm_node *out, uint32_t first, uint32_t count); /* many in a row */

/* The simplified, shared node for op(a, b, c); operands past the op's count are ignored. */
dm_node dm_apply(dm_graph *g, dm_op op, dm_node a, dm_node b, dm_node c);

/* While on, dm_apply makes the operation as it stands and dm_compact leaves the roots alone: for
 * sums whose rounding errors are meant. */
void dm_graph_verbatim(dm_graph *g, int on);

/* While on, dm_compact pulls no coefficient out of a sum that would round the others: for kernels
 * that must have the same coefficients, to the last bit, as others of the same function. */
void dm_graph_exact(dm_graph *g, int on);

/* Shorthand for the arithmetic that builders write. dm_power expands whole and half exponents. */
dm_node dm_neg(dm_graph *g, dm_node a);
dm_node dm_add(dm_graph *g, dm_node a, dm_node b);
dm_node dm_sub(dm_graph *g, dm_node a, dm_node b);
dm_node dm_mul(dm_graph *g, dm_node a, dm_node b);
dm_node dm_div(dm_graph *g, dm_node a, dm_node b);
dm_node dm_power(dm_graph *g, dm_node a, dm_node b);

/* a * b + c, rounded once where the processor can (numbers/fma.h). */
dm_node dm_multiply_add(dm_graph *g, dm_node a, dm_node b, dm_node c);

/* True with *value set when n is a constant. */
int dm_is_constant(const dm_graph *g, dm_node n, double *value);

/* The one scalar meaning of an operation, used for folding, by the tape and by tests. */
double dm_op_value(dm_op op, double a, double b, double c);

/* The elementary function that an operation is; NONE: it is arithmetic. A constant, which is not
 * computed, stands for sine and cosine at once. */
dm_function_name dm_op_function(dm_op op);

#endif
