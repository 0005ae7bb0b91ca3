/* group_inside.h - how the kernels of a system on a group are made: the chart of the group and what
 * depends on the element are joined in one graph. */
#ifndef DM_GROUP_INSIDE_H
#define DM_GROUP_INSIDE_H

#include "mech/group.h"

/* The joined graph has the inputs q0[n], xi[d], rate[d], t, extra[extras], e[d]. */
typedef struct {
    const dm_model *m;
    const dm_chart_trace *trace;
    dm_arena *arena;
    dm_graph *g;
    uint32_t n, d, extras;
    dm_node *q0, *xi, *rate, *extra, *e; /* inputs */
    dm_node t, a;                        /* a: of a straight curve */
    dm_node *place; /* [n] coordinates of the element g0 near(e) tau(xi), [d] its velocity */
    dm_node *slope; /* [3d] L_e, L_xi, L_rate */
} dm_joining;

/* Inputs, the element and its velocity, in the arena of a model that was built. */
dm_status dm_joining_open(dm_joining *j, const dm_group *group, const dm_model *m, dm_tau tau,
                          uint32_t extras);

/* The same of a curve xi = a V, with V for the rate and a for the input of that number: exp(a V)
 * has the velocity V. Of other tau the chart tells it. */
dm_status dm_joining_open_line(dm_joining *j, const dm_group *group, const dm_model *m, dm_tau tau,
                               uint32_t extras, uint32_t a);

/* Nodes in the arena, one more than asked for: none is empty. NULL: no memory. */
dm_node *dm_joining_take(const dm_joining *j, size_t count);

/* What stands for the inputs (q, v, t, ...) of a graph of so many, at the element: zeros behind the
 * velocity and behind t. NULL: no memory. */
dm_node *dm_joining_at_element(const dm_joining *j, uint32_t inputs);

/* L_e, L_xi, L_rate, forces added, with e still an input; the last extra inputs are the controls
 * of the force. 0: no memory. */
int dm_joining_slopes(dm_joining *j);

/* Of a straight curve: L_e[d] and dL/dV[d], forces added. 0: no memory. */
int dm_joining_line_slopes(dm_joining *j);

/* Adds what a body covector f[d] at the element does: on e by way of the adjoint action of
 * 1/tau(xi), on xi by dtau. 0: no memory. */
int dm_joining_covector(const dm_joining *j, const dm_node *f, dm_node *of_e, dm_node *of_xi);

/* dtau_R(xi)^T mu, out[d] in a graph with the inputs xi[d], mu[d]. */
dm_status dm_joining_pull(const dm_joining *j, dm_graph *g, dm_node *out);

/* The kernel of dm_chart_trace.end, of equal bodies where body[n + 2d] is there
 * (code/loops/equal_parts.h); of .change, which may be none. */
dm_status dm_joining_finish(const dm_joining *j, dm_kernel *out, const uint32_t *body,
                            uint32_t bodies, dm_compile *compile);
dm_status dm_joining_change(const dm_joining *j, dm_kernel *out, dm_compile *compile);

/* The kernels dm_group.free of a straight curve whose slopes are found, where L does not see the
 * element. */
dm_status dm_joining_free(const dm_joining *line, dm_group *out, dm_compile *compile);

/* ---- group_bodies.c ---- */

/* Which body each coordinate belongs to, so that kernels of equal bodies are made once. */
typedef struct {
    const dm_joining *j;
    uint32_t count;
    uint32_t *of_flat, *of_coordinate; /* [n], [d] */
} dm_group_bodies;

/* From what dm_joining_pull gave. */
dm_status dm_group_bodies_find(dm_group_bodies *out, const dm_joining *j, dm_graph *pull,
                               const dm_node *pulled);

/* body[] of dm_equal_parts_build for the inputs: flat coordinates [n, or 0], so many times
 * coordinates [d], others of no body, coordinates [last]. NULL: no memory. */
uint32_t *dm_group_bodies_of(const dm_group_bodies *b, uint32_t n, uint32_t times, uint32_t others,
                             uint32_t last);

#endif
