/* extrusion.h - the contraction i_X of primal forms by extrusion (Leok 3.10, Lemma 3.5). */
#ifndef DM_EXTRUSION_H
#define DM_EXTRUSION_H

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
 *   (i_X a)(s) = -k sum over w of (-1)^(place of w in s + w) a(s + w) (grad phi_w . X),
 * X its mean over s.
 * work: count[k - 1] entries each; *degenerate counts cells of zero dual volume, where the central
 * rule takes plain means. */
void dm_contract(double *out, const dm_complex *K, const dm_metric *metric,
                 const dm_vector_field *X, uint32_t k, const double *a, dm_side side,
                 uint32_t *work, double *scores, uint32_t *degenerate);

#endif
