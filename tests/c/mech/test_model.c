/* a model from its Lagrangian: structure, kernels against ones written by hand, Legendre. */
#include "built.h"
#include "check.h"

/* w (a^2 + b^2) for inputs i, i+1 */
static dm_node squares(built *b, double w, uint32_t i) {
    const dm_node s = dm_add(b->g, times(b, input(b, i), input(b, i)),
                             times(b, input(b, i + 1), input(b, i + 1)));
    return times(b, number(b, w), s);
}

/* v.v/2 + 1/|q| */
static dm_node kepler(built *b) {
    const dm_node r = dm_apply(b->g, DM_OP_SQRT, squares(b, 1.0, 0), 0, 0);
    return dm_add(b->g, squares(b, 0.5, 2), dm_div(b->g, number(b, 1.0), r));
}

static void compare(const dm_kernel *got, const dm_kernel *want, const double *x) {
    double a[32], c[32];
    CHECK(got->outputs == want->outputs && got->inputs == want->inputs);
    dm_kernel_prepare(got, a);
    dm_kernel_eval(got, x, a);
    dm_kernel_eval(want, x, c);
    for (uint32_t i = 0; i < want->outputs; i++) CHECK_NEAR(a[i], c[i], 1e-12 * (1.0 + fabs(c[i])));
}

static void kernels_agree_with_ones_by_hand(void) {
    built b;
    problem p;
    start(&b, 5);
    problem_kepler(&p, PROBLEM_SEPARABLE);
    CHECK(finish(&b, kepler(&b), 2) == DM_OK);
    CHECK(b.model.has == 63);
    for (int trial = 0; trial < 50; trial++) {
        double x[5] = {1.0 + 0.5 * random_number(), random_number(), random_number(),
                       random_number(), random_number()};
        compare(&b.model.value, &p.model.value, x);
        compare(&b.model.slope, &p.model.slope, x);
        compare(&b.model.stage, &p.model.stage, x);
        compare(&b.model.force, &p.model.force, x);
        compare(&b.model.energy, &p.model.energy, x);
        compare(&b.model.mass, &p.model.mass, x);
    }
    stop(&b);
}

static void reads_the_structure_of_kepler(void) {
    built b;
    start(&b, 5);
    CHECK(finish(&b, kepler(&b), 2) == DM_OK);
    CHECK(b.model.structure == PROBLEM_SEPARABLE);
    CHECK(b.model.cyclic[0] == 0 && b.model.cyclic[1] == 0);
    for (int i = 0; i < 2; i++) {
        CHECK_NEAR(b.model.inverse_mass[i], 1.0, 0.0);
        CHECK_NEAR(b.model.momentum_shift[i], 0.0, 0.0);
    }
    CHECK(b.model.operations > 0 && b.model.operations < 12);
    stop(&b);
}

/* polar coordinates: (r'^2 + r^2 phi'^2)/2 + 1/r: the angle is cyclic, the mass varies */
static void finds_cyclic_coordinates(void) {
    built b;
    start(&b, 5);
    const dm_node rw = times(&b, input(&b, 0), input(&b, 3));
    dm_node L = dm_add(b.g, times(&b, input(&b, 2), input(&b, 2)), times(&b, rw, rw));
    L = dm_add(b.g, times(&b, number(&b, 0.5), L), dm_div(b.g, number(&b, 1.0), input(&b, 0)));
    CHECK(finish(&b, L, 2) == DM_OK);
    CHECK(b.model.structure == (DM_AUTONOMOUS | DM_QUADRATIC_IN_V));
    CHECK(b.model.cyclic[0] == 0 && b.model.cyclic[1] == 1);
    stop(&b);
}

