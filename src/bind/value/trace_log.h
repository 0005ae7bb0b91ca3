/* trace_log.h - what a traced function did, operation by operation, beside its graph. A function
 * that does the same again needs no new graph: its symbols are nodes of the old one, and every
 * operation is compared with the one that was noted. With the first that differs a graph of its
 * own begins, as a copy of what was the same. */
#ifndef DML_TRACE_LOG_H
#define DML_TRACE_LOG_H

#include "algebra/body_sum.h"
#include "bind/core/state.h"

#include <string.h>

/* an operation of nodes, the bits of a constant, or (DM_OP_COUNT) the sum of that number in the
 * log */
typedef struct {
    uint32_t op, word[3];
} dml_deed;

typedef struct dml_step {
    dml_deed did;
    dm_node node;  /* what it became */
    uint32_t size; /* nodes of the graph then */
} dml_step;

/* A traced function: outputs as nodes of a graph. */
typedef struct dml_traced {
    dm_graph *graph;
    const dm_node *out;        /* [outputs], in the graph's arena */
    const struct dml_log *log; /* of dml_retrace: what the function did  */
    uint32_t outputs;
    uint32_t inputs;
    int bare; /* the result was a number, not a vector or table of one */
} dml_traced;

/* a sum that stays a loop, and the trace of its term */
typedef struct {
    const dm_sum *sum;
    dml_traced term;
} dml_summed;

typedef struct dml_log {
    dml_step *step;
    uint32_t count, room;
    dml_summed *sum;
    uint32_t sums, sums_room;
    dml_symbols *symbols; /* made when it is repeated first */
} dml_log;

/* The trace has a graph of its own from here on. Raises without memory. */
void dml_leavelast(lua_State *L, dml_frame *f);

/* That graph, to be added to by other means than those below: there will be no log. */
dm_graph *dml_owngraph(lua_State *L, dml_frame *f);

dm_node dml_doanew(lua_State *L, dml_frame *f, const dml_deed *d);

/* The node of a deed: the noted one, or a new one, which is noted. */
static inline dm_node dml_do(lua_State *L, dml_frame *f, const dml_deed *d) {
    if (f->step == f->end || memcmp(&f->step->did, d, sizeof *d) != 0) return dml_doanew(L, f, d);
    return f->step++->node;
}

static inline dm_node dml_constant(lua_State *L, dml_frame *f, double x) {
    dml_deed d = {.op = DM_OP_CONSTANT};
    memcpy(d.word, &x, sizeof x);
    return dml_do(L, f, &d);
}

static inline dm_node dml_operation(lua_State *L, dml_frame *f, dm_op op, dm_node a, dm_node b,
                                    dm_node c) {
    return dml_do(L, f, &(dml_deed){(uint32_t)op, {a, b, c}});
}

/* The sum that was noted next, while the trace repeats; NULL: there is none. Where it is this
 * one again, `node` is its leaf. */
const dml_summed *dml_nextsum(const dml_frame *f);
dm_node dml_sumagain(dml_frame *f);

/* A new sum, of a term that was just traced into the arena of the frame. */
dm_node dml_sumanew(lua_State *L, dml_frame *f, const dm_sum *s, const dml_traced *term);

/* The trace has no kept symbols any more: others may have them, or, where they are dropped,
 * nobody ever. */
void dml_leavesymbols(dml_frame *f);
void dml_dropsymbols(dml_frame *f);

/* Begin the log of a trace with its own graph, or repeat *last where that has a log. 0: no
 * memory. */
int dml_beginlog(dml_frame *f, const dml_traced *last);

/* The trace that was repeated from its beginning to its end with these results; NULL: it was
 * not. */
const dml_traced *dml_repeated(const dml_frame *f, const dm_node *out, uint32_t outputs);

#endif
