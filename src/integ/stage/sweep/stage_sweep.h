/* stage_sweep.h - a step of a stage method by fixed-point sweeps over all stages at once, between
 * kernels and the sums of sweep.h: fewer than nine stages, kernels for them side by side. What is
 * iterated are u = L_q (M^-1 L_q where M is not diagonal) in the separable form, S = base + h^2 A
 * M^-1 L_q; else the velocities V = u, S = base + h a V, with momenta p0 + h a L_q. Coefficients
 * are doubles in every sweep; what those lack is added to the bases once, when u has settled.
 * Speed: steps, J2 satellite by gauss(3): 3.1x, against Newton's method; 6.6x by gauss(6). */
#ifndef DM_STAGE_SWEEP_H
#define DM_STAGE_SWEEP_H

#include "integ/stage/sweep/sweep.h"
#include "integ/stage/workspace/workspace.h"

/* A kernel on [inputs][width] and [outputs][width], `lanes` at a time. */
typedef struct {
    dm_kernel kernel;
    uint32_t lanes, inputs, outputs;
    double *in, *out;           /* [.][width]; constant outputs are there from the opening on */
    double *some_in, *some_out; /* [.][lanes] for fewer lanes than stages */
} dm_stage_kernel;

/* All stages of it at once, or some lanes at a time where it has fewer. */
void dm_stage_apply_some(const dm_stage_kernel *k, uint32_t width, uint32_t stages);
static inline void dm_stage_apply(const dm_stage_kernel *k, uint32_t width, uint32_t stages) {
    if (k->lanes == width)
        dm_kernel_eval(&k->kernel, k->in, k->out);
    else
        dm_stage_apply_some(k, width, stages);
}

typedef struct dm_stage_sweeps {
    const dm_sweep_row *row;                  /* sums for so many stages, of this processor */
    dm_stage_kernel force, factors, velocity; /* the last two: general form, else lanes = 0 */
    int count;                                /* sweeps a step; 0: to round-off */
    int by_all;                               /* the largest coordinate alone tells when they end */
    dm_sweep q, p;                            /* a sweep: positions; momenta of the general form */
    dm_sweep q_rest, p_rest;  /* into their bases, by the low-order parts of the coefficients */
    dm_sweep ahead, v_ahead;  /* positions, velocities from u of the step before */
    double *u;                /* [n][width], for M that is not diagonal */
    double *base, *lift;      /* [n][width] of positions, momenta: q0's and p0's low-order parts, */
                              /* and h c v0 */
    double *whole, *rest;     /* [r][width] columns of h^2 A or h a, what they lack */
    double *further, *flying; /* [r][width] columns of `ahead`, and for h = 1 */
    double *turning;          /* [r][width] columns of v_ahead, behind `flying`, of any h */
    double *after;            /* [width] h c */
    dm_parts line, b, mean;   /* [width] h c, h b, h^2 mean */
    dm_parts flight;          /* [1] h itself */
    double *none;             /* [max(n, width)][width] zeros */
    double *share;            /* [2n] factors of q's increments, ones for p */
    double *drift;            /* [2n] h v0 in the separable form, else zero */
    double *unit;             /* [2n] by which squares of moves count, where that is not all one */
    dm_sweep_end end;
    double *memory;  /* what is kept from step to step, as follows */
    double heaviest; /* largest entry of M, where it is constant */
} dm_stage_sweeps;

/* What a step leaves to the next one: h, a mark, the contraction of its sweeps squared, the state
 * at its end [4n], u of its stages [n][width], and what dm_stage_kept has there. Mark: 0: nothing;
 * DM_SWEPT_FULL: all of it is of the step that ended at END; below zero: sweeps failed not long
 * ago, so many steps by Newton's method are left before they are tried again. */
enum { DM_SWEPT_STEP, DM_SWEPT_MARK, DM_SWEPT_RATE, DM_SWEPT_END, DM_SWEPT_FULL = 1 };

/* Doubles of the sweeps; make their kernels and lay them out as g->sweeps, or leave that NULL;
 * coefficients for the h of the weights. */
size_t dm_stage_sweeps_size(size_t s, size_t r, const dm_model *m);
void dm_stage_sweeps_open(dm_stage *g, const dm_galerkin *basis, double *memory);
void dm_stage_sweeps_scale(dm_stage_sweeps *w, const dm_stage *g);
/* These, a block of as many doubles as it returns. */
size_t dm_stage_sweeps_scaled(const dm_stage_sweeps *w, const double **first);

/* Their kernels, one in the separable form, for `width` arguments at once; how many one
 * evaluation takes, 0: there are none. */
uint32_t dm_stage_sweeps_kernels(dm_kernel out[3], const dm_stage *g, uint32_t width);

/* One step by sweeps, of the state in place; DM_NO_CONVERGENCE where they contract too slowly,
 * and Newton's method is for it. */
dm_status dm_stage_sweep(dm_stage *g, dm_stepper *stepper);

/* u of the sweeps as the last of them left it, [n][width] */
const double *dm_stage_sweeps_u(const dm_stage *g);

/* The memory. Another h (a step to a time between, a part of a composition) neither uses it nor
 * changes it. */
size_t dm_stage_memory_size(const dm_stage *g);
size_t dm_stage_memory_u(const dm_stage *g); /* doubles in front of u */
void dm_stage_memory_clear(dm_stage *g, double h);
int dm_stage_memory_fits(const dm_stage *g);         /* it was left by the step that ended here */
int dm_stage_memory_is_stiff(const dm_stage *g);     /* sweeps failed not long ago */
void dm_stage_memory_keep(dm_stage *g, double rate); /* after a step by sweeps */
void dm_stage_memory_newton(dm_stage *g);            /* after a step by Newton's method */

#endif
