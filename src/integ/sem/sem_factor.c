/* sem_factor.c - a small matrix of nodes is factored by blocks of two, whose inverses take one
 * division each: divisions of the blocks that follow wait for each other. */
#include "integ/sem/sem_factor.h"

/* x -= a y */
static void subtract(dm_graph *g, dm_node *x, dm_node a, dm_node y) {
    *x = dm_sub(g, *x, dm_mul(g, a, y));
}

/* a c - b d */
static dm_node cross(dm_graph *g, dm_node a, dm_node c, dm_node b, dm_node d) {
    dm_node x = dm_mul(g, a, c);
    subtract(g, &x, b, d);
    return x;
}

/* Rows of the block at j. */
static uint32_t rows_at(uint32_t j, uint32_t size) {
    return j + 1 < size ? 2 : 1;
}

/* The block at j, [2][2] or a number, becomes its inverse; 0: it is singular everywhere. */
static int invert(dm_graph *g, dm_node *A, uint32_t size, uint32_t wide) {
    const dm_node one = dm_constant(g, 1.0);
    if (wide == 1) {
        if (!A[0]) return 0;
        A[0] = dm_div(g, one, A[0]);
        return 1;
    }
    const dm_node a = A[0], b = A[1], c = A[size], d = A[size + 1];
    const dm_node det = cross(g, a, d, b, c);
    if (!det) return 0;
    const dm_node over = dm_div(g, one, det);
    A[0] = dm_mul(g, d, over), A[1] = dm_neg(g, dm_mul(g, b, over));
    A[size] = dm_neg(g, dm_mul(g, c, over)), A[size + 1] = dm_mul(g, a, over);
    return 1;
}

/* (y[0], y[1]) = (x[0], x[1]) B of the inverse B of a block, entries of x `apart`; transposed: B x
 */
static void times_block(dm_graph *g, dm_node *y, const dm_node *B, uint32_t size, uint32_t wide,
                        int transposed) {
    if (wide == 1) {
        y[0] = dm_mul(g, y[0], B[0]);
        return;
    }
    const dm_node u = y[0], v = y[1], b = B[transposed ? 1 : size], c = B[transposed ? size : 1];
    y[0] = dm_add(g, dm_mul(g, u, B[0]), dm_mul(g, v, b));
    y[1] = dm_add(g, dm_mul(g, u, c), dm_mul(g, v, B[size + 1]));
}

/* The block of two at 0 and the row behind it, the last: its pivot is det A / det B, so that both
 * divisions go side by side. */
static int factor_three(dm_graph *g, dm_node *A) {
    const dm_node det = cross(g, A[0], A[4], A[1], A[3]), first = cross(g, A[3], A[7], A[4], A[6]),
                  second = cross(g, A[1], A[6], A[0], A[7]);
    dm_node whole = dm_mul(g, det, A[8]);
    whole = dm_add(g, whole, dm_mul(g, first, A[2]));
    whole = dm_add(g, whole, dm_mul(g, second, A[5]));
    if (!whole || !invert(g, A, 3, 2)) return 0;
    times_block(g, A + 6, A, 3, 2, 0);
    A[8] = dm_div(g, det, whole);
    return 1;
}

int dm_sem_factor(dm_graph *g, dm_node *A, uint32_t size) {
    if (size == 3) return factor_three(g, A);
    for (uint32_t j = 0; j < size; j += 2) {
        const uint32_t wide = rows_at(j, size);
        dm_node *B = A + j * size + j;
        if (!invert(g, B, size, wide)) return 0;
        for (uint32_t i = j + wide; i < size; i++) {
            dm_node *l = A + i * size + j;
            times_block(g, l, B, size, wide, 0);
            for (uint32_t k = j + wide; k < size; k++)
                for (uint32_t w = 0; w < wide; w++)
                    subtract(g, A + i * size + k, l[w], A[(j + w) * size + k]);
        }
    }
    return 1;
}

void dm_sem_solve_factored(dm_graph *g, const dm_node *A, uint32_t size, dm_node *y) {
    for (uint32_t i = 2; i < size; i++)
        for (uint32_t k = 0; k < (i & ~1u); k++) subtract(g, y + i, A[i * size + k], y[k]);
    for (uint32_t j = (size - 1) & ~1u;; j -= 2) {
        const uint32_t wide = rows_at(j, size);
        for (uint32_t w = 0; w < wide; w++)
            for (uint32_t k = j + wide; k < size; k++)
                subtract(g, y + j + w, A[(j + w) * size + k], y[k]);
        times_block(g, y + j, A + j * size + j, size, wide, 1);
        if (j == 0) break;
    }
}
