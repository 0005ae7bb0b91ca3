/* rounds.h - one sum over bodies, neighbours or pairs (algebra/body_sum.h): its value, and what it
 * gives to a gradient. */
#ifndef DM_ROUNDS_H
#define DM_ROUNDS_H

#include "chain/loops.h"
#include "chain/pairs.h"

/* the kernel of a term or of its derivatives, one round or `lanes` rounds at a time */
typedef struct {
    const dm_sum *sum;
    dm_kernel one, many;
    dm_pairs *pairs; /* a sum over pairs has rows of its own, and nothing of what follows */
    uint32_t lanes;  /* 0: one by one */
    uint32_t outputs;
    uint8_t column[DM_LOOP_COLUMNS]; /* [outputs] what is differentiated for */
} dm_rounds;

/* Of the term itself, and of its derivatives by the columns that are inputs below m: no outputs
 * where all of these vanish. */
dm_status dm_rounds_of_value(dm_rounds *l, const dm_sum *s, dm_compile *compile, dm_arena *arena);
dm_status dm_rounds_of_slopes(dm_rounds *l, const dm_sum *s, uint32_t m, dm_compile *compile,
                              dm_arena *arena);

/* The sum S at x, and out += factor dS/dx. */
double dm_rounds_value(const dm_rounds *l, const double *x);
void dm_rounds_slopes(const dm_rounds *l, double *out, double factor, const double *x);

#endif
