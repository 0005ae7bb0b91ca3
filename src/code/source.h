/* source.h - what the kernels of one function L(q, v, t) are made from: its graph, its gradient,
 * who compiles, and where. Methods that make kernels of their own take what they need from here,
 * and leave them in the cache, where the next stepper of the same model finds them. */
#ifndef DM_SOURCE_H
#define DM_SOURCE_H

#include "code/kernel.h"

/* One kernel of the cache, newest first; `maker` is an address that only its maker has, `which`
 * tells several of one maker apart, `lanes` is how many members an evaluation takes. */
typedef struct dm_cache_entry {
    struct dm_cache_entry *next;
    const void *maker;
    uint32_t which, lanes;
    dm_kernel kernel;
} dm_cache_entry;

typedef struct {
    dm_graph *graph; /* inputs q[n], v[n], t; NULL: hyper-dual numbers, or sums that stay loops */
    dm_graph *sums;  /* the graph with its sums as leaves, where they stay loops; else NULL */
    dm_node lagrangian, potential; /* L; -V, L at v = 0, where that was asked for */
    /* L_q[n], L_v[n] with the sums held; NULL: sums over cells are all that L is made of */
    const dm_node *gradient;
    dm_node energy;        /* where sums stay loops: sum of v dL/dv over what depends on v */
    const dm_node *field;  /* of H(q, p, t), then `lagrangian`: H_p[n], -H_q[n]; else NULL */
    dm_graph *stage_graph; /* of the stage kernel, where there is one, to be taken as it stands */
    const dm_node *stage;  /* and its roots; the first 2n are those of the gradient */
    dm_compile *compile;
    dm_arena *arena;        /* of all kernels and nodes */
    dm_cache_entry **cache; /* NULL: nothing stays for the next stepper */
} dm_source;

#endif
