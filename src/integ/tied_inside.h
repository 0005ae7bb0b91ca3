/* tied_inside.h - the workspace of the stage solver with ties, for its files only. */
#ifndef DM_TIED_INSIDE_H
#define DM_TIED_INSIDE_H

#include "integ/tied.h"
#include "linalg/band.h"
#include "mech/ties.h"

/* The curve at some points: Q = q0 + h sum_j a_kj V_j, Qdot = sum_j d_kj V_j. */
typedef struct {
    uint32_t count;
    dm_weight *c;     /* [count] */
    dm_weight *a, *d; /* [count*s] */
} dm_tied_points;

/* Entries of a block of a kernel's outputs that are not zero everywhere. */
typedef struct {
    uint32_t count;
    uint32_t *entry, *row, *column;
} dm_tied_entries;

/* A matrix of n unknowns, dense by rows or a band: entry (i, j) stands at row[i] + column[j]. */
typedef struct {
    dm_band band;
    int banded;
    size_t *row, *column; /* [n] */
    uint32_t *order;      /* [n] */
} dm_tied_matrix;

/* Laid out at the head of stepper->work by dm_tied_open. */
typedef struct {
    dm_stage_table table;
    dm_tied_points tie, gauss; /* K + 1 points with impulses, K where rolling is enforced */
    const dm_model *m;
    const dm_ties *ties;
    uint32_t n, K, k, l;          /* dim Q, tie points less one, holonomic ties, rolling ties */
    double h, t;                  /* step, its start */
    dm_weight *hb, *hbeta;        /* [r], [s] */
    dm_weight *ha, *wq, *wv;      /* [r*s]: h a_ij, h b_i (a_ij - beta_j), b_i d_ij */
    dm_weight *tie_ha, *gauss_ha; /* [(K+1)*s], [K*s] */
    dm_weight *lever;             /* [K*s]: a~_kj - beta_j */
    dm_tied_entries qq, qv, vv, mass_vv, f_q, f_v, r_q, r_v; /* [n*n] */
    dm_tied_entries G, E, phi_v, phi_q;                      /* [k*n], [l*n] */
    dm_tied_matrix step, hidden; /* of the step equation, of the hidden constraint */
    double *ahead;               /* [s*(s+1)]: V_j from v0 and the V of the step before */
    double *inner_force; /* [(K-1)*r]: integral to t_k of what stands at the quadrature points */
    double
        *inner_impulse; /* [(K-1)*(K+1)]: of the reactions at the tie points, over their weights */
    double *inner_v; /* [(K-1)*n] velocity at the inner tie points, where reactions turn with it */
    double *longer;  /* [s*(s+1)]: and from those of a step of half the length */
    const double *state;             /* at the start of the step */
    double *x;                       /* [2n+1 + k+l + controls] arguments of a kernel */
    double *shift, *v;               /* [n] of a point */
    double *slope;                   /* [r][2n] L_q + f, L_v */
    double *plain;                   /* [r][2n] outputs of the slope kernel */
    double *curve;                   /* [r][2n + 3n^2] outputs of the stage kernel */
    double *drag;                    /* [r][n + 2n^2] outputs of the force kernels */
    double *holonomic;               /* [K+1][k(n+2)] g, G, g_t */
    double *rolling;                 /* [K+1][l(1+3n)] phi, E, phi_v, phi_q at the tie points */
    double *roll;                    /* [K][l(1+3n)] at the Gauss points */
    double *reaction;                /* [K+1][n + 2n^2] I_k, its derivatives in q, v */
    double *impulse;                 /* [K+1][n] I_k */
    double *lambda;                  /* [k+l] multipliers as the reaction takes them */
    double *row_unit, *impulse_unit; /* [k+l] M over the largest entry of G, phi_v; of G, E */
    double *mass;                    /* [n + n^2] L_v, L_vv at the ends */
    double mass_size;                /* largest entry of L_vv */
    double *root;                    /* [s][n] V, [K][k+l] impulses in units of velocity */
    double *end;                     /* [n] v1, [k+l] impulses of the last tie point */
    double *v0;                      /* [n] velocity at the start */
    double *next;                    /* [4n] state at the end */
    double *dq, *dp;                 /* [n] */
    double *before;                  /* [n] momentum at the end without I_K */
    double *scratch;                 /* of Newton and of the Legendre transform */
    double *memory;                  /* see tied_memory.c */
    double size;                     /* of the terms of the residual */
    long evaluations;
    int iterations; /* of Newton, in this step */
    double residual;
    uint32_t lost; /* the tie that depends on those before it, from 1; 0: none was found */
} dm_tied;

/* without the call that fmax is */
static inline double dm_tied_larger(double a, double b) {
    return a > b ? a : b;
}

/* outputs of the kernels at the tie point k */
static inline double *dm_tied_holonomic(const dm_tied *g, uint32_t k) {
    return g->holonomic + k * (size_t)g->k * (g->n + 2);
}
static inline double *dm_tied_rolling(const dm_tied *g, uint32_t k) {
    return g->rolling + k * (size_t)g->l * (1 + 3 * (size_t)g->n);
}
static inline double *dm_tied_curved(const dm_tied *g, uint32_t k) {
    return g->reaction + k * (size_t)g->n * (1 + 2 * (size_t)g->n);
}

