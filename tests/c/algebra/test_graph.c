/* nodes are shared and simplified, and keep their values */
#include "algebra/compact.h"
#include "algebra/derive.h"
#include "graph/analyse.h"

#include "check.h"
#include "models.h"
#include "random_graph.h"

static dm_arena arena;
static dm_graph *g;
static dm_node x, y, z;

static void open_graph(void) {
    arena = new_arena();
    g = dm_graph_new(&arena, 3);
    x = dm_input(g, 0), y = dm_input(g, 1), z = dm_input(g, 2);
}

static dm_node number(double v) {
    return dm_constant(g, v);
}

static dm_node call(dm_op op, dm_node a) {
    return dm_apply(g, op, a, 0, 0);
}

static void sharing(void) {
    open_graph();
    CHECK(dm_add(g, x, y) == dm_add(g, y, x) && dm_mul(g, x, y) == dm_mul(g, y, x));
    CHECK(call(DM_OP_SIN, x) == call(DM_OP_SIN, x));
    CHECK(number(1.5) == number(1.5) && number(0.0) == 0);
    const uint32_t before = dm_graph_size(g);
    for (int i = 0; i < 100; i++) dm_mul(g, dm_add(g, x, y), call(DM_OP_SIN, x));
    CHECK(dm_graph_size(g) == before + 1);
    dm_arena_release(&arena);
}

/* all nodes from `first` on are found under their numbers; gives how many are not */
static uint32_t count_lost(dm_node first) {
    uint32_t lost = 0;
    for (dm_node n = first; n < dm_graph_size(g); n++) {
        const dm_expr e = *dm_graph_at(g, n);
        lost += dm_node_make(g, &e) != n;
    }
    return lost;
}

/* nodes of one newest operand have few places near it and go anywhere, as do numbers */
static void crowds(void) {
    open_graph();
    for (int i = 1; i <= 5000; i++) dm_add(g, call(DM_OP_SIN, x), number(1.0 / i));
    for (int i = 1; i <= 500; i++) dm_mul(g, z, dm_input(g, (uint32_t)i % 3));
    CHECK(dm_graph_size(g) > 10000 && count_lost(1) == 0);
    dm_arena_release(&arena);
}

/* what is taken away leaves a graph that goes on as if it had not been there, over growth of the
 * table too */
static void forgetting(void) {
    for (uint32_t kept = 10; kept < 3000; kept = 3 * kept + 1) {
        open_graph();
        random_source first = {.state = kept}, again;
        while (dm_graph_size(g) < kept) {
            const dm_node a = random_operand(&first, g), b = random_operand(&first, g);
            dm_apply(g, random_op(&first), a, b, x);
        }
        const uint32_t size = dm_graph_size(g);
        dm_node made[2][2000];
        for (int round = 0; round < 2; round++) {
            again = first;
            for (int i = 0; i < 2000; i++) {
                const dm_node a = random_operand(&again, g);
                made[round][i] = dm_apply(g, random_op(&again), a, y, z);
            }
            CHECK(count_lost(1) == 0);
            if (round == 0) dm_graph_forget(g, size);
        }
        CHECK(memcmp(made[0], made[1], sizeof made[0]) == 0);
        dm_arena_release(&arena);
    }
}

/* sum over i < j of 1/|x_i - x_j|, in which rewriting finds nothing */
static dm_node many_bodies(uint32_t bodies) {
    dm_node sum = 0;
    for (uint32_t i = 0; i < bodies; i++)
        for (uint32_t j = 0; j < i; j++) {
            dm_node r2 = 0;
            for (uint32_t k = 0; k < 3; k++) {
                const dm_node d = dm_sub(g, dm_input(g, 3 * i + k), dm_input(g, 3 * j + k));
                r2 = dm_add(g, r2, dm_mul(g, d, d));
            }
            sum = dm_add(g, sum, dm_div(g, number(1.0), call(DM_OP_SQRT, r2)));
        }
    return sum;
}

