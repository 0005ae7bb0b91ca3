/* filon.h - quadratures of products with a fast oscillation whose frequency is known (Filon 1928;
 * Leok 5.7.2), and of functions of a slow time and a fast phase. */
#ifndef DM_FILON_H
#define DM_FILON_H

#include "integ/method/quadrature.h"

enum { DM_FILON_NODES = 8 };

/* b_i(z) = int_0^1 l_i(x) exp(i z x) dx, l_i the Lagrange polynomials of the nodes of *q, r <= 8:
 * int_0^h F(t) exp(i w t) dt ~ h sum_i b_i(w h) F(c_i h), exact below degree r. z = 0: the weights
 * of the interpolatory rule. */
void dm_filon_weights(double *re, double *im, const dm_quadrature *q, double z);

/* weight[r*phases] of F(c_i h, 2 pi m/phases) for int_0^h F(t, w t) dt, F a trigonometric
 * polynomial of degree (phases - 1)/2 in the phase, a polynomial below degree r in t; `phases` odd
 * (Leok 5.7.2, each harmonic by its own weights). */
void dm_filon_two_scales(double *weight, const dm_quadrature *q, int phases, double w, double h);

#endif
