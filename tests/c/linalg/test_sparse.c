/* sparse matrices against dense ones; conjugate gradients and eigenvectors against closed forms */
#include "check.h"

#include "linalg/sparse/conjugate_gradient.h"
#include "linalg/sparse/sparse.h"
#include "linalg/sparse/symmetric_eigen.h"

#include <stdlib.h>

static void *allocate(void *ud, void *block, size_t old_size, size_t new_size) {
    (void)ud, (void)old_size;
    if (new_size) return realloc(block, new_size);
    free(block);
    return NULL;
}

enum { MOST = 12, ENTRIES = 60 };
typedef struct {
    dm_sparse A;
    double dense[MOST][MOST];
} both;

static uint32_t state = 12345;
static uint32_t number(uint32_t below) {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % below;
}

/* whole numbers, some at one place, some that cancel */
static void random_matrix(both *m, dm_arena *arena, int32_t rows, int32_t columns) {
    int32_t row[ENTRIES], column[ENTRIES], count = (int32_t)number(ENTRIES);
    double x[ENTRIES];
    memset(m->dense, 0, sizeof m->dense);
    for (int32_t i = 0; i < count; i++) {
        row[i] = (int32_t)number((uint32_t)rows), column[i] = (int32_t)number((uint32_t)columns);
        x[i] = (double)number(7) - 3.0;
        m->dense[row[i]][column[i]] += x[i];
    }
    CHECK(dm_sparse_assemble(&m->A, arena, rows, columns, count, row, column, x) == DM_OK);
}

/* rows ascend, nothing twice, and the entries are those of the dense matrix */
static void same(const dm_sparse *A, double dense[MOST][MOST], int32_t rows, int32_t columns) {
    double left[MOST][MOST];
    memcpy(left, dense, sizeof left);
    CHECK(A->rows == rows && A->columns == columns && A->start[0] == 0);
    for (int32_t j = 0; j < columns; j++)
        for (int32_t p = A->start[j]; p < A->start[j + 1]; p++) {
            CHECK(p == A->start[j] || A->row[p - 1] < A->row[p]);
            left[A->row[p]][j] -= A->value[p];
        }
    for (int32_t i = 0; i < rows; i++)
        for (int32_t j = 0; j < columns; j++) CHECK(left[i][j] == 0.0);
}

static int32_t zeros(const dm_sparse *A) {
    int32_t count = 0;
    for (int32_t p = 0; p < A->start[A->columns]; p++) count += A->value[p] == 0.0;
    return count;
}

static void products(dm_arena *arena, const both *a, const both *b) {
    const int32_t n = a->A.rows, m = a->A.columns, l = b->A.columns;
    double dense[MOST][MOST] = {{0}}, gram[MOST][MOST] = {{0}}, w[MOST];
    dm_sparse C;
    for (int32_t i = 0; i < n; i++) {
        w[i] = (double)number(5);
        for (int32_t k = 0; k < m; k++)
            for (int32_t j = 0; j < l; j++) dense[i][j] += a->dense[i][k] * b->dense[k][j];
    }
    CHECK(dm_sparse_product(&C, arena, &a->A, &b->A, NULL) == DM_OK);
    same(&C, dense, n, l);
    CHECK(zeros(&C) == 0);
    for (int32_t k = 0; k < n; k++)
        for (int32_t i = 0; i < m; i++)
            for (int32_t j = 0; j < m; j++) gram[i][j] += a->dense[k][i] * w[k] * a->dense[k][j];
    CHECK(dm_sparse_gram(&C, arena, &a->A, w, NULL) == DM_OK);
    same(&C, gram, m, m);
}

