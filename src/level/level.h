/* level.h - a level set F = 1 in R^n, and its angle with the orbits of a group that moves the
 * points: its points are found by Newton steps of least length. (1, not 0: a trace is compared
 * with plain calls, and beside 1 what cancels is.) What can be narrow in F is known from its
 * graph: the operands of tanh, exp, /, abs and the like, the switches. */
#ifndef DM_LEVEL_H
#define DM_LEVEL_H

#include "code/kernel.h"

enum { DM_SWITCHES = 24 };

/* What happens along the operand u of an operation: it bends within |u| of about 1 (tanh, exp),
 * turns with every period (sin), has a scale of |u| (1/u, log) or breaks off at u = 0 (abs). Behind
 * these: what must be u > 0, whose edge is looked at, too. */
typedef enum { DM_BENDS, DM_TURNS, DM_DIVIDES, DM_BREAKS, DM_EDGES } dm_switch;

/* F: n numbers -> c, of which the first r stand for the section. At the point that was looked at
 * last: value[c] of F, slope[(c + s) n] of F and, behind it, of the switches, psi[n r] of the
 * action, u[s] the switches. */
typedef struct {
    uint32_t n, c, r, s;
    dm_switch kind[DM_SWITCHES];
    dm_kernel kernel;
    double *value, *slope, *psi, *u;
    /* scratch: [(c + s) n], [c + s], its square, [r r] twice, [n] twice */
    double *rows, *y, *gram, *A, *turns, *change, *best;
    uint32_t *pivot;
    double goal[DM_SWITCHES], unit[DM_SWITCHES]; /* of u, where they are aimed at */
    int has_gram; /* gram holds the factors of J J^T of F where it was looked at */
} dm_level;

/* A traced function: value[outputs] in its graph of so many inputs. */
typedef struct {
    dm_graph *graph;
    const dm_node *value;
    uint32_t inputs, outputs;
} dm_level_function;

/* moved(y, x): r + n inputs, x moved by y; inside: what must be > 0, or NULL. In
 * `arena`; DM_NO_MEMORY, or what a graph refuses. */
dm_status dm_level_build(dm_level *out, const dm_level_function *F, const dm_level_function *moved,
                         const dm_level_function *inside, dm_arena *arena);

/* All of it at x; 0: something is not finite there. */
int dm_level_look(dm_level *l, const double *x);

/* x brought to the level set by corrections that fit a step of this length; 0: it is not there. */
int dm_level_bring(dm_level *l, double *x, double step);

/* v[n] becomes the unit vector along the level set beside it, at right angles to `more` rows that
 * stand in l->rows behind c n numbers; 0: there is none. */
int dm_level_turn(dm_level *l, double *v, uint32_t more);

/* The product of the sines of the angles between level set and orbit, with a sign: det J psi
 * / (det J J^T det psi^T psi)^1/2. It passes zero where the set turns back along orbits. *slant
 * (or NULL): det J psi over the lengths of its rows, which does not pass zero where orbits only
 * become short in some direction; the sine where there is one row. */
double dm_level_sine(dm_level *l, double *slant);

/* The section against orbits at x, which need not be on it. A[r r] = D J psi, inverse[r r] that of
 * A, D = diag(unit[r]), which makes rows of D J as long as 1, since a section may have any units.
 * condition: |A^-1| max(|A|/r, |D J| |x|) in Frobenius' norm, as near a fixed point psi itself
 * vanishes; INFINITY where A is singular. 0: J or psi is not finite. */
int dm_level_cut(dm_level *l, const double *x, double *A, double *inverse, double *unit,
                 double *condition);

/* y[r] of the algebra, the least one that moves x[n] as close to goal[n] as it can, to first order.
 * 0: psi is not finite, or its columns depend on each other. */
int dm_level_approach(dm_level *l, const double *x, const double *goal, double *y);

/* How far F can be followed from here along v before it may have changed at a switch, and how far
 * it is to just behind the next break; INFINITY: any length. */
double dm_level_reach(const dm_level *l, const double *v, double *breaks);

/* How long the change at switch j is, across it; INFINITY where its slope is zero along the set.
 * across[n]: the unit vector along the set. */
double dm_level_width(dm_level *l, uint32_t j, double *across);

/* x moved along the level set to where the `count` switches which[] are closest to zero; 0: they
 * come no closer than they are. */
int dm_level_aim(dm_level *l, double *x, const uint32_t *which, uint32_t count);

#endif
