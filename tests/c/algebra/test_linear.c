/* systems written out in a graph: against dense LU, and how many operations they take */
#include "algebra/contract.h"
#include "check.h"
#include "code/tape/tape.h"
#include "graph/analyse.h"
#include "graph/linear.h"
#include "linalg/lu.h"

#include <math.h>
#include <string.h>

enum { MOST = 12 };

static void *from_heap(void *ud, void *block, size_t old_size, size_t new_size) {
    (void)ud;
    (void)old_size;
    if (new_size) return realloc(block, new_size);
    free(block);
    return NULL;
}

static double random_number(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-53 - 0.5;
}

/* a pattern of A and numbers in it */
typedef struct {
    uint32_t m;
    double A[MOST * MOST], b[MOST];
} problem;

/* x, the determinant, the size of x */
static double reference(const problem *p, double *x, double *determinant) {
    double A[MOST * MOST], largest = 0.0;
    uint32_t pivot[MOST];
    memcpy(A, p->A, sizeof A);
    memcpy(x, p->b, sizeof p->b);
    CHECK(dm_lu_factor(A, pivot, p->m) == DM_OK);
    dm_lu_solve(x, A, pivot, p->m);
    *determinant = 1.0;
    for (uint32_t i = 0; i < p->m; i++) {
        largest = fmax(largest, fabs(x[i]));
        *determinant *= (pivot[i] != i ? -1.0 : 1.0) / A[i * p->m + i];
    }
    return largest;
}

/* inputs A[m*m], b[m]; entries that are 0 in p are node 0. Returns the operations. */
static uint32_t compare(const problem *p, int symmetric, double tolerance) {
    const uint32_t m = p->m;
    dm_arena arena;
    double in[MOST * MOST + MOST], out[MOST], x[MOST], determinant;
    dm_node A[MOST * MOST], b[MOST];
    dm_kernel k;
    dm_arena_init(&arena, from_heap, NULL);
    dm_graph *g = dm_graph_new(&arena, m * m + m);
    for (uint32_t i = 0; i < m * m; i++) A[i] = p->A[i] != 0.0 ? dm_input(g, i) : 0;
    for (uint32_t i = 0; symmetric && i < m; i++)
        for (uint32_t j = 0; j < i; j++) A[i * m + j] = 0; /* not to be read */
    for (uint32_t i = 0; i < m; i++) b[i] = dm_input(g, m * m + i);
    dm_graph_verbatim(g, 1);
    dm_graph_solve(g, A, b, m, symmetric, NULL);
    const uint32_t operations = dm_operations(g, b, m);
    CHECK(dm_tape_build(&k, g, b, m, &arena) == DM_OK);
    memcpy(in, p->A, m * m * sizeof *in);
    memcpy(in + m * m, p->b, m * sizeof *in);
    dm_kernel_prepare(&k, out);
    dm_kernel_eval(&k, in, out);
    const double size = reference(p, x, &determinant);
    for (uint32_t i = 0; i < m; i++) CHECK_NEAR(out[i], x[i], tolerance * size);
    dm_arena_release(&arena);
    return operations;
}

/* B B^T + 1 on the pattern of a graph: (i, j) joined where join says so */
static void fill(problem *p, uint32_t m, int join(uint32_t i, uint32_t j, uint32_t m),
                 uint64_t seed) {
    *p = (problem){.m = m};
    for (uint32_t i = 0; i < m; i++) {
        p->b[i] = random_number(&seed);
        p->A[i * m + i] = m;
        for (uint32_t j = 0; j < i; j++)
            if (join(i, j, m)) p->A[i * m + j] = p->A[j * m + i] = random_number(&seed);
    }
}

static int everything(uint32_t i, uint32_t j, uint32_t m) {
    (void)i, (void)j, (void)m;
    return 1;
}
static int chain(uint32_t i, uint32_t j, uint32_t m) {
    (void)m;
    return i == j + 1;
}
/* the first is joined to all others: in the order of the rows everything would fill in */
static int star(uint32_t i, uint32_t j, uint32_t m) {
    (void)i, (void)m;
    return j == 0;
}
/* the chain 0, 5, 10, 3, 8 ... numbered out of order (m = 12) */
static int shuffled(uint32_t i, uint32_t j, uint32_t m) {
    return i * 5 % m + 1 == j * 5 % m || j * 5 % m + 1 == i * 5 % m;
}

static void solutions(void) {
    problem p;
    for (uint32_t m = 1; m <= MOST; m++)
        for (uint64_t seed = 1; seed < 4; seed++) {
            fill(&p, m, everything, seed);
            compare(&p, 1, 1e-14);
            for (uint32_t i = 0; i < m * m; i += 3) p.A[i] *= 1.25; /* not symmetric */
            compare(&p, 0, 1e-14);
        }
}

/* the determinant times all units, whose signs two pivots of other signs do not hide */
static void volumes(void) {
    for (uint32_t m = 1; m <= 6; m++)
        for (int symmetric = 0; symmetric < 2; symmetric++) {
            problem p;
            dm_arena arena;
            double in[MOST * MOST], x[MOST], determinant, volume;
            dm_node A[MOST * MOST], b[MOST], units[MOST];
            dm_kernel k;
            fill(&p, m, everything, 11 + m);
            for (uint32_t i = 0; i < m * m; i++) p.A[i] = -p.A[i];
            reference(&p, x, &determinant);
            dm_arena_init(&arena, from_heap, NULL);
            dm_graph *g = dm_graph_new(&arena, m * m);
            for (uint32_t i = 0; i < m * m; i++) A[i] = dm_input(g, i);
            for (uint32_t i = 0; i < m; i++) b[i] = units[i] = dm_constant(g, -0.5);
            const dm_node root = dm_graph_solve(g, A, b, m, symmetric, units);
            CHECK(dm_tape_build(&k, g, &root, 1, &arena) == DM_OK);
            memcpy(in, p.A, sizeof in);
            dm_kernel_prepare(&k, &volume);
            dm_kernel_eval(&k, in, &volume);
            CHECK_NEAR(volume, determinant * pow(-0.5, m), 1e-12 * fabs(determinant));
            dm_arena_release(&arena);
        }
}

