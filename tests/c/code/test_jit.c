/* native code gives the bits of a node-by-node sweep, in every width */
#include "code/native/jit.h"
#include "code/tape/tape.h"
#include "numbers/fma.h"
#include "numbers/processor.h"

#include "check.h"
#include "models.h"
#include "random_graph.h"

#include <sys/resource.h>
#include <time.h>

#if defined(__SANITIZE_ADDRESS__)
#define LIMITS_ADDRESSES 0 /* the sanitizer needs the address space itself */
#elif defined(__has_feature)
#define LIMITS_ADDRESSES !__has_feature(address_sanitizer)
#else
#define LIMITS_ADDRESSES 1
#endif

static long graphs_compared, values_compared;

/* one graph on random points, `lanes` at a time */
static void compare(random_source *r, dm_graph *g, dm_arena *arena, uint32_t m, uint32_t lanes) {
    dm_node *roots = dm_arena_take(arena, m * sizeof *roots);
    roots[0] = dm_graph_size(g) - 1;
    for (uint32_t i = 1; i < m; i++) roots[i] = random_operand(r, g);
    double *value = dm_arena_take(arena, dm_graph_size(g) * sizeof *value);
    double *out = dm_arena_take(arena, m * lanes * sizeof *out), in[8 * 8], one[8];
    dm_kernel k;
    const dm_status status = dm_jit_build_exact(&k, g, roots, m, lanes, arena);
    if (!CHECK(status == DM_OK)) return;
    for (uint32_t i = 0; i < 8 * lanes; i++) in[i] = random_between(r, -3.0, 3.0);
    dm_kernel_prepare_lanes(&k, lanes, out);
    dm_kernel_eval(&k, in, out);
    for (uint32_t lane = 0; lane < lanes; lane++) {
        for (uint32_t i = 0; i < 8; i++) one[i] = in[i * lanes + lane];
        graph_values(g, one, value);
        for (uint32_t i = 0; i < m; i++, values_compared++)
            CHECK(same_bits(out[i * lanes + lane], value[roots[i]]));
    }
    graphs_compared++;
}

static void many_graphs(uint64_t seed, int graphs, uint32_t most, uint32_t lanes) {
    random_source r = {seed};
    for (int i = 0; i < graphs && lanes <= dm_jit_lanes(); i++) {
        dm_arena arena = new_arena();
        dm_graph *g = random_graph(&r, &arena, 1 + random_below(&r, most), i % KINDS_OF_GRAPHS);
        const uint32_t m = 1 + random_below(&r, i % 4 ? 12 : 200);
        compare(&r, g, &arena, m, lanes);
        dm_arena_release(&arena);
    }
}

static void scalar(void) {
    many_graphs(1, 6000, 60, 1);
    many_graphs(2, 300, 2000, 1);
}

static void lanes4(void) {
    many_graphs(3, 4000, 60, 4);
    many_graphs(4, 100, 2000, 4);
}

static void lanes8(void) {
    many_graphs(5, 4000, 60, 8);
    many_graphs(6, 100, 2000, 8);
}

static void large(void) {
    many_graphs(7, 3, 100000, 1);
}

/* a processor without the instruction: a * b + c is rounded twice on all roads */
static void rounded_twice(void) {
    dm_fma_allow(0);
    CHECK(dm_fma(1.0 + 0x1p-52, 1.0 - 0x1p-52, -1.0) == 0.0);
    many_graphs(12, 300, 60, 1);
    many_graphs(13, 300, 60, 4);
    many_graphs(14, 300, 60, 8);
    dm_fma_allow(1);
    if (dm_fma_is_fused()) CHECK(dm_fma(1.0 + 0x1p-52, 1.0 - 0x1p-52, -1.0) == -0x1p-104);
}

