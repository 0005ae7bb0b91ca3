/* loops in machine code give the bits of their parts done one after the other by the tape */
#include "code/native/jit.h"
#include "code/tape/loop.h"
#include "code/tape/tape.h"

#include "check.h"
#include "random_graph.h"

enum { MOST = 24, LANES = 8, GROUPS = 4, COEFFICIENTS = 6 };

static long loops_compared;

/* a value of its own for every carried number, itself or its input */
static dm_loop_part random_part(random_source *r, dm_arena *arena, uint32_t size, int calls) {
    const uint32_t coefficients = random_below(r, COEFFICIENTS);
    dm_loop_part p = {dm_graph_new(arena, size + coefficients), NULL, coefficients, 0};
    dm_node *roots = dm_arena_take(arena, size * sizeof *roots);
    const uint32_t count = 1 + random_below(r, 80);
    for (uint32_t i = 0; i < count; i++) {
        const dm_op op = calls ? random_op(r) : random_arithmetic_op(r);
        const dm_node a = random_operand(r, p.graph), b = random_operand(r, p.graph),
                      c = random_operand(r, p.graph);
        const int operands = dm_op_operands(op);
        dm_node_plain(p.graph, op, a, operands > 1 ? b : 0, operands > 2 ? c : 0);
    }
    for (uint32_t i = 0; i < size; i++) {
        roots[i] = random_operand(r, p.graph);
        const dm_expr *x = dm_graph_at(p.graph, roots[i]);
        if (x->op == DM_OP_INPUT && x->as.input < size) roots[i] = dm_input(p.graph, i);
    }
    p.roots = roots;
    return p;
}

/* [COEFFICIENTS x all parts x steps] spread over lanes */
static void spread(double *to, const double *from, uint32_t count, uint32_t lanes) {
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t lane = 0; lane < lanes; lane++) to[i * lanes + lane] = from[i];
}

static void compare(random_source *r, uint32_t size, uint32_t lanes, int calls) {
    static double coefficients[1024], wide[1024 * LANES], state[GROUPS * MOST * LANES], one[MOST];
    dm_arena arena = new_arena();
    dm_loop_part part[DM_LOOP_PARTS] = {{0}};
    dm_loop native, slow;
    int64_t step = 0;
    for (int k = 0; k < DM_LOOP_PARTS; k++)
        if (k == DM_LOOP_BODY || random_below(r, 3)) part[k] = random_part(r, &arena, size, calls);
    const uint32_t groups = lanes == 1 ? 1 : 2 + 2 * random_below(r, 2);
    const int64_t repeats = 1 + random_below(r, 3), steps = 1 + random_below(r, 4);
    for (int k = DM_LOOP_HEAD; k < DM_LOOP_PARTS; k++)
        step += part[k].coefficients * (k == DM_LOOP_BODY ? repeats : 1);
    if (random_below(r, 2)) step = 0;
    for (int i = 0; i < 1024; i++) coefficients[i] = random_between(r, -2.0, 2.0);
    spread(wide, coefficients, 1024, lanes);
    for (uint32_t i = 0; i < groups * size * lanes; i++) state[i] = random_between(r, -2.0, 2.0);
    static double start[GROUPS * MOST * LANES];
    memcpy(start, state, sizeof start);
    const dm_status fast = dm_loop_native(&native, part, size, lanes, &arena);
    CHECK(dm_loop_by_kernels(&slow, part, size, dm_tape_build_exact, &arena) == DM_OK);
    if (CHECK(fast == DM_OK)) {
        dm_loop_call c = {.state = state,
                          .coefficients = wide,
                          .groups = groups,
                          .repeats = repeats,
                          .steps = steps,
                          .stride = step * (int64_t)sizeof(double) * lanes};
        dm_loop_run(&native, &c);
        for (uint32_t i = 0; i < groups * lanes; i++) {
            const uint32_t base = i / lanes * size * lanes + i % lanes;
            for (uint32_t k = 0; k < size; k++) one[k] = start[base + k * lanes];
            dm_loop_call d = {.state = one,
                              .coefficients = coefficients,
                              .repeats = repeats,
                              .groups = 1,
                              .steps = steps,
                              .stride = step * (int64_t)sizeof(double)};
            dm_loop_run(&slow, &d);
            for (uint32_t k = 0; k < size; k++) CHECK(same_bits(state[base + k * lanes], one[k]));
        }
        loops_compared++;
    }
    dm_arena_release(&arena);
}

static void many(uint64_t seed, uint32_t lanes, int count) {
    random_source r = {seed};
    for (int i = 0; i < count && lanes <= dm_jit_lanes(); i++)
        compare(&r, 1 + random_below(&r, MOST), lanes, i % 4 == 0);
}

static void one(void) {
    many(1, 1, 3000);
}

static void four(void) {
    many(2, 4, 1500);
}

static void eight(void) {
    many(3, 8, 1500);
}

int main(void) {
    RUN(one, "3000 random loops: machine code = tape, bit for bit");
    RUN(four, "1500 random loops in 4 lanes");
    RUN(eight, "1500 random loops in 8 lanes");
    printf("# %ld loops compared\n", loops_compared);
    return check_finish();
}
