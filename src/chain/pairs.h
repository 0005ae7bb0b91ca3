/* pairs.h - sums over pairs of bodies (algebra/body_sum.h), all of them or those nearer than a
 * distance, as loops along arrays (code/loops/array_loop.h).
 *
 * Columns of the bodies are first laid side by side, each an array. Row i is the pairs of body i
 * with bodies j > i, and one run of the loop: what i has is a scalar of it. Slopes by columns of j
 * are added to their places in an array, those by columns of i written side by side and added in
 * eight partial sums (partner j to sum j mod 8). Rows are dealt out to strips, i to strip
 * i mod DM_PAIR_STRIPS, and a strip has arrays of its own, which are added at the end in their
 * order: so an entry has one writer, and lanes, backends and threads give the same bits.
 *
 * Between calls only the list of neighbours lasts (chain/near.h), on which no bit depends, and the
 * team that was set. */
#ifndef DM_PAIRS_H
#define DM_PAIRS_H

#include "algebra/body_sum.h"
#include "chain/near.h"
#include "chain/team.h"
#include "code/loops/array_loop.h"

/* strips of sums over many bodies, others have one; bodies from which on they are many */
enum { DM_PAIR_STRIPS = 8, DM_PAIR_MANY = 64, DM_PAIR_COLUMNS = 24 };

/* functions of the columns of a sum, made ready for rows of pairs */
typedef struct {
    const dm_sum *sum;
    dm_array_loop loop; /* outputs in the order of `column` */
    uint32_t outputs;
    int slopes;                      /* outputs are derivatives by the columns column[outputs] */
    uint8_t column[DM_PAIR_COLUMNS]; /* else there is one output, the term */
    uint32_t strips;
    dm_near *near; /* NULL: all pairs */
    dm_team *team; /* threads that deal out the strips, while they are lent; NULL: one */
    size_t pitch;  /* doubles from array to array; more than bodies + 8 */
    double *array; /* [columns][pitch] what the bodies have */
    double *strip; /* [strips]: arrays of a strip, see strip_of */
    size_t size;   /* doubles of a strip */
} dm_pairs;

/* A sum over pairs: from < to. roots[outputs] of its term; with `slopes` they are its derivatives
 * by the columns column[outputs], else one function whose values are added. */
dm_status dm_pairs_open(dm_pairs *p, const dm_sum *s, const dm_node *roots, uint32_t outputs,
                        const uint8_t *column, int slopes, dm_compile *compile, dm_arena *arena);

/* The sum itself, with compensation. */
double dm_pairs_value(const dm_pairs *p, const double *x);

/* out[entry] += factor dS/d entry. */
void dm_pairs_slopes(const dm_pairs *p, double *out, double factor, const double *x);

/* May threads share the strips? Native code alone keeps nothing between rounds. */
int dm_pairs_shared(const dm_pairs *p);

#endif
