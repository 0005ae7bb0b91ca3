/* problems.h - mechanical systems for the tests. Unit-mass ones are kernels written by hand from
 * V' and V'', independent of the expression graph; the double spherical pendulum is a graph. */
#ifndef PROBLEMS_H
#define PROBLEMS_H

#include "algebra/derive.h"
#include "code/tape/tape.h"
#include "integ/method/method.h"
#include "integ/registry.h"
#include "run/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PROBLEM_SIZE = 4 };

static const double PI = 3.14159265358979323846;

/* V(q), V'[n], V''[n*n]; a NULL output is not wanted */
typedef void potential(double *V, double *slope, double *curve, const double *q);

typedef struct {
    uint32_t n;
    potential *V;
    dm_model model;
    double q[PROBLEM_SIZE], v[PROBLEM_SIZE]; /* a start */
    double ones[PROBLEM_SIZE], zeros[PROBLEM_SIZE];
    dm_arena arena;
} problem;

static void *problem_allocate(void *ud, void *block, size_t old_size, size_t new_size) {
    (void)ud, (void)old_size;
    if (new_size) return realloc(block, new_size);
    free(block);
    return NULL;
}

static inline void problem_close(problem *p) {
    dm_arena_release(&p->arena);
}

/* ---- potentials ---- */

static inline void kepler_potential(double *V, double *slope, double *curve, const double *q) {
    const double r2 = q[0] * q[0] + q[1] * q[1], r = sqrt(r2), r3 = r * r2;
    if (V) *V = -1.0 / r;
    for (int i = 0; i < 2; i++) {
        if (slope) slope[i] = q[i] / r3;
        for (int j = 0; curve && j < 2; j++)
            curve[2 * i + j] = (i == j) / r3 - 3.0 * q[i] * q[j] / (r3 * r2);
    }
}

static inline void pendulum_potential(double *V, double *slope, double *curve, const double *q) {
    if (V) *V = -cos(q[0]);
    if (slope) slope[0] = sin(q[0]);
    if (curve) curve[0] = cos(q[0]);
}

/* V = (x^2 + y^2)/2 + x^2 y - y^3/3 */
static inline void henon_heiles_potential(double *V, double *slope, double *curve,
                                          const double *q) {
    const double x = q[0], y = q[1];
    if (V) *V = 0.5 * (x * x + y * y) + x * x * y - y * y * y / 3.0;
    if (slope) {
        slope[0] = x + 2.0 * x * y;
        slope[1] = y + x * x - y * y;
    }
    if (curve) {
        curve[0] = 1.0 + 2.0 * y;
        curve[1] = curve[2] = 2.0 * x;
        curve[3] = 1.0 - 2.0 * y;
    }
}

/* spring of length 1 and constant 1e4 in the plane, no gravity */
static inline void spring_potential(double *V, double *slope, double *curve, const double *q) {
    const double k = 1e4, r = sqrt(q[0] * q[0] + q[1] * q[1]), r3 = r * r * r;
    if (V) *V = 0.5 * k * (r - 1.0) * (r - 1.0);
    for (int i = 0; i < 2; i++) {
        if (slope) slope[i] = k * q[i] * (1.0 - 1.0 / r);
        for (int j = 0; curve && j < 2; j++)
            curve[2 * i + j] = k * ((i == j) * (1.0 - 1.0 / r) + q[i] * q[j] / r3);
    }
}

/* ---- kernels of L = v.v/2 - V(q), layouts of mech/model.h ---- */

static inline void problem_value(const void *pool, const double *x, double *out) {
    const problem *p = pool;
    double V;
    p->V(&V, NULL, NULL, x);
    out[0] = -V;
    for (uint32_t i = 0; i < p->n; i++) out[0] += 0.5 * x[p->n + i] * x[p->n + i];
}

static inline void problem_energy(const void *pool, const double *x, double *out) {
    const problem *p = pool;
    p->V(out, NULL, NULL, x);
    for (uint32_t i = 0; i < p->n; i++) out[0] += 0.5 * x[p->n + i] * x[p->n + i];
}

static inline void problem_force(const void *pool, const double *x, double *out) {
    const problem *p = pool;
    p->V(NULL, out, NULL, x);
    for (uint32_t i = 0; i < p->n; i++) out[i] = -out[i];
}

static inline void problem_slope(const void *pool, const double *x, double *out) {
    const problem *p = pool;
    problem_force(pool, x, out);
    memcpy(out + p->n, x + p->n, p->n * sizeof *out);
}

