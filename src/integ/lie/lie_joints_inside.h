/* lie_joints_inside.h - the workspace of lie(s) with constraints, for its files only. */
#ifndef DM_LIE_JOINTS_INSIDE_H
#define DM_LIE_JOINTS_INSIDE_H

#include "integ/lie/lie_joints.h"
#include "integ/method/stage_table.h"
#include "linalg/solve/newton.h"
#include "linalg/step_matrix.h"
#include "mech/crossing.h"

enum { DM_LIE_JOINTS_KEPT = 5, DM_LIE_JOINTS_TEXT = 128 };

/* The curve at some points: xi = h sum_j a_kj V_j, its rate sum_j d_kj V_j, at t + c_k h. */
typedef struct {
    uint32_t count;
    double *a, *d; /* [count*s] */
    double *c;     /* [count] */
} dm_lie_points;

/* Sizes: n flat coordinates, d dimension of the group, s velocities, K constraint points less one,
 * k and l constraints, m both; N unknowns V[s][d], multipliers[K][m] in units of velocity. */
typedef struct {
    const dm_model *model;
    const dm_group_joints *joints;
    const dm_group_entries *along;     /* L along the curve; s = 1: line */
    const dm_constraints *constraints; /* NULL: none */
    uint32_t n, d, s, K, k, l, m, N;
    double h, t;                    /* of this step */
    dm_lie_points at, nodes, rolls; /* quadrature, constraint points, Gauss points */
    double *b, *beta;               /* [r], [s] */
    const double *state;            /* q[n], p[n] ... */
    double *x;                      /* [n + 3d + 1 + m + controls] inputs of a point */
    double *v; /* [K or 1][n] velocities for reactions that turn with v: at the start, inside */
    double *inner_force; /* [(K - 1) * r], [(K - 1) * (K + 1)] as in constrained/ */
    double *inner_impulse;
    double *of_e;                   /* [r + K + 1][d] what L_e and impulses give w */
    double *slope, *reaction, *phi; /* outputs of kernels at a point, */
    double *pull, *hidden;          /* then their entries */
    double *z;                      /* [N] the unknowns */
    double *w;                      /* [d] where the equation was last evaluated */
    uint32_t *pull_first;           /* [d + 1] entries of pull in the columns of w: */
    uint32_t *pull_entry;           /* those of column i from pull_first[i] on */
    double *xi;                     /* [d] at the end of the step */
    double *last;                   /* [d + m] v1, multipliers of the last constraint point */
    double *in, *end;               /* [n + 2d] and [n + d + arcs] of the end */
    double *row_unit,
        *impulse_unit;            /* [m] M over the largest entry of a row of G, phi_v; of G, E */
    double *holonomic, *rolling;  /* outputs of the kernels of the constraints at a state */
    double *end_x;                /* [2n + 1 + m] inputs of these */
    double *momenta;              /* [(K + 1) * m] multipliers of the last step */
    dm_step_matrix step, closing; /* of the step equation, of the hidden constraints */
    double *work;                 /* of Newton's methods, of the Legendre transform */
    double mass;                  /* M, the largest entry of d2L/dv2 */
    double size;                  /* of the terms of the equation where it was last evaluated */
    /* what steps leave to the next: how many there are, their h, M (0: not known), volumes of rows
     * (mech/crossing.h), the largest entries of the rows of G and E, and of G and phi_v, of d2L/dv2
     * its diagonal [d], z of the last ones, newest first: [dm_lie_joints_memory_size] */
    double *memory;
    long evaluations;
    int iterations, matrices; /* of Newton, in this step */
    double residual;
    uint32_t lost;                 /* a constraint that depends on those before it, from 1 */
    double turn;                   /* rad, of a step that left the chart, else 0 */
    char text[DM_LIE_JOINTS_TEXT]; /* why a step failed */
} dm_lie_joints;

/* where memory keeps what */
enum {
    DM_LIE_AT_COUNT,
    DM_LIE_AT_H,
    DM_LIE_AT_MASS,
    DM_LIE_AT_VOLUMES,
    DM_LIE_AT_UNITS = DM_LIE_AT_VOLUMES + DM_CROSSING_WATCHED
};

/* Where z of the last steps begin. */
static inline size_t dm_lie_joints_kept(const dm_lie_joints *e) {
    return DM_LIE_AT_UNITS + 2 * (size_t)e->m + e->d;
}

static inline dm_lie_joints *dm_lie_joints_of(const dm_stepper *s) {
    return (dm_lie_joints *)(void *)s->work;
}

/* ---- lie_joints_open.c ---- */

size_t dm_lie_joints_work(const dm_rule *rule, const dm_model *m);
dm_status dm_lie_joints_open(dm_stepper *s);
size_t dm_lie_joints_memory_size(const dm_lie_joints *e);

/* ---- lie_joints_equation.c ---- */

/* For dm_newton: the step equation at z, and its matrix. */
dm_status dm_lie_joints_equation(void *joints, double *R, double *J, const double *z);

/* Entries that can differ from zero are not zero in J[N*N]. */
void dm_lie_joints_pattern(dm_lie_joints *e, double *J);

/* ---- lie_joints_crossing.c ---- */

/* Does the step that was finished go over a place where holonomic constraints cross? `trouble` says
 * where. Doubles of e->work for that. */
size_t dm_lie_joints_crossing_work(const dm_lie_joints *e);
int dm_lie_joints_cross(dm_lie_joints *e, dm_trouble *trouble);

/* ---- lie_joints_turning.c: reactions that turn with v ---- */

int dm_lie_joints_turn(const dm_lie_joints *e);
void dm_lie_joints_turning_guess(dm_lie_joints *e);
/* from the end of a step with a guess of the inner velocities to that with theirs */
dm_status dm_lie_joints_turning_end(dm_lie_joints *e, const dm_stepper *s);

/* ---- lie_joints.c ---- */

/* From z to the root. */
dm_status dm_lie_joints_newton(dm_lie_joints *e, const dm_stepper *s, dm_newton_report *report);

/* ---- lie_joints_end.c ---- */

/* out[n + d + arcs]: g0 tau(xi), mu carried there. */
void dm_lie_joints_carry(dm_lie_joints *e, double *out, const double *xi, const double *mu,
                         double sign);

/* The largest angle of what was carried to e->end. */
double dm_lie_joints_arc(const dm_lie_joints *e);

/* Element and momentum at the end into e->end, from z and w where they were last evaluated. */
dm_status dm_lie_joints_finish(dm_lie_joints *e, const dm_stepper *s);

/* As dm_lie_joints_pattern, of the hidden constraints. */
void dm_lie_joints_closing_pattern(dm_lie_joints *e, double *J);

/* Outputs of the kernels of the constraints at (q, v, t) into e->holonomic, e->rolling. */
void dm_lie_joints_look(dm_lie_joints *e, const double *q, const double *v, double t);

#endif
