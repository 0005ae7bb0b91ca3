/* stage_inside.h - the workspace of the stage solver, for its files only. */
#ifndef DM_STAGE_INSIDE_H
#define DM_STAGE_INSIDE_H

#include "integ/stage/stage.h"
#include "integ/stage/sweep/sweep.h"

#include <string.h>

/* A kernel on [inputs][width] and [outputs][width], `lanes` at a time. */
typedef struct {
    dm_kernel kernel;
    uint32_t lanes, inputs, outputs;
    double *in, *out;           /* [.][width] */
    double *some_in, *some_out; /* [.][lanes] for fewer lanes than stages */
} dm_stage_kernel;

/* Fixed-point sweeps over all stages at once, between the kernels and the sums of sweep.h. What
 * is iterated are u = L_q (M^-1 L_q where M is not diagonal) in the separable form, S = base +
 * h^2 A M^-1 L_q; else the velocities V = u, S = base + h a V, with momenta p0 + h a L_q.
 * Coefficients are doubles in every sweep; what those lack is added to the bases once, when u
 * has settled. */
typedef struct {
    const dm_sweep_row *row;                  /* NULL: this step has no sweeps */
    dm_stage_kernel force, factors, velocity; /* the last two: general form */
    int count;                                /* sweeps a step; 0: to round-off */
    dm_sweep q, p;                            /* positions; momenta of the general form */
    dm_sweep q_rest, p_rest;  /* their bases, by the low-order parts of the coefficients */
    dm_sweep ahead, v_ahead;  /* positions, velocities from u of the step before */
    double *u;                /* [n][width], for M that is not diagonal */
    double *base, *lift;      /* [n][width] of positions, momenta */
    double *whole, *rest;     /* [r][width] columns of h^2 A or h a, what they lack */
    double *further, *flying; /* [r][width] columns of ahead, and for h = 1 */
    double *turning;          /* [r][width] columns of v_ahead */
    double *after;            /* [width] h c */
    dm_parts line, b, mean;   /* [width] h c, h b, h^2 mean */
    double *none;             /* [max(n, width)][width] zeros */
    double *share;            /* [2n] factors of q's increments, ones for p */
    double *drift;            /* [2n] h v0 in the separable form, else zero */
    dm_sweep_end end;
    double *memory;  /* what is kept from step to step, see stage_memory.c */
    double heaviest; /* largest entry of M, where it is constant */
} dm_stage_sweeps;

/* The step of one stage by push.h, see stage_push.c. */
typedef struct {
    dm_kernel kernel;
    double *memory;   /* what a step leaves to the next one; NULL: made another way */
    double *in, *out; /* of the kernel */
    int known;        /* the step in hand goes on from the memory */
    double over;      /* 1 / (h^2 A) */
    double heaviest;  /* largest entry of M */
} dm_stage_pushes;

/* Laid out at the head of stepper->work by dm_stage_open. */
typedef struct {
    dm_stage_table table;
    const dm_model *m;
    uint32_t n;
    int separable;          /* the cheaper form for L = T(v) - V(q, t), constant mass */
    int prepared, weighed;  /* for Newton's method; its weights are those of h */
    const dm_kernel *stage; /* where it is prepared: of a fallback it is made then */
    double h, t;            /* step, its start */
    dm_weight *hA, *hmean;  /* [r*r], [r]: h^2 A, h^2 mean */
    dm_weight *ha;          /* [r*s]: h a */
    dm_weight *wq, *wv;     /* [r*s]: h b_i (a_ij - beta_j), b_i d_ij */
    dm_weight *hbeta;       /* [s] */
    dm_weight *hb, *hc;     /* [r] */
    dm_weight *hreach;      /* [r]: h times the sums of the rows of a */
    double *state;          /* at the start of the step; after sweeps at its end */
    double *x;              /* [2n+1] arguments of a kernel */
    double *slope;          /* [r][2n] L_q, L_v; separable: [r][n] L_q */
    double *curve;          /* [r][2n + 3n^2] outputs of the stage kernel */
    double *root;           /* [r or s][n] unknowns */
    double *v0, *a0;        /* [n] velocity and acceleration at the start */
    double *push;           /* [r][n] M^-1 L_q(m) of the separable form */
    double *base;           /* [r][n] what Q_m - q0 is without the unknown forces */
    double *next;           /* [4n] state at the end */
    double *scratch;        /* of Newton, and of what comes before it */
    double *before;         /* [r or s][n] roots of a shorter step (continuation in h) */
    double ratio;           /* h over that of `before`; 0: there is none */
    uint32_t *known;        /* [r] separable: how point m is found */
    double size;            /* of the terms of the residual */
    int one;                /* one velocity at one point: stage_one.c */
    const double *newest;   /* its slope at the last evaluation */
    dm_stage_sweeps sweeps;
    dm_stage_pushes pushes;
    double *warm, *ahead;         /* stage_warm.c; NULL: nothing is kept */
    struct dm_stage_lanes *lanes; /* stage_lanes.h; NULL: this is no ensemble */
    long evaluations;
} dm_stage;

/* Doubles of the weights above; lay them out; compute those of the sweeps for a step h, and what
 * Newton's method needs besides. */
size_t dm_stage_weights_size(size_t s, size_t r);
void dm_stage_weights_place(dm_stage *g, double *memory);
void dm_stage_weights_scale(dm_stage *g, double h);
void dm_stage_weights_complete(dm_stage *g);

/* Doubles of the sweeps; make their kernel and lay them out, or leave them without one; for a
 * new step h. */
