/* signs of the mass of a model that are told without looking at states. */
#include "algebra/extremum.h"
#include "built.h"
#include "check.h"
#include "linalg/signature.h"

/* a v1^2 + v2^2/2 + c v1 v2 cos(q1 - q2): is the mass told definite, or L convex in v, anywhere? M = (2a
 * c cos; c cos 1) is definite where c^2 < 2a; L with w1^2/2 + w2^2/2 + c w1 w2, w1 = (q1 v1 + q2 v2)/q2,
 * w2 = v2 has no negative value where c^2 <= 1, and vanishing ones where q1 = 0 */
static void tells_a_mass_that_keeps_its_signs(void) {
    static const struct {
        double a, c;
        int definite;
    } pairs[] = {{1.0, 1.0, 1}, {0.55, 1.0, 1}, {0.45, 1.0, 0}, {1.0, -1.4, 1}, {1.0, 1.42, 0}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        built b;
        start(&b, 5);
        const dm_node angle = dm_sub(b.g, input(&b, 0), input(&b, 1));
        dm_node cross =
            times(&b, times(&b, input(&b, 2), input(&b, 3)), dm_apply(b.g, DM_OP_COS, angle, 0, 0));
        dm_node L = times(&b, number(&b, pairs[i].a), times(&b, input(&b, 2), input(&b, 2)));
        L = dm_add(b.g, L, times(&b, number(&b, 0.5), times(&b, input(&b, 3), input(&b, 3))));
        L = dm_add(b.g, L, times(&b, number(&b, pairs[i].c), cross));
        CHECK(finish(&b, L, 2) == DM_OK);
        CHECK(((b.model.structure & DM_DEFINITE_MASS) != 0) == pairs[i].definite);
        CHECK((b.model.mass_bounds == NULL) == pairs[i].definite);
        stop(&b);
    }
    for (int wide = 0; wide < 2; wide++) {
        built b;
        start(&b, 5);
        const dm_node w = dm_div(b.g,
                                 dm_add(b.g, times(&b, input(&b, 0), input(&b, 2)),
                                        times(&b, input(&b, 1), input(&b, 3))),
                                 input(&b, 1));
        dm_node L = dm_add(b.g, times(&b, w, w), times(&b, input(&b, 3), input(&b, 3)));
        const dm_node cross = times(&b, number(&b, wide ? 1.1 : 0.9), times(&b, w, input(&b, 3)));
        L = dm_add(b.g, times(&b, number(&b, 0.5), L), dm_neg(b.g, cross));
        CHECK(finish(&b, L, 2) == DM_OK);
        CHECK(!(b.model.structure & DM_DEFINITE_MASS) && (b.model.mass_bounds == NULL) == !wide);
        stop(&b);
    }
}

/* The extremum over y of f = s v^2/2 + (v + q y)^2/2 + y^2/2, as of a Routhian, s v^2/2 + v^2/(2 (1 +
 * q^2)): bounds of its mass leave 0 for large q; f is convex in (v, y) where s >= 0 alone. */
static void tells_a_least_value_that_keeps_its_signs(void) {
    static const double s[] = {0.0, -0.5};
    for (size_t i = 0; i < 2; i++) {
        built b, of;
        start(&b, 3);
        of = b;
        of.g = dm_graph_new(&b.arena, 4);
        const dm_node q = input(&b, 0), v = input(&b, 1), qv = times(&b, q, v);
        const dm_node unit = dm_add(b.g, number(&b, 1.0), times(&b, q, q));
        const dm_node y = dm_neg(b.g, dm_div(b.g, qv, unit));
        const dm_node w = dm_add(of.g, input(&of, 1), times(&of, input(&of, 0), input(&of, 2)));
        const dm_node squared =
            dm_add(of.g, times(&of, w, w), times(&of, input(&of, 2), input(&of, 2)));
        const dm_node beside =
            times(&of, number(&of, s[i]), times(&of, input(&of, 1), input(&of, 1)));
        const dm_node value = times(&b, number(&b, 0.5),
                                    dm_add(b.g, times(&b, number(&b, s[i]), times(&b, v, v)),
                                           dm_div(b.g, times(&b, v, v), unit)));
        const dm_extremum e = {.value = value,
                               .n = 2,
                               .m = 1,
                               .y = &y,
                               .of = of.g,
                               .f = times(&of, number(&of, 0.5), dm_add(of.g, beside, squared))};
        dm_extremum_keep(b.g, &e);
        CHECK(finish(&b, value, 1) == DM_OK);
        CHECK(!(b.model.structure & DM_DEFINITE_MASS));
        CHECK((b.model.mass_bounds == NULL) == (s[i] >= 0.0));
        stop(&b);
    }
}