static void parts(dm_arena *arena, const both *a) {
    const int32_t n = a->A.rows, m = a->A.columns;
    double turned[MOST][MOST] = {{0}}, picked[MOST][MOST] = {{0}}, x[MOST], y[MOST];
    unsigned char keep_row[MOST], keep_column[MOST];
    dm_sparse C;
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j < m; j++) turned[j][i] = a->dense[i][j];
    CHECK(dm_sparse_transpose(&C, arena, &a->A) == DM_OK);
    same(&C, turned, m, n);
    int32_t rows = 0, columns = 0;
    for (int32_t i = 0; i < n; i++) keep_row[i] = (unsigned char)number(2);
    for (int32_t j = 0; j < m; j++) keep_column[j] = (unsigned char)number(2), x[j] = number(9);
    for (int32_t j = 0; j < m; j++) {
        if (!keep_column[j]) continue;
        rows = 0;
        for (int32_t i = 0; i < n; i++)
            if (keep_row[i]) picked[rows++][columns] = a->dense[i][j];
        columns++;
    }
    rows = 0;
    for (int32_t i = 0; i < n; i++) rows += keep_row[i];
    CHECK(dm_sparse_pick(&C, arena, &a->A, keep_row, keep_column) == DM_OK);
    same(&C, picked, rows, columns);
    dm_sparse_apply(y, &a->A, x);
    for (int32_t i = 0; i < n; i++) {
        double sum = 0.0;
        for (int32_t j = 0; j < m; j++) sum += a->dense[i][j] * x[j];
        CHECK(y[i] == sum);
    }
}

static void against_dense(void) {
    for (int round = 0; round < 200; round++) {
        const int32_t n = 1 + (int32_t)number(MOST), m = 1 + (int32_t)number(MOST),
                      l = 1 + (int32_t)number(MOST);
        dm_arena arena;
        both a, b, c;
        dm_sparse sum;
        double dense[MOST][MOST];
        dm_arena_init(&arena, allocate, NULL);
        random_matrix(&a, &arena, n, m);
        random_matrix(&b, &arena, m, l);
        random_matrix(&c, &arena, n, m);
        same(&a.A, a.dense, n, m);
        products(&arena, &a, &b);
        parts(&arena, &a);
        for (int32_t i = 0; i < MOST; i++)
            for (int32_t j = 0; j < MOST; j++) dense[i][j] = 2 * a.dense[i][j] - c.dense[i][j];
        CHECK(dm_sparse_sum(&sum, &arena, 2.0, &a.A, -1.0, &c.A) == DM_OK);
        same(&sum, dense, n, m);
        CHECK(zeros(&sum) == 0);
        dm_arena_release(&arena);
    }
}

/* a matrix whose product would have more entries than indices is refused before memory is taken */
static void stopped(void) {
    dm_arena arena;
    both a;
    dm_sparse C;
    const int stop = 1;
    dm_arena_init(&arena, allocate, NULL);
    random_matrix(&a, &arena, 5, 5);
    CHECK(dm_sparse_product(&C, &arena, &a.A, &a.A, &stop) == DM_STOPPED);
    CHECK(dm_sparse_room(&C, &arena, 2, 2, (int64_t)INT32_MAX + 1) == DM_TOO_LARGE);
    dm_arena_release(&arena);
}

enum { LINE = 50 };

/* -u'' on a line, ends fixed: {-1, 2, -1} */
static void second_difference(dm_sparse *A, dm_arena *arena, double corner) {
    int32_t row[3 * LINE], column[3 * LINE], count = 0;
    double x[3 * LINE];
    for (int32_t i = 0; i < LINE; i++)
        for (int32_t j = i - 1; j <= i + 1; j++)
            if (j >= 0 && j < LINE) {
                row[count] = i, column[count] = j;
                x[count++] = i != j ? -1.0 : i == 0 ? corner : 2.0;
            }
    CHECK(dm_sparse_assemble(A, arena, LINE, LINE, count, row, column, x) == DM_OK);
}

