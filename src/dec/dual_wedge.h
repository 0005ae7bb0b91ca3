/* dual_wedge.h - products of dual forms (Leok, Def 3.25), corrected and as printed. */
#ifndef DM_DUAL_WEDGE_H
#define DM_DUAL_WEDGE_H

#include "dec/field.h"

typedef enum {
    DM_DUAL_CONSISTENT, /* exact on constant forms, in any dimension */
    DM_DUAL_THESIS      /* as printed: without weights */
} dm_dual_rule;

/* out[count[n - k - l]] = a ^ b of a dual k-form a[count[n - k]] and a dual l-form. In a top cell,
 * with r the vertices that are not in the base and nu_i = grad phi_i, "consistent" is
 *   |*base in s| / |nu_r| sum over r = I + J of sign(I, J) a(nu_I) b(nu_J),
 * a(nu_I) = +-|nu_I| a / |*| of the face without I, |nu_I| the volume that these span. Needs an
 * orientation. DM_SINGULAR: zero dual volume, see *fault. */
dm_status dm_dual_wedge(double *out, const dm_complex *K, const dm_metric *metric,
                        dm_dual_rule rule, uint32_t k, const double *a, uint32_t l, const double *b,
                        dm_sharp_fault *fault);

#endif