/* v.M v/2 + (3, -1).v - q.q/2 with M = (2 1; 1 2): full mass and a shift */
static void keeps_a_full_mass_and_its_shift(void) {
    built b;
    start(&b, 5);
    dm_node L = dm_add(b.g, squares(&b, 1.0, 2), times(&b, input(&b, 2), input(&b, 3)));
    L = dm_add(b.g, L, times(&b, number(&b, 3.0), input(&b, 2)));
    L = dm_sub(b.g, dm_sub(b.g, L, input(&b, 3)), squares(&b, 0.5, 0));
    CHECK(finish(&b, L, 2) == DM_OK);
    CHECK(b.model.structure ==
          (DM_SEPARABLE | DM_CONSTANT_MASS | DM_AUTONOMOUS | DM_QUADRATIC_IN_V));
    static const double M[4] = {2, 1, 1, 2}, inverse[4] = {2. / 3, -1. / 3, -1. / 3, 2. / 3};
    for (int i = 0; i < 4; i++) {
        CHECK_NEAR(b.model.mass_matrix[i], M[i], 0.0);
        CHECK_NEAR(b.model.inverse_mass[i], inverse[i], 1e-15);
    }
    CHECK_NEAR(b.model.momentum_shift[0], 3.0, 0.0);
    CHECK_NEAR(b.model.momentum_shift[1], -1.0, 0.0);
    double work[256], q[2] = {0.3, 0.4}, v[2] = {1.5, -2.5}, p[2], back[2] = {0};
    CHECK(dm_legendre_work(&b.model) <= 256);
    CHECK(dm_legendre(&b.model, p, q, v, 0.0, work) == DM_OK);
    CHECK_NEAR(p[0], 2 * 1.5 - 2.5 + 3, 1e-15);
    CHECK_NEAR(p[1], 1.5 - 2 * 2.5 - 1, 1e-15);
    CHECK(dm_legendre_inverse(&b.model, back, q, p, 0.0, work) == DM_OK);
    for (int i = 0; i < 2; i++) CHECK_NEAR(back[i], v[i], 1e-15);
    stop(&b);
}

/* a potential that depends on t stays separable; a momentum that does, does not */
static void tells_where_time_enters(void) {
    built b;
    start(&b, 3);
    const dm_node kinetic = times(&b, number(&b, 0.5), times(&b, input(&b, 1), input(&b, 1)));
    dm_node L = dm_sub(b.g, kinetic, times(&b, input(&b, 0), input(&b, 2)));
    CHECK(finish(&b, L, 1) == DM_OK);
    CHECK(b.model.structure == (PROBLEM_SEPARABLE & ~(unsigned)DM_AUTONOMOUS));
    L = dm_add(b.g, kinetic, times(&b, input(&b, 1), input(&b, 2)));
    CHECK(finish(&b, L, 1) == DM_OK);
    CHECK(b.model.structure == (DM_CONSTANT_MASS | DM_QUADRATIC_IN_V));
    stop(&b);
}

/* (v1 + v2)^2/2 has a singular mass; q1 v2 has none */
static void tells_degenerate_lagrangians(void) {
    built b;
    start(&b, 5);
    const dm_node sum = dm_add(b.g, input(&b, 2), input(&b, 3));
    CHECK(finish(&b, times(&b, number(&b, 0.5), times(&b, sum, sum)), 2) == DM_SINGULAR);
    CHECK(b.model.structure & DM_CONSTANT_MASS && !(b.model.structure & DM_LINEAR_IN_V));
    CHECK(finish(&b, times(&b, input(&b, 0), input(&b, 3)), 2) == DM_SINGULAR);
    CHECK(b.model.structure & DM_LINEAR_IN_V);
    stop(&b);
}

/* L = -sqrt(1 - v^2): p = v/sqrt(1 - v^2), so v = p/sqrt(1 + p^2), however large p is */
static void inverts_the_relativistic_momentum(void) {
    built b;
    start(&b, 3);
    const dm_node root = dm_sub(b.g, number(&b, 1.0), times(&b, input(&b, 1), input(&b, 1)));
    CHECK(finish(&b, dm_neg(b.g, dm_apply(b.g, DM_OP_SQRT, root, 0, 0)), 1) == DM_OK);
    CHECK(!(b.model.structure & DM_QUADRATIC_IN_V));
    double work[64], q = 0.0;
    CHECK(dm_legendre_work(&b.model) <= 64);
    for (double p = -100.0; p <= 100.0; p += 12.5) {
        double v = 0.0, back;
        CHECK(dm_legendre_inverse(&b.model, &v, &q, &p, 0.0, work) == DM_OK);
        CHECK_NEAR(v, p / sqrt(1.0 + p * p), 1e-15);
        CHECK(dm_legendre(&b.model, &back, &q, &v, 0.0, work) == DM_OK);
        CHECK_NEAR(back, p, 1e-15 * (1.0 + p * p) * (1.0 + fabs(p)));
    }
    stop(&b);
}

