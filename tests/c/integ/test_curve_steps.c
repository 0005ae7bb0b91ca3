/* steps along curve segments: exact tangent, what they keep, known methods among them, failures. */
#include "curves.h"

typedef struct {
    bench b; /* whose arena holds the model */
    problem p;
    session x;
} run;

static int run_open(run *r, const model *m, const char *rule, double h) {
    if (!bench_open(&r->b, m, "euler", 1.0)) return 0;
    r->p = (problem){.n = m->n, .model = r->b.model};
    memcpy(r->p.q, r->b.y, m->n * sizeof(double));
    memcpy(r->p.v, r->b.y + m->n, m->n * sizeof(double));
    return session_open(&r->x, &r->p, rule, h);
}

/* a round orbit of Kepler's problem */
static int run_kepler(run *r, const char *rule, double h) {
    int fine = run_open(r, models, rule, h);
    const double state[4] = {1.0, 0.1, 0.2, 0.9};
    if (fine) memcpy(r->x.state, state, sizeof state);
    return fine;
}

static void run_close(run *r) {
    session_close(&r->x);
    bench_close(&r->b);
}

/* max |D^T J D - J| for the exact tangent map D */
static double symplectic_defect(run *r) {
    const uint32_t n = r->p.n, N = 2 * n;
    double D[64], worst = 0.0;
    double *memory = malloc(r->x.s.engine->tangent_work(&r->x.s) * sizeof *memory);
    const dm_status status = r->x.s.engine->tangent(&r->x.s, D, r->x.state, 0.1, r->x.h, memory);
    free(memory);
    if (status != DM_OK) return NAN;
    for (uint32_t i = 0; i < N; i++)
        for (uint32_t j = 0; j < N; j++) {
            double sum = (i + n == j) ? -1.0 : (j + n == i) ? 1.0 : 0.0;
            for (uint32_t k = 0; k < n; k++)
                sum += D[k * N + i] * D[(n + k) * N + j] - D[(n + k) * N + i] * D[k * N + j];
            worst = fmax(worst, fabs(sum));
        }
    return worst;
}

/* the exact tangent against differences of steps */
static void check_tangent(run *r) {
    const uint32_t n = r->p.n, N = 2 * n;
    double D[64], start[4 * PROBLEM_SIZE + 8];
    double *memory = malloc(r->x.s.engine->tangent_work(&r->x.s) * sizeof *memory);
    CHECK(r->x.s.engine->tangent(&r->x.s, D, r->x.state, 0.1, r->x.h, memory) == DM_OK);
    free(memory);
    memcpy(start, r->x.state, sizeof start);
    for (uint32_t i = 0; i < N; i++) {
        double column[8] = {0};
        for (int k = -3; k <= 3; k++) {
            if (!k) continue;
            memcpy(r->x.state, start, sizeof start);
            r->x.state[i] += 3e-3 * k;
            CHECK(r->x.s.engine->step(&r->x.s, r->x.state, 0.1, r->x.h) == DM_OK);
            for (uint32_t j = 0; j < N; j++)
                column[j] += (k > 0 ? 1.0 : -1.0) * DIFFERENCE[abs(k) - 1] *
                             (r->x.state[j] + r->x.state[N + j]) / 0.18;
        }
        for (uint32_t j = 0; j < N; j++) CHECK_NEAR(D[j * N + i], column[j], 5e-9);
    }
    memcpy(r->x.state, start, sizeof start);
}

static void steps_are_symplectic_whatever_the_method(void) {
    const model *some[] = {models, models + 1, models + 2, &curved};
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < METHODS; i++) {
            run r;
            char rule[64];
            snprintf(rule, sizeof rule, "curve(%s, %s)", methods[i], i % 2 ? "1" : "0.5");
            if (CHECK(run_open(&r, some[k], rule, 0.1))) {
                if (!CHECK_NEAR(symplectic_defect(&r), 0.0, 2e-13))
                    printf("# %s, %s\n", some[k]->name, rule);
                if (i < 4) check_tangent(&r);
            }
            run_close(&r);
        }
}

/* Kepler: q x p to round-off over 2000 steps of every method */
static void angular_momentum_is_kept(void) {
    for (int i = 0; i < METHODS; i++) {
        run r;
        char rule[64];
        snprintf(rule, sizeof rule, "curve(%s)", methods[i]);
        if (CHECK(run_kepler(&r, rule, 0.05))) {
            double *z = r.x.state;
            const double before = z[0] * z[3] - z[1] * z[2];
            CHECK(session_run(&r.x, 2000) == DM_OK);
            if (!CHECK_NEAR(z[0] * z[3] - z[1] * z[2], before, 1e-14)) printf("# %s\n", rule);
        }
        run_close(&r);
    }
}

