/* derivatives against closed forms, differences, and the mechanics they come from */
#include "algebra/compact.h"
#include "algebra/derive.h"
#include "graph/analyse.h"

#include "check.h"
#include "models.h"
#include "random_graph.h"

static dm_arena arena;
static dm_graph *g;

static void open_graph(uint32_t inputs) {
    arena = new_arena();
    g = dm_graph_new(&arena, inputs);
}

static double value_at(dm_node n, const double *in) {
    double *value = dm_arena_take(&arena, dm_graph_size(g) * sizeof *value);
    graph_values(g, in, value);
    return value[n];
}

/* op by op: derivative in x at a point, by formulas that are not those of derive.c */
typedef struct {
    dm_op op;
    double x, slope;
} closed_form;

static void functions(void) {
    static const closed_form forms[] = {
        {DM_OP_NEG, 0.7, -1.0},
        {DM_OP_ABS, -0.7, -1.0},
        {DM_OP_ABS, 0.7, 1.0},
        {DM_OP_SIGN, 0.7, 0.0},
        {DM_OP_SQRT, 0.25, 1.0},
        {DM_OP_RSQRT, 0.25, -4.0},
        {DM_OP_RSQRT3, 0.25, -48.0},
        {DM_OP_EXP, 1.0, 2.718281828459045},
        {DM_OP_LOG, 0.125, 8.0},
        {DM_OP_SIN, 1.0471975511965976, 0.5},
        {DM_OP_COS, 0.5235987755982988, -0.5},
        {DM_OP_TAN, 0.7853981633974483, 2.0},
        {DM_OP_ASIN, 0.6, 1.25},
        {DM_OP_ACOS, 0.6, -1.25},
        {DM_OP_ATAN, 2.0, 0.2},
        {DM_OP_SINH, 0.6931471805599453, 1.25},
        {DM_OP_COSH, 0.6931471805599453, 0.75},
        {DM_OP_TANH, 0.6931471805599453, 0.64},
    };
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
        open_graph(1);
        dm_node d;
        dm_gradient(g, dm_apply(g, forms[i].op, dm_input(g, 0), 0, 0), 0, 1, &d);
        CHECK_NEAR(value_at(d, &forms[i].x), forms[i].slope, 4e-15);
        dm_arena_release(&arena);
    }
}

/* d/dx, d/dy of op(x, y) */
static void gradient2(dm_op op, double x, double y, double out[2]) {
    const double in[2] = {x, y};
    dm_node d[2];
    open_graph(2);
    dm_gradient(g, dm_apply(g, op, dm_input(g, 0), dm_input(g, 1), 0), 0, 2, d);
    out[0] = value_at(d[0], in);
    out[1] = value_at(d[1], in);
    dm_arena_release(&arena);
}

static void two_operands(void) {
    double d[2];
    gradient2(DM_OP_DIV, 3.0, 2.0, d);
    CHECK(d[0] == 0.5 && d[1] == -0.75);
    gradient2(DM_OP_ATAN2, 3.0, 4.0, d);
    CHECK_NEAR(d[0], 0.16, 1e-16);
    CHECK_NEAR(d[1], -0.12, 1e-16);
    gradient2(DM_OP_POW, 2.0, 3.0, d);
    CHECK_NEAR(d[0], 12.0, 1e-14);
    CHECK_NEAR(d[1], 5.545177444479562, 1e-14); /* 8 log 2 */
    gradient2(DM_OP_POW, 0.0, 3.0, d);
    CHECK(d[0] == 0.0 && d[1] == 0.0);
    gradient2(DM_OP_POW, -2.0, 3.0, d);
    CHECK(d[0] == 12.0 && isnan(d[1])); /* (-2)^y is no real function of y */
    gradient2(DM_OP_MIN, 1.0, 2.0, d);
    CHECK(d[0] == 1.0 && d[1] == 0.0);
    gradient2(DM_OP_MIN, 2.0, 1.0, d);
    CHECK(d[0] == 0.0 && d[1] == 1.0);
    gradient2(DM_OP_MAX, 1.0, 2.0, d);
    CHECK(d[0] == 0.0 && d[1] == 1.0);
}

