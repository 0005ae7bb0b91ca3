/* matching.h - an acyclic matching of the cells of a complex, and what it carries (Leok 3.11;
 * Forman; Mrozek and Batko's coreductions).
 *
 * A pair (a, b) is a cell a and a coface b of it; what is in no pair is critical. Pairs are found
 * in the order in which the complex could be built from nothing: when b comes, all of its faces
 * but a are there. So with c = [b : a] = +-1 and tau = db - c a
 *   h(a) = c (b - h(tau)),  h(b) = h(critical) = 0
 * ends, and dh + hd = 1 - g f in integers, where f takes a chain to the critical cells that are
 * left of it and g(m) = m - h(dm). The critical cells with the boundary f d have the homology of
 * the complex: few cells stand for many. */
#ifndef DM_MATCHING_H
#define DM_MATCHING_H

#include "dec/complex.h"

typedef enum {
    DM_CELL_CRITICAL,
    DM_CELL_LOWER, /* the a of a pair */
    DM_CELL_UPPER, /* the b */
    DM_CELL_ABSENT /* of the part that homology is relative to */
} dm_cell_kind;

/* Arrays of degree k have count[k] entries, in the numbering of the complex. */
typedef struct {
    const dm_complex *K;
    uint8_t *kind[DM_DIMENSION + 1];     /* dm_cell_kind */
    uint32_t *partner[DM_DIMENSION + 1]; /* the other one of a pair, of a neighbouring degree */
    uint32_t *order[DM_DIMENSION + 1];   /* cells in the order in which they come */
    uint32_t *time[DM_DIMENSION + 1];    /* the place of a cell in `order` */
    uint32_t present[DM_DIMENSION + 1];  /* how many are in `order`: all but the absent ones */
    uint32_t criticals[DM_DIMENSION + 1];
    uint32_t *critical[DM_DIMENSION + 1]; /* ascending */
    uint32_t core[DM_DIMENSION + 1];      /* cells that collapses left over */
} dm_matching;

/* How it is made. absent[k]: NULL, or a byte for every cell, not 0 for cells of a subcomplex that
 * is taken as nothing. hub: the vertex to begin with, UINT32_MAX for the first one. collapse: first
 * take away free faces with what they are free in, never the hub. */
typedef struct {
    const uint8_t *absent[DM_DIMENSION + 1];
    uint32_t hub;
    int collapse;
} dm_matching_wish;

/* Time and memory linear in K. DM_OK, DM_NO_MEMORY or DM_STOPPED. */
dm_status dm_matching_build(dm_matching *M, dm_arena *arena, const dm_complex *K,
                            const dm_matching_wish *wish, volatile const int *stop);

/* ---- chains ---- */

typedef struct {
    uint32_t cell;
    int64_t coefficient;
} dm_term;

/* Work of one degree; between calls of dm_flow_run nothing is in it. */
typedef struct {
    const dm_matching *M;
    uint32_t k;
    int64_t *sum;    /* [count[k]] the chain that is left */
    uint8_t *listed; /* [count[k]] is it in the heap? */
    uint32_t *heap;  /* places in `order`, the last one on top */
    uint32_t heaped;
    dm_term *upper; /* h of the chain, of degree k + 1 */
    uint32_t uppers;
    dm_term *rest; /* f of the chain: critical cells of degree k, the last in order first */
    uint32_t rests;
} dm_flow;

dm_status dm_flow_open(dm_flow *w, dm_arena *arena, const dm_matching *M, uint32_t k);

/* Add a term to the chain. 0 where a coefficient leaves 64 bits. */
int dm_flow_add(dm_flow *w, uint32_t cell, int64_t x);

/* h and f of what was added, in w->upper and w->rest until the next call. DM_OK, DM_TOO_LARGE
 * where a coefficient leaves 64 bits, DM_STOPPED. */
dm_status dm_flow_run(dm_flow *w, volatile const int *stop);

/* ---- cochains: the transposes ---- */

/* beta, of degree k, from alpha of degree k + 1 (or NULL for 0) and its own values on critical
 * cells, which stay: h^T alpha + f^T beta. */
void dm_matching_cocone(const dm_matching *M, uint32_t k, const double *alpha, double *beta);

/* g^T alpha: out[criticals[k]] from alpha of degree k and h^T alpha of degree k - 1. */
void dm_matching_gather(const dm_matching *M, uint32_t k, const double *alpha, const double *below,
                        double *out);

#endif
