/* slopes that are read off as linear functions have the bits of the kernel that they stand for */
#include "check.h"
#include "random_graph.h"

#include "algebra/derive.h"
#include "chain/cells.h"
#include "code/tape/tape.h"

enum { CELLS = 37, N = 29, COLUMNS = 7, COORDINATES = 5 };

static double x[3 * N + 4], data[2][2 * CELLS];
static uint32_t place[COORDINATES][CELLS];
static dm_column column[COLUMNS];

/* five columns of coordinates, some with steps or without an index, and two of data */
static void fill(random_source *r) {
    for (uint32_t i = 0; i < 3 * N + 4; i++) x[i] = random_between(r, -2.0, 2.0);
    for (uint32_t k = 0; k < 2; k++)
        for (uint32_t i = 0; i < 2 * CELLS; i++) data[k][i] = random_between(r, 0.1, 3.0);
    for (uint32_t k = 0; k < COORDINATES; k++) {
        for (uint32_t i = 0; i < CELLS; i++) place[k][i] = random_below(r, N);
        column[k] = (dm_column){.first = random_below(r, 4),
                                .step = 1 + random_below(r, 2) * random_below(r, 3),
                                .index = place[k]};
    }
    if (random_below(r, 3) == 0) column[0] = (dm_column){.first = 1, .step = 1};
    column[COORDINATES] = (dm_column){.step = 1, .data = data[0]};
    column[COORDINATES + 1] = (dm_column){.first = 1, .step = 2, .data = data[1]};
}

/* a sum of some coordinates with signs, times numbers and data; now and then not linear */
static dm_node random_slope(random_source *r, dm_graph *g) {
    static const double numbers[] = {2.0, -0.5, 1.0, 0.3, 1.7};
    const uint32_t terms = 1 + random_below(r, 4);
    dm_node sum = dm_input(g, random_below(r, COORDINATES));
    for (uint32_t k = 1; k < terms; k++) {
        const dm_node a = dm_input(g, random_below(r, COORDINATES));
        sum = random_below(r, 2) ? dm_add(g, sum, a) : dm_sub(g, random_below(r, 2) ? sum : a, sum);
    }
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t kind = random_below(r, 6);
        if (kind == 0) sum = dm_mul(g, sum, dm_constant(g, numbers[random_below(r, 5)]));
        if (kind == 1) sum = dm_mul(g, sum, dm_input(g, COORDINATES + random_below(r, 2)));
        if (kind == 2) sum = dm_neg(g, sum);
        if (kind == 3) sum = dm_div(g, sum, dm_constant(g, 4.0));
        if (kind == 4 && random_below(r, 8) == 0) sum = dm_apply(g, DM_OP_SIN, sum, 0, 0);
    }
    return sum;
}

/* compacted as kernels are, node by node, cell by cell */
static int has_those_bits(const dm_cell_loop *l, dm_graph *term, const dm_node *roots,
                          uint32_t outputs, dm_arena *arena) {
    double out[2][CELLS], work[4096], in[COLUMNS], y[2];
    dm_node with[COLUMNS], own[2];
    dm_kernel k;
    dm_graph *g = dm_graph_new(arena, COLUMNS);
    for (uint32_t c = 0; c < COLUMNS; c++) with[c] = dm_input(g, c);
    dm_transplant(g, term, roots, outputs, with, own);
    int same = dm_tape_build(&k, g, own, outputs, arena) == DM_OK;
    dm_kernel_prepare(&k, y);
    dm_cell_loop_run(l, out[0], CELLS, x, 0, CELLS, work);
    for (uint32_t i = 0; i < CELLS; i++) {
        for (uint32_t c = 0; c < COLUMNS; c++) {
            const dm_column *from = column + c;
            in[c] = (from->data ? from->data : x)[dm_sum_entry(l->sum, from, i, 0)];
        }
        dm_kernel_eval(&k, in, y);
        for (uint32_t o = 0; o < outputs; o++) same &= out[o][i] == y[o];
    }
    return same;
}

static void linear_slopes_have_the_bits_of_kernels(void) {
    random_source r = {20261123};
    uint32_t linear = 0, kernels = 0;
    for (uint32_t round = 0; round < 400; round++) {
        dm_arena arena = new_arena();
        dm_graph *term = dm_graph_new(&arena, COLUMNS);
        dm_cell_loop l;
        fill(&r);
        const uint32_t outputs = 1 + random_below(&r, 2);
        dm_node roots[2];
        for (uint32_t o = 0; o < outputs; o++) roots[o] = random_slope(&r, term);
        const dm_sum s = {.term = term,
                          .column = column,
                          .columns = COLUMNS,
                          .bodies = CELLS,
                          .cells = 1};
        CHECK(dm_cell_loop_make(&l, &s, roots, outputs, dm_tape_build, &arena) == DM_OK);
        CHECK(has_those_bits(&l, term, roots, outputs, &arena));
        linear += l.linear != NULL;
        kernels += l.linear == NULL;
        dm_arena_release(&arena);
    }
    CHECK(linear > 200 && kernels > 20);
}

static void factors_are_rounded_once_more(void) {
    static double q[4] = {0.1, 0.7, -1.3, 2.9}, w[2] = {0.3, 1.1};
    static const uint32_t a[2] = {0, 2}, b[2] = {1, 3};
    const dm_cell_linear l = {.terms = 2,
                              .term = {{b, 0, 1, 1.0}, {a, 0, 1, -1.0}},
                              .weight = w,
                              .scale = -2.0};
    double y[4];
    dm_cell_linear_run(&l, y, 2, q, 0, 2, 0.7);
    for (int i = 0; i < 2; i++) {
        const double slope = (w[i] * (q[b[i]] - q[a[i]])) * -2.0;
        CHECK(y[2 * i] == slope * 0.7 && y[2 * i + 1] == -(slope * 0.7));
    }
}

int main(void) {
    RUN(linear_slopes_have_the_bits_of_kernels, "linear slopes have the bits of their kernels");
    RUN(factors_are_rounded_once_more, "factors are rounded once more, opposites stand behind");
    return check_finish();
}
