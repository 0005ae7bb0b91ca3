/* curve_inside.h - the workspace of the curve rule, for its files only. */
#ifndef DM_CURVE_INSIDE_H
#define DM_CURVE_INSIDE_H

#include "integ/curve/curve_choice.h"
#include "integ/curve/curve_segment.h"
#include "mech/crossing.h"

/* What constraints bring into a step, all zero without any. The reaction of the start is R0 =
 * rows(q0)^T (pull kappa), the last unknowns kappa[m] in units of velocity. */
typedef struct {
    const dm_constraints *c;
    size_t k, l, m;            /* holonomic, rolling, all of them */
    double *x;                 /* [2n+1 + m + controls] arguments of their kernels */
    double *start, *end;       /* [k(n+2)] g, G, g_t at q0 and at q1 */
    double *roll_start, *roll; /* [l(1+3n)] phi, E, phi_v, phi_q at (q0, v), at y */
    double *reaction;          /* [n + 2n*n] R0, its derivatives in q and v */
    double *unit, *pull;       /* [m] of a row of the equation, of a multiplier */
    double *p0;                /* [n] p0 + R0 */
    double *hidden;            /* [n + m] v1 and multipliers of the end */
    double *mass;              /* [n + n*n] L_v, L_vv there */
    double *impulse;           /* [2][m] of the last step, at its ends */
    double stiffness;          /* largest entry of M */
} dm_curve_tie;

/* at the head of the workspace */
typedef struct {
    dm_curve curve;
    dm_segment segment;
    dm_curve_tie tie;
    const double *state;
    double t, h;
    size_t n, unknowns;
    int estimate;     /* the matrix may err by h^p */
    uint32_t columns; /* of G_yy, from where on they are wanted */
    double *mass;     /* [n] size of M by rows: what turns velocities into momenta */
    double *z, *y,
        *p1; /* [3][unknowns], where they began or two roots; [2n] q - q0, v of the last run; [n] */
    double *next, *memory; /* [4n]; see below */
    double *slope;         /* [2n] of L at the end */
    double *scratch;
    double *share;         /* [substeps] of this step, and what the choice takes and gives */
    dm_kernel chooses;     /* them (curve_choice.h) */
    double size, residual; /* of the momenta; of the step equation */
    int ran;               /* the segment is at y */
    int settled;           /* the last increment, at the head of scratch, was at round-off */
    long evaluations, matrices;
} dm_curve_step;

/* 2 n, or 3 n where d- is not q, and the multipliers */
static inline size_t dm_curve_unknowns(const dm_curve *c, const dm_model *m) {
    return (c->centred ? 2 : 1) * (size_t)m->n + dm_field_rows(m);
}

/* The substeps of the step in hand, of the method of the rule; made anew where they differ from
 * those of the last one. */
dm_status dm_curve_choose(dm_curve_step *e, dm_stepper *s, const dm_curve *whole);

/* Points and ends for the unknowns z, unless they are there already. */
dm_status dm_curve_place(dm_curve_step *e, const double *z);

/* Solve it for the step from `state` at time t; the root is in z, the segment at it or one
 * increment away. */
dm_status dm_curve_solve(dm_stepper *s, const double *state, double t, double h);

/* The step equation for dm_newton: r = 0 for z = (v, (p1 - p0) / mass, (q - q0) / h, kappa). */
dm_status dm_curve_equation(void *ctx, double *r, double *J, const double *z);

/* The exact derivative of a step, for the engine; not with constraints, where unit vectors of (q,
 * p) are no tangents. */
size_t dm_curve_tangent_work(const dm_stepper *s);
dm_status dm_curve_tangent(dm_stepper *s, double *D, const double *state, double t, double h,
                           double *memory);

/* ---- curve_tie.c: constraints of a step ---- */

size_t dm_curve_tie_work(const dm_model *m);
void dm_curve_tie_open(dm_curve_tie *c, const dm_model *m, double *memory);

/* Rows at the start of a step and their units; controls, which are held over it. v[n] is the
 * velocity there. */
dm_status dm_curve_tie_begin(dm_curve_step *e, const double *v);

/* R0 and p0 + R0 at the unknowns z; with the segment there what constraints say, into r; with its
 * tangents the rest of J. */
void dm_curve_tie_react(dm_curve_step *e, const double *z);
void dm_curve_tie_residual(dm_curve_step *e, double *r);
void dm_curve_tie_matrix(const dm_curve_step *e, double *J);

/* The v[n] nearest to the one given, with the reaction (c->reaction) that puts p onto the hidden
 * constraints: L_v = p + rows^T kappa, G v + g_t = 0, phi = 0 at (q, v, t). */
dm_status dm_curve_tie_hide(dm_curve_step *e, const dm_stepper *s, double *v, const double *p,
                            const double *q, double t);

/* After `hide`: DM_SINGULAR where the step, which began at t, goes over a place where holonomic
 * constraints cross. watched: of mech/crossing.h. */
size_t dm_curve_tie_crossing_work(const dm_model *m);
dm_status dm_curve_tie_look(dm_curve_step *e, double *watched, double t, dm_trouble *trouble);

/* Impulses of the step whose root is z; those of its end join them after `hide`. */
void dm_curve_tie_keep(dm_curve_step *e, const double *z);
void dm_curve_tie_end(dm_curve_step *e);

#endif
