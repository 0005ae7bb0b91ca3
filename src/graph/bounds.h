/* bounds.h - a graph in interval arithmetic: what its nodes can be where the inputs are anywhere
 * in a box. Rounded outwards, so that neither the function nor its kernel leaves the bounds. */
#ifndef DM_BOUNDS_H
#define DM_BOUNDS_H

#include "graph/interval.h"

/* value[dm_graph_size] = bounds of every node, the inputs being anywhere in in[inputs]. A node
 * whose operands may be outside its domain, and one that only an equation defines, is unbounded:
 * so a graph is best a copy of what is needed (dm_graph_copy). Bounds are those of interval
 * extension: tight where every input stands once, else up to first order in the size of the box. */
void dm_bounds(const dm_graph *g, const dm_interval *in, dm_interval *value);

/* Inputs that move along a line or curve in the box at rates in rate_in[inputs]: rate[] = bounds of
 * how fast every node then changes, by the chain rule; value[] = dm_bounds of the same box. */
void dm_bounds_rate(const dm_graph *g, const dm_interval *rate_in, const dm_interval *value,
                    dm_interval *rate);

/* The derivative of an operation with one operand, where that is a and the value y. */
dm_interval dm_bounds_slope(dm_op op, dm_interval a, dm_interval y);

/* The same with the rates of dm_bounds_rate: bend[] = bounds of the second derivatives of the nodes
 * along a curve whose inputs have those in bend_in[inputs]; NULL: a straight line. */
void dm_bounds_bend(const dm_graph *g, const dm_interval *bend_in, const dm_interval *value,
                    const dm_interval *rate, dm_interval *bend);

/* weight[dm_graph_size] holds weights w_r of some nodes r, zeros elsewhere: adds to every node x
 * sum_r w_r |dr/dx|, each at most what it can be in the box of value[]. Infinite: not bounded. */
void dm_bounds_weight(const dm_graph *g, const dm_interval *value, double *weight);

#endif
