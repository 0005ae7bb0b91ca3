/* factor.h - one factorization: what the files of this room share. CHOLMOD and UMFPACK get their
 * memory from the allocator of an arena, block by block, so that a refusing allocator is felt here
 * too and a collector sees it. */
#ifndef DM_FACTOR_H
#define DM_FACTOR_H

#include "linalg/sparse/solvers.h"

#include <suitesparse/cholmod.h>

/* a block of a library: stands in front of it, in the list of its factorization */
typedef struct dm_library_block dm_library_block;

struct dm_factor {
    dm_factorization kind;
    const dm_sparse *A;
    dm_arena *arena;          /* whose allocator gives */
    dm_library_block *blocks; /* all that were given, newest first */
    /* Cholesky: workspace and factors */
    cholmod_common common;
    cholmod_factor *L;
    cholmod_dense *y, *e;     /* of solves: kept for the next */
    void *numeric, *symbolic; /* LU; of an analysis */
    double operations;        /* of an analysis */
};

/* L, or symbolic, without numbers */
struct dm_analysis {
    dm_factor f;
};

/* Between these two the allocation functions of SuiteSparse are ours and give to f. They nest
 * nowhere, and what stood there before comes back. */
void dm_library_enter(dm_factor *f);
void dm_library_leave(void);

/* All blocks back to the allocator. */
void dm_library_release(dm_factor *f);

/* Both of one factorization: Cholesky's is of the symmetric matrix in the upper triangle. known: of
 * the pattern, or NULL. */
dm_status dm_cholesky_analyse(dm_factor *f);
dm_status dm_cholesky_factor(dm_factor *f, const dm_analysis *known, double *condition);
dm_status dm_cholesky_refactor(dm_factor *f);
dm_status dm_cholesky_solve(dm_factor *f, double *x, const double *b);
dm_status dm_inertia(int64_t *negatives, const dm_sparse *A, dm_arena *arena);
/* LU of the whole matrix; its solves refine until rounding. */
dm_status dm_umfpack_analyse(dm_factor *f);
dm_status dm_umfpack_factor(dm_factor *f, const dm_analysis *known, double *condition);
dm_status dm_umfpack_refactor(dm_factor *f, const dm_analysis *known);
dm_status dm_umfpack_solve(dm_factor *f, double *x, const double *b);
/* eigen of the table */
dm_status dm_lanczos(dm_eigen_problem *problem, dm_arena *arena);

/* f's own solve */
dm_status dm_factor_solve(const dm_factor *f, double *x, const double *b);

#endif