/* L = sqrt(1 + v^2) has |p| < 1: no velocity for p = 2, and v = 2 for p = 2/sqrt(5) */
static void tells_a_momentum_without_velocity(void) {
    built b;
    start(&b, 3);
    const dm_node root = dm_add(b.g, number(&b, 1.0), times(&b, input(&b, 1), input(&b, 1)));
    CHECK(finish(&b, dm_apply(b.g, DM_OP_SQRT, root, 0, 0), 1) == DM_OK);
    double work[64], q = 0.0, p = 2.0, v = 0.25;
    CHECK(dm_legendre_inverse(&b.model, &v, &q, &p, 0.0, work) != DM_OK);
    CHECK(v == 0.25);
    p = 2.0 / sqrt(5.0);
    CHECK(dm_legendre_inverse(&b.model, &v, &q, &p, 0.0, work) == DM_OK);
    CHECK_NEAR(v, 2.0, 1e-13);
    p = NAN;
    CHECK(dm_legendre_inverse(&b.model, &v, &q, &p, 0.0, work) == DM_NOT_FINITE);
    stop(&b);
}

/* Ld = (q1 - q0)^2/(2 h) - h V((q0 + q1)/2), V = x^2/2 on a line, by hand */
static void makes_the_kernels_of_a_discrete_lagrangian(void) {
    const double h = 0.1, q0 = 0.4, q1 = 0.7;
    built b;
    start(&b, 2);
    const dm_node d = dm_sub(b.g, input(&b, 1), input(&b, 0));
    const dm_node m = times(&b, number(&b, 0.5), dm_add(b.g, input(&b, 0), input(&b, 1)));
    const dm_node Ld = dm_sub(b.g, times(&b, number(&b, 0.5 / h), times(&b, d, d)),
                              times(&b, number(&b, 0.5 * h), times(&b, m, m)));
    CHECK(dm_model_build_pair(&b.model, b.g, Ld, 1, dm_tape_build, &b.arena) == DM_OK);
    CHECK(b.model.has == (DM_WANT_VALUE | DM_WANT_PAIR) && b.model.n == 1);
    const double x[2] = {q0, q1}, middle = 0.5 * (q0 + q1);
    double value = 0.0, out[3] = {0};
    dm_kernel_prepare(&b.model.value, &value);
    dm_kernel_eval(&b.model.value, x, &value);
    dm_kernel_prepare(&b.model.pair, out);
    dm_kernel_eval(&b.model.pair, x, out);
    CHECK_NEAR(value, 0.09 / (2 * h) - h * middle * middle / 2, 1e-15);
    CHECK_NEAR(out[0], -0.3 / h - h * middle / 2, 1e-14);
    CHECK_NEAR(out[1], 0.3 / h - h * middle / 2, 1e-14);
    CHECK_NEAR(out[2], -1.0 / h - h / 4, 1e-14);
    stop(&b);
}

/* an allocator that refuses from some request on: an error, never a crash */
static int left;

static void *refusing(void *ud, void *block, size_t old_size, size_t new_size) {
    if (new_size && left-- <= 0) return NULL;
    return problem_allocate(ud, block, old_size, new_size);
}

static void runs_out_of_memory_politely(void) {
    int passed = 0;
    for (int allowed = 0; allowed < 2000 && !passed; allowed++) {
        built b = {0};
        left = allowed;
        dm_arena_init(&b.arena, refusing, NULL);
        b.g = dm_graph_new(&b.arena, 5);
        const dm_status status = b.g ? finish(&b, kepler(&b), 2) : DM_NO_MEMORY;
        CHECK(status == DM_OK || status == DM_NO_MEMORY);
        passed = status == DM_OK;
        stop(&b);
    }
    CHECK(passed);
}

int main(void) {
    RUN(kernels_agree_with_ones_by_hand, "kernels agree with ones written by hand");
    RUN(reads_the_structure_of_kepler, "reads the structure of Kepler's problem");
    RUN(finds_cyclic_coordinates, "finds cyclic coordinates");
    RUN(keeps_a_full_mass_and_its_shift, "keeps a full constant mass and its shift");
    RUN(tells_where_time_enters, "tells where time enters");
    RUN(tells_degenerate_lagrangians, "tells degenerate Lagrangians");
    RUN(inverts_the_relativistic_momentum, "inverts the relativistic momentum");
    RUN(tells_a_momentum_without_velocity, "tells a momentum without velocity, v unchanged");
    RUN(makes_the_kernels_of_a_discrete_lagrangian, "makes the kernels of a discrete Lagrangian");
    RUN(runs_out_of_memory_politely, "runs out of memory politely");
    return check_finish();
}