/* where(x, sqrt(x), 0) at x < 0 and x = 0: the other branch has no finite derivative there */
static void branches(void) {
    open_graph(1);
    const dm_node x = dm_input(g, 0), root = dm_apply(g, DM_OP_SQRT, x, 0, 0);
    dm_node d, dd;
    dm_gradient(g, dm_apply(g, DM_OP_WHERE, x, root, dm_mul(g, x, x)), 0, 1, &d);
    dm_gradient(g, d, 0, 1, &dd);
    const double at[3] = {4.0, 0.0, -3.0};
    CHECK(value_at(d, at) == 0.25 && value_at(dd, at) == -1.0 / 32);
    CHECK(value_at(d, at + 1) == 0.0 && value_at(dd, at + 1) == 2.0);
    CHECK(value_at(d, at + 2) == -6.0 && value_at(dd, at + 2) == 2.0);
    dm_arena_release(&arena);
}

/* the meaning of a node in long double, for differences */
static long double apply_long(dm_op op, long double a, long double b, long double c) {
    switch (op) {
    case DM_OP_NEG:
        return -a;
    case DM_OP_ABS:
        return fabsl(a);
    case DM_OP_SIGN:
        return (long double)((a > 0) - (a < 0));
    case DM_OP_SQRT:
        return sqrtl(a);
    case DM_OP_RSQRT:
        return 1 / sqrtl(a);
    case DM_OP_RSQRT3:
        return 1 / (a * sqrtl(a));
    case DM_OP_EXP:
        return expl(a);
    case DM_OP_LOG:
        return logl(a);
    case DM_OP_SIN:
        return sinl(a);
    case DM_OP_COS:
        return cosl(a);
    case DM_OP_TAN:
        return tanl(a);
    case DM_OP_ASIN:
        return asinl(a);
    case DM_OP_ACOS:
        return acosl(a);
    case DM_OP_ATAN:
        return atanl(a);
    case DM_OP_SINH:
        return sinhl(a);
    case DM_OP_COSH:
        return coshl(a);
    case DM_OP_TANH:
        return tanhl(a);
    case DM_OP_ADD:
        return a + b;
    case DM_OP_SUB:
        return a - b;
    case DM_OP_MUL:
        return a * b;
    case DM_OP_DIV:
        return a / b;
    case DM_OP_POW:
        return powl(a, b);
    case DM_OP_ATAN2:
        return atan2l(a, b);
    case DM_OP_MIN:
        return b < a ? b : a;
    case DM_OP_MAX:
        return a < b ? b : a;
    case DM_OP_WHERE:
        return a > 0 ? b : c;
    default: /* the fused ones: a b + c, a b - c, c - a b */
        return (op == DM_OP_FNMA ? -a : a) * b + (op == DM_OP_FMS ? -c : c);
    }
}

static long double long_at(dm_node f, const long double *in, long double *value) {
    for (dm_node n = 0; n <= f; n++) {
        const dm_expr *e = dm_graph_at(g, n);
        if (e->op == DM_OP_CONSTANT)
            value[n] = e->as.value;
        else if (e->op == DM_OP_INPUT)
            value[n] = in[e->as.input];
        else
            value[n] =
                apply_long(e->op, value[e->as.arg[0]], value[e->as.arg[1]], value[e->as.arg[2]]);
    }
    return value[f];
}

static long double central(dm_node f, const double *in, int i, long double h) {
    long double at[20], *value = dm_arena_take(&arena, (f + 1) * sizeof *value);
    for (int k = 0; k < 20; k++) at[k] = in[k];
    at[i] = in[i] + h;
    const long double above = long_at(f, at, value);
    at[i] = in[i] - h;
    return (above - long_at(f, at, value)) / (2 * h);
}

