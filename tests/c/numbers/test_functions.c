/* elementary functions: their error against long double, and that all processor levels have them */
#include "code/loops/array_loop.h"
#include "code/native/jit.h"
#include "code/tape/tape.h"
#include "numbers/functions.h"
#include "numbers/processor.h"

#include "check.h"
#include "random_graph.h"

#include <float.h>

/* |y - exact| in units of the last place of a double as large as exact */
static double ulps(double y, long double exact) {
    int exponent;
    if (y != y || exact != exact) return y != y && exact != exact ? 0.0 : INFINITY;
    if (fabsl(exact) > DBL_MAX) exact = exact < 0.0L ? -INFINITY : INFINITY;
    if (isinf(exact) || exact == 0.0L) return (long double)y == exact ? 0.0 : INFINITY;
    frexpl(exact, &exponent);
    if (exponent < DBL_MIN_EXP) exponent = DBL_MIN_EXP;
    return (double)(fabsl(y - exact) / ldexpl(1.0L, exponent - DBL_MANT_DIG));
}

/* any double: sign, exponent and digits by chance */
static double random_double(random_source *r) {
    const uint64_t bits = (uint64_t)random_below(r, UINT32_MAX) << 32 | random_below(r, UINT32_MAX);
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
    const double most =
        level == DM_AVX512 ? 0.6 : 1.5; /* two roundings, one of a number just below 1 */
    random_source r = {7};
    double worst = 0.0, cube = 0.0;
    for (int i = 0; i < 1000000 + HARD; i++) {
        const double x = i < HARD ? hard[i] : random_double(&r);
        const double error = ulps(dm_rsqrt(x), 1.0L / sqrtl(x));
        const double of_cube = ulps(dm_rsqrt3(x), 1.0L / (x * sqrtl(x)));
        if (x == 0.0) CHECK(dm_rsqrt(x) == 1.0 / x && isinf(dm_rsqrt3(x)));
        if (x == 0.0) continue;
        if (error > worst) worst = error;
        /* at the ends of the range a part of the sum, or x sqrt(x), is denormal */
        const double y = dm_rsqrt3(x);
        if (y > 0x1p-1000 && y < 0x1p1020 && of_cube > cube) cube = of_cube;
        if (y <= 0x1p-1000 && level == DM_AVX512) CHECK(of_cube < 2.0);
    }
    printf("# x^(-1/2), x^(-3/2) at level %d: %.3f, %.3f ulp\n", (int)level, worst, cube);
    CHECK(worst < most && cube < (level == DM_AVX512 ? 0.6 : 3.0));
}

static void reciprocal_root(void) {
    at_every_level(root_at);
}

/* a function of our own, its exact one, a range (of log2 |x| where `scale`) and what its error
 * must stay below */
typedef struct {
    const char *name;
    double (*own)(double);
    long double (*exact)(long double);
    double from, to;
    int scale;
} range;

static const range ranges[] = {
    {"exp", dm_exp, expl, -745.2, 709.78, 0}, {"exp", dm_exp, expl, -60.0, -1.0, 1},
    {"log", dm_log, logl, 0.6, 1.6, 0},       {"log", dm_log, logl, -1074.0, 1023.99, 2},
    {"sin", dm_sin, sinl, -7.0, 7.0, 0},      {"sin", dm_sin, sinl, -60.0, 30.0, 1},
    {"cos", dm_cos, cosl, -7.0, 7.0, 0},      {"cos", dm_cos, cosl, -60.0, 30.0, 1},
    {"tan", dm_tan, tanl, -7.0, 7.0, 0},      {"tan", dm_tan, tanl, -60.0, 30.0, 1},
    {"sinh", dm_sinh, sinhl, -2.0, 2.0, 0},   {"sinh", dm_sinh, sinhl, -60.0, 9.47, 1},
    {"cosh", dm_cosh, coshl, -2.0, 2.0, 0},   {"cosh", dm_cosh, coshl, -60.0, 9.47, 1},
    {"tanh", dm_tanh, tanhl, -2.0, 2.0, 0},   {"tanh", dm_tanh, tanhl, -60.0, 9.0, 1},
};

static double random_argument(random_source *r, const range *f) {
    const double u = random_between(r, f->from, f->to);
    if (!f->scale) return u;
    return f->scale == 1 && random_below(r, 2) ? -exp2(u) : exp2(u);
}

static void errors_at(dm_processor_level level) {
    random_source r = {11};
    for (size_t k = 0; k < sizeof ranges / sizeof ranges[0] && level != DM_PLAIN; k++) {
        const range *f = ranges + k;
        double worst = 0.0, at = 0.0;
        for (int i = 0; i < 100000; i++) {
            const double x = random_argument(&r, f);
            const double error = ulps(f->own(x), f->exact(x));
            if (error > worst) worst = error, at = x;
        }
        if (level == DM_AVX512) printf("# %s: %.3f ulp at %.17g\n", f->name, worst, at);
        CHECK(worst < 1.0);
    }
}

