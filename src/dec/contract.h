/* contract.h - the contraction i_X by extrusion (Leok 3.10, Lemma 3.5), and the products of dual
 * forms (Def 3.25). */
#ifndef DM_CONTRACT_H
#define DM_CONTRACT_H

#include "dec/field.h"

/* From which top cells a value on a cell between them comes. */
typedef enum {
    DM_SIDE_CENTRAL, /* all of them, by their shares in the dual cell */
    DM_SIDE_FORWARD, /* those that X points into, or nearly so where there are none */
    DM_SIDE_BACKWARD /* those that -X points into */
} dm_side;

/* out[count[k - 1]] = i_X a, a[count[k]] a primal k-form, k > 0: the derivative of the integral of
 * a, as its Whitney interpolant, over the extrusion of the cell along X, oriented (X, cell). In a
 * top cell only faces cell + w of the cell count:
 *   (i_X a)(s) = -k sum over w of (-1)^(place of w in s + w) a(s + w) (grad phi_w . mean of X on s).
 * work: count[k - 1] entries each; *degenerate counts cells of zero dual volume, where the central
 * rule takes plain means. */
void dm_contract(double *out, const dm_complex *K, const dm_metric *metric, const dm_field *X,
                 uint32_t k, const double *a, dm_side side, uint32_t *work, double *scores,
                 uint32_t *degenerate);

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
                        dm_dual_rule rule, uint32_t k, const double *a, uint32_t l,
                        const double *b, dm_sharp_fault *fault);

#endif
