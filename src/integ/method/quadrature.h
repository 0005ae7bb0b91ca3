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

/* r >= 1 nodes with the end 1, exact to degree 2r - 2: zeros of P_r - P_(r-1) on [-1, 1]. */
void dm_quadrature_radau(dm_quadrature *out, int r);

/* The mirror image, with the end 0. */
void dm_quadrature_radau_left(dm_quadrature *out, int r);

/* r >= 2 nodes (1 - cos(i pi / (r - 1)))/2, exact to degree r - 1, for odd r to degree r. */
void dm_quadrature_clenshaw_curtis(dm_quadrature *out, int r);

/* Weights that are exact to degree r - 1 for the distinct nodes that *q has. */
void dm_quadrature_interpolate(dm_quadrature *q);

/* Largest degree whose polynomials the quadrature integrates to `tolerance`; -1: not even
 * constants. */
int dm_quadrature_degree(const dm_quadrature *q, double tolerance);

/* Quadratures by name, as in galerkin(3, radau(3)). */
typedef struct {
    const char *name; /* NULL ends the list */
    int least;        /* nodes */
    void (*fill)(dm_quadrature *out, int r);
} dm_quadrature_row;
extern const dm_quadrature_row dm_quadratures[];

/* NULL when there is none of that name. */
const dm_quadrature_row *dm_quadrature_find(const char *name);

/* value[s] = l_j(x) of the Lagrange polynomials of nodes c[s]. */
void dm_lagrange_value(long double *value, const long double *c, int s, long double x);

/* value[s] = l_j(x) and integral[s] = int_0^x l_j of the Lagrange polynomials of nodes c[s]. */
void dm_lagrange(long double *value, long double *integral, const long double *c, int s,
                 long double x);

#endif
