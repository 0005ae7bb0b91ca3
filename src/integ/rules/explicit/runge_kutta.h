/* runge_kutta.h - explicit Runge-Kutta methods on Hamilton's equations of L:
 *   q' = v(q, p, t), the inverse Legendre transform,  p' = L_q(q, v, t),
 * with a fixed step and compensated sums. Values of a field without mass are at every stage what
 * the others make of them, L_q = 0. They are not symplectic: their use is comparison and
 * short runs. */
#ifndef DM_RUNGE_KUTTA_H
#define DM_RUNGE_KUTTA_H

#include "integ/split/cells_split.h"

/* A row's table. */
typedef struct {
    uint32_t stages;
    const double *a; /* [stages + 1][stages]: a_ij, strictly lower, in the last row b */
} dm_runge_kutta;

extern const dm_engine dm_engine_runge_kutta;

/* Of any engine on these equations. */
const char *dm_runge_kutta_fits(const dm_rule *rule, const dm_model *m);
unsigned dm_runge_kutta_wants(const dm_rule *rule, const dm_model *m);

/* Values without mass, in doubles of workspace: 0 where there are none. In that workspace, opened;
 * NULL: none. */
size_t dm_runge_kutta_massless_work(const dm_model *m);
dm_cells_split *dm_runge_kutta_massless(const dm_model *m, double *work);

#endif