/* Richardson's extrapolation of central differences; 0 where the function is not smooth
 * enough there for the two steps to agree */
static int difference(dm_node f, const double *in, int i, double *out) {
    const long double wide = central(f, in, i, 2e-4L), narrow = central(f, in, i, 1e-4L);
    const long double best = (4 * narrow - wide) / 3;
    *out = (double)best;
    return isfinite((double)best) && fabsl(narrow - wide) < 1e-5L * (1 + fabsl(best)) &&
           fabsl(best) < 1e3L;
}

/* a branch whose condition, tan(pi) say, is round-off: long double may take the other side */
static int is_undecided(dm_node n, const double *value) {
    const dm_expr *e = dm_graph_at(g, n);
    const double condition = e->op == DM_OP_WHERE ? fabs(value[e->as.arg[0]]) : 0.0;
    return condition > 0.0 && condition < 1e-14;
}

/* no intermediate value is beyond what differences can bear */
static int is_tame(dm_node f, const double *in) {
    double *value = dm_arena_take(&arena, dm_graph_size(g) * sizeof *value);
    graph_values(g, in, value);
    for (dm_node n = 0; n <= f; n++)
        if (!(fabs(value[n]) < 1e8) || is_undecided(n, value)) return 0;
    return 1;
}

static void against_differences(void) {
    random_source r = {161803};
    long compared = 0, singular = 0;
    for (int graph = 0; graph < 40000; graph++) {
        arena = new_arena();
        g = random_graph(&r, &arena, 3 + random_below(&r, 12), 1);
        const dm_node f = dm_graph_size(g) - 1;
        const uint32_t n = dm_graph_inputs(g);
        dm_node d[8];
        double in[20], want;
        for (int i = 0; i < 20; i++) in[i] = random_between(&r, -1.5, 1.5);
        if (!is_tame(f, in)) {
            dm_arena_release(&arena);
            continue;
        }
        dm_gradient(g, f, 0, n, d);
        for (uint32_t i = 0; i < n; i++) {
            if (!difference(f, in, (int)i, &want)) continue;
            const double got = value_at(d[i], in);
            compared += want != 0.0;
            if (isfinite(got))
                CHECK_NEAR(got, want, 1e-8 * (1.0 + fabs(want)));
            else
                singular++; /* acos(x/x): the chain rule ends in 0 * infinity */
        }
        dm_arena_release(&arena);
    }
    CHECK(compared > 5000 && singular * 500 < compared);
}

/* rows and columns give the same numbers, and the Hessian is their symmetric one */
static void both_orders(void) {
    random_source r = {1123};
    for (int k = 0; k < MODELS; k++) {
        const uint32_t N = 2 * models[k].n;
        static dm_node roots[400], jacobian[324];
        double in[20], want;
        open_graph(N);
        model_roots(g, models + k, roots);
        dm_jacobian(g, roots + 1, N, 0, N, jacobian);
        for (int i = 0; i < 20; i++) in[i] = random_between(&r, 0.3, 1.2) * (i % 2 ? -1 : 1);
        for (uint32_t i = 0; i < N * N; i++) {
            const dm_node h = roots[1 + N + i];
            CHECK(h == roots[1 + N + i % N * N + i / N]);
            CHECK(difference(roots[1 + i / N], in, (int)(i % N), &want));
            CHECK_NEAR(value_at(h, in), want, 1e-9 * (1.0 + fabs(want)));
            CHECK_NEAR(value_at(jacobian[i], in), want, 1e-9 * (1.0 + fabs(want)));
        }
        dm_arena_release(&arena);
    }
}