size_t dm_stage_sweeps_size(size_t s, size_t r, const dm_model *m);
void dm_stage_sweeps_open(dm_stage *g, const dm_galerkin *basis, double *memory);
void dm_stage_sweeps_scale(dm_stage *g);
/* Its coefficients, a block of as many doubles as it returns. */
size_t dm_stage_sweeps_scaled(const dm_stage *g, const double **first);

/* Their kernels, one in the separable form, for `width` arguments at once; how many one
 * evaluation takes, 0: there are none. */
uint32_t dm_stage_sweeps_kernels(dm_kernel out[3], const dm_stage *g, uint32_t width);

/* One step by sweeps, of g->state in place; DM_NO_CONVERGENCE where they contract too slowly,
 * and Newton's method is for it. */
dm_status dm_stage_sweep(dm_stage *g, dm_stepper *stepper);

/* Largest entry of a constant M: over h it turns a displacement into a momentum. */
double dm_stage_heaviest(const dm_stage *g);

/* u of the sweeps as the last of them left it, [n][width] */
const double *dm_stage_sweeps_u(const dm_stage *g);

/* Where the memory of steps by sweeps has what: h, a mark, contraction, the state at its end
 * [4n], u [n][width]. */
enum { DM_SWEPT_STEP, DM_SWEPT_MARK, DM_SWEPT_RATE, DM_SWEPT_END, DM_SWEPT_FULL = 1 };

/* What a step leaves to the next one: the forces of its stages, valid where that step begins at
 * its end. */
size_t dm_stage_memory_size(const dm_stage *g);
void dm_stage_memory_clear(dm_stage *g, double h);
int dm_stage_memory_fits(const dm_stage *g);          /* it was left by the step that ended here */
const double *dm_stage_memory_end(const dm_stage *g); /* [4n], where that step ended */
double dm_stage_memory_rate(const dm_stage *g);       /* contraction of the sweeps, squared */
int dm_stage_memory_is_stiff(const dm_stage *g);      /* sweeps failed not long ago */
void dm_stage_memory_keep(dm_stage *g, double rate);  /* after a step by sweeps */
void dm_stage_memory_newton(dm_stage *g);             /* after a step by Newton's method */

/* And that of Newton's method: h, steps, the state at the end of the last [4n], its V[s][n],
 * differences. */
enum {
    DM_WARM_STEP,
    DM_WARM_COUNT,
    DM_WARM_END,
    DM_WARM_TERMS = 6,   /* differences */
    DM_WARM_PARABOLA = 2 /* differences that one stage always takes */
};
static const double DM_WARM_NEARER = 0.5; /* what a difference may leave of what was missing */

/* Newton's method of the general form: doubles for s stages; what of them is memory of the last
 * steps. */
size_t dm_stage_warm_size(size_t s, uint32_t n);
size_t dm_stage_warm_memory(const dm_stage *g);
void dm_stage_warm_open(dm_stage *g, const dm_galerkin *basis, double *memory);
void dm_stage_warm_clear(dm_stage *g, double h);
int dm_stage_warm_guess(dm_stage *g); /* g->root from the steps before; 0: none ended here */
void dm_stage_warm_keep(dm_stage *g);

/* One stage, separable, few coordinates: doubles; what of them is memory of the last steps; 0
 * where there is no kernel for it. */
size_t dm_stage_push_size(const dm_model *m);
size_t dm_stage_push_memory(const dm_stage *g);
int dm_stage_push_open(dm_stage *g, double *memory);
void dm_stage_push_clear(dm_stage *g, double h);

/* One step of g->state in place; DM_NO_CONVERGENCE leaves it to Newton's method, whose root is
 * kept then. */
dm_status dm_stage_push(dm_stage *g, dm_stepper *stepper);
void dm_stage_push_newton(dm_stage *g);

/* Where its memory has what: h, number of P, the state at the end of the last step [4n], the
 * next u [n], P [terms][n]. */
enum {
    DM_PUSHED_STEP,
    DM_PUSHED_COUNT,
    DM_PUSHED_END,
    DM_PUSHED_TERMS = 6, /* polynomials P, of degrees 0 to 5 */
    DM_PUSHED_CALLS = 6  /* of the kernel in a step, at most */
};

/* How a point of the separable form is found. */
enum { DM_POINT_FIRST, DM_POINT_SOLVED, DM_POINT_LAST };

/* One step with unknown displacements; leaves the end in g->next. */
dm_status dm_stage_separable(dm_stage *g, dm_stepper *stepper);
void dm_stage_separable_open(dm_stage *g);

/* One velocity at one point, Qdot = V: the step equation, for dm_newton, and the end with the
 * last increment. */
int dm_stage_is_one(const dm_stage *g);
dm_status dm_stage_one(void *ctx, double *R, double *J, const double *V);
dm_status dm_stage_one_finish(dm_stage *g, const double *dV);

/* next = state + (dq[n], dp[n]) with compensation; DM_NOT_FINITE when it is not. */
dm_status dm_stage_update(dm_stage *g, const double *dq, const double *dp);

/* One double at a time where they are few: a wide load would wait for the narrow stores that a
 * state has just had. */
static inline void dm_stage_copy(double *to, const volatile double *from, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) to[i] = from[i];
}

/* Kernel arguments: x = (q0 + shift[n], v[n], t + after); v NULL: the start's. */
void dm_stage_at(dm_stage *g, const double *shift, const double *v, double after);

#endif
