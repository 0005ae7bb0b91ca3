/* array_loop.h - a kernel run along arrays: entry i of every output from entries of inputs beside it,
 * for i = 0, 1, ..., count-1, as one generated loop in lanes. A strand says where the entries
 * are: at a fixed distance from one of two bases that move with i, or a number that is the same
 * for all i. The reads of a group of lanes come before its writes; an output may overwrite an
 * input of the same entry. Tape and native code of any lanes give the same bits, since no sum
 * runs along i. */
#ifndef DM_STRIP_H
#define DM_STRIP_H

#include "code/kernel.h"
#include "graph/graph.h"

enum {
    DM_STRIP_MOST = 96,   /* inputs or outputs */
    DM_STRIP_GROUP = 8,   /* lanes at most */
    DM_STRIP_CARRIED = 12 /* values from group to group */
};

typedef enum { DM_STRAND_FIXED, DM_STRAND_MAIN, DM_STRAND_SIDE, DM_STRAND_CARRIED } dm_strand_base;

/* entry i is base[at + i]; fixed: base[at * DM_STRIP_GROUP], with a copy for every lane behind
 * it; carried: what the group of lanes before this one wrote, number `at` */
typedef struct {
    dm_strand_base base;
    int64_t at;
} dm_strand;

/* where the bases are when the loop begins */
typedef struct {
    double *main, *side;
    const double *fixed;
} dm_strip_bases;

typedef void dm_strip_eval(const void *pool, double *main, const double *fixed, const double *end,
                           double *side);

typedef struct {
    dm_kernel one; /* for one entry */
    dm_strip_eval *eval;
    const void *pool;
    uint32_t lanes; /* of eval; 0: entry by entry */
    const dm_strand *in, *out;
    dm_graph *g; /* what it is made of, and its outputs */
    const dm_node *root;
} dm_strip;

/* A strip under construction: nodes of `g` between strands. */
typedef struct {
    dm_graph *g;
    uint32_t inputs, outputs;
    int full;   /* more strands than there is room for */
    int stands; /* sums are taken as they stand: no products are fused */
    uint32_t carried;
    dm_strand start[DM_STRIP_CARRIED]; /* where what is carried comes from */
    int kept[DM_STRIP_CARRIED];        /* and goes there at the end */
    dm_strand in[DM_STRIP_MOST], out[DM_STRIP_MOST];
    dm_node root[DM_STRIP_MOST];
} dm_strip_draft;

/* 0 without memory. */
int dm_strip_begin(dm_strip_draft *d, dm_arena *arena);
dm_node dm_strip_read(dm_strip_draft *d, dm_strand from);
void dm_strip_write(dm_strip_draft *d, dm_strand to, dm_node value);

/* One more carried value, which begins as `start` of the first group; keep: its last one goes
 * back there. Only native code of DM_STRIP_GROUP lanes knows them: dm_strip_end gives
 * DM_NO_NATIVE elsewhere. */
dm_strand dm_strip_carry(dm_strip_draft *d, dm_strand start, int keep);

/* out[m] = outputs of s in the draft, where with[k] stands for its input k. */
void dm_strip_repeat(dm_strip_draft *d, const dm_strip *s, const dm_node *with, dm_node *out);

/* The loop; `compile` makes the kernel of one entry and decides whether there is native code. */
dm_status dm_strip_end(dm_strip *out, dm_strip_draft *d, dm_compile *compile, dm_arena *arena);

/* All entries, rounded up to whole groups of DM_STRIP_GROUP: the arrays have room for them. */
void dm_strip_run(const dm_strip *s, dm_strip_bases at, uint32_t count);

/* jit_strip.c: native code for s, whose graph, outputs and strands are set, carried values as in
 * d; DM_NO_NATIVE where there is none. */
dm_status dm_jit_build_strip(dm_strip *s, const dm_strip_draft *d, dm_arena *arena);

#endif