static void nothing_twice(void) {
    enum { BODIES = 20, N = 3 * BODIES };
    dm_node one[N], two[N], small[N];
    arena = new_arena();
    g = dm_graph_new(&arena, N);
    const dm_node f = many_bodies(BODIES);
    const uint32_t traced = dm_graph_size(g);
    CHECK(dm_compact_source(g, f) == f && dm_graph_size(g) == traced);
    dm_gradient(g, f, 0, N, one);
    const uint32_t derived = dm_graph_size(g);
    CHECK(derived < traced + 2 * dm_operations(g, &f, 1));
    dm_gradient(g, f, 0, N, two);
    CHECK(memcmp(one, two, sizeof one) == 0);
    const dm_graph *h = dm_compact_graph(g, one, N, small);
    CHECK(h && h == dm_compact_graph(g, two, N, two) && h != g);
    CHECK(memcmp(small, two, sizeof small) == 0 && dm_graph_size(g) == derived);
    dm_arena_release(&arena);
}

static void identities(void) {
    open_graph();
    const dm_node s = dm_add(g, x, y), n = dm_neg(g, x);
    CHECK(dm_add(g, x, 0) == x && dm_sub(g, x, 0) == x && dm_sub(g, 0, x) == n);
    CHECK(dm_mul(g, x, number(1.0)) == x && dm_mul(g, x, 0) == 0);
    CHECK(dm_sub(g, x, x) == 0 && dm_neg(g, n) == x && dm_div(g, x, number(1.0)) == x);
    CHECK(dm_mul(g, n, y) == dm_neg(g, dm_mul(g, x, y)));
    CHECK(dm_mul(g, n, dm_neg(g, y)) == dm_mul(g, x, y));
    CHECK(dm_add(g, x, dm_neg(g, y)) == dm_sub(g, x, y));
    CHECK(dm_sub(g, x, dm_neg(g, y)) == s && dm_add(g, x, x) == dm_mul(g, number(2.0), x));
    CHECK(dm_neg(g, dm_sub(g, y, z)) == dm_sub(g, z, y));
    CHECK(dm_mul(g, number(2.0), dm_mul(g, x, number(3.0))) == dm_mul(g, number(6.0), x));
    CHECK(dm_add(g, number(2.0), dm_add(g, s, number(-2.0))) == s);
    CHECK(dm_apply(g, DM_OP_WHERE, number(1.0), x, y) == x);
    CHECK(dm_apply(g, DM_OP_WHERE, x, y, y) == y);
    dm_arena_release(&arena);
}

static void functions(void) {
    open_graph();
    const dm_node n = dm_neg(g, x), x2 = dm_mul(g, x, x);
    const dm_node u = dm_add(g, x2, dm_mul(g, y, y)), r = call(DM_OP_SQRT, u);
    CHECK(call(DM_OP_SIN, n) == dm_neg(g, call(DM_OP_SIN, x)));
    CHECK(call(DM_OP_COS, n) == call(DM_OP_COS, x));
    CHECK(call(DM_OP_SQRT, x2) == call(DM_OP_ABS, x));
    CHECK(call(DM_OP_ABS, x2) == x2 && dm_mul(g, r, r) == u);
    const dm_node s = call(DM_OP_SQRT, x); /* NaN for x < 0: its square is not x */
    CHECK(dm_mul(g, s, s) != x);
    double c;
    CHECK(dm_is_constant(g, call(DM_OP_COS, 0), &c) && c == 1.0);
    dm_arena_release(&arena);
}