static inline void problem_mass(const void *pool, const double *x, double *out) {
    const problem *p = pool;
    memcpy(out, x + p->n, p->n * sizeof *out);
    for (uint32_t i = 0; i < p->n; i++)
        for (uint32_t j = 0; j < p->n; j++) out[p->n + i * p->n + j] = i == j;
}

static inline void problem_stage(const void *pool, const double *x, double *out) {
    const problem *p = pool;
    const uint32_t n = p->n, nn = n * n;
    problem_slope(pool, x, out);
    p->V(NULL, NULL, out + 2 * n, x);
    for (uint32_t i = 0; i < nn; i++) {
        out[2 * n + i] = -out[2 * n + i];
        out[2 * n + nn + i] = 0.0;
        out[2 * n + 2 * nn + i] = i % (n + 1) == 0;
    }
}

static inline dm_kernel problem_kernel(const problem *p, dm_eval *eval, uint32_t outputs) {
    return (dm_kernel){.eval = eval,
                       .pool = p,
                       .inputs = 2 * p->n + 1,
                       .outputs = outputs,
                       .operations = 1,
                       .backend = "by hand"};
}

/* structure = 0 hides what L is: the general solver must find the same */
static inline void problem_open(problem *p, uint32_t n, potential *V, unsigned structure) {
    *p = (problem){.n = n, .V = V};
    dm_arena_init(&p->arena, problem_allocate, NULL);
    for (uint32_t i = 0; i < n; i++) p->ones[i] = 1.0;
    dm_model *m = &p->model;
    *m = (dm_model){.n = n, .structure = structure, .has = 63};
    m->value = problem_kernel(p, problem_value, 1);
    m->slope = problem_kernel(p, problem_slope, 2 * n);
    m->stage = problem_kernel(p, problem_stage, 2 * n + 3 * n * n);
    m->force = problem_kernel(p, problem_force, n);
    m->energy = problem_kernel(p, problem_energy, 1);
    m->mass = problem_kernel(p, problem_mass, n + n * n);
    if (structure & DM_CONSTANT_MASS) {
        m->inverse_mass = m->mass_matrix = p->ones;
        m->momentum_shift = p->zeros;
    }
}

enum {
    PROBLEM_SEPARABLE =
        DM_SEPARABLE | DM_CONSTANT_MASS | DM_DIAGONAL_MASS | DM_AUTONOMOUS | DM_QUADRATIC_IN_V,
    PROBLEM_GENERAL = DM_AUTONOMOUS
};

/* e = 0.6, period 2 pi, energy -1/2, angular momentum 0.8 */
static inline void problem_kepler(problem *p, unsigned structure) {
    problem_open(p, 2, kepler_potential, structure);
    p->q[0] = 0.4;
    p->v[1] = 2.0;
}

static inline void problem_pendulum(problem *p, unsigned structure) {
    problem_open(p, 1, pendulum_potential, structure);
    p->q[0] = 0.3;
    p->v[0] = 1.5;
}

static inline void problem_henon_heiles(problem *p, unsigned structure) {
    problem_open(p, 2, henon_heiles_potential, structure);
    p->q[0] = 0.1;
    p->v[1] = 0.5;
}

static inline void problem_spring(problem *p, unsigned structure) {
    problem_open(p, 2, spring_potential, structure);
    p->q[0] = 1.01;
    p->v[1] = 1.0;
}

/* ---- double spherical pendulum, unit masses and rods, angles (theta1, phi1, theta2, phi2) from
 * the downward vertical: L = |x1'|^2 + x1'.x2' + |x2'|^2/2 - V, x2 relative to x1 ---- */

static inline dm_node graph_product(dm_graph *g, dm_node a, dm_node b, dm_node c, dm_node d) {
    return dm_mul(g, dm_mul(g, a, b), dm_mul(g, c, d));
}