/* more live values than registers, used in an order that spills */
static void pressure(void) {
    random_source r = {11};
    for (uint32_t lanes = 1; lanes <= dm_jit_lanes(); lanes = lanes == 1 ? 4 : 2 * lanes) {
        dm_arena arena = new_arena();
        dm_graph *g = dm_graph_new(&arena, 6);
        dm_node n[200];
        for (uint32_t i = 0; i < 200; i++) {
            n[i] = dm_constant(g, random_between(&r, 0.5, 1.5));
            n[i] = dm_mul(g, n[i], dm_input(g, i % 6));
            if (i % 20 == 0) n[i] = dm_apply(g, DM_OP_SIN, n[i], 0, 0);
        }
        dm_node sum = n[0];
        for (int i = 199; i > 0; i--)
            sum = i % 3 ? dm_add(g, dm_node_plain(g, DM_OP_DIV, n[i], sum, 0), n[199 - i])
                        : dm_node_plain(g, DM_OP_MAX, sum, n[i], 0);
        compare(&r, g, &arena, 9, lanes);
        dm_arena_release(&arena);
    }
}

/* the compacted kernels of the models: tape and native code, and how long it takes */
static void model_kernels(void) {
    random_source r = {13};
    for (int k = 0; k < MODELS && dm_jit_lanes(); k++) {
        static dm_node roots[400];
        double in[20], a[400], b[400];
        dm_arena arena = new_arena();
        dm_graph *g = dm_graph_new(&arena, 2 * models[k].n);
        const uint32_t m = model_roots(g, models + k, roots);
        dm_kernel tape, jit;
        CHECK(dm_tape_build(&tape, g, roots, m, &arena) == DM_OK);
        CHECK(dm_jit_build(&jit, g, roots, m, &arena) == DM_OK);
        dm_kernel_prepare(&tape, a);
        dm_kernel_prepare(&jit, b);
        for (int i = 0; i < 1000; i++) {
            for (int j = 0; j < 20; j++) in[j] = random_between(&r, -2.0, 2.0);
            dm_kernel_eval(&tape, in, a);
            dm_kernel_eval(&jit, in, b);
            CHECK(memcmp(a, b, m * sizeof *a) == 0);
        }
        dm_arena_release(&arena);
    }
}

/* attracting bodies in space: many values alive that are read once from memory, so that a slot
 * whose value dies in a step must not be used again within that step */
static void crowded(void) {
    random_source r = {29};
    for (uint32_t bodies = 2; bodies <= 9; bodies++) {
        const uint32_t n = 3 * bodies;
        double in[27], *a, *b;
        dm_arena arena = new_arena();
        dm_graph *g = dm_graph_new(&arena, n);
        dm_node *roots = dm_arena_take(&arena, (n + n * n) * sizeof *roots), V = 0;
        for (uint32_t i = 0; i < bodies; i++)
            for (uint32_t j = 0; j < i; j++) {
                dm_node r2 = 0;
                for (uint32_t k = 0; k < 3; k++) {
                    const dm_node d = dm_sub(g, dm_input(g, 3 * i + k), dm_input(g, 3 * j + k));
                    r2 = dm_add(g, r2, dm_mul(g, d, d));
                }
                const dm_node c = dm_constant(g, 0.3 + 0.7 * i + j);
                V = dm_add(g, V, dm_div(g, c, dm_apply(g, DM_OP_SQRT, r2, 0, 0)));
            }
        const uint32_t m = n + n * n;
        dm_hessian(g, V, 0, n, roots, roots + n);
        dm_kernel tape, jit;
        CHECK(dm_tape_build(&tape, g, roots, m, &arena) == DM_OK);
        CHECK(dm_jit_build(&jit, g, roots, m, &arena) == DM_OK);
        a = dm_arena_take(&arena, m * sizeof *a), b = dm_arena_take(&arena, m * sizeof *b);
        dm_kernel_prepare(&tape, a);
        dm_kernel_prepare(&jit, b);
        for (uint32_t j = 0; j < n; j++) in[j] = random_between(&r, -2.0, 2.0);
        dm_kernel_eval(&tape, in, a);
        dm_kernel_eval(&jit, in, b);
        CHECK(memcmp(a, b, m * sizeof *a) == 0);
        dm_arena_release(&arena);
    }
}

