/* curve_written.h - the curve segment of a method that is no tableau, written out as one graph: the
 * method is run to both ends and to the Gauss nodes of the action, the acceleration solved in the
 * graph, and derivatives taken of all that. */
#ifndef DM_CURVE_WRITTEN_H
#define DM_CURVE_WRITTEN_H

#include "integ/curve/curve.h"
#include "integ/curve/curve_recipe.h"

/* Kernels take (q[n], v[n], t, ..., h, p1[n], p0[n], share[substeps]), where what stands between t
 * and h is that of curve_field.h, controls behind it. */
typedef struct {
    dm_kernel ends;     /* d+ - q, d- - q, velocities there [n] each, Ld, impulses [2][rolling] */
    dm_kernel gradient; /* sigma_d - p1 . (d+ - q)_y + p0 . (d- - q)_y [2n] */
    dm_kernel hessian;  /* its derivatives [2n*2n], those of d+ - q and d- - q [n*2n] each */
    size_t inputs, h, p1, p0, share; /* places of the inputs; how many there are */
    size_t calls;                    /* of f in a segment */
} dm_written;

/* What there will be of inputs and outputs, before any kernel is made. */
size_t dm_written_inputs(const dm_curve *c, const dm_model *m);
size_t dm_written_outputs(const dm_model *m);

/* In the model's arena, kept by the model. */
dm_status dm_written_build(dm_written *out, const dm_curve *c, const dm_model *m);

#endif
