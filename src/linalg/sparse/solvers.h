/* solvers.h - the table of functions by which a loaded library of solvers is used: factorizations
 * and eigenpairs of sparse symmetric matrices. src/sparse has one of them; nothing else of dmlua
 * knows which library stands behind it. */
#ifndef DM_SOLVERS_H
#define DM_SOLVERS_H

#include "linalg/sparse/sparse.h"

/* A factorization; `solve` may be called as often as wanted, by one thread at a time. */
typedef struct dm_factor dm_factor;

typedef enum { DM_CHOLESKY, DM_LU } dm_factorization;

/* Of a pattern: the ordering and what else of a factorization depends on no number. */
typedef struct dm_analysis dm_analysis;

/* Eigenpairs S x = lambda M x, S symmetric, M = diag(mass) with mass >= 0, those with the largest
 * 1 / (lambda - shift) (`above`) or the largest modulus of it. */
typedef struct {
    const dm_sparse *S;
    const double *mass;       /* [n] */
    const dm_factor *shifted; /* of S - shift M */
    double shift;
    int32_t count; /* how many, less than n */
    int above;
    const double *start; /* [n] the vector that the iteration begins with */
    volatile const int *stop;
    double *value;  /* [count] set, as they come */
    double *vector; /* [count][n] set, x^T M x = 1 */
    int32_t solves; /* set: how many there were */
} dm_eigen_problem;

typedef struct dm_solvers {
    const char *name; /* "CHOLMOD, UMFPACK, ARPACK" */
    /* The factorization of a square matrix, for Cholesky of the symmetric one whose upper triangle
     * it has. A must stay. Its memory comes from the arena's allocator. DM_SINGULAR: it is
     * singular, for Cholesky not positive definite; DM_NO_MEMORY; DM_STOPPED where the table is of
     * somebody who can stop it. *condition: an estimate of the reciprocal condition, from the
     * pivots. */
    dm_status (*factor)(dm_factor **out, dm_factorization kind, const dm_sparse *A, dm_arena *arena,
                        double *condition);
    /* For several matrices of one pattern: its analysis, found once, and factors by it. */
    dm_status (*analyse)(dm_analysis **out, dm_factorization kind, const dm_sparse *A,
                         dm_arena *arena);
    dm_status (*factor_by)(dm_factor **out, dm_factorization kind, const dm_sparse *A,
                           const dm_analysis *known, dm_arena *arena, double *condition);
    /* Floating-point operations of such factors, an estimate. */
    double (*operations)(const dm_analysis *known);
    /* Factors of f's own matrix, whose values have changed, in the memory that they have; known:
     * its analysis. On a failure f can only be released. DM_TOO_LARGE: they are better made anew,
     * where they can be stopped. */
    dm_status (*refactor)(dm_factor *f, const dm_analysis *known);
    /* x[n] = A^-1 b[n] */
    dm_status (*solve)(const dm_factor *f, double *x, const double *b);
    /* Gives the memory back, where that is not a collector's task. */
    void (*release)(dm_factor *f);
    void (*release_analysis)(dm_analysis *a);
    /* Work arrays come from the arena. DM_NO_CONVERGENCE, DM_NO_MEMORY, DM_STOPPED. */
    dm_status (*eigen)(dm_eigen_problem *problem, dm_arena *arena);
    /* How many eigenvalues of a symmetric matrix are negative, by L D L^T without exchanges.
     * DM_SINGULAR: a pivot is 0; others as for a factorization. */
    dm_status (*inertia)(int64_t *negatives, const dm_sparse *A, dm_arena *arena);
} dm_solvers;

/* The symbol of the library: const dm_solvers dm_solvers_table. */
#define DM_SOLVERS_SYMBOL "dm_solvers_table"

#endif