/* ---- tied_table.c ---- */

uint32_t dm_tied_count(size_t s, size_t r, const dm_galerkin *g); /* K */
size_t dm_tied_weights_size(size_t s, size_t r);
void dm_tied_weights_fill(dm_tied *g, const dm_galerkin *basis, double *memory);
void dm_tied_weights_scale(dm_tied *g, double h);

/* ---- tied_point.c: kernels along the curve of the velocities V ---- */

/* x = (q0 + shift, v, t + after) */
void dm_tied_at(dm_tied *g, const double *shift, const double *v, double after);
/* x at the tie point k */
void dm_tied_at_tie(dm_tied *g, const double *V, uint32_t k);
/* slopes (and curves) at the points of the quadrature */
void dm_tied_slopes(dm_tied *g, const double *V, int with_curve);
/* ties where they are wanted and the impulses of the multipliers behind V; derivatives of these
 * too */
void dm_tied_ties(dm_tied *g, const double *V, int with_curve);
/* rows of the ties at x, kept for the tie point k; the impulse that they make; its derivatives */
void dm_tied_rows(dm_tied *g, uint32_t k);
void dm_tied_impulse(dm_tied *g, double *impulse, const double *impulses, uint32_t k);
void dm_tied_reaction(dm_tied *g, const double *impulses, uint32_t k);
/* G, E, v0, M and the scales at the start of the step */
dm_status dm_tied_begin(dm_tied *g);

/* ---- tied_entries.c: what of the matrices is not zero ---- */

/* doubles that entries and matrices take */
size_t dm_tied_entries_size(uint32_t n, uint32_t k, uint32_t l);
size_t dm_tied_matrix_size(uint32_t unknowns);
void dm_tied_entries_find(dm_tied *g, double *memory);
/* dense; and, where that pays, the band that the entries of J[n*n] fit in, scratch[2n] */
void dm_tied_matrix_open(dm_tied_matrix *m, uint32_t n, double *memory);
void dm_tied_matrix_narrow(dm_tied_matrix *m, const double *J, uint32_t *scratch);
/* values with no meaning wherever a kernel writes, for a look at the entries */
void dm_tied_scatter(dm_tied *g);

/* J += w B at (row, column), J += w B^T, y += B x */
void dm_tied_add(double *J, const dm_tied_matrix *m, uint32_t row, uint32_t column, double w,
                 const double *B, const dm_tied_entries *e);
void dm_tied_add_transposed(double *J, const dm_tied_matrix *m, uint32_t row, uint32_t column,
                            double w, const double *B, const dm_tied_entries *e);
void dm_tied_product(double *y, const double *B, const double *x, const dm_tied_entries *e);
void dm_tied_zero(double *J, const dm_tied_matrix *m);

/* ---- tied_equation.c ---- */

uint32_t dm_tied_unknowns(const dm_tied *g);
dm_status dm_tied_equation(void *ctx, double *R, double *J, const double *z);
void dm_tied_equation_matrix(const dm_tied *g, double *J);

/* ---- tied.c ---- */

dm_status dm_tied_newton(dm_tied *g, const dm_stepper *stepper);

/* ---- tied_end.c: from the root to the state at the end ---- */

dm_status dm_tied_finish(dm_tied *g, const dm_stepper *stepper);

/* ---- tied_hidden.c: v1 and the last impulses into g->end, from g->next without them ---- */

dm_status dm_tied_hidden(dm_tied *g, const dm_stepper *stepper);
void dm_tied_hidden_matrix(const dm_tied *g, double *J);

/* ---- tied_bent.c: reactions that turn with v ---- */

int dm_tied_is_bent(const dm_tied *g);
void dm_tied_bend_guess(dm_tied *g);
/* from a root with a guess of the inner velocities to one with theirs, and to the end of the
 * step */
dm_status dm_tied_bend(dm_tied *g, const dm_stepper *stepper);

/* ---- tied_memory.c: V, impulses, end and start of a step, for the next one ---- */

size_t dm_tied_memory_size(uint32_t n, uint32_t unknowns, uint32_t m);
void dm_tied_memory_clear(dm_tied *g, double h);
int dm_tied_memory_fits(const dm_tied *g);
const double *dm_tied_memory_velocity(const dm_tied *g); /* v1 */
void dm_tied_memory_keep(dm_tied *g);
/* root = a guess: from the step before where there is one (else 0), v0 alone, from V of a step
 * half as long */
int dm_tied_guess(dm_tied *g);
void dm_tied_plain_guess(dm_tied *g);
void dm_tied_longer_guess(dm_tied *g, const double *V);

/* ---- tied_rank.c ---- */

/* the first tie at the tie point k whose row depends on those before it, from 1; 0: none */
uint32_t dm_tied_dependent(dm_tied *g, uint32_t k);

#endif
