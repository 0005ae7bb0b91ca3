/* quadrature.h - nodes in [0, 1] and weights, and integrals of Lagrange polynomials. */
#ifndef DM_QUADRATURE_H
#define DM_QUADRATURE_H

enum { DM_QUADRATURE_NODES = 32 };

typedef struct {
    int r;
    long double c[DM_QUADRATURE_NODES]; /* nodes, rising */
    long double b[DM_QUADRATURE_NODES]; /* weights, sum 1 */
} dm_quadrature;

/* r >= 1 nodes, exact to degree 2r - 1: zeros of the Legendre polynomial P_r. */
void dm_quadrature_gauss(dm_quadrature *out, int r);

/* r >= 2 nodes with both ends, exact to degree 2r - 3: ends and zeros of P'_(r-1). */
void dm_quadrature_lobatto(dm_quadrature *out, int r);

/* value[s] = l_j(x) of the Lagrange polynomials of nodes c[s]. */
void dm_lagrange_value(long double *value, const long double *c, int s, long double x);

/* value[s] = l_j(x) and integral[s] = int_0^x l_j of the Lagrange polynomials of nodes c[s]. */
void dm_lagrange(long double *value, long double *integral, const long double *c, int s,
                 long double x);

#endif
