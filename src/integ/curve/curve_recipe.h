/* curve_recipe.h - a one-step method that is not linear in the values of f, as it was traced for
 * one dim Q: what it does is a graph, not a table of numbers. A call asks for f itself or for a
 * derivative of it along some directions (Taylor methods), and is answered by symbols. */
#ifndef DM_CURVE_RECIPE_H
#define DM_CURVE_RECIPE_H

#include "graph/graph.h"

enum { DM_RECIPE_DIRECTIONS = 4 }; /* at most, of a call */

/* Inputs of the graph: x[2n], h, answers k[calls][2n] with room for DM_CURVE_STAGES, t. */
typedef struct dm_curve_recipe {
    uint32_t n;
    uint32_t serial; /* no two have the same */
    int calls;
    int timed;             /* every call says its time */
    const int *directions; /* [calls]; 0: f itself */
    dm_graph *graph;
    const dm_node *out; /* of every call x[2n], t, directions (u[2n], dt) each; the end [2n] */
} dm_curve_recipe;

#endif
