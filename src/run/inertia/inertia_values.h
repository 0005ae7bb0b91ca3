/* inertia_values.h - d2L/dv2 at a place, and the values of its blocks. */
#ifndef DM_INERTIA_VALUES_H
#define DM_INERTIA_VALUES_H

#include "run/inertia/inertia.h"

/* d2L/dv2 at a state is found, behind dL/dv[n] in x->out; 0: no velocity is known. Its values are
 * counted, which become x->values. */
int dm_inertia_find_state(const dm_inertia *x, const double *state, double t);
dm_inertia_there dm_inertia_count(const dm_inertia *x);

/* d2L/dv2 at a velocity is found; scaled, A[n*n] until something else is asked, where behind the
 * inputs of its kernel lie dL/dv[n] and d2L/dv2[n*n]; and how many of its values are negative. */
void dm_inertia_find(const dm_inertia *x, const double *q, const double *v, double t);
double *dm_inertia_mass(const dm_inertia *x, const double *q, const double *v, double t);
uint32_t dm_inertia_negative(const dm_inertia *x, const double *q, const double *v, double t);

/* Block b of the mass that was found last, or all of it where b is the number of blocks, scaled,
 * and the rows of the constraints there: A[n*n], G[rows*n], of a prolonged L those of L; room for
 * another A, and for work. Row i is that of coordinate order[i]. */
typedef struct {
    double *A, *copy, *G, *border;
    const uint32_t *order;
    uint32_t n, rows;
} dm_inertia_form;

dm_inertia_form dm_inertia_place(const dm_inertia *x, uint32_t b);

/* The velocity u[n] that constraints allow for the momentum u[n], with as many numbers behind it;
 * NULL: there is none. All but G is overwritten. */
double *dm_inertia_solve(const dm_inertia_form *f, double *u);

/* How many values are negative of f->A[n*n], and what the block has. The copy is A. */
uint32_t dm_inertia_negative_in(const dm_inertia_form *f, uint32_t n, dm_inertia_value *out);

/* Are all values of block b of the mass that was found last positive by far, as is easily told?
 * Then these. */
int dm_inertia_is_far(const dm_inertia *x, uint32_t b, dm_inertia_value *out);

/* The first d columns of rows[count*n], d at most n, in their place: on a group the others have
 * masses of 1, which are no velocities (mech/group.h). */
void dm_inertia_narrow(double *rows, size_t count, uint32_t n, uint32_t d);

/* ---- tangent maps (inertia_prolonged.c) ---- */

/* Is M[n*n] that of a prolonged L? */
int dm_inertia_is_prolonged(const double *M, uint32_t n);

/* Where it is so, and the constraints G[rows*n] are: the M of L and the constraints of q, in the
 * first entries of A and G; their order. Else n. work[(rows + 1) * n]. */
uint32_t dm_inertia_halve(double *A, double *G, uint32_t *rows, uint32_t n, double *work);

#endif
