/* test_means.c - products by a decimal step have roundings without a mean. That of h x alone has
 * one: h = 0.05 is so near to 1/20 that h x lies at few places between two doubles, and what a step
 * should keep drifts (docs/benchmarks/drifts.md). */
#include "algebra/even.h"
#include "check.h"
#include "code/tape/tape.h"
#include "integ/stage/sweep/sweep.h"
#include "numbers/processor.h"
#include "numbers/weight.h"
#include "random_graph.h"

enum { SAMPLES = 400000 };
static const double h = 0.05;

/* of errors in units of the last place of the exact value */
typedef struct {
    double sum, square;
} errors;

static void count(errors *e, double got, long double exact) {
    int power;
    frexpl(exact, &power);
    const double x = (double)ldexpl((long double)got - exact, 53 - power);
    e->sum += x, e->square += x * x;
}

/* in standard errors of the mean */
static double mean(const errors *e) {
    return e->sum / sqrt(e->square);
}

/* as a velocity goes along part of an orbit */
static double sample(int i) {
    return 1.2 + 0.01 * sin(1e-3 * i + 0.3);
}

static void one_product(void) {
    errors e = {0};
    for (int i = 0; i < SAMPLES; i++) count(&e, h * sample(i), (long double)h * sample(i));
    if (!CHECK(fabs(mean(&e)) > 20.0)) printf("# %.1f standard errors\n", mean(&e));
}

/* h a_22 of gauss(3) is 1/90 */
static void coefficients(void) {
    const dm_weight a = dm_weight_of((long double)h * 2.0L / 9.0L);
    const double nearest = dm_weight_double(a), few = dm_weight_few_bits(nearest);
    errors one = {0}, other = {0};
    for (int i = 0; i < SAMPLES; i++) {
        count(&one, nearest * sample(i), (long double)nearest * sample(i));
        count(&other, few * sample(i), (long double)few * sample(i));
    }
    CHECK(fabs(few - nearest) <= 0x1p-47 * nearest && ldexp(few, 53) == floor(ldexp(few, 53)));
    if (!CHECK(fabs(mean(&one)) > 5.0)) printf("# %.1f standard errors\n", mean(&one));
    if (!CHECK(fabs(mean(&other)) < 5.0)) printf("# %.1f standard errors\n", mean(&other));
}

static void graphs(void) {
    dm_arena arena = new_arena();
    dm_graph *g = dm_graph_new(&arena, 1);
    const dm_node x = dm_input(g, 0),
                  roots[] = {dm_mul(g, dm_constant(g, h), x), dm_mul(g, dm_constant(g, 0.75), x),
                             dm_mul(g, dm_constant(g, 1e-300), x),
                             dm_apply(g, DM_OP_RSQRT3, x, 0, 0)};
    dm_node out[4];
    dm_kernel k;
    errors e = {0};
    dm_graph *even = dm_even_graph(g, roots, 4, out);
    CHECK(even && dm_tape_build(&k, even, out, 4, &arena) == DM_OK);
    double y[4];
    dm_kernel_prepare(&k, y);
    for (int i = 0; i < SAMPLES; i++) {
        const double at = sample(i), root = 1.0 / sqrt(at);
        dm_kernel_eval(&k, &at, y);
        count(&e, y[0], (long double)h * at);
        CHECK(y[1] == 0.75 * at && y[2] == 1e-300 * at);
        CHECK(fabs(y[3] - root * root * root) <= 2e-15 * y[3]);
    }
    if (!CHECK(fabs(mean(&e)) < 5.0)) printf("# %.1f standard errors\n", mean(&e));
    dm_arena_release(&arena);
}

/* A difference of positions is a whole number of units of their last place, so that c times it, of
 * 3/20, lies at 40 places between two doubles of the other terms, and at half a unit always on the
 * same side. */
static void differences(void) {
    dm_arena arena = new_arena();
    dm_graph *g = dm_graph_new(&arena, 3);
    const dm_node d = dm_sub(g, dm_input(g, 1), dm_input(g, 0)),
                  scaled = dm_mul(g, dm_constant(g, 0.15), d),
                  roots[] = {dm_add(g, dm_input(g, 2), scaled), dm_sub(g, scaled, dm_input(g, 2)),
                             dm_mul(g, dm_neg(g, scaled), d)};
    dm_node out[3];
    dm_kernel k;
    errors plus = {0}, minus = {0};
    dm_graph *even = dm_even_graph(g, roots, 3, out);
    CHECK(even && dm_tape_build(&k, even, out, 3, &arena) == DM_OK);
    double y[3];
    dm_kernel_prepare(&k, y);
    for (int i = 0; i < SAMPLES; i++) {
        const double x[] = {sample(i), sample(i) + h * sample(3 * i + 1), 0.5 + sample(2 * i)};
        const long double exact = 0.15L * (x[1] - x[0]); /* 0.15L - 0.15 moves it by less */
        dm_kernel_eval(&k, x, y);
        count(&plus, y[0], x[2] + exact);
        count(&minus, y[1], exact - x[2]);
        CHECK(fabsl(y[2] + exact * (x[1] - x[0])) <= 1e-15L * -y[2]);
    }
    if (!CHECK(fabs(mean(&plus)) < 5.0)) printf("# %.1f standard errors\n", mean(&plus));
    if (!CHECK(fabs(mean(&minus)) < 5.0)) printf("# %.1f standard errors\n", mean(&minus));
    dm_arena_release(&arena);
}

/* base = low + h c v of the sweeps, by every width */
static void lines(void) {
    for (uint32_t stages = 1; stages <= 8; stages++) {
        const dm_sweep_row *row = dm_sweep_find(stages);
        double top[8], rest[8], base[8] __attribute__((aligned(64))), low = 0.0;
        const dm_parts c = {top, rest};
        errors e = {0};
        for (int l = 0; l < 8; l++) {
            const dm_weight w = dm_weight_of(0.5L * h);
            top[l] = w.top, rest[l] = w.rest;
        }
        for (int i = 0; i < SAMPLES; i++) {
            const double v = sample(i);
            row->line(base, &low, &v, &c, 1);
            count(&e, base[0], 0.5L * h * v);
        }
        if (!CHECK(fabs(mean(&e)) < 5.0))
            printf("# %u stages: %.1f standard errors\n", stages, mean(&e));
    }
}

int main(void) {
    RUN(one_product, "one product by h = 0.05 has a mean");
    RUN(coefficients, "nor has one by 1/90 in few bits, as by the nearest double");
    RUN(graphs, "even graphs: two products have none, other products stay, cubes are values");
    RUN(differences, "nor have sums with decimal parts of differences of positions");
    RUN(lines, "nor has what sweeps begin with, at every width");
    return check_finish();
}
