/* derive_inside.h - a sweep of derivatives, for the files that know its rules. */
#ifndef DM_DERIVE_INSIDE_H
#define DM_DERIVE_INSIDE_H

#include "algebra/implicit.h"

/* what an implicit function's outputs for one chain of arguments have got so far */
typedef struct dm_root_adjoint {
    struct dm_root_adjoint *next;
    dm_node with;
    dm_node *of; /* [2 r + 1] by number of the output; 0: nothing */
} dm_root_adjoint;

/* scratch of the sweeps: one derivative per node and whether it can differ from zero */
typedef struct {
    dm_node *d;
    uint8_t *active;
    uint64_t *pending; /* bit n: of the sweep that is on, n is still to be come to */
    uint64_t *known;   /* bit n: of a forward sweep, d[n] is there and not zero */
    uint32_t first, n; /* the inputs in question */
    uint32_t room;
    dm_root_adjoint *roots; /* of a reverse sweep */
} dm_derive_sweep;

/* What n holds in a reverse sweep that has not come to it yet; d from now on. */
dm_node dm_derive_held(const dm_derive_sweep *s, dm_node n);
void dm_derive_hold(dm_derive_sweep *s, dm_node n, dm_node d);

/* a + b for derivatives: what stands under the same condition stays together. */
dm_node dm_derive_join(dm_graph *g, dm_node a, dm_node b);

/* factor * slope; a factor that a branch makes zero stays zero whatever the slope is. */
dm_node dm_derive_times(dm_graph *g, dm_node factor, dm_node slope);

/* What operand k of n gets of, or gives to, a derivative `factor` at n. */
dm_node dm_derive_share(dm_graph *g, dm_node n, int k, dm_node factor);

/* What operand k holds after it has got its share of `factor`, and before. */
dm_node dm_derive_pass(dm_graph *g, dm_node n, int k, dm_node factor, dm_node held);

/* A reverse sweep at node n, DM_OP_ROOT or DM_OP_WITH, which has an adjoint (implicit_derive.c). */
void dm_derive_root(dm_derive_sweep *s, dm_graph *g, dm_node n);

#endif
