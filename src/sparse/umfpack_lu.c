/* umfpack_lu.c - LU of UMFPACK with its default pivoting, for what is not positive definite. */
#include "sparse/factor.h"

#include <suitesparse/umfpack.h>

/* what is neither fine nor singular is want of memory: the matrix was looked at before */
static dm_status status_of(int status) {
    if (status == UMFPACK_OK) return DM_OK;
    return status == UMFPACK_WARNING_singular_matrix ? DM_SINGULAR : DM_NO_MEMORY;
}

/* Of the numbers it is only asked which pivots are there: those of a step equation all are. */
dm_status dm_umfpack_analyse(dm_factor *f) {
    const dm_sparse *A = f->A;
    double info[UMFPACK_INFO];
    dm_library_enter(f);
    const int status = umfpack_di_symbolic(A->rows, A->columns, A->start, A->row, A->value,
                                           &f->symbolic, NULL, info);
    dm_library_leave();
    f->operations = status == UMFPACK_OK ? info[UMFPACK_FLOPS_ESTIMATE] : 0.0;
    return status_of(status);
}

/* symbolic factors that are not known are only needed for the numbers */
dm_status dm_umfpack_factor(dm_factor *f, const dm_analysis *known, double *condition) {
    const dm_sparse *A = f->A;
    double info[UMFPACK_INFO];
    void *own = NULL;
    int status = UMFPACK_OK;
    dm_library_enter(f);
    if (!known)
        status =
            umfpack_di_symbolic(A->rows, A->columns, A->start, A->row, A->value, &own, NULL, info);
    if (status == UMFPACK_OK)
        status = umfpack_di_numeric(A->start, A->row, A->value, known ? known->f.symbolic : own,
                                    &f->numeric, NULL, info);
    umfpack_di_free_symbolic(&own);
    dm_library_leave();
    *condition = status == UMFPACK_OK ? info[UMFPACK_RCOND] : 0.0;
    return status_of(status);
}

/* UMFPACK has no numbers in place */
dm_status dm_umfpack_refactor(dm_factor *f, const dm_analysis *known) {
    double condition;
    dm_library_enter(f);
    umfpack_di_free_numeric(&f->numeric);
    dm_library_leave();
    return dm_umfpack_factor(f, known, &condition);
}

/* with its steps of refinement */
dm_status dm_umfpack_solve(dm_factor *f, double *x, const double *b) {
    const dm_sparse *A = f->A;
    dm_library_enter(f);
    const int status =
        umfpack_di_solve(UMFPACK_A, A->start, A->row, A->value, x, b, f->numeric, NULL, NULL);
    dm_library_leave();
    return status_of(status);
}
