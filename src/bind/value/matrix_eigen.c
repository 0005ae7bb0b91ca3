/* matrix_eigen.c - eigenvalues of a matrix of numbers, modes of two (GSL). */
#include "bind/value/matrix_solve.h"

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

static int is_symmetric(const double *a, size_t n) {
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++)
            if (a[i * n + j] != a[j * n + i]) return 0;
    return 1;
}

/* returns a GSL status; a is overwritten */
static int symmetric(double *re, double *a, size_t n) {
    gsl_eigen_symm_workspace *w = gsl_eigen_symm_alloc(n);
    if (!w) return GSL_ENOMEM;
    gsl_matrix_view m = gsl_matrix_view_array(a, n, n);
    gsl_vector_view v = gsl_vector_view_array(re, n);
    const int status = gsl_eigen_symm(&m.matrix, &v.vector, w);
    gsl_eigen_symm_free(w);
    return status;
}

/* z: 2 n doubles of scratch */
static int general(double *re, double *im, double *a, double *z, size_t n) {
    gsl_eigen_nonsymm_workspace *w = gsl_eigen_nonsymm_alloc(n);
    if (!w) return GSL_ENOMEM;
    gsl_matrix_view m = gsl_matrix_view_array(a, n, n);
    gsl_vector_complex_view v = gsl_vector_complex_view_array(z, n);
    const int status = gsl_eigen_nonsymm(&m.matrix, &v.vector, w);
    gsl_eigen_nonsymm_free(w);
    for (size_t i = 0; i < n; i++) re[i] = z[2 * i], im[i] = z[2 * i + 1];
    return status;
}

/* by real, then by imaginary part */
static void sort_pairs(double *re, double *im, size_t n) {
    for (size_t i = 1; i < n; i++)
        for (size_t j = i; j > 0; j--) {
            const double dr = re[j] - re[j - 1];
            if (dr > 0 || (dr == 0 && im[j] >= im[j - 1])) break;
            const double r = re[j], s = im[j];
            re[j] = re[j - 1], im[j] = im[j - 1];
            re[j - 1] = r, im[j - 1] = s;
        }
}

/* The power of 2 by which the largest entry is beyond 2^(far/2), or below 2^(-far/2), where it is
 * beyond 2^far or below 2^-far, so that products overflow or vanish; else 0. */
static int scale_of(const double *a, size_t n, int far) {
    double largest = 0.0;
    int power = 0;
    for (size_t i = 0; i < n; i++) largest = fmax(largest, fabs(a[i]));
    if (largest > 0.0) frexp(largest, &power);
    return power > far ? power - far / 2 : power < -far ? power + far / 2 : 0;
}

/* Symmetric matrices by the symmetric solver, which gives real values; others by the general
 * one. Sorted. */
void dml_eigenvalues(lua_State *L, const dml_array *m) {
    const size_t n = m->rows;
    dml_checksquare(L, m);
    double *scratch = lua_newuserdatauv(L, (n * n + 2 * n) * sizeof *scratch, 0);
    double *re = dml_pushvector(L, m->rows), *im = dml_pushvector(L, m->rows);
    const double *numbers = dml_numbersof(m);
    if (!numbers)
        luaL_error(L, "eigenvalues are for matrices of numbers, not of symbols or hyper-dual "
                      "numbers");
    dml_checkfinite(L, numbers, n * n);
    const int alike = is_symmetric(numbers, n);
    const int power = scale_of(numbers, n * n, alike ? 1000 : 300);
    for (size_t i = 0; i < n * n; i++) scratch[i] = ldexp(numbers[i], -power);
    const int status =
        alike ? symmetric(re, scratch, n) : general(re, im, scratch, scratch + n * n, n);
    if (status != GSL_SUCCESS)
        luaL_error(L, "the eigenvalues did not converge: %s", gsl_strerror(status));
    sort_pairs(re, im, n);
    for (size_t i = 0; power && i < n; i++) {
        re[i] = ldexp(re[i], power);
        im[i] = ldexp(im[i], power);
    }
}

/* x^T B x of column k of the vectors, which is made 1 */
static void scale_mode(double *x, const double *b, size_t n, size_t k) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) sum += x[i * n + k] * b[i * n + j] * x[j * n + k];
    for (size_t i = 0; i < n; i++) x[i * n + k] /= sqrt(sum);
}

/* By Cholesky's decomposition of B (GSL). */
void dml_modes(lua_State *L, const dml_array *a, const dml_array *b) {
    const size_t n = a->rows, size = n * n;
    const double *A = dml_numbersof(a), *B = dml_numbersof(b);
    if (!A || !B || a->columns != n || b->rows != n || b->columns != n || !is_symmetric(A, n) ||
        !is_symmetric(B, n))
        luaL_error(L, "a:modes(b) takes two symmetric matrices of numbers of one size");
    dml_checkfinite(L, A, size);
    dml_checkfinite(L, B, size);
    double *copy = lua_newuserdatauv(L, 2 * size * sizeof *copy, 0);
    double *values = dml_pushvector(L, a->rows), *vectors = dml_pushmatrix(L, a->rows, a->rows);
    memcpy(copy, A, size * sizeof *copy);
    memcpy(copy + size, B, size * sizeof *copy);
    gsl_eigen_gensymmv_workspace *w = gsl_eigen_gensymmv_alloc(n);
    if (!w) luaL_error(L, "not enough memory");
    gsl_matrix_view ma = gsl_matrix_view_array(copy, n, n),
                    mb = gsl_matrix_view_array(copy + size, n, n),
                    mv = gsl_matrix_view_array(vectors, n, n);
    gsl_vector_view v = gsl_vector_view_array(values, n);
    const int status = gsl_eigen_gensymmv(&ma.matrix, &mb.matrix, &v.vector, &mv.matrix, w);
    gsl_eigen_gensymmv_free(w);
    if (status != GSL_SUCCESS)
        luaL_error(L, "a:modes(b): %s; is b positive definite?", gsl_strerror(status));
    gsl_eigen_gensymmv_sort(&v.vector, &mv.matrix, GSL_EIGEN_SORT_VAL_ASC);
    for (size_t k = 0; k < n; k++) scale_mode(vectors, B, n, k);
}
