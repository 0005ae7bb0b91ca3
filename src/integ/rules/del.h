/* del.h - one step of a discrete Lagrangian on pairs of points, with what constrains and pushes it:
 * its workspace (del_work.c), its equations and their root (del_step.c); the rule is del.c. */
#ifndef DM_DEL_H
#define DM_DEL_H

#include "base/largest.h"
#include "integ/method/method.h"
#include "linalg/solve/newton.h"
#include "mech/crossing.h"

#include <math.h>
#include <string.h>

/* p0 + D1 Ld(q0, q0 + z) = 0 for z[n]; out = D1[n], D2[n], D1D2[n*n]. What a step leaves to the
 * next one: how many steps there are, the state at the end of the last [4n], the last four z,
 * the last first, and what the kernel remembers of its implicit functions; the cubic through the
 * z is where Newton's method begins. With constraints g: p0 + D1 Ld + G(q0)^T lambda = 0, g(q0 +
 * z) = 0 for (z, lambda), and p1 = D2 Ld is left as it is: what it has across the constraint is
 * taken up by the next lambda (Marsden-West 2001 sec. 3.5, Leok 2.8.1). Rolling constraints
 * phi(q0, q1) = 0 react along the rows of E: E^T mu stands beside G^T lambda, phi beside g
 * (Cuell-Patrick 2009, 3). Discrete forces F1, F2 are added to D1 Ld and D2 Ld (Leok 2.8.2).
 *
 * Rows of G and phi are one list here. Row c is in units of momentum by unit_c, the largest entry
 * of D1D2 over that of row c of the derivative in q1; its multiplier is in units of z by unit_c
 * too, with G(q0) or E in place of that derivative (pull_c). */
typedef struct {
    const dm_model *m;
    const double *state;
    uint32_t n, k, l, N; /* dim Q, holonomic and rolling constraints, unknowns */
    double *x, *out, *sum, *z, *next, *memory, *roots, *scratch;
    /* (q, v, t, lambda, mu); g, G, g_t at q0 and at q1; [k + l] each */
    double *constraint_x, *here, *there, *unit, *pull;
    double *roll;     /* phi[l], E[l*n], dphi/dq1[l*n], dphi/dq0[l*n] */
    double *turn;     /* E^T mu, its derivatives in q0 and in q1: [n + 2 n*n] */
    double *push;     /* F1, F2, their derivatives in q0 and in q1 */
    double stiffness; /* largest entry of D1D2 */
    double size;
    double sign, inverse; /* of the determinant at the root: 0 or its sign, of its size */
    long evaluations;
} dm_del;

/* places of the memory: how many steps there are; of the determinant of a step (del_inertia.c) its
 * sign, the inverse of its size and by what that grew; volumes of rows of constraints
 * (mech/crossing.h), the state at the end, the last KEPT z */
enum {
    DM_DEL_COUNT,
    DM_DEL_SIGN,
    DM_DEL_INVERSE,
    DM_DEL_FALL,
    DM_DEL_WATCHED,
    DM_DEL_END = DM_DEL_WATCHED + DM_CROSSING_WATCHED,
    DM_DEL_KEPT = 4
};

/* 4n numbers */
static inline void dm_del_copy_state(double *to, const double *state, uint32_t n) {
    for (uint32_t i = 0; i < n; i++, to += 4, state += 4) memcpy(to, state, 4 * sizeof *to);
}

/* Holonomic ones alone are known. */
static inline uint32_t dm_del_constraints(const dm_model *m) {
    return m->constraints ? m->constraints->holonomic : 0;
}

static inline uint32_t dm_del_rolling(const dm_model *m) {
    return m->constraints ? m->constraints->rolling : 0;
}

static inline uint32_t dm_del_rows(const dm_model *m) {
    return dm_del_constraints(m) + dm_del_rolling(m);
}

static inline int dm_del_is_forced(const dm_model *m) {
    return m->constraints && m->constraints->forced;
}

/* row c of the derivative in q1 of g and phi, and of what their multipliers pull along */
static inline const double *dm_del_slope_row(const dm_del *e, uint32_t c) {
    const size_t n = e->n;
    return c < e->k ? e->there + e->k + c * n : e->roll + e->l + (e->l + c - e->k) * n;
}

static inline const double *dm_del_pull_row(const dm_del *e, uint32_t c) {
    const size_t n = e->n;
    return c < e->k ? e->here + e->k + c * n : e->roll + e->l + (c - e->k) * n;
}

/* the largest entry; NaN where there is one */
static inline double dm_del_norm(const double *a, uint32_t n) {
    double largest = 0.0;
    for (uint32_t i = 0; i < n; i++) largest = dm_largest(largest, a[i]);
    return largest;
}

/* Doubles of the workspace, and of what a step leaves to the next one; that of a stepper, whose
 * places follow from the sizes, laid out where it is opened. */
size_t dm_del_work(const dm_model *m);
size_t dm_del_memory(const dm_model *m);
dm_del *dm_del_lay_out(const dm_stepper *s);

static inline dm_del *dm_del_of(const dm_stepper *s) {
    return (dm_del *)(void *)s->work;
}

/* what the kernel remembers of its implicit functions, from the memory and into it */
void dm_del_take_roots(const dm_del *e);
void dm_del_leave_roots(const dm_del *e);

/* g, G at q */
void dm_del_constrain_at(dm_del *e, double *out, const double *q);

/* q1 and p1 of the root into e->next */
dm_status dm_del_finish(dm_del *e);

/* The root: from the last steps where this one follows them (*follows), else from z = 0 or h p0. */
dm_status dm_del_solve(dm_del *e, const dm_stepper *s, double h, dm_newton_report *report,
                       int *follows);

/* The determinant of a step whose matrix has these factors. Has it another sign than that of the
 * step before? Then DM_INERTIA. Was that about to vanish? */
void dm_del_note(dm_del *e, const double *LU, const uint32_t *pivot);
int dm_del_has_turned(const dm_del *e);
dm_status dm_del_look(const dm_del *e);
int dm_del_is_fading(const dm_del *e);

/* what the step leaves to the next one */
void dm_del_keep(dm_del *e, int follows);

#endif