static void saddle_points(void) {
    problem p, q;
    fill(&p, 10, everything, 7);
    for (uint32_t i = 0; i < 5; i++)
        for (uint32_t j = 0; j < 5; j++) p.A[i * 10 + j] = 0.0; /* [0, B; B^T, C] */
    for (uint32_t i = 0; i < 5; i++) p.A[i * 10 + i + 5] = p.A[(i + 5) * 10 + i] = 9.0;
    compare(&p, 1, 1e-13);
    compare(&p, 0, 1e-13);
    q = p;
    for (uint32_t i = 5; i < 10; i++) q.A[i * 11] = 1e-300; /* there, and nearly zero */
    compare(&q, 1, 1e-13);
}

static void costs(void) {
    problem p;
    uint32_t before = 0, last = 0;
    for (uint32_t m = 6; m <= MOST; m++) {
        fill(&p, m, chain, 3);
        const uint32_t now = compare(&p, 1, 1e-14);
        if (m > 7) CHECK(now - last == last - before);
        before = last, last = now;
    }
    fill(&p, MOST, shuffled, 3);
    CHECK(compare(&p, 1, 1e-14) <= last);
    fill(&p, MOST, star, 3);
    CHECK(compare(&p, 1, 1e-14) <= last);
    fill(&p, MOST, star, 3);
    CHECK(compare(&p, 0, 1e-14) <= last + 12);
}

/* sum x_i y_i, and its square, where no product is the last term: n + 1 operations instead of 2
 * n */
static void contracted_sums(void) {
    enum { N = 5 };
    dm_arena arena;
    dm_node roots[2], out[2];
    double in[2 * N], value[2], sum = 0.0;
    dm_kernel k;
    dm_arena_init(&arena, from_heap, NULL);
    dm_graph *g = dm_graph_new(&arena, 2 * N);
    dm_graph_verbatim(g, 1);
    for (uint32_t i = 0; i < N; i++) {
        const dm_node x = dm_input(g, i), y = dm_input(g, N + i);
        const dm_node product = dm_mul(g, x, y);
        roots[0] = i ? dm_add(g, roots[0], product) : product;
        in[i] = 0.1 + i, in[N + i] = 1.0 / (3.0 + i);
        sum += in[i] * in[N + i];
    }
    roots[1] = dm_mul(g, roots[0], roots[0]);
    CHECK(dm_operations(g, roots, 2) == 2 * N);
    dm_graph *small = dm_contract_graph(g, roots, 2, out);
    CHECK(small && dm_operations(small, out, 2) == N + 1);
    CHECK(dm_tape_build_exact(&k, small, out, 2, &arena) == DM_OK);
    dm_kernel_prepare(&k, value);
    dm_kernel_eval(&k, in, value);
    CHECK_NEAR(value[0], sum, 1e-15 * sum);
    CHECK_NEAR(value[1], sum * sum, 4e-15 * sum * sum);
    dm_arena_release(&arena);
}

/* a product of two sums and a difference vanishes into all three, one that is an output stays,
 * and so does a product of its own */
static void contracted_differences(void) {
    enum { N = 4 };
    const double in[N] = {0.3, 1.7, -0.9, 2.5};
    const double a = in[0], b = in[1], c = in[2], d = in[3];
    const double want[] = {c + a * b, d - a * b, a * b - c, d - c * d, c * d, c * c + 1.0};
    dm_arena arena;
    dm_node x[N], roots[6], out[6];
    double value[6];
    dm_kernel k;
    dm_arena_init(&arena, from_heap, NULL);
    dm_graph *g = dm_graph_new(&arena, N);
    dm_graph_verbatim(g, 1);
    for (uint32_t i = 0; i < N; i++) x[i] = dm_input(g, i);
    const dm_node ab = dm_mul(g, x[0], x[1]), square = dm_mul(g, x[2], x[2]);
    roots[0] = dm_add(g, x[2], ab);
    roots[1] = dm_sub(g, x[3], ab);
    roots[2] = dm_sub(g, ab, x[2]);
    roots[4] = dm_mul(g, x[2], x[3]);
    roots[3] = dm_sub(g, x[3], roots[4]);
    const dm_node one = dm_constant(g, 1.0);
    roots[5] = dm_add(g, square, one);
    CHECK(dm_operations(g, roots, 6) == 8);
    dm_graph *small = dm_contract_all(g, roots, 6, out);
    CHECK(small && dm_operations(small, out, 6) == 6);
    CHECK(dm_tape_build_exact(&k, small, out, 6, &arena) == DM_OK);
    dm_kernel_prepare(&k, value);
    dm_kernel_eval(&k, in, value);
    for (int i = 0; i < 6; i++) CHECK_NEAR(value[i], want[i], 1e-15 * fabs(want[i]));
    dm_arena_release(&arena);
}

int main(void) {
    RUN(solutions, "solves what dense LU solves, symmetric or not");
    RUN(volumes, "the product of pivots in units");
    RUN(saddle_points, "zeros on the diagonal call for rows, not for the entries that "
                       "happen to be there");
    RUN(costs, "a chain costs the same for each further unknown, in any order, and so "
               "does a star");
    RUN(contracted_sums, "products that are added at once");
    RUN(contracted_differences, "products that are subtracted at once, and added to several sums");
    return check_finish();
}
