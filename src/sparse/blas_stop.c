/* blas_stop.c - how a stop reaches into a factorization. CHOLMOD and UMFPACK ask nobody while they
 * compute, but nearly all of their time goes into BLAS, and this module is asked for its symbols
 * before the BLAS behind it: here each of those functions looks at the stop of the factorization
 * first. When it is set they do nothing, and dpotrf finds a matrix that is not positive definite,
 * so the library comes to an end at once; what it has is thrown away (f->stopped). Where a library
 * is bound to its BLAS in another way it is as if this file were not there. */
#define _GNU_SOURCE /* RTLD_NEXT */
#include "sparse/factor.h"

#include <dlfcn.h>

/* Lengths of text arguments, which Fortran passes behind all others and C does not: the functions
 * behind get them, those here must not count on their room. */
typedef size_t length;

/* the function behind this module */
#define NEXT(name)                                                                                 \
    static name##_type *next;                                                                      \
    if (!next) next = (name##_type *)(uintptr_t)dlsym(RTLD_NEXT, #name);                           \
    if (dm_library_is_stopped() || !dm_library_has((void *)(uintptr_t)next)) return

typedef void dgemm__type(const char *, const char *, const int *, const int *, const int *,
                         const double *, const double *, const int *, const double *, const int *,
                         const double *, double *, const int *, length, length);
typedef void dsyrk__type(const char *, const char *, const int *, const int *, const double *,
                         const double *, const int *, const double *, double *, const int *, length,
                         length);
typedef void dtrsm__type(const char *, const char *, const char *, const char *, const int *,
                         const int *, const double *, const double *, const int *, double *,
                         const int *, length, length, length, length);
typedef void dgemv__type(const char *, const int *, const int *, const double *, const double *,
                         const int *, const double *, const int *, const double *, double *,
                         const int *, length);
typedef void dger__type(const int *, const int *, const double *, const double *, const int *,
                        const double *, const int *, double *, const int *);
typedef void dpotrf__type(const char *, const int *, double *, const int *, int *, length);

void dgemm_(const char *ta, const char *tb, const int *m, const int *n, const int *k,
            const double *alpha, const double *A, const int *lda, const double *B, const int *ldb,
            const double *beta, double *C, const int *ldc);
void dsyrk_(const char *uplo, const char *t, const int *n, const int *k, const double *alpha,
            const double *A, const int *lda, const double *beta, double *C, const int *ldc);
void dtrsm_(const char *side, const char *uplo, const char *t, const char *diagonal, const int *m,
            const int *n, const double *alpha, const double *A, const int *lda, double *B,
            const int *ldb);
void dgemv_(const char *t, const int *m, const int *n, const double *alpha, const double *A,
            const int *lda, const double *x, const int *incx, const double *beta, double *y,
            const int *incy);
void dger_(const int *m, const int *n, const double *alpha, const double *x, const int *incx,
           const double *y, const int *incy, double *A, const int *lda);
void dpotrf_(const char *uplo, const int *n, double *A, const int *lda, int *info);

void dgemm_(const char *ta, const char *tb, const int *m, const int *n, const int *k,
            const double *alpha, const double *A, const int *lda, const double *B, const int *ldb,
            const double *beta, double *C, const int *ldc) {
    NEXT(dgemm_);
    next(ta, tb, m, n, k, alpha, A, lda, B, ldb, beta, C, ldc, 1, 1);
}

void dsyrk_(const char *uplo, const char *t, const int *n, const int *k, const double *alpha,
            const double *A, const int *lda, const double *beta, double *C, const int *ldc) {
    NEXT(dsyrk_);
    next(uplo, t, n, k, alpha, A, lda, beta, C, ldc, 1, 1);
}

void dtrsm_(const char *side, const char *uplo, const char *t, const char *diagonal, const int *m,
            const int *n, const double *alpha, const double *A, const int *lda, double *B,
            const int *ldb) {
    NEXT(dtrsm_);
    next(side, uplo, t, diagonal, m, n, alpha, A, lda, B, ldb, 1, 1, 1, 1);
}

void dgemv_(const char *t, const int *m, const int *n, const double *alpha, const double *A,
            const int *lda, const double *x, const int *incx, const double *beta, double *y,
            const int *incy) {
    NEXT(dgemv_);
    next(t, m, n, alpha, A, lda, x, incx, beta, y, incy, 1);
}

void dger_(const int *m, const int *n, const double *alpha, const double *x, const int *incx,
           const double *y, const int *incy, double *A, const int *lda) {
    NEXT(dger_);
    next(m, n, alpha, x, incx, y, incy, A, lda);
}

void dpotrf_(const char *uplo, const int *n, double *A, const int *lda, int *info) {
    *info = 1;
    NEXT(dpotrf_);
    next(uplo, n, A, lda, info, 1);
}