/* sum_i a_i (s_i v_i)^2/2 + sum_ij b_ij s_i s_j v_i v_j cos(k q1 + m q2 + c), s = (1, q3, q3 q4), the
 * kinetic energy of bodies on arms; the products in several orders. `curved`: times 1 + q3^2. */
static dm_node arms(built *b, const double *a, int curved) {
    const dm_node s[3] = {number(b, 1.0), input(b, 2), times(b, input(b, 2), input(b, 3))};
    dm_node L = number(b, 0.0);
    for (uint32_t i = 0; i < 3; i++) {
        const dm_node v = input(b, 4 + i), w = times(b, s[i], v);
        const dm_node square =
            i == 1 ? times(b, times(b, s[i], s[i]), times(b, v, v)) : times(b, w, w);
        L = dm_add(b->g, L, times(b, number(b, 0.5 * a[i]), square));
    }
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t i = k == 2, j = k == 0 ? 1 : 2;
        const double m = floor(2.0 * a[3 + k]), phase = a[6 + k];
        dm_node angle = dm_sub(b->g, times(b, number(b, m), input(b, 0)), input(b, 1));
        angle = dm_apply(b->g, DM_OP_COS, dm_add(b->g, angle, number(b, phase)), 0, 0);
        const dm_node wi = times(b, s[i], input(b, 4 + i)), wj = times(b, input(b, 4 + j), s[j]);
        const dm_node scaled = times(b, number(b, a[9 + k]), angle);
        L = dm_add(b->g, L,
                   k == 1 ? times(b, times(b, scaled, wi), wj)
                          : times(b, scaled, times(b, wi, wj)));
    }
    if (curved) L = times(b, L, dm_add(b->g, number(b, 1.0), times(b, input(b, 2), input(b, 2))));
    /* q4' is free of the others */
    return dm_add(b->g, L, times(b, number(b, 0.5), times(b, input(b, 7), input(b, 7))));
}

/* v4^2/2 + v.K v/2 with cos(x_i - x_j) beside K_ij, i < j < 4, x = (q1, q2, q3), and of the fourth
 * 0, as links on a cart have it; `odd`: one cosine is of a sum, and no product of unit vectors. */
static dm_node links(built *b, const double *K, int odd) {
    dm_node L = number(b, 0.0);
    for (uint32_t i = 0; i < 4; i++)
        for (uint32_t j = 0; j <= i; j++) {
            const dm_node x = input(b, j), y = i < 3 ? input(b, i) : number(b, 0.0);
            const int is_sum = odd && i == 2 && j == 0;
            dm_node angle = is_sum             ? dm_add(b->g, x, y)
                            : K[4 * i + j] > 0 ? dm_sub(b->g, x, y)
                                               : dm_sub(b->g, y, x);
            dm_node term = times(b, input(b, 4 + i), input(b, 4 + j));
            if (i != j) term = times(b, term, dm_apply(b->g, DM_OP_COS, angle, 0, 0));
            L = dm_add(b->g, L, times(b, number(b, (i == j ? 0.5 : 1.0) * K[4 * i + j]), term));
        }
    return L;
}

/* Does the mass have a negative value at a random state, angles anywhere in some turns? */
static int is_negative_somewhere(const built *b, int tries) {
    enum { N = 4 };
    double x[2 * N + 1], out[N + N * N], least, all;
    for (int k = 0; k < tries; k++) {
        for (int i = 0; i < 2 * N + 1; i++) x[i] = (i < 2 ? 10.0 : 2.0) * random_number();
        dm_kernel_prepare(&b->model.mass, out);
        dm_kernel_eval(&b->model.mass, x, out);
        if (dm_negative_values(out + N, N, &least, &all)) return 1;
    }
    return 0;
}

/* Of an L that is told convex no value is negative anywhere; most of those that are so are told, by
 * halving angles. */
static void tells_arms_that_keep_their_signs(void) {
    int told = 0, missed = 0, negative = 0;
    for (int trial = 0; trial < 200; trial++) {
        built b;
        double a[12];
        for (int i = 0; i < 12; i++) a[i] = random_number();
        for (int i = 0; i < 3; i++) a[i] = 1.0 + 0.5 * a[i];
        start(&b, 9);
        CHECK(finish(&b, arms(&b, a, trial % 2), 4) == DM_OK);
        const int is_told = b.model.mass_bounds == NULL,
                  is_negative = is_negative_somewhere(&b, 2000);
        CHECK(!(is_told && is_negative));
        told += is_told, negative += is_negative, missed += !is_told && !is_negative;
        stop(&b);
    }
    CHECK(told > 50 && negative > 50);
    CHECK(missed < told / 2);
}

