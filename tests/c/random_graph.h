/* random_graph.h - graphs of random operations, the sweep that says what they are worth,
 * and
 * the heap as an allocator that can be told to refuse. */
#ifndef RANDOM_GRAPH_H
#define RANDOM_GRAPH_H

#include "graph/nodes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* xorshift64* (Vigna 2016): the same numbers everywhere */
typedef struct {
    uint64_t state;
} random_source;

static inline uint32_t random_below(random_source *r, uint32_t n) {
    r->state ^= r->state >> 12;
    r->state ^= r->state << 25;
    r->state ^= r->state >> 27;
    return (uint32_t)((r->state * 0x2545F4914F6CDD1Du >> 32) * n >> 32);
}

/* uniform in (low, high) */
static inline double random_between(random_source *r, double low, double high) {
    return low + (high - low) * ((double)random_below(r, 1u << 30) + 0.5) / (1u << 30);
}

/* the heap, until `left` requests are used up (negative: never) */
static inline void *heap(void *ud, void *block, size_t old_size, size_t new_size) {
    long *left = ud;
    (void)old_size;
    if (new_size == 0) {
        free(block);
        return NULL;
    }
    if (left && *left == 0) return NULL;
    if (left && *left > 0) --*left;
    return realloc(block, new_size);
}

static inline dm_arena new_arena(void) {
    dm_arena arena;
    dm_arena_init(&arena, heap, NULL);
    return arena;
}

/* an operand: mostly one of the newest nodes, sometimes an input or a constant */
static inline dm_node random_operand(random_source *r, dm_graph *g) {
    const uint32_t kind = random_below(r, 10), size = dm_graph_size(g);
    if (kind == 0) return dm_constant(g, (double)random_below(r, 9) / 2.0 - 2.0);
    if (kind < 3) return dm_input(g, random_below(r, dm_graph_inputs(g)));
    const uint32_t reach = size < 40 ? size : 40;
    return kind < 8 ? size - 1 - random_below(r, reach) : random_below(r, size);
}

static inline dm_op random_op(random_source *r) {
    return (dm_op)(DM_OP_NEG + random_below(r, DM_OP_COUNT - DM_OP_NEG));
}

/* an operation that is one instruction, so that values stay in registers until these run out */
static inline dm_op random_arithmetic_op(random_source *r) {
    static const dm_op ops[] = {DM_OP_ADD,  DM_OP_SUB,   DM_OP_MUL, DM_OP_DIV, DM_OP_MIN,
                                DM_OP_MAX,  DM_OP_NEG,   DM_OP_ABS, DM_OP_ADD, DM_OP_SQRT,
                                DM_OP_SIGN, DM_OP_WHERE, DM_OP_SUB, DM_OP_MUL, DM_OP_FMA,
                                DM_OP_ADD,  DM_OP_FMA,   DM_OP_MUL, DM_OP_FMS, DM_OP_FNMA};
    return ops[random_below(r, sizeof ops / sizeof ops[0])];
}

enum { AS_IT_COMES, SIMPLIFIED, ARITHMETIC, KINDS_OF_GRAPHS };

/* `count` operations on `inputs` inputs, simplified or as they come; m random roots */
static inline dm_graph *random_graph(random_source *r, dm_arena *arena, uint32_t count, int kind) {
    dm_graph *g = dm_graph_new(arena, 1 + random_below(r, 6));
    for (uint32_t i = 0; g && i < count; i++) {
        const dm_op op = kind == ARITHMETIC ? random_arithmetic_op(r) : random_op(r);
        const dm_node a = random_operand(r, g), b = random_operand(r, g), c = random_operand(r, g);
        const int operands = dm_op_operands(op);
        if (kind == SIMPLIFIED)
            dm_apply(g, op, a, b, c);
        else
            dm_node_plain(g, op, a, operands > 1 ? b : 0, operands > 2 ? c : 0);
    }
    return g;
}

/* value[n] for every node: what all backends must give */
static inline void graph_values(const dm_graph *g, const double *in, double *value) {
    for (dm_node n = 0; n < dm_graph_size(g); n++) {
        const dm_expr *e = dm_graph_at(g, n);
        if (e->op == DM_OP_CONSTANT)
            value[n] = e->as.value;
        else if (e->op == DM_OP_INPUT)
            value[n] = in[e->as.input];
        else
            value[n] =
                dm_op_value(e->op, value[e->as.arg[0]], value[e->as.arg[1]], value[e->as.arg[2]]);
    }
}

/* the same bits, all NaNs being one */
static inline int same_bits(double a, double b) {
    return (a != a && b != b) || memcmp(&a, &b, sizeof a) == 0;
}

#endif
