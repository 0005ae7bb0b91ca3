/* trial_inside.h - what the files of integ/trial share. */
#ifndef DM_TRIAL_INSIDE_H
#define DM_TRIAL_INSIDE_H

#include "integ/trial/trial.h"

/* The curve at one time: q[n], qdot[n], derivatives by z in rows of K, and, where the curve is not
 * linear, the second ones contracted with l[2n]. */
typedef struct {
    double *q, *v, *q_z, *v_z, *second;
} dm_trial_point;

typedef struct {
    const dm_trial_row *row;
    const dm_trial_kernels *k;
    const dm_model *m;
    uint32_t n, K, unknowns, points;
    double h;            /* that weights and points are those of; 0: none yet */
    double *weight, *at; /* [points]: w_j, t_j */
    double *in;          /* [3 + K + 2n] */
    double *out;         /* of `point`, where the curve is not linear */
    double *table;     /* [points + 2][2n + 2nK]: linear curves at z = 0; the last two: the ends */
    double *line;      /* [K][2n] linear curves: z of the straight line from q with v */
    double *x, *stage; /* [2n+1], [2n + 3nn]: of the stage kernel */
    double *q, *v;     /* [n] at a point, of linear curves */
    double *A;         /* [2n*K] */
    double *z;         /* [K + n]: z, p1 */
    double *v0;        /* [n] */
    double *solved;    /* [2n+1] q, p, t of the state that z is the step from */
    int is_solved;
    double whole;        /* h of the run; 0: not known */
    double began;        /* H of the start; NaN: not known so far, infinity: it is not watched */
    double twice, drift; /* largest v . L_v so far, and |H - began| over it */
    double *scratch;
    const double *q0, *p0;
    double t, size;
    long evaluations;
} dm_trial;

/* Points, weights, and tables of linear curves for the length h. DM_SINGULAR: no straight line. */
dm_status dm_trial_lay(dm_trial *e, double h);

/* The curve at point j (points, points + 1: the ends) for the parameters z. l may be NULL where the
 * curve is linear. */
dm_trial_point dm_trial_at(dm_trial *e, uint32_t j, const double *z, const double *l);

/* q and p at the time t inside the step of z, whose momenta are L_v and, spread over the step, what
 * L_v is off by at its ends. */
void dm_trial_inside(dm_trial *e, double *q, double *p, double t);

/* How far p1 is from L_v at the end of the curve, over the largest L_v at its points, the worst
 * coordinate: what the space has not of the motion. */
double dm_trial_defect(dm_trial *e);

/* The largest v . L_v at some times inside the step of z. */
double dm_trial_kinetic(dm_trial *e);

/* A run begins; a step of z has led to (q, p): DM_BLOW_UP where its energy has left that of the
 * start. */
void dm_trial_watch_begin(dm_trial *e);
dm_status dm_trial_watch(dm_trial *e, const double *q, const double *p);

/* Condition number of the step equation at z, in the maximum norm. */
double dm_trial_condition(dm_trial *e);

/* Newton's method from e->z, with a matrix of its own every time, until the curve no longer
 * moves. */
dm_status dm_trial_iterate(dm_trial *e, dm_stepper *s);

/* For dm_newton: R and dR/dx at x = (z, p1). */
dm_status dm_trial_equation(void *ctx, double *R, double *J, const double *x);

#endif
