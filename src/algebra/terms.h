/* terms.h - a graph seen as sums and products of many parts, hash-consed like the graph.
 * A product is of powers of terms, exponents counted in halves: u^(-3/2) has e = -3. A sum is
 * of terms with coefficients. Everything else is an atom. A value is c * term; term 0 is 1. */
#ifndef DM_TERMS_H
#define DM_TERMS_H

#include "graph/graph.h"

typedef uint32_t dm_term;

typedef enum { DM_TERM_ATOM, DM_TERM_PRODUCT, DM_TERM_SUM } dm_term_kind;

typedef struct {
    double c; /* sum and atom: coefficient of the part; product: 1 */
    dm_term t;
    int32_t e; /* product: exponent in halves; else 0 */
} dm_part;

typedef struct {
    uint8_t kind;
    uint8_t op;            /* of an atom */
    uint8_t nonnegative;   /* >= 0 wherever it is a number */
    uint32_t first, count; /* the parts it is known by; an atom's are its operands */
    uint32_t body, size;   /* the parts it is made of now */
    dm_node node;          /* of a leaf; when written: the node that it became */
} dm_term_entry;

typedef struct {
    double c;
    dm_term t;
} dm_scaled;

typedef struct {
    dm_graph *g;
    dm_arena *arena; /* of the terms; the graph has its own */
    dm_term_entry *entries;
    uint32_t size, capacity;
    dm_part *parts;
    uint32_t parts_size, parts_capacity;
    dm_term *table; /* open addressing, 0 is free */
    uint32_t mask;
    dm_part *scratch; /* parts on their way to a term */
    uint32_t scratch_capacity;
    void *stack; /* of a walk, as the next two: dm_terms_order */
    dm_term *order;
    uint32_t *uses;
    uint32_t walk_capacity;
    int unfit; /* a coefficient left the normal range: leave the graph as it is */
} dm_terms;

/* An empty store, with room for what so many operations become. */
int dm_terms_open(dm_terms *s, dm_graph *g, uint32_t operations, dm_arena *arena);

/* Room for `count` parts in s->scratch; 0 without memory. */
int dm_terms_reserve(dm_terms *s, uint32_t count);

/* a b of two coefficients; a product that is lost to underflow makes the graph unfit. */
double dm_terms_times(dm_terms *s, double a, double b);

/* The term of this content. Products and sums bring parts that are sorted and merged. */
dm_term dm_terms_make(dm_terms *s, const dm_term_entry *head, const dm_part *parts);

/* c * (product of s->scratch[count]), parts in any order, equal bases gathered. */
dm_scaled dm_terms_product(dm_terms *s, double c, uint32_t count);

/* sum of s->scratch[count], like terms gathered, a common coefficient in front. */
dm_scaled dm_terms_sum(dm_terms *s, uint32_t count);

/* out[m] = roots as terms. 0 without memory, or where the graph is unfit. */
int dm_terms_read(dm_terms *s, const dm_node *roots, uint32_t m, dm_scaled *out);

/* Replace what t is made of by s->scratch[count]. */
void dm_terms_rewrite(dm_terms *s, dm_term t, uint32_t count);

/* What the roots are made of, parts before wholes: order[], and how often each is a part:
 * uses[size of the store]. Both hold until the next call; gives their number, 0 without memory. */
uint32_t dm_terms_order(dm_terms *s, const dm_scaled *roots, uint32_t m, dm_term **order,
                        uint32_t **uses);

/* The factors of t (a long product counts as one), copied to `to`; gives their number. */
uint32_t dm_terms_factors(const dm_terms *s, dm_term t, dm_part *to);

enum { DM_MOST_FACTORS = 12 }; /* of a product that is still opened */

/* Rewriting: products of sums multiplied out, so that like terms meet; at the start only. What
 * several sums share may stay closed (`closes`) where nothing in it meets; gives the number of
 * such sums. */
uint32_t dm_terms_expand(dm_terms *s, dm_scaled *roots, uint32_t m, int closes);

/* Rewriting: common factors of sums. */
void dm_terms_factor(dm_terms *s, const dm_scaled *roots, uint32_t m);

/* out[m] = roots as nodes of the graph. */
void dm_terms_write(dm_terms *s, const dm_scaled *roots, uint32_t m, dm_node *out);

#endif