/* straight segments: bias 1/2 is the midpoint rule; 0 and 1 are the symplectic Euler methods,
 * explicit here */
static void straight_segments_are_known_methods(void) {
    run a, b;
    CHECK(run_kepler(&a, "curve(euler, 0.5)", 0.1));
    CHECK(run_kepler(&b, "midpoint", 0.1));
    CHECK(session_run(&a.x, 50) == DM_OK && session_run(&b.x, 50) == DM_OK);
    for (int k = 0; k < 4; k++) CHECK_NEAR(a.x.state[k], b.x.state[k], 2e-14);
    run_close(&a);
    run_close(&b);
    CHECK(run_kepler(&a, "curve(euler, 1)", 0.1));
    CHECK(run_kepler(&b, "curve(euler, 0)", 0.1));
    double q[2], p[2], r3 = 0.0;
    memcpy(q, a.x.state, sizeof q);
    memcpy(p, a.x.state + 2, sizeof p);
    CHECK(session_run(&a.x, 1) == DM_OK && session_run(&b.x, 1) == DM_OK);
    /* Ld = h L(q0, v), q1 = q0 + h v: p1 = v, p0 = v - h L_q(q0); and the other end */
    r3 = pow(q[0] * q[0] + q[1] * q[1], 1.5);
    for (int k = 0; k < 2; k++) {
        CHECK_NEAR(a.x.state[2 + k], p[k] - 0.1 * q[k] / r3, 4e-16);
        CHECK_NEAR(a.x.state[k], q[k] + 0.1 * a.x.state[2 + k], 4e-16);
        CHECK_NEAR(b.x.state[k], q[k] + 0.1 * p[k], 4e-16);
    }
    r3 = pow(b.x.state[0] * b.x.state[0] + b.x.state[1] * b.x.state[1], 1.5);
    for (int k = 0; k < 2; k++) CHECK_NEAR(b.x.state[2 + k], p[k] - 0.1 * b.x.state[k] / r3, 4e-16);
    run_close(&a);
    run_close(&b);
}

/* bias 1/2 gives a symmetric step: back with -h to the start */
static void half_bias_steps_are_symmetric(void) {
    for (int i = 0; i < METHODS; i += 2) {
        run r;
        char rule[64];
        double start[8];
        snprintf(rule, sizeof rule, "curve(%s, 0.5)", methods[i]);
        if (CHECK(run_open(&r, models + 2, rule, 0.05))) {
            memcpy(start, r.x.state, sizeof start);
            CHECK(session_run(&r.x, 20) == DM_OK);
            r.x.h = -0.05;
            CHECK(session_run(&r.x, 20) == DM_OK);
            for (int k = 0; k < 8; k++)
                CHECK_NEAR(r.x.state[k] + r.x.state[8 + k], start[k], 1e-13);
        }
        run_close(&r);
    }
}

/* L = v^2/2 + exp q: from (0, 0) the midpoint velocity V = (h/2) exp(h V/2) has no root for h =
 * 2 */
static dm_node steep(dm_graph *g, const dm_node *q, const dm_node *v) {
    const dm_node hill = dm_apply(g, DM_OP_EXP, q[0], 0, 0);
    return dm_add(g, times_of(g, 0.5, square_of(g, v[0])), hill);
}

static void failure_leaves_the_state_alone(void) {
    const model hill = {"steep", 1, steep};
    const char *rules[] = {"curve(euler, 0.5)", "curve(dop853)"};
    for (int i = 0; i < 2; i++) {
        run r;
        double before[4 * PROBLEM_SIZE + 8];
        CHECK(run_open(&r, &hill, rules[i], 2.0));
        r.x.state[0] = i ? 800.0 : 0.0; /* exp 800 is infinite */
        r.x.state[1] = 0.0;
        memcpy(before, r.x.state, sizeof before);
        const dm_status status = session_run(&r.x, 1);
        CHECK(i ? status == DM_NOT_FINITE : status == DM_NO_CONVERGENCE || status == DM_SINGULAR);
        CHECK(memcmp(before, r.x.state, sizeof before) == 0);
        run_close(&r);
    }
}

int main(void) {
    RUN(steps_are_symplectic_whatever_the_method, "steps are symplectic whatever the method");
    RUN(angular_momentum_is_kept, "angular momentum is kept to round-off");
    RUN(straight_segments_are_known_methods, "straight segments are known methods");
    RUN(half_bias_steps_are_symmetric, "segments around their middle step back");
    RUN(failure_leaves_the_state_alone, "a step that is not found leaves the state alone");
    return check_finish();
}
