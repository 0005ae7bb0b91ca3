/* implicit.h - functions that are only known by an equation: y(x) with F(y, x) = 0, as nodes of
 * a graph. A leaf DM_OP_IMPLICIT names the function by its serial number, a chain of DM_OP_WITH
 * adds its arguments one by one, DM_OP_ROOT takes entry k of what comes out: of (f, x[n]) the
 * root y, and S at y where F = dS/dy; of (f, x[n], s[r]), with the matrix J = dF/dy at the root,
 * J^-T s and then J^-1 s. So the chain rule dy = -J^-1 F_x dx,  d(J^-T s) = J^-T (ds - dJ^T J^-T
 * s),  d(J^-1 s) = J^-1 (ds - dJ J^-1 s) closes, and derivatives of any order are made of these
 * nodes. All passes see operations with two operands. A kernel finds the roots first and then
 * does its straight line (dm_root_kernel): y depends on x alone, not on where it was before,
 * since Newton's method begins where the function says; only the last x is kept, with its y. */
#ifndef DM_IMPLICIT_H
#define DM_IMPLICIT_H

#include "graph/graph.h"

enum { DM_ROOT_MOST = 64 }; /* unknowns */

typedef enum {
    DM_ROOT_FOUND,
    DM_ROOT_NONE,     /* Newton's method came to no root from any start */
    DM_ROOT_SINGULAR, /* dF/dy loses rank where it ended */
    DM_ROOT_BRANCH    /* roots, but the branch condition holds at none of them */
} dm_root_outcome;

/* Where a function had no value last, for messages. */
typedef struct {
    dm_root_outcome outcome;
    double residual, condition, branch; /* max |F| there, cond(J), what must be > 0 */
    double *x, *y;                      /* arguments, and the nearest thing to a root */
    uint32_t since; /* roots that were found after it; forgotten when there are many */
} dm_root_trouble;

/* d(w^T F_y u)/d(y, x)[r + n]; nodes NULL: not asked for yet */
typedef struct {
    dm_graph *graph;
    const dm_node *nodes;
} dm_implicit_bend;

typedef struct dm_implicit {
    double serial;             /* whole, > 0: the same function has the same number */
    const char *name, *advice; /* for messages; advice may be NULL */
    uint32_t unknowns, inputs; /* r, n */
    uint32_t starts;           /* where Newton's method may begin, the best first */
    int has_branch, has_value;
    uint64_t angles;         /* bit i: unknown i is an angle in rad, known up to whole turns */
    dm_graph *graph;         /* inputs y[r], x[n], w[r], u[r] */
    const dm_node *equation; /* F[r], F_y[r*r], branch */
    const dm_node *slope;    /* F_x[r*n] */
    dm_implicit_bend *bend;  /* by dm_implicit_find_bend */
    const dm_node *value;    /* S, S_x[n], without has_value none */
    const dm_node *start;    /* [starts*r], of x alone */
    dm_root_trouble *trouble;
    const struct dm_implicit *next; /* of the graph */
} dm_implicit;

/* What a function is made from: nodes of a graph with the inputs y[r], x[n]. */
typedef struct {
    double serial;
    const char *name, *advice;
    uint32_t unknowns, inputs, starts;
    uint64_t angles; /* bit i: unknown i is an angle in rad */
    dm_graph *graph;
    const dm_node *equation; /* [r], or NULL and `value`: F = dS/dy */
    const dm_node *value;
    const dm_node *branch; /* what must be > 0 at the root; NULL: any root will do */
    const dm_node *start;  /* [starts*r] */
} dm_implicit_draft;

/* The function with its derivatives, in `arena`; texts are copied. NULL: *status says why. */
dm_implicit *dm_implicit_make(const dm_implicit_draft *draft, dm_arena *arena, dm_status *status);

/* What second derivatives of f need; NULL without memory. */
const dm_implicit_bend *dm_implicit_find_bend(const dm_implicit *f);

/* The leaf for f in g; g keeps a copy of its own where it has another arena. */
dm_node dm_implicit_leaf(dm_graph *g, const dm_implicit *f);

/* The function of g with that number, or NULL. */
const dm_implicit *dm_implicit_find(const dm_graph *g, double serial);

/* f with arguments a[m], and entry k of it. */
dm_node dm_implicit_with(dm_graph *g, dm_node f, const dm_node *a, uint32_t m);
dm_node dm_implicit_root(dm_graph *g, dm_node with, uint32_t k);

/* What the chain that ends in `with` is: its function (of g's, NULL: none), and a[<= 2
 * DM_ROOT..] arguments. */
uint32_t dm_implicit_length(const dm_graph *g, dm_node with);
const dm_implicit *dm_implicit_read(const dm_graph *g, dm_node with, dm_node *a);

/* True where one of the roots needs an implicit function. */
int dm_has_roots(dm_graph *g, const dm_node *roots, uint32_t m);

/* A function that lately had no value, of g or inside of its functions; NULL: none. forget:
 * begin anew. */
const dm_implicit *dm_root_troubled(const dm_graph *g);
void dm_root_forget(const dm_graph *g);

#endif