/* The same of links: told where K is definite, as it is for q = 0, whatever the angles are. */
static void tells_links_that_keep_their_signs(void) {
    int told[2] = {0, 0}, missed[2] = {0, 0}, negative[2] = {0, 0};
    for (int trial = 0; trial < 400; trial++) {
        const int odd = trial % 2;
        double K[16] = {0}, copy[16], least, all;
        built b;
        for (int i = 0; i < 4; i++)
            for (int j = 0; j <= i; j++)
                K[4 * i + j] = K[4 * j + i] =
                    i == j ? 0.7 + 0.3 * random_number() : 0.45 * random_number();
        memcpy(copy, K, sizeof K);
        const int definite = dm_all_positive(copy, 4, 1e-3, &least, &all);
        start(&b, 9);
        CHECK(finish(&b, links(&b, K, odd), 4) == DM_OK);
        const int is_told = (b.model.structure & DM_DEFINITE_MASS) || b.model.mass_bounds == NULL;
        const int is_negative = is_negative_somewhere(&b, 2000);
        CHECK(!(is_told && is_negative));
        if (!odd) CHECK(is_told || !definite);
        told[odd] += is_told, negative[odd] += is_negative;
        missed[odd] += !is_told && !is_negative;
        stop(&b);
    }
    CHECK(told[0] > 50 && missed[0] < 10 && told[1] > 50 && negative[0] > 20 && negative[1] > 20);
}

/* (q1 v1)^2/2 + v2^2/2 + 0.9 q1^k v1 v2 has a negative value somewhere unless k = 1. */
static void tells_products_by_their_factors(void) {
    for (int k = 0; k < 3; k++) {
        built b;
        start(&b, 5);
        const dm_node q = input(&b, 0), v1 = input(&b, 2), v2 = input(&b, 3), w = times(&b, q, v1);
        dm_node cross = times(&b, number(&b, 0.9), times(&b, v1, v2));
        for (int i = 0; i < k; i++) cross = times(&b, q, cross);
        const dm_node squared = dm_add(b.g, times(&b, w, w), times(&b, v2, v2));
        const dm_node L = dm_add(b.g, times(&b, number(&b, 0.5), squared), cross);
        CHECK(finish(&b, L, 2) == DM_OK);
        CHECK((b.model.mass_bounds == NULL) == (k == 1));
        stop(&b);
    }
}

/* The least pivot of the mass at random states with |q_i| <= 2. */
static double least_somewhere(const built *b, uint32_t n, int tries) {
    double x[9], out[20], least, all, found = INFINITY;
    for (int k = 0; k < tries; k++) {
        for (uint32_t i = 0; i < 2 * n + 1; i++) x[i] = 2.0 * random_number();
        dm_kernel_prepare(&b->model.mass, out);
        dm_kernel_eval(&b->model.mass, x, out);
        dm_negative_values(out + n, n, &least, &all);
        found = fmin(found, least);
    }
    return found;
}

/* Two sums of squares, (a v1 + b v2)^2 + (c v1 + d v2)^2, beside (q1 v1 + q2 v2)^2/u^2, which bounds
 * of entries do not tell: definite where a d != b c; else its values have no bound but 0, nor where a
 * square has none. With u = q2 it has a pole, and is looked at all the same; u = 1 + q2^2 has none. */
static void tells_squares_that_leave_no_velocity(void) {
    static const struct {
        double a, b, c, d;
        int curved, definite;
    } of[] = {{1, 0, 0, 1, 0, 1},  {1, 1, 1, -1, 0, 1}, {1, 1, 0, 2, 0, 1}, {1, 1, 2, 2, 0, 0},
              {1, -1, 0, 0, 0, 0}, {1, 0, 0, 0, 0, 0},  {1, 0, 0, 1, 1, 0}};
    for (size_t k = 0; k < 2 * sizeof of / sizeof *of; k++) {
        const size_t i = k / 2;
        const int pole = k % 2;
        built b;
        start(&b, 5);
        const dm_node v1 = input(&b, 2), v2 = input(&b, 3), q2 = input(&b, 1);
        const dm_node one =
            dm_add(b.g, times(&b, number(&b, of[i].a), v1), times(&b, number(&b, of[i].b), v2));
        const dm_node two =
            dm_add(b.g, times(&b, number(&b, of[i].c), v1), times(&b, number(&b, of[i].d), v2));
        const dm_node u = pole ? q2 : dm_add(b.g, number(&b, 1.0), times(&b, q2, q2));
        const dm_node z =
            dm_div(b.g, dm_add(b.g, times(&b, input(&b, 0), v1), times(&b, q2, v2)), u);
        dm_node first = times(&b, one, one);
        if (of[i].curved) first = times(&b, times(&b, q2, q2), first);
        const dm_node L = dm_add(b.g, first, dm_add(b.g, times(&b, two, two), times(&b, z, z)));
        CHECK(finish(&b, L, 2) == DM_OK && b.model.mass_bounds == NULL);
        CHECK(((b.model.structure & DM_DEFINITE_MASS) != 0) == (of[i].definite && !pole));
        CHECK((least_somewhere(&b, 2, 2000) > 1.0) == of[i].definite);
        stop(&b);
    }
}

