/* galerkin.h - polynomials and quadratures of any kind, for rules with data of their own. */
#ifndef DM_GALERKIN_H
#define DM_GALERKIN_H

#include "integ/method/stage_table.h"

/* Curves of degree s with any quadrature of s nodes or more. */
void dm_galerkin_of(dm_galerkin *g, int s, const dm_quadrature *q);

/* Order of the Galerkin method of a basis without a tableau. */
int dm_galerkin_order(const dm_galerkin *g);

/* The kinetic energy of the velocities is regular under the quadrature. */
int dm_galerkin_is_regular(const dm_galerkin *g);

#endif
