/* curve.h - curve segments: a discretization of TQ by an explicit one-step method for the
 * second-order field of L (Cuell-Patrick 2008, examples 1 and 2). To y = (q, v) belong the
 * points Y_i = (Q_i, V_i) with accelerations A_i, Q_i = q + h sum_j a_ij V_j + h^2 sum_j lift_ij
 * A_j,   V_i = v + h sum_j push_ij A_j, the ends d+(y) = q + h sum_i plus_i V_i + h^2 sum_i
 * plus_lift_i A_i, d-(y) likewise, and Ld(y) = h sum_i weight_i L(Y_i). For a Runge-Kutta method
 * push = a, there is no lift, and Ld is the sum that the method makes for S' = L: it has its
 * order. */
#ifndef DM_CURVE_H
#define DM_CURVE_H

#include "integ/method/method.h"

extern const dm_engine dm_engine_curve; /* data of its rules: a dm_curve */

enum { DM_CURVE_STAGES = 40, DM_CURVE_NAME = 24 };

typedef struct {
    char name[DM_CURVE_NAME];
    int s, order;
    int centred;                                /* minus is not zero: the segment begins before q */
    double bias;                                /* of the segment behind q; 1: all of it */
    double a[DM_CURVE_STAGES][DM_CURVE_STAGES]; /* strictly lower, as the next two */
    double push[DM_CURVE_STAGES][DM_CURVE_STAGES], lift[DM_CURVE_STAGES][DM_CURVE_STAGES];
    double plus[DM_CURVE_STAGES], minus[DM_CURVE_STAGES], weight[DM_CURVE_STAGES];
    double plus_lift[DM_CURVE_STAGES], minus_lift[DM_CURVE_STAGES];
    double arrival[DM_CURVE_STAGES], departure[DM_CURVE_STAGES]; /* velocities at d+, d- from A */
    double c[DM_CURVE_STAGES];                                   /* times of the points, in h */
    int lifted; /* some lift is not zero, or push is not a */
    /* a method that no such numbers describe: s is 0, and only order and bias hold; else NULL */
    const struct dm_curve_recipe *recipe;
    /* of `substeps` at most a step is made, as is chosen at its start (curve_choice.h): then the
     * numbers above are those of one of them, with bias 1; else 0 and NULL */
    int substeps;
    const struct dm_curve_choice *choice;
} dm_curve;

/* The built-in or GSL method of that name; 0 where there is none. Coefficients are those of bias
 * 1; `bias` is what dm_curve_bias should be given by default: 1, or 1/2 for "straight", which is
 * the method of Euler. */
int dm_curve_find(dm_curve *out, const char *name);

/* The name of built-in method i = 0, 1, ... and its source; NULL past the end. */
const char *dm_curve_name(int i, const char **source);

/* name, `order` and bias are left to the caller: from the coefficients of an explicit
 * Runge-Kutta method: a[s*s] and b[s]. */
void dm_curve_fill(dm_curve *out, int s, const double *a, const double *b);

/* The order, at most 8, by the conditions of all rooted trees, of a method with bias 1; *defect
 * (may be NULL) is the largest defect of the order above. */
int dm_curve_conditions(const dm_curve *c, double *defect);

/* The order, 1 to 8, as a step of the method with bias 1 shows it where accelerations depend on
 * q. */
int dm_curve_measure(const dm_curve *c);

/* Of a segment with bias 1 the one that begins at -(1 - bias) h: the method is applied to both
 * sides of y. Where it is lifted, Ld is then summed at Gauss nodes as `order` asks for. 0 where
 * that takes too many points. */
int dm_curve_bias(dm_curve *c, double bias);

/* The order, 1 to 8, of a recipe for two coordinates as a step of it shows, likewise; 0: it is no
 * method for x' = f(x). */
dm_status dm_curve_measure_recipe(int *order, const dm_curve *c, dm_compile *compile,
                                  dm_arena *arena);

/* The method that is one with bias 1, one substep after the other, as long as share[substeps] says;
 * those of length 0 are left out. 0 where that takes too many points. */
int dm_curve_compose(dm_curve *out, const dm_curve *whole, const double *share);

/* Order of the variational step: that of the method, or the next even number where the segment
 * is symmetric. */
int dm_curve_order(const dm_curve *c);

/* The tableau of a stepper of GSL, read off by running it; 0 when it is none of its explicit
 * ones. */
int dm_curve_gsl(dm_curve *out, const char *name);

#endif