static void powers(void) {
    open_graph();
    const dm_node x2 = dm_mul(g, x, x), x4 = dm_mul(g, x2, x2);
    CHECK(dm_power(g, x, number(2.0)) == x2 && dm_power(g, x, number(4.0)) == x4);
    CHECK(dm_power(g, x, number(3.0)) == dm_mul(g, x, x2));
    CHECK(dm_power(g, x, number(0.5)) == call(DM_OP_SQRT, x));
    double in[3] = {1.7, 0.0, 0.0}, *value = NULL;
    for (int k = -128; k <= 128; k++) {
        const dm_node p = dm_power(g, x, number(k / 2.0));
        value = dm_arena_take(&arena, dm_graph_size(g) * sizeof *value);
        graph_values(g, in, value);
        CHECK_NEAR(value[p] / pow(1.7, k / 2.0), 1.0, 2e-14);
    }
    uint32_t counts[DM_OP_COUNT];
    const dm_node p[2] = {dm_power(g, x, number(7.5)), dm_power(g, x, number(-7.5))};
    dm_operation_counts(g, p, 2, counts);
    CHECK(counts[DM_OP_POW] == 0 && counts[DM_OP_SQRT] == 1 && counts[DM_OP_RSQRT] == 1 &&
          counts[DM_OP_DIV] == 0);
    dm_arena_release(&arena);
}

/* every node of a random graph, made by dm_apply, against the same without simplification;
 * operands in (0.2, 3) and intermediate values below 1e6 in size are compared */
static void values_kept(void) {
    random_source r = {31415};
    long compared = 0;
    for (int graph = 0; graph < 20000; graph++) {
        dm_arena a = new_arena();
        dm_graph *h = dm_graph_new(&a, 3);
        double in[3], plain[24], *value;
        dm_node node[24];
        for (int i = 0; i < 3; i++) {
            node[i] = dm_input(h, (uint32_t)i);
            plain[i] = in[i] = random_between(&r, 0.2, 3.0);
        }
        node[3] = dm_constant(h, plain[3] = random_below(&r, 7) / 2.0 - 1.5);
        node[4] = dm_constant(h, plain[4] = random_between(&r, -2.0, 2.0));
        for (int i = 5; i < 24; i++) {
            const uint32_t p = random_below(&r, (uint32_t)i), q = random_below(&r, (uint32_t)i),
                           s = random_below(&r, (uint32_t)i);
            const dm_op op = random_op(&r);
            node[i] = dm_apply(h, op, node[p], node[q], node[s]);
            value = dm_arena_take(&a, dm_graph_size(h) * sizeof *value);
            graph_values(h, in, value);
            plain[i] = dm_op_value(op, value[node[p]], value[node[q]], value[node[s]]);
            const double got = value[node[i]];
            const int wild = !(fabs(plain[p]) + fabs(plain[q]) <= 1e6);
            if (!isfinite(plain[i]) || fabs(plain[i]) > 1e6 || wild) continue;
            const double size = fabs(plain[p]) + fabs(plain[q]) + fabs(plain[i]);
            compared += fabs(got - plain[i]) <= 1e-12 * (1.0 + size * size);
            CHECK_NEAR(got, plain[i], 1e-12 * (1.0 + size * size));
        }
        dm_arena_release(&a);
    }
    CHECK(compared > 200000);
}

static void random_arithmetic(random_source *r) {
    static const dm_op ops[] = {DM_OP_ADD, DM_OP_SUB, DM_OP_MUL,  DM_OP_COS, DM_OP_NEG,
                                DM_OP_DIV, DM_OP_SIN, DM_OP_SQRT, DM_OP_ADD, DM_OP_MUL};
    const dm_op op = ops[random_below(r, 10)];
    const dm_node a = random_operand(r, g), b = random_operand(r, g);
    dm_apply(g, op, a, b, 0);
}