/* at (0.4, 0) with 1/r: L_q = -q/r^3, L_qq = 3 q q^T/r^5 - 1/r^3 */
static void kepler_by_hand(void) {
    const double in[4] = {0.4, 0.0, 0.0, 2.0};
    dm_node roots[1 + 4 + 16];
    open_graph(4);
    model_roots(g, models, roots);
    CHECK_NEAR(value_at(roots[1], in), -6.25, 1e-14);
    CHECK_NEAR(value_at(roots[4], in), 2.0, 0.0);
    CHECK_NEAR(value_at(roots[5], in), 31.25, 1e-13);
    CHECK_NEAR(value_at(roots[10], in), -15.625, 1e-13);
    CHECK(roots[5 + 2] == 0 && roots[5 + 3] == 0); /* q and v do not mix */
    dm_arena_release(&arena);
}

/* a power is differentiated along its chain, not along a tree */
static void powers_stay_small(void) {
    open_graph(1);
    dm_node d[6] = {dm_power(g, dm_input(g, 0), dm_constant(g, 32.0))}, out[6];
    for (int k = 0; k < 5; k++) dm_gradient(g, d[k], 0, 1, d + k + 1);
    dm_compact(g, d, 6, out);
    const double in[8] = {1.1};
    CHECK_NEAR(value_at(out[5], in) / (32.0 * 31 * 30 * 29 * 28 * pow(1.1, 27)), 1.0, 1e-13);
    CHECK(dm_operations(g, out, 6) <= 20);
    dm_arena_release(&arena);
}

static void substitution(void) {
    open_graph(2);
    const dm_node x = dm_input(g, 0), y = dm_input(g, 1);
    const dm_node f = dm_add(g, dm_mul(g, x, y), dm_apply(g, DM_OP_SIN, x, 0, 0));
    const dm_node with[2] = {dm_mul(g, y, y), dm_constant(g, 3.0)};
    dm_node out;
    dm_substitute(g, &f, 1, with, &out);
    const double in[2] = {-5.0, 0.5};
    CHECK_NEAR(value_at(out, in), 0.75 + sin(0.25), 1e-15);
    CHECK(!dm_depends(g, &out, 1, 0, 1));
    dm_arena_release(&arena);
}

/* what a kernel of gradient and Hessian does; `most` is today's count, a bound against decay */
static void model_sizes(void) {
    static const uint32_t most[MODELS] = {20, 59, 216, 171};
    for (int k = 0; k < MODELS; k++) {
        const uint32_t N = 2 * models[k].n;
        static dm_node roots[400], out[400];
        open_graph(N);
        const uint32_t m = model_roots(g, models + k, roots);
        dm_compact(g, roots + 1, m - 1, out);
        printf("# %s: L %u operations, gradient and Hessian %u, compacted %u\n", models[k].name,
               dm_operations(g, roots, 1), dm_operations(g, roots + 1, m - 1),
               dm_operations(g, out, m - 1));
        CHECK(dm_operations(g, out, m - 1) <= most[k]);
        dm_arena_release(&arena);
    }
}

static void deep_chain(void) {
    open_graph(1);
    dm_node n = dm_input(g, 0), d;
    for (int i = 0; i < 200000; i++) n = dm_apply(g, DM_OP_SIN, n, 0, 0);
    dm_gradient(g, n, 0, 1, &d);
    dm_compact(g, &d, 1, &d);
    CHECK(dm_graph_status(g) == DM_OK && d != 0);
    dm_arena_release(&arena);
}

int main(void) {
    RUN(functions, "functions of one operand: closed forms");
    RUN(two_operands, "functions of two operands: closed forms");
    RUN(branches, "a branch that is not taken adds nothing, even where it is singular");
    RUN(against_differences, "gradients of 40000 random graphs against differences");
    RUN(both_orders, "Hessians of the models: symmetric, against differences");
    RUN(kepler_by_hand, "Kepler's gradient and Hessian by hand");
    RUN(powers_stay_small, "five derivatives of x^32 share their powers");
    RUN(substitution, "substitution");
    RUN(model_sizes, "operation counts of the models");
    RUN(deep_chain, "a chain of 200000 functions needs no deep recursion");
    return check_finish();
}
