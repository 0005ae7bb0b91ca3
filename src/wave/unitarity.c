/* unitarity.c - polynomials psi = sum z_k l_k of degree s with z_0 = psi_0 given, and the equations
 *   i/2 sum_j b_j (l_i(c_j) psi'_j - l_i'(c_j) psi_j) - theta sum_j b_j l_i(c_j) psi_j
 *     = i/2 z_0 delta_i0,  i = 0 .. s - 1,
 * those of the action by the quadrature b, c, in units of hbar and h. */
#include "wave/unitarity.h"

#include "linalg/lu.h"

#include <float.h>
#include <math.h>

enum { MOST = DM_QUADRATURE_NODES };

/* Values and slopes of the l_k at the points of the quadrature; control points are k/s. */
typedef struct {
    int s, r;
    long double b[MOST], value[MOST][MOST + 1], slope[MOST][MOST + 1];
} space;

/* l_k'(x) as a sum of products */
static long double slope_at(const long double *node, int s, int k, long double x) {
    long double sum = 0.0L;
    for (int m = 0; m <= s; m++) {
        long double product = 1.0L;
        if (m == k) continue;
        for (int l = 0; l <= s; l++)
            if (l != k && l != m) product *= (x - node[l]) / (node[k] - node[l]);
        sum += product / (node[k] - node[m]);
    }
    return sum;
}

/* l_k(x) */
static long double value_at(const long double *node, int s, int k, long double x) {
    long double product = 1.0L;
    for (int l = 0; l <= s; l++)
        if (l != k) product *= (x - node[l]) / (node[k] - node[l]);
    return product;
}

/* Control points do not matter to the step: equal distances will do. */
static void fill(space *out, const dm_galerkin *g) {
    long double node[MOST + 1];
    out->s = g->s, out->r = g->q.r;
    for (int k = 0; k <= g->s; k++) node[k] = (long double)k / g->s;
    for (int j = 0; j < g->q.r; j++) {
        out->b[j] = g->q.b[j];
        for (int k = 0; k <= g->s; k++) {
            out->value[j][k] = value_at(node, g->s, k, g->q.c[j]);
            out->slope[j][k] = slope_at(node, g->s, k, g->q.c[j]);
        }
    }
}

/* the coefficient of z_k in equation i: imaginary and real part */
static void entry(double *im, double *re, const space *p, int i, int k, double theta) {
    long double turn = 0.0L, mass = 0.0L;
    for (int j = 0; j < p->r; j++) {
        turn += p->b[j] * (p->value[j][i] * p->slope[j][k] - p->slope[j][i] * p->value[j][k]);
        mass += p->b[j] * p->value[j][i] * p->value[j][k];
    }
    *im = (double)(0.5L * turn);
    *re = (double)(-theta * mass);
}

double dm_wave_growth(const dm_galerkin *g, double theta) {
    double A[4 * MOST * MOST], x[2 * MOST];
    uint32_t pivot[2 * MOST];
    space p;
    if (g->s < 1 || g->tableau) return NAN;
    fill(&p, g);
    const size_t s = (size_t)p.s, size = 2 * s;
    for (size_t i = 0; i < s; i++) {
        double im, re;
        for (size_t k = 0; k < s; k++) {
            entry(&im, &re, &p, (int)i, (int)k + 1, theta);
            A[i * size + k] = re, A[i * size + s + k] = -im;
            A[(s + i) * size + k] = im, A[(s + i) * size + s + k] = re;
        }
        entry(&im, &re, &p, (int)i, 0, theta);
        x[i] = -re, x[s + i] = (i == 0 ? 0.5 : 0.0) - im;
    }
    /* 2 s real equations for s complex unknowns: Re and Im of each in two blocks */
    if (dm_lu_factor(A, pivot, (uint32_t)size) != DM_OK) return NAN;
    dm_lu_solve(x, A, pivot, (uint32_t)size);
    return hypot(x[s - 1], x[size - 1]);
}

int dm_is_gauss(const dm_galerkin *g) {
    return g->s >= 1 && !g->tableau && g->q.r == g->s &&
           dm_quadrature_degree(&g->q, 1e-12) >= 2 * g->s - 1;
}
