/* body_sum.h - sums over equal bodies, neighbours or pairs that a graph keeps as one leaf: the
 * term is a graph of its own, made once, and columns say where its inputs come from in every
 * round (a round is one body, or one pair, of the sum). The value of the sum is an input of the
 * graph behind its own ones, so that all algebra works on L(x, S1, S2, ...); the chain rule
 * joins dL/dS with the loops (chain/loops.h). */
#ifndef DM_BODY_SUM_H
#define DM_BODY_SUM_H

#include "graph/graph.h"

/* Input c of the term: entry first + step * body, of the graph's inputs or of `data`. The body is
 * i in round i, or its partner i + shift when `partner` is set; step 0: the same in all rounds.
 * In sums over cells of a mesh a round is a cell, and the body is index[i]: one of its faces. In
 * sums of virtual work a column that is `varied` stands for the displacement of its entry. */
typedef struct {
    uint32_t first, step;
    int partner, varied;
    const double *data;    /* numbers instead of inputs, kept by the caller; NULL: inputs */
    const uint32_t *index; /* [bodies], kept by the caller; NULL: as above */
} dm_column;

enum { DM_SUM_COLUMNS = 96 }; /* at most */

/* What keeps an entry of q from being moved by its momentum: it is fixed, or it has no mass and
 * follows from its own equation, dL/dq = 0. */
enum { DM_HELD = 1, DM_MASSLESS = 2 };

/* sum over shifts from .. to, over rounds i: single bodies have the shift 0, neighbours one
 * other, pairs all of 1 .. bodies - 1 */
typedef struct dm_sum {
    dm_graph *term; /* inputs: the columns */
    dm_node value;
    const dm_column *column;
    uint32_t columns, bodies, from, to;
    int periodic; /* the partner of the last body is the first */
    /* pairs nearer than `within` alone (0: all pairs): columns 0 .. axes - 1 are the positions of
     * a body, those from `partner` on its partner's, of which the nearest image in a box counts.
     * Such a sum always stays a loop, with lists that are kept for moves up to margin / 2 */
    double within, margin;
    double box[3]; /* sides, 0: not periodic */
    uint32_t axes, partner;
    int cells; /* over cells of a mesh: it always stays a loop */
    int work;  /* virtual work of forces (chain/virtual_work.h), linear in columns that are varied:
                * no root depends on it */
    /* of sums over cells: DM_HELD and DM_MASSLESS entries of q, kept by the caller; NULL: none */
    const uint8_t *held; /* [coordinates] */
    uint32_t coordinates;
    uint32_t sphere;     /* of those: q is cut into unit vectors of so many entries; 0: it is not */
    uint32_t input;      /* of the graph that stands for the sum */
    uint32_t call;       /* which of all sums that were asked for while it was traced */
    struct dm_sum *next; /* of the graph, newest first */
} dm_sum;

/* The leaf for a copy of *s (input and next are set here); 0 without memory. */
dm_node dm_sum_leaf(dm_graph *g, const dm_sum *s);

/* Sums of g, NULL when it has none; inputs of g without them. */
const dm_sum *dm_sums(const dm_graph *g);
uint32_t dm_sum_first(const dm_graph *g);

/* A sum of g that is over cells of a mesh, or NULL. */
const dm_sum *dm_sum_over_cells(const dm_graph *g);

/* One over pairs within a distance, or NULL. */
const dm_sum *dm_sum_over_near(const dm_graph *g);

/* Rounds at one shift, and in all. */
static inline uint32_t dm_sum_rounds(const dm_sum *s, uint32_t shift) {
    return s->periodic ? s->bodies : s->bodies - shift;
}
double dm_sum_all_rounds(const dm_sum *s);

/* Entry that column c reads in round i. */
static inline size_t dm_sum_entry(const dm_sum *s, const dm_column *c, uint32_t i, uint32_t shift) {
    if (c->index) return c->first + (size_t)c->step * c->index[i];
    uint32_t body = c->partner ? i + shift : i;
    if (body >= s->bodies) body -= s->bodies;
    return c->first + (size_t)c->step * body;
}

/* Value of the term for in[columns], node by node; work[nodes of the term]. */
double dm_sum_term(const dm_sum *s, const double *in, double *work);

/* The same sums of the same terms, as far as `fresh` has them: what was added to the terms of
 * `kept` since makes no difference. */
int dm_sums_same(const dm_graph *kept, const dm_graph *fresh);

/* The same pattern, columns and data; the terms may differ. */
int dm_sum_alike(const dm_sum *a, const dm_sum *b);

/* The same sum of another term with the same columns. */
dm_node dm_sum_of(dm_graph *g, const dm_sum *like, dm_node value);

/* root of g in the new graph `to` (inputs: those of g without sums), every round written out. */
dm_node dm_sum_write_out(dm_graph *to, dm_graph *g, dm_node root);

#endif