/* the solution of -u'' = 1 is a parabola, exact in differences */
static void gradients(void) {
    dm_arena arena;
    dm_sparse A;
    double x[LINE] = {0}, b[LINE], work[4 * LINE];
    dm_cg how = {.tolerance = 1e-13, .most = 10 * LINE};
    dm_arena_init(&arena, allocate, NULL);
    second_difference(&A, &arena, 2.0);
    for (int i = 0; i < LINE; i++) b[i] = 1.0;
    CHECK(dm_conjugate_gradient(x, &A, b, work, &how) == DM_OK);
    for (int i = 0; i < LINE; i++) CHECK_NEAR(x[i], 0.5 * (i + 1) * (LINE - i), 1e-9);
    CHECK(how.iterations > 0 && how.iterations <= LINE);
    how.most = 3;
    memset(x, 0, sizeof x);
    CHECK(dm_conjugate_gradient(x, &A, b, work, &how) == DM_NO_CONVERGENCE && how.iterations == 3);
    second_difference(&A, &arena, -5.0);
    how.most = 1000;
    CHECK(dm_conjugate_gradient(x, &A, b, work, &how) == DM_SINGULAR);
    dm_arena_release(&arena);
}

/* 4 sin^2(k pi / (2 n + 2)), and vectors that are sines */
static void eigenvectors(void) {
    static double A[LINE * LINE], V[LINE * LINE], value[LINE], work[LINE];
    for (int i = 0; i < LINE; i++)
        for (int j = 0; j < LINE; j++)
            A[i * LINE + j] = i == j ? 2.0 : abs(i - j) == 1 ? -1.0 : 0.0;
    memcpy(V, A, sizeof V);
    CHECK(dm_symmetric_eigen(V, value, work, LINE, NULL) == DM_OK);
    for (int k = 0; k < LINE; k++) {
        const double s = sin((k + 1) * 3.14159265358979323846 / (2 * LINE + 2));
        CHECK_NEAR(value[k], 4 * s * s, 1e-13);
        const double *v = V + k * LINE;
        for (int i = 0; i < LINE; i++) {
            double sum = -value[k] * v[i];
            for (int j = 0; j < LINE; j++) sum += A[i * LINE + j] * v[j];
            CHECK_NEAR(sum, 0.0, 1e-13);
        }
    }
    A[7] = NAN;
    CHECK(dm_symmetric_eigen(A, value, work, LINE, NULL) == DM_NOT_FINITE);
}

/* n on the diagonal, -1 elsewhere: 0 once and n + 1 else; full, so every reflection is needed */
static void degenerate(void) {
    static double V[LINE * LINE], value[LINE], work[LINE];
    for (int i = 0; i < LINE; i++)
        for (int j = 0; j < LINE; j++) V[i * LINE + j] = i == j ? LINE - 1.0 : -1.0;
    CHECK(dm_symmetric_eigen(V, value, work, LINE, NULL) == DM_OK);
    for (int k = 0; k < LINE; k++) {
        CHECK_NEAR(value[k], k == 0 ? 0.0 : LINE, 1e-12);
        for (int l = 0; l <= k; l++) {
            double sum = 0.0;
            for (int i = 0; i < LINE; i++) sum += V[k * LINE + i] * V[l * LINE + i];
            CHECK_NEAR(sum, k == l ? 1.0 : 0.0, 1e-13);
        }
    }
}

/* {{2, -3}, {0, 1e-9}} with sizes (1, 1e3): rows are 3002 and 1e-6 */
static void rows_of_unlike_units(void) {
    int32_t start[] = {0, 1, 3}, row[] = {0, 0, 1};
    double value[] = {2.0, -3.0, 1e-9}, terms[2];
    const dm_sparse A = {2, 2, start, row, value};
    const double size[] = {1.0, 1e3};
    CHECK(dm_sparse_is_within(&A, (double[]){-3000.0, 1e-6}, size, 1.0, terms));
    CHECK(!dm_sparse_is_within(&A, (double[]){0.0, 2e-6}, size, 1.0, terms));
    CHECK(!dm_sparse_is_within(&A, (double[]){NAN, 0.0}, size, 1.0, terms));
}

int main(void) {
    RUN(against_dense, "sums, products, transposes, parts are those of dense matrices");
    RUN(stopped, "a product stops on request; too many entries are refused");
    RUN(gradients, "conjugate gradients solve, end, and see what is not positive definite");
    RUN(eigenvectors, "eigenvectors of the second difference are sines");
    RUN(rows_of_unlike_units, "rows are within a part of their own terms");
    RUN(degenerate, "an eigenvalue of multiplicity n - 1 has orthogonal vectors");
    return check_finish();
}