static inline dm_node double_pendulum_lagrangian(dm_graph *g, double gravity) {
    dm_node x[8], s[4], c[4];
    for (uint32_t i = 0; i < 8; i++) x[i] = dm_input(g, i);
    for (uint32_t i = 0; i < 4; i += 2) {
        s[i] = dm_apply(g, DM_OP_SIN, x[i], 0, 0);
        c[i] = dm_apply(g, DM_OP_COS, x[i], 0, 0);
    }
    const dm_node one = dm_constant(g, 1.0), half = dm_constant(g, 0.5);
    const dm_node turn = dm_sub(g, x[1], x[3]);
    const dm_node sd = dm_apply(g, DM_OP_SIN, turn, 0, 0), cd = dm_apply(g, DM_OP_COS, turn, 0, 0);
    const dm_node w1 = dm_mul(g, s[0], x[5]), w2 = dm_mul(g, s[2], x[7]);
    dm_node L = dm_add(g, dm_mul(g, x[4], x[4]), dm_mul(g, w1, w1));
    L = dm_add(g, L, dm_mul(g, half, dm_add(g, dm_mul(g, x[6], x[6]), dm_mul(g, w2, w2))));
    const dm_node tilt = dm_add(g, graph_product(g, c[0], c[2], cd, one), dm_mul(g, s[0], s[2]));
    L = dm_add(g, L, graph_product(g, x[4], x[6], tilt, one));
    L = dm_add(g, L, graph_product(g, w1, w2, cd, one));
    L = dm_add(g, L, graph_product(g, x[4], w2, c[0], sd));
    L = dm_sub(g, L, graph_product(g, w1, x[6], c[2], sd));
    const dm_node height = dm_add(g, dm_add(g, c[0], c[0]), c[2]);
    return dm_add(g, L, dm_mul(g, dm_constant(g, gravity), height));
}

static inline dm_status problem_double_pendulum(problem *p) {
    *p = (problem){.n = 4, .q = {0.8, 0.0, 0.4, 0.0}};
    p->v[1] = 1.0 / sin(0.8);
    p->v[3] = -0.5 / sin(0.4);
    dm_arena_init(&p->arena, problem_allocate, NULL);
    dm_graph *g = dm_graph_new(&p->arena, 9);
    if (!g) return DM_NO_MEMORY;
    return dm_model_build(&p->model, g, double_pendulum_lagrangian(g, 9.81), 4, 63, dm_tape_build,
                          &p->arena);
}

/* ---- steppers ---- */

typedef struct {
    dm_rule nodes[DM_RULE_NODES];
    dm_stepper s;
    double h;
    double state[4 * PROBLEM_SIZE + 8]; /* dm_state_size, and to spare */
    double *work;
} session;

/* the rule on the problem from its start, p by the Legendre transform; 0 when something failed */
static inline int session_open(session *x, const problem *p, const char *rule, double h) {
    memset(x, 0, sizeof *x);
    if (dm_rule_read(x->nodes, rule, NULL)) return 0;
    const dm_method *m = dm_method_find(x->nodes[0].name, NULL);
    if (!m || dm_rule_check(x->nodes)) return 0;
    x->s = (dm_stepper){.model = &p->model, .rule = x->nodes};
    x->h = h;
    x->s.tolerance = 4e-15;
    x->s.max_iterations = 50;
    const size_t work = dm_rule_engine(x->nodes, &p->model)->work(x->nodes, &p->model);
    x->work = malloc((work + dm_legendre_work(&p->model)) * sizeof(double));
    x->s.work = x->work;
    double *legendre = x->work + work;
    if (!x->work || dm_stepper_open(&x->s) != DM_OK) return 0;
    memcpy(x->state, p->q, p->n * sizeof(double));
    if (!(m->traits & DM_FOR_PAIRS) &&
        dm_legendre(&p->model, x->state + p->n, p->q, p->v, 0.0, legendre) != DM_OK)
        return 0;
    return dm_stepper_start(&x->s, x->state, 0.0, h) == DM_OK;
}

static inline void session_close(session *x) {
    dm_stepper_close(&x->s);
    free(x->work);
}

/* steps from the start; the state is left in x */
static inline dm_status session_run(session *x, long steps) {
    long done;
    return dm_advance(&x->s, x->state, 0.0, x->h, steps, &done);
}

/* energy of a state */
static inline double problem_energy_of(const problem *p, const double *state) {
    const dm_model *m = &p->model;
    double x[2 * PROBLEM_SIZE + 1] = {0}, E = 0.0, *work;
    work = malloc(dm_legendre_work(m) * sizeof *work);
    memcpy(x, state, p->n * sizeof *x);
    const int found =
        work && dm_legendre_inverse(m, x + p->n, state, state + p->n, 0.0, work) == DM_OK;
    free(work);
    dm_kernel_prepare(&m->energy, &E);
    dm_kernel_eval(&m->energy, x, &E);
    return found ? E : NAN;
}

#endif
