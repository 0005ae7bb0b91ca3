/* stage_inside.h - what the files of the stage solver ask of each other. All work on dm_stage. */
#ifndef DM_STAGE_INSIDE_H
#define DM_STAGE_INSIDE_H

#include "integ/stage/stage.h"
#include "integ/stage/workspace/workspace.h"
#include "linalg/solve/newton.h"

/* Kernel arguments: x = (q0 + shift[n], v[n], t + after); v NULL: the start's. */
void dm_stage_at(dm_stage *g, const double *shift, const double *v, double after);

/* One step by Newton's method; leaves the end in g->group.next and the root in g->newton.root:
 * velocities of the general form, displacements of the separable one. */
dm_status dm_stage_general(dm_stage *g, dm_stepper *stepper);
dm_status dm_stage_separable(dm_stage *g, dm_stepper *stepper);
void dm_stage_separable_open(dm_stage *g);
void dm_stage_general_open(dm_stage *g); /* once its kernel is there */

/* The matrix of the separable form, once its kernel is there: opened with so many doubles of
 * scratch, filled in (newton.matrix says where), as a band alone, and where V is quadratic its
 * factors for the h of the weights, which stay until Newton's method takes the room. */
void dm_stage_band_open(dm_stage *g, size_t room);
void dm_stage_matrix(dm_stage *g, double *J);
void dm_stage_band_fill(const dm_stage *g, double *J);
dm_status dm_stage_band_factor(dm_stage *g);

/* Newton's method from the root's guess with factors of an earlier step, which the memory tells of:
 * the root, or not DM_OK and the guess as it was. */
dm_status dm_stage_kept(dm_stage *g, const dm_newton_problem *problem, dm_newton_report *report);

/* One step of one stage, separable, few coordinates, of g->group.state in place (one_point.h):
 * doubles; open it where there is a kernel for it; doubles of its memory. DM_NO_CONVERGENCE leaves
 * a step to Newton's method, whose root is kept then. */
size_t dm_one_point_size(const dm_model *m);
int dm_one_point_open(dm_stage *g, double *memory);
size_t dm_one_point_memory(const dm_stage *g);
void dm_one_point_clear(dm_stage *g, double h);
dm_status dm_one_point_step(dm_stage *g, dm_stepper *stepper);
void dm_one_point_newton(dm_stage *g);

#endif
