/* wedge.h - products of primal forms (Leok, Def 3.24 and 3.47). On a cell of degree m = k + l
 *   (a ^ b)[v0 .. vm] = sum over tau of sign(tau) W(tau) a[v_tau0 .. v_tauk] b[v_tauk .. v_taum],
 * over the permutations of its vertices. Those with one pivot v_tauk and one set of vertices
 * before it are k! l! times the same term, so the sum has (m + 1) C(m, k) terms. */
#ifndef DM_WEDGE_H
#define DM_WEDGE_H

#include "dec/metric.h"

typedef enum {
    DM_WEDGE_NATURAL, /* W = 1 / (m + 1)!: Leibniz' rule holds, no metric */
    DM_WEDGE_METRIC,  /* W = w / m!, w the share of the pivot in the cell, by volume (printed) */
    DM_WEDGE_CUP      /* a[v0 .. vk] b[vk .. vm] alone: associative, not anticommutative */
} dm_wedge_rule;

/* out[count[k + l]] = a ^ b, a[count[k]], b[count[l]]; k + l <= n. The metric rule needs a metric,
 * the others take NULL. */
void dm_wedge(double *out, const dm_complex *K, const dm_metric *metric, dm_wedge_rule rule,
              uint32_t k, const double *a, uint32_t l, const double *b);

#endif
