/* stage_factor.h - the factors of a sparse step equation, made anew when its numbers change. Its
 * pattern does not: the ordering is found once, which takes longer than the factors of a mesh. */
#ifndef DM_STAGE_FACTOR_H
#define DM_STAGE_FACTOR_H

#include "linalg/sparse/solvers.h"

typedef struct {
    dm_factor *factor;     /* NULL: none */
    dm_factorization kind; /* of it */
    dm_analysis *known[2]; /* of Cholesky and LU, NULL: not looked for yet */
    dm_arena arena, plans; /* of the factors, of what is known */
} dm_stage_factor;

/* Memory from the allocator of `from`. */
void dm_stage_factor_open(dm_stage_factor *f, const dm_arena *from);

/* The factors of S, the same at every call with other values, by Cholesky where it is symmetric and
 * positive definite, else LU; on a failure there are none. once: no other values will come, so that
 * nothing is kept for them. */
dm_status dm_stage_factor_make(dm_stage_factor *f, const dm_solvers *solvers, const dm_sparse *S,
                               int symmetric, int once);

/* The factors go; everything goes. */
void dm_stage_factor_drop(dm_stage_factor *f, const dm_solvers *solvers);
void dm_stage_factor_close(dm_stage_factor *f, const dm_solvers *solvers);

#endif
