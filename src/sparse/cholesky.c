/* cholesky.c - L L^T of CHOLMOD: its own choice of ordering (AMD, METIS where that fills in too
 * much) and of supernodes. */
#include "sparse/factor.h"

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

/* the numbers of f->L */
static dm_status fill_in(dm_factor *f, cholmod_sparse *A) {
    cholmod_common *c = &f->common;
    cholmod_factorize(A, f->L, c);
    if (c->status == CHOLMOD_NOT_POSDEF) return DM_SINGULAR;
    return c->status == CHOLMOD_OK ? DM_OK : DM_NO_MEMORY;
}

/* analysis, where none is known, and numbers */
static dm_status factorize(dm_factor *f, cholmod_sparse *A, const dm_analysis *known) {
    cholmod_common *c = &f->common;
    f->L = known ? cholmod_copy_factor(known->f.L, c) : cholmod_analyze(A, c);
    return f->L ? fill_in(f, A) : DM_NO_MEMORY;
}

/* between dm_library_enter and dm_library_leave */
static void begin(dm_factor *f) {
    cholmod_start(&f->common);
    f->common.print = 0;
    f->common.final_ll = 1;
}

dm_status dm_cholesky_analyse(dm_factor *f) {
    cholmod_sparse A = view(f->A);
    dm_library_enter(f);
    begin(f);
    f->L = cholmod_analyze(&A, &f->common);
    f->operations = f->common.fl;
    dm_library_leave();
    return f->L ? DM_OK : DM_NO_MEMORY;
}

dm_status dm_cholesky_factor(dm_factor *f, const dm_analysis *known, double *condition) {
    cholmod_sparse A = view(f->A);
    dm_library_enter(f);
    begin(f);
    const dm_status status = factorize(f, &A, known);
    *condition = status == DM_OK ? cholmod_rcond(f->L, &f->common) : 0.0;
    dm_library_leave();
    return status;
}

dm_status dm_cholesky_refactor(dm_factor *f) {
    cholmod_sparse A = view(f->A);
    dm_library_enter(f);
    const dm_status status = fill_in(f, &A);
    dm_library_leave();
    return status;
}

/* a vector as CHOLMOD sees it */
static cholmod_dense view_vector(const double *x, size_t n) {
    return (cholmod_dense){.nrow = n,
                           .ncol = 1,
                           .nzmax = n,
                           .d = n,
                           .x = (double *)(uintptr_t)x,
                           .xtype = CHOLMOD_REAL,
                           .dtype = CHOLMOD_DOUBLE};
}

/* x has the size that CHOLMOD asks for, so it writes there; its workspace stays for the next. */
dm_status dm_cholesky_solve(dm_factor *f, double *x, const double *b) {
    const size_t n = (size_t)f->A->columns;
    cholmod_dense right = view_vector(b, n), left = view_vector(x, n), *place = &left;
    dm_library_enter(f);
    const int fine =
        cholmod_solve2(CHOLMOD_A, f->L, &right, NULL, &place, NULL, &f->y, &f->e, &f->common);
    dm_library_leave();
    return fine && place == &left ? DM_OK : DM_NO_MEMORY;
}

/* D of L D L^T has the signs of the eigenvalues (Sylvester); column j of L begins with D_j */
static int64_t negatives_of(const cholmod_factor *L) {
    const int *start = L->p;
    const double *x = L->x;
    int64_t negatives = 0;
    for (size_t j = 0; j < L->n; j++) negatives += x[start[j]] < 0.0;
    return negatives;
}

/* Simplicial, since supernodes have L L^T only. */
dm_status dm_inertia(int64_t *negatives, const dm_sparse *A, dm_arena *arena) {
    dm_factor f = {.A = A, .arena = arena};
    cholmod_sparse symmetric = view(A);
    dm_library_enter(&f);
    cholmod_start(&f.common);
    f.common.print = 0;
    f.common.supernodal = CHOLMOD_SIMPLICIAL;
    f.common.final_ll = 0;
    const dm_status status = factorize(&f, &symmetric, NULL);
    if (status == DM_OK) *negatives = negatives_of(f.L);
    dm_library_leave();
    dm_library_release(&f);
    return status;
}
