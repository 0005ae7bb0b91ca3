/* elementary functions: their error against long double, and that all processor levels have them */
#include "expr/functions.h"
#include "expr/jit.h"
#include "expr/processor.h"
#include "expr/tape.h"

#include "check.h"
#include "random_graph.h"

#include <float.h>

/* |y - exact| in units of the last place of a double as large as exact */
static double ulps(double y, long double exact) {
    int exponent;
    if (y != y || exact != exact) return y != y && exact != exact ? 0.0 : INFINITY;
    if (isinf(exact) || exact == 0.0L) return (long double)y == exact ? 0.0 : INFINITY;
    frexpl(exact, &exponent);
    if (exponent < DBL_MIN_EXP) exponent = DBL_MIN_EXP;
    return (double)(fabsl(y - exact) / ldexpl(1.0L, exponent - DBL_MANT_DIG));
}

/* any double: sign, exponent and digits by chance */
static double random_double(random_source *r) {
    const uint64_t bits =
        (uint64_t)random_below(r, UINT32_MAX) << 32 | random_below(r, UINT32_MAX);
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static const double hard[] = {0.0,
                              -0.0,
                              INFINITY,
                              -INFINITY,
                              NAN,
                              -1.0,
                              5e-324,
                              1e-310,
                              4e-309,
                              DBL_MIN,
                              DBL_MAX,
                              1.0,
                              0x1p-1021,
                              0x1p1023,
                              4.0,
                              0.25,
                              0x1.fffffffffffffp0};
enum { HARD = sizeof hard / sizeof hard[0] };

/* the processor's own level, then those below it: what the last run leaves is all again */
static void at_every_level(void run(dm_processor_level level)) {
    for (int level = DM_AVX512; level >= DM_PLAIN; level--) {
        dm_processor_limit((dm_processor_level)level);
        if ((int)dm_processor() == level) run((dm_processor_level)level);
    }
    dm_processor_limit(DM_AVX512);
}

static void root_at(dm_processor_level level) {
    const double most = level == DM_AVX512 ? 0.6 : 1.5; /* two roundings, one of a number just below 1 */
    random_source r = {7};
    double worst = 0.0;
    for (int i = 0; i < 1000000 + HARD; i++) {
        const double x = i < HARD ? hard[i] : random_double(&r);
        const double error = ulps(dm_rsqrt(x), 1.0L / sqrtl(x));
        if (x == 0.0)
            CHECK(dm_rsqrt(x) == 1.0 / x);
        else if (error > worst)
            worst = error;
    }
    printf("# 1/sqrt(x) at level %d: %.3f ulp\n", (int)level, worst);
    CHECK(worst < most);
}

static void reciprocal_root(void) {
    at_every_level(root_at);
}

/* one operation of up to two operands in `lanes`, hard arguments and random ones */
static void compare_op(dm_op op, uint32_t lanes) {
    random_source r = {op + 1u};
    dm_arena arena = new_arena();
    dm_graph *g = dm_graph_new(&arena, 2);
    const dm_node x = dm_input(g, 0), y = dm_input(g, 1);
    const dm_node root = dm_node_plain(g, op, x, dm_op_operands(op) > 1 ? y : 0, 0);
    dm_kernel k;
    double in[16], out[8];
    CHECK(dm_jit_build_exact(&k, g, &root, 1, lanes, &arena) == DM_OK);
    for (int i = 0; i < 3000; i++) {
        for (uint32_t j = 0; j < 2 * lanes; j++)
            in[j] = i < 2 * HARD && j < lanes ? hard[(i + (int)j) % HARD]
                    : i % 2                   ? random_double(&r)
                                              : random_between(&r, -4.0, 4.0);
        dm_kernel_eval(&k, in, out);
        for (uint32_t j = 0; j < lanes; j++)
            CHECK(same_bits(out[j], dm_op_value(op, in[j], in[lanes + j], 0.0)));
    }
    dm_arena_release(&arena);
}

static void all_widths_at(dm_processor_level level) {
    (void)level;
    for (int op = DM_OP_NEG; op < DM_OP_WHERE; op++)
        for (uint32_t lanes = 1; lanes <= dm_jit_lanes();
             lanes = lanes == 1 ? 4 : 2 * lanes)
            compare_op((dm_op)op, lanes);
}

static void all_widths(void) {
    at_every_level(all_widths_at);
}

int main(void) {
    RUN(reciprocal_root, "1/sqrt(x): its error, and the ends of the range");
    RUN(all_widths,
        "every operation: native code of every width and level = dm_op_value");
    return check_finish();
}
