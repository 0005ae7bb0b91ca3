/* bodies with the same functions share a kernel: its outputs are those of the roots written out */
#include "code/loops/equal_parts.h"
#include "code/native/jit.h"
#include "code/tape/tape.h"

#include "check.h"
#include "random_graph.h"

#include <math.h>

/* x[3] of each body, then t; each body sees the first coordinate of the next one */
enum { BODIES = 21, INPUTS = 3 * BODIES + 1, OF_ONE = 4, ROOTS = OF_ONE * BODIES + 2 };

/* four functions of body b; the last is one of its first coordinate and t */
static void add_body(dm_graph *g, uint32_t b, double mass, dm_node *out) {
    const dm_node x = dm_input(g, 3 * b), y = dm_input(g, 3 * b + 1), z = dm_input(g, 3 * b + 2);
    const dm_node beside = dm_input(g, 3 * ((b + 1) % BODIES)), t = dm_input(g, 3 * BODIES);
    const dm_node angle = dm_mul(g, dm_constant(g, mass), dm_sub(g, x, beside));
    out[0] = dm_apply(g, DM_OP_SIN, angle, 0, 0);
    out[1] = dm_div(g, dm_add(g, y, out[0]), dm_add(g, dm_mul(g, z, z), dm_constant(g, 2.0)));
    out[2] = dm_mul(g, out[1], dm_mul(g, dm_add(g, y, z), out[0]));
    out[3] = dm_add(g, dm_mul(g, x, t), dm_mul(g, t, t));
}

/* body 7 has another mass, where `unlike` all have; then t^2 and a constant */
static dm_graph *make(dm_arena *arena, dm_node *roots, int unlike) {
    dm_graph *g = dm_graph_new(arena, INPUTS);
    dm_node own[OF_ONE];
    for (uint32_t b = 0; b < BODIES; b++) {
        add_body(g, b, unlike ? 1.0 + b : b == 7 ? 3.0 : 0.5, own);
        for (uint32_t i = 0; i < OF_ONE; i++) roots[i * BODIES + b] = own[i];
    }
    roots[ROOTS - 2] = dm_mul(g, dm_input(g, 3 * BODIES), dm_input(g, 3 * BODIES));
    roots[ROOTS - 1] = dm_constant(g, 2.5);
    return g;
}

static dm_status build(dm_kernel *out, dm_arena *arena, dm_node *roots, int unlike,
                       dm_compile *compile) {
    uint32_t body[INPUTS];
    for (uint32_t i = 0; i < INPUTS; i++) body[i] = i < 3 * BODIES ? i / 3 : DM_NO_BODY;
    dm_graph *g = make(arena, roots, unlike);
    return dm_equal_parts_build(out, g, roots, ROOTS, body, BODIES, compile, arena);
}

static void same_values(void) {
    dm_arena arena = new_arena();
    dm_node roots[ROOTS];
    dm_kernel native, tape, whole;
    double in[INPUTS], a[ROOTS], b[ROOTS], c[ROOTS];
    random_source r = {5};
    CHECK(build(&native, &arena, roots, 0, dm_native_build) == DM_OK && native.eval);
    CHECK(build(&tape, &arena, roots, 0, dm_tape_build) == DM_OK && tape.eval);
    CHECK(dm_tape_build(&whole, make(&arena, roots, 0), roots, ROOTS, &arena) == DM_OK);
    CHECK(native.fixed[ROOTS - 1] && native.constant[ROOTS - 1] == 2.5 && !native.fixed[0]);
    CHECK(native.outputs == ROOTS && native.inputs == INPUTS);
    dm_kernel_prepare(&native, a);
    dm_kernel_prepare(&tape, b);
    dm_kernel_prepare(&whole, c);
    for (int k = 0; k < 20; k++) {
        for (uint32_t i = 0; i < INPUTS; i++) in[i] = random_between(&r, -2.0, 2.0);
        dm_kernel_eval(&native, in, a);
        dm_kernel_eval(&tape, in, b);
        dm_kernel_eval(&whole, in, c);
        for (uint32_t i = 0; i < ROOTS; i++) {
            CHECK(memcmp(a + i, b + i, sizeof *a) == 0);
            CHECK(fabs(a[i] - c[i]) < 1e-14 * (1.0 + fabs(c[i])));
        }
    }
    dm_arena_release(&arena);
}

static void bodies_that_differ(void) {
    dm_arena arena = new_arena();
    dm_node roots[ROOTS];
    dm_kernel k;
    CHECK(build(&k, &arena, roots, 1, dm_native_build) == DM_OK && !k.eval);
    dm_arena_release(&arena);
}

static void refused_memory(void) {
    dm_status status = DM_NO_MEMORY;
    for (long requests = 0; requests < 1000 && status == DM_NO_MEMORY; requests++) {
        long left = requests;
        dm_arena arena;
        dm_node roots[ROOTS] = {0};
        dm_kernel k;
        dm_arena_init(&arena, heap, &left);
        dm_graph *g = dm_graph_new(&arena, INPUTS);
        if (g && left) status = build(&k, &arena, roots, 0, dm_tape_build);
        dm_arena_release(&arena);
    }
    CHECK(status == DM_OK);
}

int main(void) {
    RUN(same_values, "21 bodies, one of them another: the roots written out; tape = native code");
    RUN(bodies_that_differ, "bodies that all differ are left alone");
    RUN(refused_memory, "memory refused from the n-th request on, for all n");
    return check_finish();
}
