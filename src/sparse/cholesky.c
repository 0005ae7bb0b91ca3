/* cholesky.c - L L^T of CHOLMOD: its own choice of ordering (AMD, METIS where that fills in too
 * much) and of supernodes. */
#include "sparse/factor.h"

#include <string.h>

/* the matrix as CHOLMOD sees it: the upper triangle of a symmetric one */
static cholmod_sparse view(const dm_sparse *A) {
    return (cholmod_sparse){.nrow = (size_t)A->rows,
                            .ncol = (size_t)A->columns,
                            .nzmax = (size_t)A->start[A->columns],
                            .p = A->start,
                            .i = A->row,
                            .x = A->value,
                            .stype = 1,
                            .itype = CHOLMOD_INT,
                            .xtype = CHOLMOD_REAL,
                            .dtype = CHOLMOD_DOUBLE,
                            .sorted = 1,
                            .packed = 1};
}

/* Analysis and numbers. A stop is seen between them, whenever memory is asked for, and in BLAS. */
static dm_status factorize(dm_factor *f, cholmod_sparse *A) {
    cholmod_common *c = &f->common;
    f->L = cholmod_analyze(A, c);
    if (!f->L) return DM_NO_MEMORY;
    if (dm_library_is_stopped()) return DM_STOPPED;
    cholmod_factorize(A, f->L, c);
    if (c->status == CHOLMOD_NOT_POSDEF) return DM_SINGULAR;
    return c->status == CHOLMOD_OK ? DM_OK : DM_NO_MEMORY;
}

dm_status dm_cholesky_factor(dm_factor *f, double *condition) {
    cholmod_sparse A = view(f->A);
    dm_library_enter(f);
    cholmod_start(&f->common);
    f->common.print = 0;
    f->common.final_ll = 1;
    const dm_status status = factorize(f, &A);
    *condition = status == DM_OK ? cholmod_rcond(f->L, &f->common) : 0.0;
    dm_library_leave();
    return f->stopped ? DM_STOPPED : status;
}

/* CHOLMOD keeps its own x and workspace for the next solve */
dm_status dm_cholesky_solve(dm_factor *f, double *x, const double *b) {
    const size_t n = (size_t)f->A->columns;
    cholmod_dense right = {.nrow = n,
                           .ncol = 1,
                           .nzmax = n,
                           .d = n,
                           .x = (double *)(uintptr_t)b,
                           .xtype = CHOLMOD_REAL,
                           .dtype = CHOLMOD_DOUBLE};
    dm_library_enter(f);
    const int fine =
        cholmod_solve2(CHOLMOD_A, f->L, &right, NULL, &f->x, NULL, &f->y, &f->e, &f->common);
    dm_library_leave();
    if (!fine) return DM_NO_MEMORY;
    memcpy(x, f->x->x, n * sizeof *x);
    return DM_OK;
}

/* D of L D L^T has the signs of the eigenvalues (Sylvester); column j of L begins with D_j */
static int64_t negatives_of(const cholmod_factor *L) {
    const int *start = L->p;
    const double *x = L->x;
    int64_t negatives = 0;
    for (size_t j = 0; j < L->n; j++) negatives += x[start[j]] < 0.0;
    return negatives;
}

/* P A P^T with its upper triangle stored */
static cholmod_sparse *permuted(dm_factor *f, cholmod_sparse *A) {
    cholmod_sparse *lower = cholmod_ptranspose(A, 2, f->L->Perm, NULL, 0, &f->common);
    return lower ? cholmod_ptranspose(lower, 2, NULL, NULL, 0, &f->common) : NULL;
}

/* L D L^T, some rows at a time, so that a stop is seen between them: no BLAS is in it */
static dm_status factorize_rows(dm_factor *f, cholmod_sparse *A) {
    enum { ROWS = 32 };
    cholmod_common *c = &f->common;
    double beta[2] = {0.0, 0.0};
    f->L = cholmod_analyze(A, c);
    cholmod_sparse *S = f->L ? permuted(f, A) : NULL;
    if (!S) return DM_NO_MEMORY;
    for (size_t row = 0; row < S->nrow && c->status == CHOLMOD_OK; row += ROWS) {
        const size_t end = row + ROWS < S->nrow ? row + ROWS : S->nrow;
        if (dm_library_is_stopped()) return DM_STOPPED;
        cholmod_rowfac(S, NULL, beta, row, end, f->L, c);
    }
    if (c->status == CHOLMOD_NOT_POSDEF) return DM_SINGULAR;
    return c->status == CHOLMOD_OK ? DM_OK : DM_NO_MEMORY;
}

/* Simplicial, since supernodes have L L^T only. */
dm_status dm_inertia(int64_t *negatives, const dm_sparse *A, dm_arena *arena,
                     volatile const int *stop) {
    dm_factor f = {.A = A, .arena = arena, .stop = stop};
    cholmod_sparse symmetric = view(A);
    dm_library_enter(&f);
    cholmod_start(&f.common);
    f.common.print = 0;
    f.common.supernodal = CHOLMOD_SIMPLICIAL;
    f.common.final_ll = 0;
    const dm_status status = factorize_rows(&f, &symmetric);
    if (status == DM_OK) *negatives = negatives_of(f.L);
    dm_library_leave();
    dm_library_release(&f);
    return f.stopped ? DM_STOPPED : status;
}
