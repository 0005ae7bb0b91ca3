/* galerkin.h - polynomials and quadratures of any kind, for rules with data of their own. */
#ifndef DM_GALERKIN_H
#define DM_GALERKIN_H

#include "integ/method/stage_table.h"

/* Curves of degree s with any quadrature of s nodes or more. */
void dm_galerkin_of(dm_galerkin *g, int s, const dm_quadrature *q);

/* NULL when the arguments of a rule are a degree and a quadrature that goes with it, else a static
 * sentence, `usage` where they are something else. */
const char *dm_galerkin_check(const dm_rule *rule, const char *usage);

/* What such a rule is made of. */
void dm_galerkin_basis(dm_galerkin *out, const dm_rule *rule);

/* Order of the Galerkin method of a basis without a tableau. */
int dm_galerkin_order(const dm_galerkin *g);

/* The kinetic energy of the velocities is regular under the quadrature. */
int dm_galerkin_is_regular(const dm_galerkin *g);

#endif
