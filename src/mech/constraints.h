/* constraints.h - what a Lagrangian is constrained by: holonomic constraints g(q, t) = 0 with
 * the reactions G^T lambda, G = dg/dq; rolling constraints phi(q, v, t) = 0 with the reactions
 * E^T mu, where E is dphi/dv (Chetaev) or given; a force f(q, v, t) that is added to L_q
 * (Marsden-West 2001, 3.2). Of a discrete Lagrangian they are functions of (q0, q1) in
 * the place of (q, v): phi(q0, q1), whose dphi/dv is dphi/dq1, with E given, and F1, F2
 * (Cuell-Patrick 2009, 3; Leok 2.8.2). A model without any has no constraints at all. Kernels are
 * made when wanted. */
#ifndef DM_CONSTRAINTS_H
#define DM_CONSTRAINTS_H

#include "mech/model.h"

enum {                                     /* structure of constraints */
       DM_CONSTRAINTS_MOVING = 1,          /* g depends on t */
       DM_CONSTRAINTS_FORCE_SEES_V = 2,    /* f depends on v */
       DM_CONSTRAINTS_TIMED = 4,           /* some constraint depends on t */
       DM_CONSTRAINTS_GIVEN_REACTIONS = 8, /* E is the user's, not dphi/dv */
       DM_CONSTRAINTS_LINEAR = 16          /* phi is affine in v */
};

/* Where a row of G can have entries, and the first row that it has a coordinate in common with. */
typedef struct {
    uint32_t from, to, first;
} dm_row;

/* Constraints and forces of a model; not changed after dm_constraints_build but for kernels
 * that are added and their bits in `has`. */
typedef struct dm_constraints {
    uint32_t n;         /* dim Q */
    uint32_t holonomic; /* k, entries of g */
    uint32_t rolling;   /* l, entries of phi */
    int forced;         /* is there a force? */
    uint32_t forces;    /* entries of f: n, or 2 n of a discrete Lagrangian: F1 at q0, F2 at q1 */
    uint32_t controls;  /* entries of u, which is held over a step and is seen by the force alone */
    int crossings;      /* steps may go over places where g = 0 crosses itself (crossing.h) */
    int prolonged;      /* 1: of a tangent map, whose G~ is [G, 0; dG, G] */
    unsigned structure, has; /* DM_CONSTRAINTS_*; DM_WANT_* that are built */
    /* each takes x = (q[n], v[n], t), `reaction` (q, v, t, lambda[k], mu[l]); with controls the
     * forces take (q, v, t, k + l entries that they do not see, u[controls]); matrices are
     * row-major */
    dm_kernel holonomic_kernel; /* g[k], G[k*n], g_t[k] */
    dm_kernel rolling_kernel;   /* phi[l], E[l*n], phi_v[l*n], phi_q[l*n] */
    dm_kernel control;          /* u[controls] at the start of a step; made with the force */
    dm_kernel force;            /* f[forces] */
    dm_kernel force_curve;      /* f[forces], f_q[forces*n], f_v[forces*n] */
    dm_kernel reaction;         /* r[n] = G^T lambda + E^T mu, r_q[n*n], r_v[n*n] */
    const uint8_t *touches;     /* [k*n]: 0 where an entry of G is zero everywhere */
    const dm_row *rows;         /* [k] of G */
    /* for methods that make kernels of their own: nodes of a graph with the inputs q, v, t,
     * lambda, mu */
    dm_graph *graph;
    const dm_node *g, *G, *g_t; /* [k], [k*n], [k] */
    const dm_node *phi, *E;     /* [l], [l*n] */
    const dm_node *phi_v;       /* [l*n], the same nodes as E unless that is given */
    const dm_node *f, *u;       /* [forces], NULL without a force; [controls] */
    dm_arena *arena;
    /* of a system on a group: rows of G and E are body covectors, [momenta] with zeros behind them;
     * NULL else */
    const struct dm_group *group;
} dm_constraints;

