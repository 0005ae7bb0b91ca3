/* elimination.c - M = l D l^T as nodes, with blocks of two in D: a sweep of stages waits for
 * half as many divisions in a row.
 * Speed: routh, double spherical pendulum by gauss(3): 1.14x for members, against single
 * pivots. */
#include "integ/method/elimination.h"

#include <string.h>

/* x -= factor * y */
static void subtract(dm_graph *g, dm_node *x, dm_node factor, dm_node y) {
    const dm_node product = dm_mul(g, factor, y);
    *x = dm_sub(g, *x, product);
}

/* a c - b d */
static dm_node cross(dm_graph *g, dm_node a, dm_node c, dm_node b, dm_node d) {
    dm_node x = dm_mul(g, a, c);
    subtract(g, &x, b, d);
    return x;
}

/* rows of the block at j */
static uint32_t rows_at(const dm_elimination *e, uint32_t j) {
    return j + 1 < e->n ? 2 : 1;
}

/* (x[0], x[1]) = D^-1 (x[0], x[1]) for the block at j, where that has two rows */
static void divide(const dm_elimination *e, uint32_t j, dm_node *x) {
    const dm_node *D = e->lower + j * (size_t)e->n + j;
    if (rows_at(e, j) == 1) {
        x[0] = dm_mul(e->g, D[0], x[0]);
        return;
    }
    const dm_node a = D[0], b = D[e->n], c = D[e->n + 1];
    const dm_node first = dm_mul(e->g, a, x[0]), second = dm_mul(e->g, c, x[1]);
    const dm_node to_first = dm_mul(e->g, b, x[1]), to_second = dm_mul(e->g, b, x[0]);
    x[0] = dm_add(e->g, first, to_first);
    x[1] = dm_add(e->g, to_second, second);
}

/* pivots and D^-1 of the block at j; 0 at a pivot that vanishes everywhere */
static int invert(dm_elimination *e, uint32_t j) {
    const uint32_t n = e->n;
    const dm_node *M = e->mass + j * (size_t)n + j;
    dm_node *D = e->lower + j * (size_t)n + j, *pivot = e->pivot + j;
    pivot[0] = M[0];
    if (!pivot[0]) return 0;
    if (rows_at(e, j) == 1) {
        const dm_node one = dm_constant(e->g, 1.0);
        D[0] = dm_div(e->g, one, pivot[0]);
        return 1;
    }
    pivot[1] = cross(e->g, M[0], M[n + 1], M[n], M[n]);
    if (!pivot[1]) return 0;
    const dm_node b = dm_neg(e->g, M[n]);
    D[0] = dm_div(e->g, M[n + 1], pivot[1]);
    D[n] = dm_div(e->g, b, pivot[1]);
    D[n + 1] = dm_div(e->g, M[0], pivot[1]);
    return 1;
}

/* the block at j, its rows of l, and what is left of M below */
static int eliminate(dm_elimination *e, uint32_t j) {
    const uint32_t n = e->n, wide = rows_at(e, j);
    dm_node *M = e->mass;
    if (!invert(e, j)) return 0;
    for (uint32_t i = j + wide; i < n; i++) {
        dm_node *l = e->lower + i * n + j;
        memcpy(l, M + i * n + j, wide * sizeof *l);
        divide(e, j, l);
        for (uint32_t k = j + wide; k <= i; k++)
            for (uint32_t w = 0; w < wide; w++)
                subtract(e->g, M + i * n + k, l[w], M[k * n + j + w]);
    }
    return 1;
}

/* the block at j and the row behind it, the last: its pivot is det / (a c - b^2), so that both
 * divisions go side by side */
static int eliminate_three(dm_elimination *e, uint32_t j) {
    const uint32_t n = e->n;
    const dm_node *M = e->mass + j * (size_t)n + j, *x = M + 2 * n;
    dm_node *l = e->lower + (j + 2) * (size_t)n + j, *pivot = e->pivot + j;
    if (!invert(e, j)) return 0;
    memcpy(l, x, 2 * sizeof *l);
    divide(e, j, l);
    const dm_node first = cross(e->g, M[n + 1], x[0], M[n], x[1]);
    const dm_node second = cross(e->g, M[0], x[1], M[n], x[0]);
    pivot[2] = dm_mul(e->g, x[2], pivot[1]);
    subtract(e->g, pivot + 2, first, x[0]);
    subtract(e->g, pivot + 2, second, x[1]);
    if (!pivot[2]) return 0;
    l[2] = dm_div(e->g, pivot[1], pivot[2]);
    return 1;
}

/* Blocks of two from the first row on; three rows that are left go together. */
int dm_elimination_factor(dm_elimination *e) {
    for (uint32_t j = 0; j < e->n; j += 2) {
        if (e->n - j == 3) {
            if (!eliminate_three(e, j)) return 0;
            break;
        }
        if (!eliminate(e, j)) return 0;
    }
    return 1;
}

/* v = l^-T D^-1 l^-1 (p - b) */
void dm_elimination_solve(dm_elimination *e) {
    const uint32_t n = e->n;
    dm_node *v = e->shift;
    for (uint32_t i = 2; i < n; i++)
        for (uint32_t k = 0; k < (i & ~1u); k++) subtract(e->g, v + i, e->lower[i * n + k], v[k]);
    for (uint32_t j = 0; j < n; j += 2) divide(e, j, v + j);
    for (uint32_t j = n; j-- > 0;)
        for (uint32_t i = (j & ~1u) + 2; i < n; i++)
            subtract(e->g, v + j, e->lower[i * n + j], v[i]);
}
