/* group_free.c - the equation of a straight curve where L does not see the place of the body, as
 * one kernel: of two, what stands between them is a fifth of a step (lie(1) of a free body in
 * docs/benchmarks/groups.md). */
#include "algebra/derive.h"
#include "graph/analyse.h"
#include "mech/group_inside.h"

#include <string.h>

enum { MANY = 512 }; /* operations from which kernels of maps are better off alone */

static int sees_place(const dm_joining *j) {
    const uint32_t n = j->n, d = j->d;
    for (uint32_t a = 0; a < d; a++)
        if (j->slope[a]) return 1;
    return dm_depends(j->g, j->slope + d, d, 0, n) ||
           dm_depends(j->g, j->slope + d, d, n + 2 * d + 2, d);
}

/* R[d], b[d], in a graph with the inputs of dm_group.free */
static dm_status find_equation(const dm_joining *j, dm_graph *g, dm_node *R) {
    const uint32_t n = j->n, d = j->d, all = n + 3 * d + 2;
    dm_graph *pull = dm_graph_new(j->arena, 2 * d);
    dm_node *with = dm_joining_take(j, all), *b = R + d;
    if (!pull || !with) return DM_NO_MEMORY;
    dm_status status = dm_joining_pull(j, pull, R);
    if (status != DM_OK) return status;
    for (uint32_t a = 0; a < d; a++) {
        with[a] = dm_mul(g, dm_input(g, 2 * d + 2), dm_input(g, a));
        with[d + a] = dm_input(g, d + a);
    }
    dm_transplant(g, pull, R, d, with, b);
    memset(with, 0, all * sizeof *with);
    dm_inputs(g, with + n + d, 0, d);
    dm_inputs(g, with + n + 2 * d, 2 * d, 2);
    dm_transplant(g, j->g, j->slope + d, d, with, R);
    for (uint32_t a = 0; a < d; a++) R[a] = dm_sub(g, R[a], b[a]);
    return dm_graph_status(g);
}

dm_status dm_joining_free(const dm_joining *j, dm_group *out, dm_compile *compile) {
    const uint32_t d = j->d;
    out->free = out->free_matrix = (dm_kernel){0};
    if (sees_place(j)) return DM_OK;
    dm_graph *g = dm_graph_new(j->arena, 2 * d + 3);
    dm_node *R = dm_joining_take(j, d * (size_t)(d + 2));
    if (!g || !R) return DM_NO_MEMORY;
    dm_status status = find_equation(j, g, R);
    if (status != DM_OK || dm_operations(g, R, 2 * d) > MANY) return status;
    dm_jacobian(g, R, d, 0, d, R + 2 * d);
    status = dm_graph_status(g);
    if (status == DM_OK) status = compile(&out->free, g, R, 2 * d, j->arena);
    if (status == DM_OK) status = compile(&out->free_matrix, g, R, d * (d + 2), j->arena);
    return status;
}
