/* constrained_inside.h - the workspace of the stage solver with constraints, for its files only. */
#ifndef DM_CONSTRAINED_INSIDE_H
#define DM_CONSTRAINED_INSIDE_H

#include "integ/constrained/constrained.h"
#include "linalg/solve/newton.h"
#include "linalg/step_matrix.h"
#include "mech/crossing.h"

/* The curve at some points: Q = q0 + h sum_j a_kj V_j, Qdot = sum_j d_kj V_j. */
typedef struct {
    uint32_t count;
    dm_weight *c;     /* [count] */
    dm_weight *a, *d; /* [count*s] */
} dm_constrained_points;

/* Entries of a block of a kernel's outputs that are not zero everywhere. */
typedef struct {
    uint32_t count;
    uint32_t *entry, *row, *column;
} dm_constrained_entries;

/* Laid out at the head of stepper->work when the engine opens. Tables, shapes of matrices and
 * memory last from step to step; all else is of the step in hand. */
typedef struct {
    dm_stage_table table;
    /* the curve at the K + 1 points with impulses, and at the K where rolling is enforced */
    dm_constrained_points constraint, gauss;
    const dm_model *m;
    const dm_constraints *constraints;
    /* dim Q, constraint points less one, holonomic constraints, rolling constraints */
    uint32_t n, K, k, l;
    double h, t; /* step, its start; h is also that of the coefficients below */
    /* [r], [s]; [r*s]: h a_ij, h b_i (a_ij - beta_j), b_i d_ij; [(K+1)*s], [K*s]: h a at the
     * constraint points and the Gauss points */
    dm_weight *hb, *hbeta, *ha, *wq, *wv, *constraint_ha, *gauss_ha;
    dm_weight *lever; /* [K*s]: a~_kj - beta_j */
    /* entries of blocks that can differ from zero: [n*n], and [k*n] or [l*n] */
    dm_constrained_entries qq, qv, vv, mass_vv, f_q, f_v, r_q, r_v, G, E, phi_v, phi_q;
    dm_step_matrix step, hidden; /* of the step equation, of the hidden constraint */
    /* [s*(s+1)]: V_j from v0 and the V of the step before, and of a step of half the length */
    double *ahead, *longer;
    /* integrals to the inner constraint points: [(K-1)*r] of what stands at the quadrature points,
     * [(K-1)*(K+1)] of the reactions at the constraint points, over their weights */
    double *inner_force, *inner_impulse;
    double *inner_v;     /* [(K-1)*n] velocity at the inner constraint points, see turning.c */
    const double *state; /* at the start of the step */
    double *x;           /* [2n+1 + k+l + controls] arguments of a kernel */
    double *shift, *v;   /* [n] of a point */
    double *slope;       /* [r][2n] L_q + f, L_v */
    /* outputs of the kernels at the points of the quadrature: [r][2n] of the slope kernel,
     * [r][2n + 3n^2] of the stage kernel, [r][n + 2n^2] of forces */
    double *plain, *curve, *drag;
    /* and at the constraint points: [K+1][k(n+2)] g, G, g_t; [K+1][l(1+3n)] phi, E, phi_v, phi_q;
     * [K+1][n + 2n^2] I_k, its derivatives in q, v */
    double *holonomic, *rolling, *reaction;
    double *roll;                    /* [K][l(1+3n)] as rolling, at the Gauss points */
    double *impulse;                 /* [K+1][n] I_k */
    double *lambda;                  /* [k+l] multipliers as the reaction takes them */
    double *row_unit, *impulse_unit; /* [k+l] M over the largest entry of G, phi_v; of G, E */
    double *mass;                    /* [n + n^2] L_v, L_vv at the ends */
    double mass_size;                /* largest entry of L_vv; 0: not looked for yet */
    double *root;                    /* [s][n] V, [K][k+l] impulses in units of velocity */
    double *end;                     /* [n] v1, [k+l] impulses of the last constraint point */
    double *v0;                      /* [n] velocity at the start */
    double *next;                    /* [4n] state at the end */
    double *dq, *dp;                 /* [n] what the step adds */
    double *before;                  /* [n] momentum at the end without I_K */
    double *scratch;                 /* of Newton and of the Legendre transform */
    dm_newton_constant constant; /* without constraints where all is linear; J NULL: it is not */
    double factored;             /* the h that it is of */
    double *memory;              /* see constrained_memory.c */
    int goes_on;                 /* it is that of the step before, which was as long */
    double size;                 /* of the terms of the residual */
    double position_size;        /* of what rounding q leaves of it, in this step */
    long evaluations;            /* of L, in this step */
    int iterations, matrices;    /* of Newton, in this step */
    double residual;
    uint32_t lost; /* the constraint that depends on those before it, from 1; 0: none was found */
    int crosses;   /* others there, inside of the step (mech/crossing.h), at this time */
    double at;     /* its time */
    dm_wide_product
        volume; /* of the rows at the end; part 0: the hidden constraint did not tell it */
} dm_constrained;

/* without the call that fmax is */
static inline double dm_constrained_larger(double a, double b) {
    return a > b ? a : b;
}

/* outputs of the kernels at the constraint point k */
static inline double *dm_constrained_holonomic(const dm_constrained *g, uint32_t k) {
    return g->holonomic + k * (size_t)g->k * (g->n + 2);
}
static inline double *dm_constrained_rolling(const dm_constrained *g, uint32_t k) {
    return g->rolling + k * (size_t)g->l * (1 + 3 * (size_t)g->n);
}
static inline double *dm_constrained_curved(const dm_constrained *g, uint32_t k) {
    return g->reaction + k * (size_t)g->n * (1 + 2 * (size_t)g->n);
}