static void errors(void) {
    at_every_level(errors_at);
}

/* doubles next to multiples of pi/2, where all digits of the angle but the last cancel */
static void near_multiples_at(dm_processor_level level) {
    for (int k = 1; k < 200000 && level != DM_PLAIN; k += k < 2000 ? 1 : 997) {
        const double x = (double)(k * 1.57079632679489661923L);
        CHECK(ulps(dm_sin(x), sinl(x)) < 1.0 && ulps(dm_cos(x), cosl(x)) < 1.0);
        CHECK(ulps(dm_tan(x), tanl(x)) < 1.0);
    }
}

static void near_multiples(void) {
    at_every_level(near_multiples_at);
}

static void ends_at(dm_processor_level level) {
    const double big = INFINITY, none = NAN;
    double c;
    (void)level;
    CHECK(dm_exp(0.0) == 1.0 && dm_exp(big) == big && dm_exp(-big) == 0.0);
    CHECK(dm_exp(710.0) == big && dm_exp(-746.0) == 0.0 && dm_exp(-745.0) == 5e-324);
    CHECK(dm_log(1.0) == 0.0 && dm_log(0.0) == -big && dm_log(big) == big);
    CHECK(isnan(dm_log(-1.0)) && isnan(dm_log(-big)) && isnan(dm_sin(big)));
    CHECK(isnan(dm_cos(-big)) && isnan(dm_tan(big)) && dm_cos(0.0) == 1.0);
    CHECK(dm_sinh(711.0) == big && dm_sinh(-big) == -big && dm_cosh(-711.0) == big);
    CHECK(dm_tanh(big) == 1.0 && dm_tanh(-big) == -1.0 && dm_cosh(0.0) == 1.0);
    CHECK(dm_sin(1e22) == sin(1e22) && dm_cos(1e300) == cos(1e300));
    CHECK(dm_sincos(0.7, &c) == dm_sin(0.7) && c == dm_cos(0.7));
    CHECK(isnan(dm_exp(none)) && isnan(dm_log(none)) && isnan(dm_sincos(none, &c)) && isnan(c));
    CHECK(isnan(dm_tan(none)) && isnan(dm_sinh(none)) && isnan(dm_cosh(none)));
    CHECK(isnan(dm_tanh(none)));
}

static void ends(void) {
    at_every_level(ends_at);
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
        for (uint32_t lanes = 1; lanes <= dm_jit_lanes(); lanes = lanes == 1 ? 4 : 2 * lanes)
            compare_op((dm_op)op, lanes);
}

static void all_widths(void) {
    at_every_level(all_widths_at);
}

/* exp along an array, where 8 lanes have it written out */
static void along_an_array_at(dm_processor_level level) {
    enum { COUNT = 4096 };
    static double x[2 * COUNT + 8];
    static const double fixed[8] = {0.0};
    random_source r = {7};
    dm_arena arena = new_arena();
    dm_array_loop_draft d;
    dm_array_loop s;
    (void)level;
    CHECK(dm_array_loop_begin(&d, &arena));
    const dm_node root = dm_array_loop_read(&d, (dm_array_ref){DM_ARRAY_MAIN, 0});
    dm_array_loop_write(&d, (dm_array_ref){DM_ARRAY_MAIN, COUNT},
                        dm_apply(d.g, DM_OP_EXP, root, 0, 0));
    CHECK(dm_array_loop_end(&s, &d, dm_native_build, &arena) == DM_OK);
    for (int i = 0; i < COUNT; i++)
        x[i] = i < 2 * HARD ? (i % 2 ? 1.0 : 720.0) * hard[i / 2]
               : i % 3      ? random_between(&r, -750.0, 715.0)
               : i % 2      ? random_double(&r)
                            : random_between(&r, -0.1, 0.1);
    dm_array_loop_run(&s, (dm_array_bases){x, x, fixed}, COUNT);
    for (int i = 0; i < COUNT; i++) CHECK(same_bits(x[COUNT + i], dm_exp(x[i])));
    dm_arena_release(&arena);
}

static void along_an_array(void) {
    at_every_level(along_an_array_at);
}

int main(void) {
    if (!doubles_only()) RUN(reciprocal_root, "1/sqrt(x): its error, and the ends of the range");
    if (LDBL_MANT_DIG > DBL_MANT_DIG && !doubles_only()) {
        RUN(errors, "exp, log, sin, cos, tan, sinh, cosh, tanh: below one unit of the "
                    "last place");
        RUN(near_multiples, "angles next to multiples of pi/2");
    }
    RUN(ends, "ends of the range, infinite, no number, huge angles");
    RUN(all_widths, "every operation: native code of every width and level = dm_op_value");
    RUN(along_an_array, "exponentials along an array = dm_exp");
    return check_finish();
}
