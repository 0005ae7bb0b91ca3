/* stage_sparse.h - steps of stage methods for fields on meshes: Newton's method with the sparse
 * matrix of second derivatives (chain/curvature.h). With f_m = M^-1 L_q(q0 + Z_m, t + c_m h)
 *   Z_i = h r_i v0 + h^2 sum_m A_im f_m,  q1 = q0 + h v0 + h^2 sum_m mean_m f_m,
 * as in stage_separable.c, and its matrix is M - h^2 A_im L_qq at the start of the step, or at
 * every point where that does not serve. */
#ifndef DM_STAGE_SPARSE_H
#define DM_STAGE_SPARSE_H

#include "integ/method/stage_table.h"

extern const dm_engine dm_engine_stage_sparse;

/* Why a rule cannot step a field on a mesh, or NULL; the force of L and its second derivatives,
 * with the first of which come forces beside L. Those of stage_worked.h, too. */
const char *dm_stage_field_fits(const dm_rule *rule, const dm_model *m);
unsigned dm_stage_field_wants(const dm_rule *rule, const dm_model *m);

#endif
