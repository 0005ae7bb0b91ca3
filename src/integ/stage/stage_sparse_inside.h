/* stage_sparse_inside.h - what the files of sparse step equations ask of each other. */
#ifndef DM_STAGE_SPARSE_INSIDE_H
#define DM_STAGE_SPARSE_INSIDE_H

#include "integ/stage/stage_factor.h"
#include "integ/stage/stage_place.h"
#include "integ/stage/stage_sparse.h"

/* How a point is found: explicit, by Newton's method, or read off when all others are known. */
enum { DM_SPARSE_FIRST, DM_SPARSE_SOLVED, DM_SPARSE_LAST };

/* At the head of stepper->work. */
typedef struct {
    dm_stage_table table;
    uint32_t solved, at[DM_QUADRATURE_NODES]; /* points that are solved for */
    uint32_t first; /* the first of the explicit points; r: there are none */
    uint8_t kind[DM_QUADRATURE_NODES];
    dm_sparse S; /* [n solved]^2: unknown k of solved point i is k solved + i */
    dm_stage_factor factors;
    dm_stage_place kept;      /* (q, t) that S may be of, where it is not constant */
    double h;                 /* that S was made for; 0: none */
    int fresh;                /* forces at the solved Z are there, all of them finite */
    int constant;             /* second derivatives are numbers, and so are factors */
    double *x, *Z, *base, *F; /* (q, v, t); [r][n] each: Z, what is known of it, F */
    double *R, *dx, *cg;      /* [solved][n], [4 solved n] */
    double *diagonal;         /* [n][solved] of S, in the place of cg; NULL: not known */
    double *root;             /* [solved][n] Z of a shorter step, while it is continued */
    double *begin;            /* the table, in the workspace */
} dm_stage_sparse;

static inline dm_stage_sparse *dm_stage_sparse_of(const dm_stepper *s) {
    return (dm_stage_sparse *)(void *)s->work;
}

/* Where second derivatives are taken: at q0, at the mean of the points, at each of them. */
typedef enum { DM_SPARSE_AT_START, DM_SPARSE_AT_MEAN, DM_SPARSE_AT_OWN } dm_sparse_place;

/* The pattern of S, once; S for a step h with second derivatives from there, and its factors;
 * dx = S^-1 R. */
void dm_stage_sparse_pattern(dm_stage_sparse *l, const dm_sparse *A);
dm_status dm_stage_sparse_matrix(dm_stepper *s, const double *q, double t, double h,
                                 dm_sparse_place at);
dm_status dm_stage_sparse_solve(dm_stepper *s);

/* F at point m, q0 + Z_m. */
void dm_stage_sparse_force(dm_stepper *s, const double *q, uint32_t m, double t, double h);

/* out[n] += h^2 sum of A_im M^-1 F_m over the points of one kind */
void dm_stage_sparse_add(const dm_stepper *s, double *out, uint32_t i, int kind, double h);

/* Z of the points that are solved for, from what stands there; from `base`, where it is 1, with a
 * matrix that is kept. */
dm_status dm_stage_sparse_newton(dm_stepper *s, const double *q, double t, double h, int from_base);

#endif