static void refusals(void) {
    dm_arena arena = new_arena();
    dm_graph *g = dm_graph_new(&arena, 1);
    const dm_node x = dm_input(g, 0);
    dm_kernel k = {.outputs = 77};
    CHECK(dm_jit_build_exact(&k, g, &x, 1, 3, &arena) == DM_NO_NATIVE && k.outputs == 77);
    dm_jit_limit(0); /* as on a processor without AVX */
    CHECK(dm_jit_lanes() == 0);
    CHECK(dm_jit_build(&k, g, &x, 1, &arena) == DM_NO_NATIVE && k.outputs == 77);
    CHECK(dm_native_build(&k, g, &x, 1, &arena) == DM_OK && k.backend[0] == 't');
    dm_jit_limit(8);
    dm_arena_release(&arena);
}

/* valgrind and the sanitizer live in the same address space and need it themselves */
static int may_limit_addresses(void) {
    const char *preload = getenv("LD_PRELOAD");
    return LIMITS_ADDRESSES && !(preload && strstr(preload, "valgrind"));
}

/* no address space left for code: the arena's memory was taken before */
static void refused_code_memory(void) {
    struct rlimit old, none;
    dm_arena arena = new_arena();
    dm_graph *g = dm_graph_new(&arena, 1);
    const dm_node x = dm_input(g, 0);
    dm_kernel k;
    CHECK(dm_arena_take(&arena, 1 << 16) != NULL);
    CHECK(getrlimit(RLIMIT_AS, &old) == 0);
    none = old;
    none.rlim_cur = 1 << 20;
    if (may_limit_addresses() && dm_jit_lanes() && setrlimit(RLIMIT_AS, &none) == 0) {
        const dm_status status = dm_jit_build(&k, g, &x, 1, &arena);
        CHECK(status == DM_NO_NATIVE || status == DM_NO_MEMORY);
        setrlimit(RLIMIT_AS, &old);
    }
    dm_arena_release(&arena);
}

static int with_blocks(long left) {
    random_source r = {99};
    dm_arena arena;
    dm_arena_init(&arena, heap, &left);
    dm_graph *g = random_graph(&r, &arena, 3000, 1);
    dm_status status = g ? dm_graph_status(g) : DM_NO_MEMORY;
    dm_kernel k = {.outputs = 77};
    if (g) {
        const dm_node root = dm_graph_size(g) - 1;
        status = dm_jit_build(&k, g, &root, 1, &arena);
        CHECK(status == DM_OK || k.outputs == 77);
    }
    dm_arena_release(&arena);
    return status == DM_OK;
}

static void refused_memory(void) {
    long left = 0;
    while (dm_jit_lanes() && !with_blocks(left) && left < 1000) left++;
    CHECK(left < 1000);
}

int main(int argc, char **argv) {
    const int seconds = argc > 1 ? atoi(argv[1]) : 0; /* fuzz that long */
    const time_t start = time(NULL);
    for (uint64_t seed = (uint64_t)start; time(NULL) - start < seconds; seed += 4) {
        dm_processor_limit((dm_processor_level)(seed / 4 % 3));
        for (uint32_t lanes = 1, most = 20; lanes <= 8; lanes = lanes == 1 ? 4 : 2 * lanes)
            many_graphs(seed + lanes * 1000003u, 50, most = most * 5 % 3001, lanes);
    }
    dm_processor_limit(DM_AVX512);
    RUN(scalar, "6300 random graphs: native code = sweep, bit for bit");
    RUN(lanes4, "4100 random graphs in 4 lanes");
    RUN(lanes8, "4100 random graphs in 8 lanes");
    RUN(large, "graphs of up to 100000 operations");
    RUN(rounded_twice, "fused multiply-add, and where there is none");
    RUN(pressure, "more values alive than registers");
    RUN(model_kernels, "kernels of the models: tape = native code, bit for bit");
    if (dm_jit_lanes())
        RUN(crowded, "nine bodies: more values alive than registers, many dying in memory");
    RUN(refusals, "no AVX, no such width: the tape takes over");
    RUN(refused_code_memory, "executable memory refused");
    RUN(refused_memory, "memory refused from the n-th request on, for all n");
    printf("# %ld graphs, %ld values compared\n", graphs_compared, values_compared);
    return check_finish();
}
