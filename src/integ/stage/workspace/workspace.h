/* workspace.h - what steps of the stage solver (integ/stage/stage.h) work on, by what it is for.
 * dm_stage_open lays it out at the head of stepper->work; what follows of sub-rooms has its
 * struct there. Arrays of members are [entry][lane]: one lane for a run, 4 or 8 for an ensemble. */
#ifndef DM_WORKSPACE_H
#define DM_WORKSPACE_H

#include "base/doubles.h"
#include "integ/method/method.h"
#include "integ/method/stage_table.h"
#include "linalg/step_matrix.h"

/* The table times powers of one step h: the only numbers here that h enters. All lie behind each
 * other from hA on, so that members with steps of their own have theirs as one block. */
typedef struct {
    double h;         /* the step that they are of, 0 before the first */
    int complete;     /* 0: those of Newton's method alone are still of another step */
    dm_weight *hA;    /* [r*r] h^2 A, in the separable form */
    dm_weight *hmean; /* [r] h^2 mean, in the separable form */
    dm_weight *ha;    /* [r*s] h a, in the general form */
    dm_weight *wq;    /* [r*s] h b_i (a_ij - beta_j), general form, when complete */
    dm_weight *wv;    /* [r*s] b_i d_ij, general form, when complete */
    dm_weight *hbeta; /* [s] h beta, general form, when complete */
    dm_weight *hb;    /* [r] h b */
    dm_weight *hc;    /* [r] h c */
    dm_weight *reach; /* [r] h times the sums of the rows of a, when complete */
    /* [1] h itself, in the separable form: a decimal h is near a ratio of small numbers, and
     * products with it would be rounded in few ways, not evenly */
    dm_weight *flight;
} dm_stage_weights;

/* The members whose step is made, and what steps leave behind. */
typedef struct {
    double *state;   /* [dm_state_size] at the start of the step, after it at its end */
    double *memory;  /* what a step leaves to the next one, as its form lays it out */
    double *next;    /* [4n] the end, before it is known to be finite */
    double t;        /* start of the step */
    const double *h; /* [lane] */
    /* entry k of the coefficients that begin at `one` is scaled[k][lane] */
    const double *one, *scaled;
    double tolerance; /* of Newton's method, as in dm_stepper */
    int max_iterations;
} dm_stage_group;

/* Newton's method. Of the separable form the unknowns are displacements Z_m of points. */
typedef struct {
    const dm_kernel *stage; /* L_q, L_v, L_qq, L_qv, L_vv; NULL until it is needed first */
    const dm_kernel *slope; /* L_q, L_v; separable: L_q */
    double *x;              /* [2n + 1] q, v, t: arguments of both */
    double *curve;          /* [r][2n + 3n^2] outputs of `stage` where the matrix was made */
    double *slopes;         /* [r][2n] of `slope` at the last iterate; separable: [r][n] */
    double *root;           /* [s or r][n] the iterate */
    double *missed;         /* [s][n] what a warm start has missed, while it is kept */
    /* of the separable form, set with `stage`, but for the linear ones */
    dm_step_matrix matrix;
    double *lists;    /* room for those of `matrix` */
    uint32_t *solved; /* [points] that are solved for */
    uint32_t points;  /* how many */
    int linear;       /* V is quadratic, of the general form L: the factors are kept */
    int keeps;        /* it is not, but they are tried in further steps (stage_kept.c) */
    double factored;  /* the h that they are of; NaN: there are none */
    double *place;    /* [n + 1] q, t that they are of, where V is not quadratic */
    double *factors;  /* in the scratch */
    uint32_t *pivot;  /* behind them */
    struct dm_newton_constant *constant; /* of the general form, in a solve; NULL: not linear */
} dm_stage_newton;

/* The start and the points of the separable form, and what the first guess of both asks. */
typedef struct {
    double *v0, *a0; /* [n] velocity and acceleration at the start of the step in hand */
    double *u;       /* [r][n] M^-1 L_q at the points */
    double *base;    /* [r][n] Q_m - q0 without the forces that are not known yet */
    uint32_t *kind;  /* [r] how a point is found, DM_POINT_FIRST ... */
} dm_stage_points;

/* How a point of the separable form is found: before Newton's method, by it, after it. */
enum { DM_POINT_FIRST, DM_POINT_SOLVED, DM_POINT_LAST };

/* Where Newton's method fails: the root of a shorter step leads to that of a longer one. */
typedef struct {
    double *root; /* [s or r][n] of the shorter step */
    double ratio; /* the longer step over it; 0: no step is continued */
} dm_stage_continuation;

typedef struct dm_stage {
    const dm_model *m;
    uint32_t n;
    int separable; /* the cheaper form for L = T(v) - V(q, t) with constant mass */
    int one;       /* a single velocity at a single point, general form */
    dm_stage_table table;
    dm_stage_weights weights; /* of the step in hand */
    dm_stage_group group;     /* the one member of a run */
    dm_stage_newton newton;
    dm_stage_points points;
    dm_stage_continuation before;
    double *scratch;  /* of dm_newton and of dm_legendre_inverse; [s][n] of it the last increment */
    size_t room;      /* doubles of it */
    double size;      /* of the terms of the residual that was evaluated last */
    long evaluations; /* of kernels, in the step in hand */
    double *ahead;    /* [s*s] stage_warm.h: velocities of the next step from those of the last */
    /* other roads, where the method and the model have them; NULL: not */
    struct dm_stage_sweeps *sweeps; /* fixed-point sweeps, sweep/stage_sweep.h */
    struct dm_one_point *one_point; /* a separable step of one stage, lanes/one_point.h */
    struct dm_stage_lanes *lanes;   /* members of an ensemble, lanes/stage_lanes.h */
} dm_stage;

static inline dm_stage *dm_stage_of(const dm_stepper *stepper) {
    return (dm_stage *)(void *)stepper->work;
}

/* Doubles of the weights above; lay them out; compute those of a step h that sweeps and one-point
 * steps want, and what Newton's method needs besides. */
size_t dm_stage_weights_size(size_t s, size_t r);
void dm_stage_weights_place(dm_stage_weights *w, const dm_stage_table *t, double *memory);
void dm_stage_weights_scale(dm_stage *g, double h);
void dm_stage_weights_complete(dm_stage *g);

/* Largest entry of a constant M: over h it turns a displacement into a momentum. */
double dm_stage_heaviest(const dm_model *m);

/* Unknowns from which on a band is looked for, and factors are kept for further steps; doubles of
 * the memory that tells of these (stage_kept.c). */
enum { DM_STAGE_BAND_LEAST = 65, DM_STAGE_KEPT_LEAST = 4 };
static inline size_t dm_stage_kept_size(const dm_stage *g) {
    return g->separable && g->n * g->table.r >= DM_STAGE_KEPT_LEAST ? g->n + 2 : 0;
}

/* One double at a time where they are few: a wide load would wait for the narrow stores that a
 * state has just had. */
static inline void dm_stage_copy(double *to, const volatile double *from, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) to[i] = from[i];
}

#endif
