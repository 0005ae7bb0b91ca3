/* models whose sums stay loops: forces by hand, the same bits on every backend, cost per body. */
#include "check.h"
#include "problems.h"

#include "algebra/body_sum.h"
#include "code/native/jit.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    dm_arena arena;
    dm_model m;
    dm_status status;
} built;

/* a sum of f(column 0, column 1) over neighbours, or of f(column 0) over bodies */
static dm_node sum(dm_graph *g, dm_graph *term, dm_node f, dm_column *column, uint32_t columns,
                   uint32_t n) {
    const dm_sum s = {.term = term,
                      .value = f,
                      .column = column,
                      .columns = columns,
                      .bodies = n,
                      .from = columns - 1,
                      .to = columns - 1,
                      .periodic = 1};
    return dm_sum_leaf(g, &s);
}

/* Toda ring: sum v_i^2/2 - sum exp(q_i - q_(i+1)) */
static void ring_with(built *b, uint32_t n, unsigned want, dm_compile *compile) {
    static dm_column v[1], q[2];
    dm_arena_init(&b->arena, problem_allocate, NULL);
    dm_graph *g = dm_graph_new(&b->arena, 2 * n + 1);
    dm_graph *one = dm_graph_new(&b->arena, 1), *two = dm_graph_new(&b->arena, 2);
    const dm_node u = dm_input(one, 0), half = dm_constant(one, 0.5);
    const dm_node kinetic = dm_mul(one, half, dm_mul(one, u, u));
    const dm_node d = dm_sub(two, dm_input(two, 0), dm_input(two, 1));
    const dm_node bond = dm_apply(two, DM_OP_EXP, d, 0, 0);
    v[0] = (dm_column){.first = n, .step = 1};
    q[0] = (dm_column){.step = 1};
    q[1] = (dm_column){.step = 1, .partner = 1};
    const dm_node T = sum(g, one, kinetic, v, 1, n), V = sum(g, two, bond, q, 2, n);
    b->m = (dm_model){0};
    b->status = dm_model_build(&b->m, g, dm_sub(g, T, V), n, want, compile, &b->arena);
}

static void ring(built *b, uint32_t n, dm_compile *compile) {
    const unsigned kernels = DM_WANT_VALUE | DM_WANT_FORCE | DM_WANT_SLOPE | DM_WANT_ENERGY;
    ring_with(b, n, kernels, compile);
}

static void fill(double *x, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) {
        x[i] = sin(1.3 * i);
        x[n + i] = cos(0.7 * i);
    }
    x[2 * n] = 0.0;
}

static void forces_are_those_by_hand(void) {
    enum { N = 1001 };
    static double x[2 * N + 1], force[N], slope[2 * N];
    double value, energy, T = 0.0, V = 0.0;
    built b;
    ring(&b, N, dm_tape_build);
    fill(x, N);
    CHECK(b.status == DM_OK && b.m.structure & DM_LOOPS && b.m.structure & DM_DIAGONAL_MASS &&
          b.m.structure & DM_AUTONOMOUS);
    dm_kernel_eval(&b.m.force, x, force);
    dm_kernel_eval(&b.m.slope, x, slope);
    dm_kernel_eval(&b.m.value, x, &value);
    dm_kernel_eval(&b.m.energy, x, &energy);
    for (uint32_t i = 0; i < N; i++) {
        const double before = exp(x[(i + N - 1) % N] - x[i]);
        const double after = exp(x[i] - x[(i + 1) % N]);
        CHECK_NEAR(force[i], before - after, 1e-14);
        CHECK(slope[i] == force[i] && slope[N + i] == x[N + i]);
        CHECK(b.m.inverse_mass[i] == 1.0);
        T += x[N + i] * x[N + i] / 2;
        V += after;
    }
    CHECK_NEAR(value, T - V, 1e-10);
    CHECK_NEAR(energy, T + V, 1e-10);
    dm_arena_release(&b.arena);
}

/* odd lengths end within a block and within the lanes */
static void all_backends_give_the_same_bits(void) {
    enum { MOST = 1000 };
    static double x[2 * MOST + 1], tape[MOST], own[MOST];
    for (uint32_t n = 129; n < MOST; n += 57)
        for (uint32_t lanes = 1; lanes <= 8; lanes *= lanes == 1 ? 4 : 2) {
            built a, b;
            double value[2];
            dm_jit_limit(lanes);
            ring(&a, n, dm_tape_build);
            ring(&b, n, dm_native_build);
            fill(x, n);
            dm_kernel_eval(&a.m.force, x, tape);
            dm_kernel_eval(&b.m.force, x, own);
            CHECK(memcmp(tape, own, n * sizeof *own) == 0);
            dm_kernel_eval(&a.m.energy, x, value);
            dm_kernel_eval(&b.m.energy, x, value + 1);
            CHECK(memcmp(value, value + 1, sizeof *value) == 0);
            dm_arena_release(&a.arena);
            dm_arena_release(&b.arena);
        }
    dm_jit_limit(8);
}

static void cost_per_body_does_not_grow(void) {
    double operations[2], bytes[2];
    const uint32_t n[2] = {1000, 100000};
    for (int k = 0; k < 2; k++) {
        built b;
        ring(&b, n[k], dm_tape_build);
        CHECK(b.status == DM_OK);
        operations[k] = (double)b.m.force.operations / n[k];
        bytes[k] = (double)b.arena.total / n[k];
        dm_arena_release(&b.arena);
    }
    CHECK_NEAR(operations[1] / operations[0], 1.0, 0.01);
    CHECK(bytes[1] <= 1.1 * bytes[0]);
}

/* short ones are written out, and so is what wants n x n tables; long ones are refused then */
static void dense_tables_only_where_they_fit(void) {
    const struct {
        uint32_t n;
        unsigned want;
        dm_status status;
        int loops;
    } cases[] = {{DM_MODEL_WRITTEN_OUT / 2, DM_WANT_FORCE, DM_OK, 0},
                 {50, DM_WANT_FORCE, DM_OK, 1},
                 {100, DM_WANT_FORCE, DM_OK, 1},
                 {100, DM_WANT_FORCE | DM_WANT_STAGE, DM_OK, 0},
                 {DM_MODEL_DENSE + 1, DM_WANT_FORCE, DM_OK, 1},
                 {DM_MODEL_DENSE + 1, DM_WANT_MASS, DM_TOO_LARGE, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        built b;
        ring_with(&b, cases[i].n, cases[i].want, dm_tape_build);
        CHECK(b.status == cases[i].status);
        CHECK(((b.m.structure & DM_LOOPS) != 0) == cases[i].loops);
        dm_arena_release(&b.arena);
    }
}

int main(void) {
    RUN(forces_are_those_by_hand, "forces, value and energy of a ring");
    RUN(all_backends_give_the_same_bits, "tape and native code, 1, 4 and 8 lanes");
    RUN(cost_per_body_does_not_grow, "operations and memory per body, 10^3 and 10^5");
    RUN(dense_tables_only_where_they_fit, "few rounds are written out");
    return check_finish();
}