/* arithmetic of sizes near 1, so that cancellation does not hide errors */
static void compaction(void) {
    random_source r = {2718};
    long compared = 0;
    for (int graph = 0; graph < 20000; graph++) {
        open_graph();
        const int count = 4 + (int)random_below(&r, 30);
        for (int i = 0; i < count; i++) random_arithmetic(&r);
        dm_node roots[3], out[3];
        for (uint32_t i = 0; i < 3; i++) roots[i] = dm_graph_size(g) - 1 - i;
        dm_compact(g, roots, 3, out);
        double in[3], *value = dm_arena_take(&arena, dm_graph_size(g) * sizeof *value);
        for (int i = 0; i < 3; i++) in[i] = random_between(&r, 0.3, 2.0);
        graph_values(g, in, value);
        for (int i = 0; i < 3; i++) {
            const double want = value[roots[i]];
            if (!isfinite(want) || fabs(want) > 1e4) continue;
            compared++;
            CHECK_NEAR(value[out[i]], want, 1e-7 * (1.0 + fabs(want))); /* sqrt(round-off) */
        }
        dm_arena_release(&arena);
    }
    CHECK(compared > 40000);
}

static void append(void *ud, const char *text, size_t length) {
    strncat(ud, text, length);
}

/* 1/r, 1/r^3, 1/r^5 from one reciprocal root; x - y and y - x are one subtraction */
static void compact_forms(void) {
    uint32_t counts[DM_OP_COUNT];
    open_graph();
    const dm_node u = sum_of_squares(g, (dm_node[]){x, y, z}, 3);
    dm_node roots[3], out[3];
    for (int i = 0; i < 3; i++) roots[i] = dm_power(g, u, number(-0.5 - i));
    dm_compact(g, roots, 3, out);
    dm_operation_counts(g, out, 3, counts);
    CHECK(counts[DM_OP_RSQRT] == 1 && counts[DM_OP_DIV] + counts[DM_OP_SQRT] == 0 &&
          counts[DM_OP_MUL] <= 6);
    const dm_node both[2] = {call(DM_OP_SQRT, u), dm_power(g, u, number(-0.5))};
    const double zero[3] = {0.0, 0.0, 0.0};
    dm_compact(g, both, 2, out); /* sqrt(u) out of 1/sqrt(u), and 0 at 0 */
    dm_operation_counts(g, out, 2, counts);
    CHECK(counts[DM_OP_RSQRT] == 1 && counts[DM_OP_DIV] + counts[DM_OP_SQRT] == 0);
    double *value = dm_arena_take(&arena, dm_graph_size(g) * sizeof *value);
    graph_values(g, zero, value);
    CHECK(value[out[0]] == 0.0 && value[out[1]] == INFINITY);
    const dm_node sum = dm_add(g, dm_mul(g, x, y), dm_mul(g, x, z));
    dm_compact(g, &sum, 1, out);
    CHECK(dm_operations(g, out, 1) == 2);
    const dm_node back[2] = {dm_mul(g, dm_sub(g, x, y), z), dm_mul(g, dm_sub(g, y, x), z)};
    dm_compact(g, back, 2, out);
    CHECK(dm_operations(g, out, 2) <= 3);
    dm_arena_release(&arena);
}

/* |d/dt (sin a cos b, sin a sin b, cos a)|^2 = a'^2 + b'^2 sin^2 a */
static void trigonometry(void) {
    arena = new_arena();
    g = dm_graph_new(&arena, 4);
    dm_node v[3], in[4];
    for (uint32_t i = 0; i < 4; i++) in[i] = dm_input(g, i);
    rod(g, v, in, in + 2);
    const dm_node T = sum_of_squares(g, v, 3);
    const dm_node sine = call(DM_OP_SIN, in[0]), swing = dm_mul(g, in[3], sine);
    const dm_node a2 = dm_mul(g, in[2], in[2]), b2 = dm_mul(g, swing, swing);
    dm_node out;
    dm_compact(g, &T, 1, &out);
    CHECK(dm_operations(g, &out, 1) == 5);
    const dm_node want = dm_add(g, a2, b2), plain = dm_sub(g, in[0], in[1]);
    const double at[4] = {0.3, -1.1, 0.7, 2.0};
    double *value = dm_arena_take(&arena, dm_graph_size(g) * sizeof *value);
    graph_values(g, at, value);
    CHECK_NEAR(value[out], value[want], 1e-15);
    const dm_node spring = dm_mul(g, dm_mul(g, plain, plain), in[2]);
    dm_compact(g, &spring, 1, &out); /* (x - y)^2 must not become x^2 - 2 x y + y^2 */
    CHECK(dm_operations(g, &out, 1) == 3);
    dm_arena_release(&arena);
}

