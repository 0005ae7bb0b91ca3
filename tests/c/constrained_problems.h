/* constrained_problems.h - systems with constraints, rolling and forces, as graphs, for the tests. */
#ifndef CONSTRAINED_PROBLEMS_H
#define CONSTRAINED_PROBLEMS_H

#include "mech/constraints.h"
#include "problems.h"

/* what a maker fills in: nodes of g in the inputs q[n], v[n], t */
typedef struct {
    dm_graph *g;
    dm_node q[PROBLEM_SIZE], v[PROBLEM_SIZE], t, L;
    dm_node constraint[PROBLEM_SIZE], rolling[PROBLEM_SIZE], f[PROBLEM_SIZE];
    dm_node E[PROBLEM_SIZE * PROBLEM_SIZE];
    uint32_t constraints, rollings;
    int forced, given;
} constrained_draft;

typedef void constrained_maker(constrained_draft *d);

typedef struct {
    problem p;
    dm_constraints constraints;
    constrained_draft draft; /* the constraints point into it */
} constrained_problem;

static inline dm_node num(constrained_draft *d, double x) {
    return dm_constant(d->g, x);
}
static inline dm_node sum2(constrained_draft *d, dm_node a, dm_node b) {
    return dm_add(d->g, a, b);
}
static inline dm_node less(constrained_draft *d, dm_node a, dm_node b) {
    return dm_sub(d->g, a, b);
}
static inline dm_node prod(constrained_draft *d, dm_node a, dm_node b) {
    return dm_mul(d->g, a, b);
}
static inline dm_node times(constrained_draft *d, double x, dm_node a) {
    return dm_mul(d->g, dm_constant(d->g, x), a);
}
static inline dm_node sine(constrained_draft *d, dm_node a) {
    return dm_apply(d->g, DM_OP_SIN, a, 0, 0);
}
static inline dm_node cosine(constrained_draft *d, dm_node a) {
    return dm_apply(d->g, DM_OP_COS, a, 0, 0);
}
/* sum of a_i b_i */
static inline dm_node dot_of(constrained_draft *d, const dm_node *a, const dm_node *b, int n) {
    dm_node sum = 0;
    for (int i = 0; i < n; i++) sum = sum2(d, sum, prod(d, a[i], b[i]));
    return sum;
}

/* ---- makers ---- */

/* unit mass on the unit sphere in R^3, g = 1, of radius 1 */
static inline void sphere_maker(constrained_draft *d) {
    d->L = less(d, times(d, 0.5, dot_of(d, d->v, d->v, 3)), d->q[2]);
    d->constraint[0] = less(d, dot_of(d, d->q, d->q, 3), num(d, 1.0));
    d->constraints = 1;
}

/* the same with damping -0.1 v, no longer a variational problem */
static inline void damped_sphere_maker(constrained_draft *d) {
    sphere_maker(d);
    for (int i = 0; i < 3; i++) d->f[i] = times(d, -0.1, d->v[i]);
    d->forced = 1;
}

/* a mass that varies with position and radius 1 + 0.1 sin t, magnetic term: nothing is simple */
static inline void breathing_maker(constrained_draft *d) {
    const dm_node m = sum2(d, num(d, 1.0), times(d, 0.3, prod(d, d->q[0], d->q[0])));
    const dm_node T = times(d, 0.5, prod(d, m, dot_of(d, d->v, d->v, 3)));
    const dm_node A = times(d, 0.4, prod(d, d->q[0], d->v[1]));
    const dm_node radius = sum2(d, num(d, 1.0), times(d, 0.1, sine(d, d->t)));
    d->L = sum2(d, less(d, T, prod(d, d->q[2], cosine(d, d->t))), A);
    d->constraint[0] = less(d, dot_of(d, d->q, d->q, 3), prod(d, radius, radius));
    d->constraints = 1;
}

/* upright disk (x, y, roll, heading), all masses and radii 1 (Bloch 2003, 1.4) */
static inline void disk_maker(constrained_draft *d) {
    const dm_node *v = d->v, heading = d->q[3];
    d->L = times(d, 0.5, dot_of(d, v, v, 4));
    d->rolling[0] = less(d, v[0], prod(d, cosine(d, heading), v[2]));
    d->rolling[1] = less(d, v[1], prod(d, sine(d, heading), v[2]));
    d->rollings = 2;
}

/* knife edge (x, y, heading) on a plane with downhill force 1 along x (Bloch 2003, 1.6) */
static inline void knife_maker(constrained_draft *d) {
    d->L = sum2(d, times(d, 0.5, dot_of(d, d->v, d->v, 3)), d->q[0]);
    d->rolling[0] =
        less(d, prod(d, sine(d, d->q[2]), d->v[0]), prod(d, cosine(d, d->q[2]), d->v[1]));
    d->rollings = 1;
}

/* nonholonomic particle in a harmonic and an unsymmetric potential, z' = y x' */
static inline void particle_maker(constrained_draft *d) {
    const dm_node *q = d->q;
    dm_node V = times(d, 0.5, sum2(d, prod(d, q[0], q[0]), prod(d, q[1], q[1])));
    V = sum2(d, V, times(d, 0.3, prod(d, q[2], sine(d, sum2(d, q[0], q[1])))));
    d->L = less(d, times(d, 0.5, dot_of(d, d->v, d->v, 3)), V);
    d->rolling[0] = less(d, d->v[2], prod(d, q[1], d->v[0]));
    d->rollings = 1;
}

