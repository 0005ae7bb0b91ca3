/* mass_form.h - the quadratic form in v that stands in L, read off its graph. */
#ifndef DM_MASS_FORM_H
#define DM_MASS_FORM_H

#include "graph/bounds.h"

enum { DM_FORM_MOST = 24, DM_FORM_PARTS = 8 };

/* w = a node of first degree in v times the root of some factors (r^2 for r theta' of polar
 * coordinates). */
typedef struct {
    dm_node node;
    uint32_t count;
    dm_node square[DM_FORM_PARTS]; /* factors of w w */
} dm_form_w;

/* What of a coefficient is taken into the w_i, not into the bounds of the c_ij: nothing, factors
 * that are not bounded, cosines besides, one for a pair. */
enum { DM_FORM_PLAIN, DM_FORM_FACTORS, DM_FORM_COSINES };

/* L = sum_ij c_ij w_i w_j / 2 + what is linear in v + what is free of it, c symmetric. Of a graph
 * that holds nothing else. */
typedef struct {
    const dm_graph *g;
    dm_node L;
    uint32_t first, velocities; /* v are so many inputs, from that one on */
    unsigned char *degree;      /* of the nodes in v; from three on as one */
    dm_interval *value;         /* bounds of all nodes */
    int apart;                  /* what is not in the c_ij */
    long visits;                /* nodes that may be looked at yet: they may share many others */
    uint32_t count;             /* of the w_i, whose squares stand in L */
    dm_form_w w[DM_FORM_MOST];
    dm_interval c[DM_FORM_MOST][DM_FORM_MOST];
    dm_node turn[DM_FORM_MOST][DM_FORM_MOST]; /* cosines beside c_ij; 0: none */
} dm_form;

/* The degrees of all nodes, f->degree[]. */
void dm_form_degrees(dm_form *f);

/* w and bounds c of the coefficients, from those of the nodes, f->value[], and f->apart. 0: L is
 * not written so, as sums of squares and of products of what is squared elsewhere. */
int dm_form_read(dm_form *f);

/* Are cosines that stand apart those of differences x_i - x_j, of an x_i for every w_i, as
 * of links that turn in a plane? Then they are products of unit vectors, and (c_ij cos) has no
 * negative value where (c_ij) has none (Schur's product theorem). */
int dm_form_turns(const dm_form *f);

/* marks[n] = 1: a node free of v that multiplies or divides one that is not. */
void dm_form_factors(const dm_form *f, unsigned char *marks);

#endif
