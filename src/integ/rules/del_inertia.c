/* del_inertia.c - does p0 still determine q1? Not where the matrix of the step, [D1D2 Ld, G0^T; G1,
 * 0], loses its rank: D1D2 Ld is nearly -d2L/dv2 over h, and where its determinant changes its sign
 * from step to step the motion has gone over such a place, or onto another branch. */
#include "integ/rules/del.h"

#include "linalg/lu.h"

/* From its factors, which Newton's method has. The sign stays where the size is beyond numbers. */
void dm_del_note(dm_del *e, const double *LU, const uint32_t *pivot) {
    const size_t N = e->N;
    double inverse = 1.0;
    for (size_t i = 0; i < N; i++) inverse *= pivot[i] != i ? -LU[i * N + i] : LU[i * N + i];
    e->sign = copysign(1.0, inverse);
    e->inverse = fabs(inverse);
}

/* Rows of rolling constraints turn, and those that may cross change signs as they do. */
static int is_told(const dm_del *e) {
    const dm_constraints *c = e->m->constraints;
    return !e->l && !(c && c->crossings) && e->sign != 0.0;
}

int dm_del_has_turned(const dm_del *e) {
    return is_told(e) && e->memory[DM_DEL_SIGN] == -e->sign;
}

dm_status dm_del_look(const dm_del *e) {
    double *memory = e->memory;
    if (!is_told(e)) return DM_OK;
    if (memory[DM_DEL_SIGN] == -e->sign) return DM_INERTIA;
    memory[DM_DEL_FALL] = memory[DM_DEL_SIGN] == 0.0 ? 1.0 : e->inverse / memory[DM_DEL_INVERSE];
    memory[DM_DEL_SIGN] = e->sign, memory[DM_DEL_INVERSE] = e->inverse;
    return DM_OK;
}

/* Like the root of the steps that are left, as at a fold of the momentum. */
int dm_del_is_fading(const dm_del *e) {
    static const double STEPS = 2.5;
    const double fall = e->memory[DM_DEL_FALL];
    return (fall * fall - 1.0) * STEPS >= 1.0;
}
