/* loop.h - many stages in one call: what comes out of one goes into the next. A step of a loop
 * is a head, a body so many times, a tail; before the first step comes a start. Each part is a
 * graph from the carried values and a few coefficients of its own to the carried values; the
 * coefficients lie one after the other in memory. Native code keeps the values of a single
 * member in registers from part to part; members in lanes go in groups, each part for all groups
 * before the next part, so that their latencies overlap. */
#ifndef DM_LOOP_H
#define DM_LOOP_H

#include "code/kernel.h"
#include "graph/graph.h"

typedef enum {
    DM_LOOP_START,
    DM_LOOP_HEAD,
    DM_LOOP_BODY,
    DM_LOOP_TAIL,
    DM_LOOP_PARTS
} dm_loop_kind;

/* The nodes as they stand. */
typedef struct {
    dm_graph *graph; /* inputs: carried[size], coefficients[coefficients]; NULL: no such part */
    const dm_node *roots; /* [size]; no other carried input than i itself may stand for i */
    uint32_t coefficients;
    int own; /* every group of lanes has coefficients of its own */
} dm_loop_part;

/* One call; native code reads and counts here. */
typedef struct {
    const void *pool[DM_LOOP_PARTS];
    double *state;              /* [groups][size][lanes], in place */
    const double *coefficients; /* [][lanes]: of the start, then of a step, part by part */
    int64_t groups, repeats;    /* of the body, >= 1 where there is one */
    int64_t steps;              /* >= 1 */
    int64_t stride; /* bytes from the coefficients of a step to those of the next; 0: the same */
    int64_t groups_left, repeats_left;
    const double *now;
    int64_t
        /* bytes between the coefficients of passes, where groups have their own: of a pass
         * coefficient j of its group k is at [j][k][lanes] */
        group_stride;
    const double *part_now;
} dm_loop_call;

typedef struct {
    void (*native)(dm_loop_call *call); /* NULL: by kernels */
    uint32_t size, lanes;
    uint32_t together; /* groups that one pass of the code takes, instruction by instruction */
    uint32_t coefficients[DM_LOOP_PARTS];
    const void *pool[DM_LOOP_PARTS];
    dm_kernel kernel[DM_LOOP_PARTS];
    double *buffer[2];   /* of kernels: carried, coefficients */
    uint32_t operations; /* of all parts together */
} dm_loop;

/* Machine code for 1, 4 or 8 lanes, the number of groups of a call being a multiple of
 * `together`, which is 1 for one lane; DM_NO_NATIVE where there is none, DM_NO_MEMORY. */
dm_status dm_loop_native(dm_loop *out, const dm_loop_part part[DM_LOOP_PARTS], uint32_t size,
                         uint32_t lanes, dm_arena *arena);

/* One member, every part a kernel made by `compile`. */
dm_status dm_loop_by_kernels(dm_loop *out, const dm_loop_part part[DM_LOOP_PARTS], uint32_t size,
                             dm_compile *compile, dm_arena *arena);

/* Run it: of *call state, coefficients, groups, repeats, steps and stride are given. */
void dm_loop_run(const dm_loop *l, dm_loop_call *call);

#endif