/* w (v1 + v2)^2 + v1^2 has the values of w and 1 but for a part: it is told definite where w has
 * bounds; beside one that has none v1 would be lost in rounding. */
static void tells_weights_with_bounds(void) {
    for (int k = 0; k < 4; k++) {
        built b;
        start(&b, 5);
        const dm_node v1 = input(&b, 2), sum = dm_add(b.g, v1, input(&b, 3)), q1 = input(&b, 0);
        const dm_node weights[] = {dm_add(b.g, number(&b, 2.0), dm_apply(b.g, DM_OP_SIN, q1, 0, 0)),
                                   dm_add(b.g, number(&b, 2.0), times(&b, q1, q1)),
                                   dm_add(b.g, number(&b, 2.0), dm_apply(b.g, DM_OP_EXP, q1, 0, 0)),
                                   times(&b, q1, q1)};
        dm_node L = dm_add(b.g, times(&b, weights[k], times(&b, sum, sum)), times(&b, v1, v1));
        if (k == 3) L = dm_add(b.g, L, times(&b, input(&b, 3), input(&b, 3)));
        CHECK(finish(&b, L, 2) == DM_OK && b.model.mass_bounds == NULL);
        CHECK(((b.model.structure & DM_DEFINITE_MASS) != 0) == (k == 0));
        stop(&b);
    }
}

/* c_(k+1) = c_k (cos(k q2) c_k) beside v1 v2: a tree of 2^60 factors, of few nodes */
static void looks_at_shared_factors_once(void) {
    built b;
    start(&b, 5);
    const dm_node v1 = input(&b, 2), v2 = input(&b, 3), w = times(&b, input(&b, 1), v1);
    dm_node c = dm_apply(b.g, DM_OP_COS, input(&b, 0), 0, 0);
    for (int k = 1; k <= 60; k++) {
        const dm_node angle = times(&b, number(&b, k), input(&b, 1));
        c = times(&b, c, times(&b, dm_apply(b.g, DM_OP_COS, angle, 0, 0), c));
    }
    const dm_node squares = dm_add(b.g, times(&b, w, w), times(&b, v2, v2));
    const dm_node L = dm_add(b.g, squares, times(&b, times(&b, c, v1), v2));
    CHECK(finish(&b, L, 2) == DM_OK && b.model.mass_bounds != NULL);
    stop(&b);
}

/* an allocator that refuses one request: what is left out for it is no crash */
static long before_refusal;

static void *refusing_once(void *ud, void *block, size_t old_size, size_t new_size) {
    if (new_size && before_refusal-- == 0) return NULL;
    return problem_allocate(ud, block, old_size, new_size);
}

static void tells_without_room(void) {
    long wanted = 0;
    do {
        built b = {0};
        dm_arena_init(&b.arena, refusing_once, NULL);
        b.arena.exact = 1;
        before_refusal = wanted++;
        b.g = dm_graph_new(&b.arena, 5);
        if (b.g) {
            const dm_node v1 = input(&b, 2), v2 = input(&b, 3);
            const dm_node z = dm_add(b.g, times(&b, input(&b, 0), v1), times(&b, input(&b, 1), v2));
            const dm_node L =
                dm_add(b.g, dm_add(b.g, times(&b, v1, v1), times(&b, v2, v2)), times(&b, z, z));
            const dm_status status = finish(&b, L, 2);
            CHECK(status == DM_OK || status == DM_NO_MEMORY);
            CHECK(before_refusal < 0 || b.model.structure & DM_DEFINITE_MASS);
        }
        stop(&b);
    } while (before_refusal < 0);
    CHECK(wanted > 10);
}

int main(void) {
    RUN(tells_a_mass_that_keeps_its_signs, "tells a mass that keeps its signs");
    RUN(tells_a_least_value_that_keeps_its_signs, "tells a least value that keeps its signs");
    RUN(tells_links_that_keep_their_signs, "tells links that keep their signs");
    RUN(tells_arms_that_keep_their_signs, "tells arms that keep their signs");
    RUN(tells_products_by_their_factors, "tells products by their factors");
    RUN(tells_squares_that_leave_no_velocity, "tells squares that leave no velocity");
    RUN(tells_weights_with_bounds, "tells weights with bounds");
    RUN(looks_at_shared_factors_once, "looks at shared factors once");
    RUN(tells_without_room, "tells without room");
    return check_finish();
}
