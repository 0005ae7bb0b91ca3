/* the tape gives the bits of a node-by-node sweep */
#include "code/tape/tape.h"
#include "numbers/functions.h"

#include "check.h"
#include "random_graph.h"

/* one graph, `points` random inputs, every root compared */
static void compare(random_source *r, dm_graph *g, dm_arena *arena, uint32_t m, int points) {
    dm_node *roots = dm_arena_take(arena, m * sizeof *roots);
    roots[0] = dm_graph_size(g) - 1;
    for (uint32_t i = 1; i < m; i++) roots[i] = random_operand(r, g);
    double *value = dm_arena_take(arena, dm_graph_size(g) * sizeof *value);
    double *out = dm_arena_take(arena, m * sizeof *out), in[8];
    dm_kernel k;
    if (!CHECK(dm_tape_build_exact(&k, g, roots, m, arena) == DM_OK)) return;
    CHECK(k.inputs == dm_graph_inputs(g) && k.outputs == m);
    dm_kernel_prepare(&k, out);
    for (int p = 0; p < points; p++) {
        for (int i = 0; i < 8; i++) in[i] = random_between(r, -3.0, 3.0);
        dm_kernel_eval(&k, in, out);
        graph_values(g, in, value);
        for (uint32_t i = 0; i < m; i++) CHECK(same_bits(out[i], value[roots[i]]));
    }
}

static void many_graphs(int graphs, uint32_t most, int points) {
    random_source r = {20240229};
    for (int i = 0; i < graphs; i++) {
        dm_arena arena = new_arena();
        dm_graph *g = random_graph(&r, &arena, 1 + random_below(&r, most), i % 2);
        compare(&r, g, &arena, 1 + random_below(&r, 12), points);
        dm_arena_release(&arena);
    }
}

static void small_graphs(void) {
    many_graphs(4000, 60, 5);
}

static void large_graphs(void) {
    many_graphs(4, 100000, 2);
}

static void angles(void) {
    random_source r = {7};
    dm_arena arena = new_arena();
    dm_graph *g = dm_graph_new(&arena, 1);
    const dm_node x = dm_input(g, 0);
    const dm_node roots[2] = {dm_apply(g, DM_OP_SIN, x, 0, 0), dm_apply(g, DM_OP_COS, x, 0, 0)};
    dm_kernel k;
    CHECK(dm_tape_build(&k, g, roots, 2, &arena) == DM_OK);
    for (int j = 0; j < 1000000; j++) {
        const double size = pow(10.0, random_between(&r, -12.0, 12.0));
        const double in = size * random_between(&r, -1.0, 1.0);
        double out[2];
        dm_kernel_eval(&k, &in, out);
        CHECK(same_bits(out[0], dm_sin(in)) && same_bits(out[1], dm_cos(in)));
    }
    dm_arena_release(&arena);
}

static void constant_outputs(void) {
    dm_arena arena = new_arena();
    dm_graph *g = dm_graph_new(&arena, 2);
    const dm_node x = dm_input(g, 0), y = dm_input(g, 1);
    const dm_node roots[4] = {dm_mul(g, x, y), 0, dm_constant(g, 2.5), x};
    double in[2] = {3.0, 4.0}, out[4] = {-1.0, -1.0, -1.0, -1.0};
    dm_kernel k;
    CHECK(dm_tape_build(&k, g, roots, 4, &arena) == DM_OK);
    CHECK(!k.fixed[0] && k.fixed[1] && k.fixed[2] && !k.fixed[3]);
    CHECK(k.operations == 1);
    dm_kernel_eval(&k, in, out);
    CHECK(out[0] == 12.0 && out[1] == -1.0 && out[2] == -1.0 && out[3] == 3.0);
    dm_kernel_prepare(&k, out);
    CHECK(out[0] == 12.0 && out[1] == 0.0 && out[2] == 2.5);
    dm_arena_release(&arena);
}

/* graph and tape under an allocator that gives `left` blocks */
static int with_blocks(long left) {
    random_source r = {99};
    dm_arena arena;
    dm_arena_init(&arena, heap, &left);
    dm_graph *g = random_graph(&r, &arena, 5000, 1);
    dm_status status = g ? dm_graph_status(g) : DM_NO_MEMORY;
    dm_kernel k = {.outputs = 77};
    if (g) {
        const dm_node root = dm_graph_size(g) - 1;
        status = dm_tape_build(&k, g, &root, 1, &arena);
        CHECK(status == DM_OK || (status == DM_NO_MEMORY && k.outputs == 77));
    }
    dm_arena_release(&arena);
    return status == DM_OK;
}

static void refused_memory(void) {
    long left = 0;
    while (!with_blocks(left) && left < 1000) left++;
    CHECK(left > 3 && left < 1000);
}

int main(void) {
    RUN(small_graphs, "4000 random graphs of every operation: tape = sweep, bit for bit");
    RUN(large_graphs, "graphs of up to 100000 operations: tape = sweep, bit for bit");
    RUN(angles, "sine and cosine made together are sin and cos, bit for bit");
    RUN(constant_outputs, "constant outputs are reported and left alone");
    RUN(refused_memory, "memory refused from the n-th request on, for all n");
    return check_finish();
}