/* |v| = 1 in a potential, Chetaev's rule: E = v (Gauss' principle of least constraint) */
static inline void speed_maker(constrained_draft *d) {
    const dm_node V = prod(d, sine(d, d->q[0]), cosine(d, d->q[1]));
    d->L = less(d, times(d, 0.5, dot_of(d, d->v, d->v, 2)), V);
    d->rolling[0] = less(d, dot_of(d, d->v, d->v, 2), num(d, 1.0));
    d->rollings = 1;
}

/* the same with reactions at an angle to v */
static inline void pushed_maker(constrained_draft *d) {
    speed_maker(d);
    d->E[0] = less(d, d->v[0], times(d, 0.5, d->v[1]));
    d->E[1] = sum2(d, d->v[1], times(d, 0.5, d->v[0]));
    d->given = 1;
}

/* the sphere in angles (from the downward vertical, around it), no constraints */
static inline void angles_maker(constrained_draft *d) {
    const dm_node w = prod(d, sine(d, d->q[0]), d->v[1]);
    const dm_node T = sum2(d, prod(d, d->v[0], d->v[0]), prod(d, w, w));
    d->L = sum2(d, times(d, 0.5, T), cosine(d, d->q[0]));
}

/* harmonic oscillator with damping -0.002 v */
static inline void damped_maker(constrained_draft *d) {
    d->L = times(d, 0.5, less(d, prod(d, d->v[0], d->v[0]), prod(d, d->q[0], d->q[0])));
    d->f[0] = times(d, -0.002, d->v[0]);
    d->forced = 1;
}

/* the sphere by two constraints of which the second follows from the first */
static inline void twice_maker(constrained_draft *d) {
    sphere_maker(d);
    d->constraint[1] = times(d, 2.0, d->constraint[0]);
    d->constraints = 2;
}

/* ---- from a maker to a problem ---- */

static inline dm_status constrained_open(constrained_problem *t, constrained_maker *make,
                                         uint32_t n, uint32_t constraints) {
    *t = (constrained_problem){.p = {.n = n}};
    dm_arena_init(&t->p.arena, problem_allocate, NULL);
    constrained_draft *d = &t->draft;
    d->g = dm_graph_new(&t->p.arena, 2 * n + 1 + constraints);
    if (!d->g) return DM_NO_MEMORY;
    for (uint32_t i = 0; i < n; i++) {
        d->q[i] = dm_input(d->g, i);
        d->v[i] = dm_input(d->g, n + i);
    }
    d->t = dm_input(d->g, 2 * n);
    make(d);
    dm_status status =
        dm_model_build(&t->p.model, d->g, d->L, n, DM_WANT_DENSE | DM_WANT_SLOPE | DM_WANT_ENERGY,
                       dm_tape_build, &t->p.arena);
    if (status != DM_OK || !(d->constraints + d->rollings || d->forced)) return status;
    const dm_constraints_traced traced = {.graph = d->g,
                                          .n = n,
                                          .holonomic = d->constraints,
                                          .rolling = d->rollings,
                                          .forces = d->forced ? n : 0,
                                          .g = d->constraint,
                                          .phi = d->rolling,
                                          .f = d->forced ? d->f : NULL,
                                          .E = d->given ? d->E : NULL};
    status = dm_constraints_build(&t->constraints, &traced, &t->p.arena);
    if (status == DM_OK)
        status = dm_constraints_want(&t->constraints, DM_WANT_CONSTRAINTS, dm_tape_build);
    if (t->constraints.structure & DM_CONSTRAINTS_TIMED)
        t->p.model.structure &= ~(unsigned)DM_AUTONOMOUS;
    t->p.model.constraints = &t->constraints;
    return status;
}

static inline void constrained_place(constrained_problem *t, const double *q, const double *v) {
    memcpy(t->p.q, q, t->p.n * sizeof *q);
    memcpy(t->p.v, v, t->p.n * sizeof *v);
}

/* largest |g|, |G v + g_t| and |phi| of a state at time t */
static inline double constrained_defect(const constrained_problem *t, const double *state,
                                        double time) {
    double x[3 * PROBLEM_SIZE + 1] = {0}, out[PROBLEM_SIZE * (3 * PROBLEM_SIZE + 2)];
    const uint32_t n = t->p.n, k = t->constraints.holonomic, l = t->constraints.rolling;
    double worst = 0.0, *work = malloc(dm_legendre_work(&t->p.model) * sizeof *work);
    memcpy(x, state, n * sizeof *x);
    x[2 * n] = time;
    const dm_status status =
        work ? dm_legendre_inverse(&t->p.model, x + n, state, state + n, time, work) : DM_NO_MEMORY;
    free(work);
    if (k) {
        dm_kernel_prepare(&t->constraints.holonomic_kernel, out);
        dm_kernel_eval(&t->constraints.holonomic_kernel, x, out);
    }
    for (uint32_t c = 0; c < k; c++) {
        double hidden = out[k + k * n + c];
        for (uint32_t i = 0; i < n; i++) hidden += out[k + c * n + i] * x[n + i];
        worst = fmax(worst, fmax(fabs(out[c]), fabs(hidden)));
    }
    if (l) {
        dm_kernel_prepare(&t->constraints.rolling_kernel, out);
        dm_kernel_eval(&t->constraints.rolling_kernel, x, out);
    }
    for (uint32_t c = 0; c < l; c++) worst = fmax(worst, fabs(out[c]));
    return status == DM_OK ? worst : NAN;
}

#endif
