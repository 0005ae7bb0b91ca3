/* what a step may have missed is looked for along the polynomial of degree 5 through q and v at its
 * start, middle and end: a narrow pulse that it meets, and one that only the parabola meets */
#include "run/hidden.h"

#include "check.h"
#include "problems.h"

enum { MOST = 64 };
static const double WIDTH = 0.01, H = 2.0, T = 3.0;

/* q = sum_k c_k x^k, x = s - 1/2 in [-1/2, 1/2]; also dq/dx */
static double quintic(const double c[6], double x, double *slope) {
    double q = 0.0;
    *slope = 0.0;
    for (int k = 5; k >= 0; k--) *slope = *slope * x + q, q = q * x + c[k];
    return q;
}

/* the first s at which it is `place` */
static double arrival(const double c[6], double place) {
    double a = -0.5, b = -0.5, slope;
    const double start = quintic(c, -0.5, &slope) - place;
    while ((quintic(c, b, &slope) - place) * start > 0.0) b += 1e-3;
    for (a = b - 1e-3; b - a > 1e-14;) {
        const double x = 0.5 * (a + b);
        if ((quintic(c, x, &slope) - place) * start > 0.0)
            a = x;
        else
            b = x;
    }
    return 0.5 + a;
}

/* Is a pulse of the force at q = place, beside a constant one, seen in a step along the quintic?
 * L = v^2/2. */
static int is_seen(const double c[6], double place, double constant, int known, double *where) {
    problem p = {.n = 1};
    dm_arena_init(&p.arena, problem_allocate, NULL);
    dm_graph *g = dm_graph_new(&p.arena, 3), *forces = dm_graph_new(&p.arena, 3);
    const dm_node v = dm_input(g, 1), half = dm_constant(g, 0.5);
    dm_model model;
    CHECK(dm_model_build(&model, g, dm_mul(g, half, dm_mul(g, v, v)), 1, DM_WANT_MASS,
                         dm_tape_build, &p.arena) == DM_OK);
    const dm_node off = dm_sub(forces, dm_input(forces, 0), dm_constant(forces, place));
    const dm_node away = dm_div(forces, off, dm_constant(forces, WIDTH));
    const dm_node pulse =
        dm_apply(forces, DM_OP_EXP, dm_neg(forces, dm_mul(forces, away, away)), 0, 0);
    const dm_node force = dm_add(forces, pulse, dm_constant(forces, constant));
    dm_interval boxes[3 * MOST + 9 + 2];
    double numbers[MOST + 10 * 2 + 9], work[64], q[3], mv[3];
    dm_hidden x = {.graph = forces,
                   .roots = &force,
                   .n = 1,
                   .count = 1,
                   .impulses = 1,
                   .negligible = 1e-9,
                   .value = boxes,
                   .rate = boxes + MOST,
                   .bend = boxes + 2 * MOST,
                   .in = boxes + 3 * MOST,
                   .rate_in = boxes + 3 * MOST + 3,
                   .bend_in = boxes + 3 * MOST + 6,
                   .found = boxes + 3 * MOST + 9,
                   .weight = numbers,
                   .samples = numbers + MOST,
                   .curve = (double(*)[6])(void *)(numbers + MOST + 20),
                   .velocity = numbers + MOST + 26,
                   .model = known ? &model : NULL,
                   .work = work};
    CHECK(dm_graph_size(forces) <= MOST && dm_legendre_work(&model) <= 64);
    for (int k = 0; k < 3; k++) {
        q[k] = quintic(c, 0.5 * k - 0.5, mv + k);
        mv[k] /= H;
    }
    const dm_swept step = {.t = T,
                           .h = H,
                           .q = {q, q + 1, q + 2},
                           .p = {mv, mv + 1, mv + 2},
                           .momentum = 4.0};
    const int seen = !dm_hidden_nothing(&x, &step, where);
    dm_arena_release(&p.arena);
    return seen;
}

/* coefficients of all degrees, with the odd and the even part by themselves; the pulses lie between
 * the samples at eighths of the step */
static void pulses(void) {
    static const double all[][7] = {
        /* c_0 .. c_5, the place of a pulse */
        {0, -2 * 3.141592653589793, 0, 37.7, 0, -50.2, 0.85}, /* about sin 2 pi s */
        {0, 0, 16, 0, -64, 0, 0.93},                          /* 16 x^2 (1 - 4 x^2) */
        {0.2, 1.5, -3, 9, 20, -31, 0.47},
        {-0.1, 0.4, 2, -12, -7, 60, 0.33},
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        const double *c = all[i], place = c[6];
        double where = NAN;
        CHECK(is_seen(c, place, 0.0, 1, &where));
        /* it begins where the pulse is a ten thousandth, some widths before */
        const double s = (where - T) / H, there = arrival(c, place);
        CHECK(s <= there && s > there - 0.06);
        CHECK(is_seen(c, place, 1.0, 1, &where));   /* as large as what the samples are */
        CHECK(!is_seen(c, place, 20.0, 1, &where)); /* less than a tenth of it */
        CHECK(!is_seen(c, place + 40.0, 0.0, 1, &where));
    }
    double where;
    const double swing[6] = {0, -2 * 3.141592653589793, 0, 37.7, 0, -50.2};
    CHECK(
        !is_seen(swing, 0.85, 0.0, 0, &where)); /* the parabola through three zeros is not there */
}

int main(void) {
    RUN(pulses, "pulses on the polynomial of degree 5 are seen, and where");
    return check_finish();
}