/* ---- constrained_table.c ---- */

uint32_t dm_constrained_count(size_t s, size_t r, const dm_galerkin *g); /* K */
size_t dm_constrained_weights_size(size_t s, size_t r);
void dm_constrained_weights_fill(dm_constrained *g, const dm_galerkin *basis, double *memory);
void dm_constrained_weights_scale(dm_constrained *g, double h);

/* ---- constrained_point.c: kernels along the curve of the velocities V ---- */

/* x = (q0 + shift, v, t + after) */
void dm_constrained_at(dm_constrained *g, const double *shift, const double *v, double after);
/* x at the constraint point k */
void dm_constrained_at_constraint(dm_constrained *g, const double *V, uint32_t k);
/* slopes (and curves) at the points of the quadrature */
void dm_constrained_slopes(dm_constrained *g, const double *V, int with_curve);
/* constraints where they are wanted and the impulses of the multipliers behind V; derivatives of
 * these too */
void dm_constrained_constraints(dm_constrained *g, const double *V, int with_curve);
/* rows of the constraints at x, kept for the constraint point k; the impulse that they make; its
 * derivatives */
void dm_constrained_rows(dm_constrained *g, uint32_t k);
void dm_constrained_impulse(dm_constrained *g, double *impulse, const double *impulses, uint32_t k);
void dm_constrained_reaction(dm_constrained *g, const double *impulses, uint32_t k);
/* G, E, v0, M and the scales at the start of the step */
dm_status dm_constrained_begin(dm_constrained *g);

/* ---- constrained_sparsity.c: what of the matrices is not zero ---- */

/* doubles that entries take */
size_t dm_constrained_entries_size(uint32_t n, uint32_t k, uint32_t l);
void dm_constrained_entries_find(dm_constrained *g, double *memory);
/* values with no meaning wherever a kernel writes, for a look at the entries */
void dm_constrained_scatter(dm_constrained *g);

/* J += w B at (row, column), J += w B^T, y += B x */
void dm_constrained_add(double *J, const dm_step_matrix *m, uint32_t row, uint32_t column, double w,
                        const double *B, const dm_constrained_entries *e);
void dm_constrained_add_transposed(double *J, const dm_step_matrix *m, uint32_t row,
                                   uint32_t column, double w, const double *B,
                                   const dm_constrained_entries *e);
void dm_constrained_product(double *y, const double *B, const double *x,
                            const dm_constrained_entries *e);

/* ---- constrained_equation.c ---- */

uint32_t dm_constrained_unknowns(const dm_constrained *g);
/* How much of the residual rounding q leaves, in units of momentum. */
double dm_constrained_position_size(const dm_constrained *g);
dm_status dm_constrained_equation(void *ctx, double *R, double *J, const double *z);
void dm_constrained_equation_matrix(const dm_constrained *g, double *J);

/* ---- constrained.c ---- */

dm_status dm_constrained_newton(dm_constrained *g, const dm_stepper *stepper);

/* ---- constrained_end.c: from the root to the state at the end ---- */

dm_status dm_constrained_finish(dm_constrained *g, const dm_stepper *stepper);

/* ---- constrained_hidden.c: v1, the last impulses into g->end, from g->next without them ---- */

dm_status dm_constrained_hidden(dm_constrained *g, const dm_stepper *stepper);
void dm_constrained_hidden_matrix(const dm_constrained *g, double *J);

/* ---- constrained_turning.c: reactions that turn with v ---- */

int dm_constrained_turns(const dm_constrained *g);
void dm_constrained_turning_guess(dm_constrained *g);
/* from a root with a guess of the inner velocities to one with theirs, to the end of the step */
dm_status dm_constrained_turning_end(dm_constrained *g, const dm_stepper *stepper);

/* ---- constrained_memory.c: V, impulses, end and start of a step, for the next one ---- */

size_t dm_constrained_memory_size(uint32_t n, uint32_t unknowns, uint32_t m);
void dm_constrained_memory_clear(dm_constrained *g, double h);
enum { DM_CONSTRAINED_VOLUMES = 2 }; /* place of what is watched, which is there for any h */
int dm_constrained_memory_fits(const dm_constrained *g);
const double *dm_constrained_memory_velocity(const dm_constrained *g); /* v1 */
void dm_constrained_memory_keep(dm_constrained *g);
/* root = a guess: from the step before where there is one (else 0), v0 alone, from V of a step
 * half as long */
int dm_constrained_guess(dm_constrained *g);
void dm_constrained_plain_guess(dm_constrained *g);
void dm_constrained_longer_guess(dm_constrained *g, const double *V);

/* ---- constrained_rank.c ---- */

/* the first constraint whose row depends on those before it at a point of the step, from 1; 0:
 * none; ended: did the step come to its end, where rolling is evaluated last? */
uint32_t dm_constrained_dependent(dm_constrained *g, int ended);
/* Do rows depend on each other there to rounding, so that they leave a velocity open? A step that
 * ends so, exactly where they cross, may have any. */
int dm_constrained_is_lost(dm_constrained *g, uint32_t k);

/* Does the step that was made go over a place where holonomic constraints cross? g->lost says. */
size_t dm_constrained_crossing_work(const dm_constraints *c);
int dm_constrained_crosses(dm_constrained *g);

#endif