/* What was traced: nodes of `graph`, whose inputs are q[n], v[n], t, lambda[k], mu[l],
 * u[controls]. */
typedef struct {
    dm_graph *graph;
    uint32_t n, holonomic, rolling, controls, forces;
    int crossings, prolonged;
    const dm_node *u;       /* [controls] or NULL */
    const dm_node *g, *phi; /* [k], [l] */
    const dm_node *f;       /* [forces] or NULL */
    const dm_node *E;       /* [l*n] or NULL: dphi/dv */
    /* of a system on a group (mech/group.h): [n*momenta] directions of q; NULL else */
    const dm_node *directions;
    uint32_t momenta;
} dm_constraints_traced;

/* Differentiate and read the structure; everything that *out points to is in `arena`. */
dm_status dm_constraints_build(dm_constraints *out, const dm_constraints_traced *traced,
                               dm_arena *arena);

/* Make the kernels `want` (DM_WANT_CONSTRAINTS bits) that are missing. */
dm_status dm_constraints_want(dm_constraints *constraints, unsigned want, dm_compile *compile);

/* A row of zeros: which constraint does not depend on what it must depend on (g on q, phi on v);
 * k + l: none. */
uint32_t dm_constraints_idle(const dm_constraints *constraints);

/* Add f(q, v, t) at x = (q, v, t) to sum[n], where there are constraints and a force; f[n] is
 * scratch. Needs DM_WANT_CONSTRAINT_FORCE, and no controls. */
void dm_constraints_add_force(double *sum, const dm_constraints *constraints, const double *x,
                              double *f);

/* A constraint whose row depends on those before it, from 1, by the outputs of both kernels at a
 * point; holonomic NULL: there are none; 0: none does. least: the square of the sine of the angle
 * between rows that do not. work[dm_constraints_dependent_work] (constraints_rank.c). */
#define DM_CONSTRAINTS_NEAR 1e-10 /* near enough for a step to fail */
size_t dm_constraints_dependent_work(const dm_constraints *constraints);
uint32_t dm_constraints_dependent(const dm_constraints *constraints, const double *holonomic,
                                  const double *rolling, double least, double *work);

/* ---- the start (constraints_start.c); W[n*n] is the inverse of the mass matrix there ---- */

/* Doubles of scratch for all functions below. */
size_t dm_constraints_start_work(const dm_constraints *constraints);

/* W = (d2L/dv2)^-1 at x = (q, v, t). Needs DM_WANT_MASS. */
dm_status dm_constraints_inverse_mass(double *W, const dm_model *m, const double *x, double *work);

/* Rows are counted from 1 through g and phi; 0: none. */
typedef struct {
    double distance;  /* the largest |g_i|, or of |(G v + g_t)_i| and |phi_i| */
    double move;      /* length of the shift that mends all, relative to 1 + |q| or 1 + |v| */
    uint32_t row;     /* the constraint of that distance */
    uint32_t depends; /* a row of G, or of (G; dphi/dv), that depends on those before it */
    uint32_t on;      /* the one of these that has most part in it; 0: the row is zero here */
} dm_constraints_defect;

/* How far x = (q, v, t) is from g = 0, and from G v + g_t = 0 and phi = 0. Needs
 * DM_WANT_HOLONOMIC, DM_WANT_ROLLING. */
dm_status dm_constraints_position_defect(dm_constraints_defect *out,
                                         const dm_constraints *constraints, const double *x,
                                         const double *W, double *work);
dm_status dm_constraints_velocity_defect(dm_constraints_defect *out,
                                         const dm_constraints *constraints, const double *x,
                                         const double *W, double *work);

/* Move q, or v, in x = (q, v, t) to the nearest point in the metric of the mass that meets these
 * equations. On failure x is not usable. */
dm_status dm_constraints_project_position(const dm_constraints *constraints, double *x,
                                          const double *W, double *work);
dm_status dm_constraints_project_velocity(const dm_constraints *constraints, double *x,
                                          const double *W, double *work);

#endif
