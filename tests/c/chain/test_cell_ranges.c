/* threads that have a range of the entries of a gradient give the bits of one thread, on bands of
 * cells, closed or open, in any number of ranges; cells that have entries far apart get none */
#include "check.h"
#include "random_graph.h"

#include "algebra/derive.h"
#include "chain/cell_ranges.h"
#include "code/tape/tape.h"

enum { CELLS = 1500, N = 1700, FACES = 3, COLUMNS = FACES + 1, SUMS = 2, OTHERS = 560 };

static double x[N], data[CELLS], all[N], some[N], work[8192];
static uint32_t place[SUMS][FACES][CELLS];
static dm_column column[SUMS][COLUMNS];

/* faces near the cell's place, all different, as those of simplices are; now and then round the
 * end */
static void fill(random_source *r, uint32_t reach) {
    const uint32_t shift = random_below(r, 2) * random_below(r, N);
    for (uint32_t i = 0; i < N; i++) x[i] = random_between(r, -2.0, 2.0);
    for (uint32_t i = 0; i < CELLS; i++) data[i] = random_between(r, 0.1, 3.0);
    for (uint32_t s = 0; s < SUMS; s++) {
        for (uint32_t k = 0; k < FACES; k++) {
            for (uint32_t i = 0; i < CELLS; i++)
                place[s][k][i] =
                    (shift + i * (N - 8) / CELLS + k * reach + random_below(r, reach)) % (N - 2);
            column[s][k] = (dm_column){.first = s, .step = 1, .index = place[s][k]};
        }
        column[s][FACES] = (dm_column){.step = 1, .data = data};
    }
}

/* squares of differences, whose slopes are linear, or something else */
static dm_node random_term(random_source *r, dm_graph *g) {
    const dm_node a = dm_input(g, 0), b = dm_input(g, 1), c = dm_input(g, 2);
    const dm_node y = dm_add(g, dm_sub(g, a, b), c);
    const dm_node square = dm_mul(g, dm_input(g, FACES), dm_mul(g, y, y));
    const uint32_t kind = random_below(r, 4);
    if (kind == 0) return dm_apply(g, DM_OP_SIN, square, 0, 0);
    if (kind == 1) return dm_add(g, square, dm_mul(g, a, dm_mul(g, b, c)));
    return square;
}

/* every entry by its range alone, which leaves the others as they are */
static int ranges_give_the_bits(const dm_cells *c, const dm_cell_ranges *r, const double *factor) {
    int same = 1;
    for (uint32_t part = 0; part < r->parts; part++) {
        uint32_t from, to;
        for (uint32_t i = 0; i < N; i++) some[i] = 0.625;
        dm_cell_range(N, r->unit, part, r->parts, &from, &to);
        dm_cell_ranges_gradient(c, r, some, factor, x, work, part);
        for (uint32_t i = 0; i < N; i++)
            same &= i >= from && i < to ? memcmp(some + i, all + i, sizeof *all) == 0
                                        : some[i] == 0.625;
    }
    return same;
}

static void ranges_have_the_bits_of_one_thread(void) {
    random_source r = {20261124};
    static const double factor[SUMS] = {-0.5, 0.3};
    uint32_t ranges = 0, none = 0;
    for (uint32_t round = 0; round < 300; round++) {
        dm_arena arena = new_arena();
        dm_sum sum[SUMS];
        const dm_sum *sums[SUMS];
        dm_cells c;
        const int far = random_below(&r, 4) == 0;
        fill(&r, far ? OTHERS : 1 + random_below(&r, 6));
        for (uint32_t s = 0; s < SUMS; s++) {
            dm_graph *term = dm_graph_new(&arena, COLUMNS);
            sum[s] = (dm_sum){.term = term,
                              .value = random_term(&r, term),
                              .column = column[s],
                              .columns = COLUMNS,
                              .bodies = CELLS,
                              .cells = 1};
            sums[s] = sum + s;
        }
        CHECK(dm_cells_open(&c, sums, 1 + random_below(&r, SUMS), N, dm_tape_build, &arena) ==
              DM_OK);
        CHECK(c.work <= sizeof work / sizeof *work);
        dm_cells_gradient(&c, all, factor, x, work);
        const uint32_t parts = 1 + random_below(&r, 6), unit = 1 + random_below(&r, 64);
        const dm_cell_ranges *of = dm_cell_ranges_make(&c, unit, parts, &arena);
        CHECK(of == dm_cell_ranges_make(&c, unit, parts, &arena));
        if (of) CHECK(ranges_give_the_bits(&c, of, factor));
        if (far && parts > 1) CHECK(!of);
        ranges += of && parts > 1;
        none += !of;
        dm_arena_release(&arena);
    }
    CHECK(ranges > 100 && none > 30);
}

int main(void) {
    RUN(ranges_have_the_bits_of_one_thread, "ranges have the bits of one thread");
    return check_finish();
}
