#include "expr/linear.h"

dm_node dm_add_product(dm_graph *g, dm_node sum, dm_node x, dm_node y) {
    if (!x || !y) return sum;
    return sum ? dm_multiply_add(g, x, y, sum) : dm_mul(g, x, y);
}

dm_node dm_subtract_product(dm_graph *g, dm_node sum, dm_node x, dm_node y) {
    if (!x || !y) return sum;
    const dm_node minus = dm_neg(g, x);
    return dm_add_product(g, sum, minus, y);
}

/* rows k and i of A, from column k on, and of x change places */
static void exchange(dm_node *A, dm_node *x, uint32_t m, uint32_t k, uint32_t i) {
    dm_node *a = A + k * (size_t)m, *b = A + i * (size_t)m;
    for (uint32_t j = k; j < m; j++) {
        const dm_node kept = a[j];
        a[j] = b[j], b[j] = kept;
    }
    const dm_node kept = x[k];
    x[k] = x[i], x[i] = kept;
}

/* a pivot that is zero everywhere: the next row that has one */
static void find_pivot(dm_node *A, dm_node *x, uint32_t m, uint32_t k) {
    for (uint32_t i = k; i < m; i++)
        if (A[i * (size_t)m + k]) {
            if (i != k) exchange(A, x, m, k, i);
            return;
        }
}

/* the lower half too, where a diagonal entry is zero everywhere; 0: symmetric no more */
static int fits_symmetric(dm_node *A, uint32_t m) {
    uint32_t zeros = 0;
    for (uint32_t i = 0; i < m; i++) zeros += A[i * (size_t)m + i] == 0;
    for (uint32_t i = 0; zeros && i < m; i++)
        for (uint32_t j = 0; j < i; j++) A[i * (size_t)m + j] = A[j * (size_t)m + i];
    return !zeros;
}

/* the reciprocals of the pivots stay on the diagonal */
static void eliminate(dm_graph *g, dm_node *A, dm_node *x, uint32_t m, int symmetric) {
    const dm_node one = dm_constant(g, 1.0);
    symmetric = symmetric && fits_symmetric(A, m);
    for (uint32_t k = 0; k < m; k++) {
        dm_node *pivot = A + k * (size_t)m;
        if (!symmetric) find_pivot(A, x, m, k);
        pivot[k] = dm_div(g, one, pivot[k]);
        for (uint32_t i = k + 1; i < m; i++) {
            dm_node *row = A + i * (size_t)m;
            const dm_node below = symmetric ? pivot[i] : row[k];
            if (!below) continue;
            const dm_node factor = dm_mul(g, below, pivot[k]);
            for (uint32_t j = symmetric ? i : k + 1; j < m; j++)
                row[j] = dm_subtract_product(g, row[j], factor, pivot[j]);
            x[i] = dm_subtract_product(g, x[i], factor, x[k]);
        }
    }
    for (uint32_t k = m; k-- > 0;) {
        const dm_node *row = A + k * (size_t)m;
        for (uint32_t j = k + 1; j < m; j++)
            x[k] = dm_subtract_product(g, x[k], row[j], x[j]);
        if (x[k]) x[k] = dm_mul(g, x[k], row[k]);
    }
}

/* two by two by Cramer's rule: one division */
static void solve_two(dm_graph *g, const dm_node *A, dm_node *x, int symmetric) {
    const dm_node a10 = symmetric ? A[1] : A[2], one = dm_constant(g, 1.0);
    dm_node determinant = dm_add_product(g, 0, A[0], A[3]);
    determinant = dm_subtract_product(g, determinant, A[1], a10);
    const dm_node inverse = dm_div(g, one, determinant);
    dm_node first = dm_add_product(g, 0, A[3], x[0]);
    first = dm_subtract_product(g, first, A[1], x[1]);
    dm_node second = dm_add_product(g, 0, A[0], x[1]);
    second = dm_subtract_product(g, second, a10, x[0]);
    x[0] = dm_mul(g, first, inverse);
    x[1] = dm_mul(g, second, inverse);
}

void dm_graph_solve(dm_graph *g, dm_node *A, dm_node *x, uint32_t m, int symmetric) {
    if (m == 1)
        x[0] = dm_div(g, x[0], A[0]);
    else if (m == 2)
        solve_two(g, A, x, symmetric);
    else
        eliminate(g, A, x, m, symmetric);
}