static void structure(void) {
    open_graph();
    const dm_node roots[2] = {dm_mul(g, x, x), call(DM_OP_SIN, z)};
    CHECK(dm_depends(g, roots, 2, 0, 1) && !dm_depends(g, roots, 2, 1, 1));
    CHECK(dm_depends(g, roots, 1, 0, 3) && !dm_depends(g, roots, 1, 1, 2));
    CHECK(dm_operations(g, roots, 2) == 2);
    dm_arena_release(&arena);
}

static void printing(void) {
    static const char *const names[] = {"x", "y", "z"};
    char text[400] = "";
    open_graph();
    const dm_node s = call(DM_OP_SIN, x);
    const dm_node roots[2] = {dm_sub(g, dm_mul(g, s, s), dm_sub(g, y, z)),
                              dm_div(g, dm_add(g, s, y), dm_mul(g, y, z))};
    dm_print(g, roots, 2, names, append, text);
    CHECK(strcmp(text, "t1 = sin(x)\ny1 = t1^2 - (y - z)\ny2 = (y + t1)/(y*z)\n") == 0);
    dm_arena_release(&arena);
}

static void limit(void) {
    open_graph();
    dm_node n = x;
    for (uint32_t i = 0; i < DM_GRAPH_LIMIT + 10u; i++) n = dm_apply(g, DM_OP_EXP, n, 0, 0);
    CHECK(dm_graph_status(g) == DM_TOO_LARGE && n == 0);
    CHECK(dm_graph_size(g) == DM_GRAPH_LIMIT && dm_constant(g, 5.0) == 0);
    dm_arena_release(&arena);
}

/* everything that takes memory, with `left` blocks of it */
static int with_blocks(long left) {
    dm_arena a;
    dm_arena_init(&a, heap, &left);
    dm_graph *h = dm_graph_new(&a, 18);
    int done = 0;
    if (h) {
        dm_node roots[400], out[400];
        char text[20000] = "";
        const uint32_t m = model_roots(h, models + 3, roots);
        dm_compact(h, roots, m, out);
        dm_print(h, out, 3, NULL, append, text);
        done = dm_graph_status(h) == DM_OK;
        CHECK(done || dm_graph_status(h) == DM_NO_MEMORY);
    }
    dm_arena_release(&a);
    return done;
}

static void refused_memory(void) {
    long left = 0;
    while (!with_blocks(left) && left < 1000) left++;
    CHECK(left > 3 && left < 1000);
}

int main(void) {
    RUN(sharing, "equal nodes are one node");
    RUN(crowds, "nodes of one operand, and numbers, are found in crowds");
    RUN(forgetting, "what is taken away leaves no trace");
    RUN(nothing_twice,
        "rewriting for nothing leaves nothing; derivatives and kernels are made once");
    RUN(identities, "identities of arithmetic");
    RUN(functions, "signs leave functions; sqrt(u)^2 = u only where u >= 0");
    RUN(powers, "whole and half powers from -64 to 64, shared");
    RUN(values_kept, "dm_apply keeps values: 20000 random graphs of every operation");
    RUN(compaction, "compaction keeps values: 20000 random graphs");
    RUN(compact_forms, "compaction shares powers, factors and differences");
    RUN(trigonometry, "sin^2 + cos^2 = 1 is seen inside squares; differences stay");
    RUN(structure, "dependence and operation counts");
    RUN(printing, "printing names what is shared");
    RUN(limit, "a graph that grows too large says so");
    RUN(refused_memory, "memory refused from the n-th request on, for all n");
    return check_finish();
}
