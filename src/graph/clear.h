/* clear.h - where along a line no root of a graph can be zero, by interval arithmetic: a proof up
 * to the finest interval that is looked at. */
#ifndef DM_CLEAR_H
#define DM_CLEAR_H

#include "graph/bounds.h"

/* roots[m] of g on the line x + t d, |t| <= reach, x and d as long as the inputs; looked at down to
 * intervals of fine (1 + |t|). found: an interval in which none is zero, in order; those that touch
 * come one after the other. box[inputs], value[dm_graph_size], vague[m] are scratch: a root whose
 * bounds exclude a zero hardly anywhere, as of a - a, is vague, and left out. */
typedef struct {
    const dm_graph *g;
    const dm_node *roots;
    uint32_t m, inputs;
    const double *x, *d;
    double reach, fine;
    dm_interval *box, *value;
    uint32_t *vague; /* in how many of the finest intervals it may be zero */
    void (*found)(void *ud, double from, double to);
    void *ud;
} dm_clear;

void dm_clear_line(dm_clear *line);

#endif
