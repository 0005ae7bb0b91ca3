/* array_loop.h - a kernel run along arrays: entry i of every output from entries of inputs
 * beside it, for i = 0, 1, ..., count-1, as one generated loop in lanes.
 *
 * A reference says where the entries are: at a fixed distance from one of two bases that move
 * with i (the arrays of the bodies, and a buffer), or a scalar, the same for all i, or a value
 * carried from the group of lanes before. The reads of a group come before its writes, so an
 * output may overwrite an input of the same entry; no sum runs along i, so tape and native code
 * of any lanes give the same bits. Loops are drafted as graphs between references (begin, read,
 * write, end) and can be put into another draft (inline), which is how passes over a chain are
 * fused.
 * Speed: P8-fpu-1024: 57x, machine code against the tape. */
#ifndef DM_ARRAY_LOOP_H
#define DM_ARRAY_LOOP_H

#include "code/kernel.h"
#include "graph/graph.h"

/* room in a loop */
enum {
    DM_ARRAY_LOOP_MOST = 96,   /* inputs or outputs */
    DM_ARRAY_GROUP = 8,        /* lanes at most */
    DM_ARRAY_LOOP_CARRIED = 12 /* values from group to group */
};

/* what a reference is relative to */
typedef enum { DM_ARRAY_SCALAR, DM_ARRAY_MAIN, DM_ARRAY_BUFFER, DM_ARRAY_CARRIED } dm_array_base;

/* entry i is base[at + i]; fixed: base[at * DM_ARRAY_GROUP], with a copy for every lane behind
 * it; carried: what the group of lanes before this one wrote, number `at` */
typedef struct {
    dm_array_base base;
    int64_t at;
} dm_array_ref;

/* where the bases are when the loop begins */
typedef struct {
    double *main, *buffer;
    const double *scalars;
} dm_array_bases;

typedef void dm_array_loop_eval(const void *pool, double *main, const double *scalars,
                                const double *end, double *buffer);

typedef struct {
    dm_kernel one; /* for one entry */
    dm_array_loop_eval *eval;
    const void *pool;
    uint32_t lanes; /* of eval; 0: entry by entry */
    const dm_array_ref *in, *out;
    dm_graph *g; /* what it is made of, and its outputs */
    const dm_node *root;
} dm_array_loop;

/* A loop under construction: nodes of `g` between references. */
typedef struct {
    dm_graph *g;
    uint32_t inputs, outputs;
    int full;     /* more references than there is room for */
    int verbatim; /* sums are taken as they stand: no products are fused */
    uint32_t carried;
    dm_array_ref start[DM_ARRAY_LOOP_CARRIED]; /* where what is carried comes from */
    int stored[DM_ARRAY_LOOP_CARRIED];         /* and goes there at the end */
    dm_array_ref in[DM_ARRAY_LOOP_MOST], out[DM_ARRAY_LOOP_MOST];
    dm_node root[DM_ARRAY_LOOP_MOST];
} dm_array_loop_draft;

/* 0 without memory. */
int dm_array_loop_begin(dm_array_loop_draft *d, dm_arena *arena);
dm_node dm_array_loop_read(dm_array_loop_draft *d, dm_array_ref from);
void dm_array_loop_write(dm_array_loop_draft *d, dm_array_ref to, dm_node value);

/* One more carried value, which begins as `start` of the first group; keep: its last one goes
 * back there. Only native code of DM_ARRAY_GROUP lanes knows them: dm_array_loop_end gives
 * DM_NO_NATIVE elsewhere. */
dm_array_ref dm_array_loop_carry(dm_array_loop_draft *d, dm_array_ref start, int keep);

/* out[m] = outputs of s in the draft, where with[k] verbatim for its input k. */
void dm_array_loop_inline(dm_array_loop_draft *d, const dm_array_loop *s, const dm_node *with,
                          dm_node *out);

/* The loop; `compile` makes the kernel of one entry and decides whether there is native code. */
dm_status dm_array_loop_end(dm_array_loop *out, dm_array_loop_draft *d, dm_compile *compile,
                            dm_arena *arena);

/* All entries, rounded up to whole groups of DM_ARRAY_GROUP: the arrays have room for them. */
void dm_array_loop_run(const dm_array_loop *s, dm_array_bases at, uint32_t count);

/* jit_array_loop.c: native code for s, whose graph, outputs and references are set, carried
 * values as in d; DM_NO_NATIVE where there is none. */
dm_status dm_jit_build_array_loop(dm_array_loop *s, const dm_array_loop_draft *d, dm_arena *arena);

#endif
