#include "integ/method/quadrature.h"

#include <math.h>
#include <string.h>

static const long double PI = 3.14159265358979323846264338327950288L;
enum { STEPS = 100 }; /* Newton needs less than 10 */

/* P_k(x) and P_(k-1)(x) by the three-term recurrence */
static void legendre(long double *p, long double *before, int k, long double x) {
    long double a = 1.0L, b = 0.0L;
    for (int j = 1; j <= k; j++) {
        const long double next = ((2 * j - 1) * x * a - (j - 1) * b) / j;
        b = a;
        a = next;
    }
    *p = a;
    *before = b;
}

/* P'_k(x) for |x| < 1: (1 - x^2) P'_k = k (P_(k-1) - x P_k) */
static long double slope(int k, long double x) {
    long double p, before;
    legendre(&p, &before, k, x);
    return k * (before - x * p) / ((1.0L - x) * (1.0L + x));
}

/* P_r at x over its slope there */
static long double ratio(int r, long double x) {
    long double p, before;
    legendre(&p, &before, r, x);
    return p * ((1.0L - x) * (1.0L + x)) / (r * (before - x * p));
}

/* Newton's method; below 1e-11 the next increment would be round-off (its error is the square,
 * times r^2) */
static long double gauss_node(int r, long double x) {
    for (int step = 0; step < STEPS; step++) {
        const long double dx = ratio(r, x);
        x -= dx;
        if (fabsl(dx) < 1e-11L) break;
    }
    return x;
}

/* zero of P'_k; Legendre's equation: (1 - x^2) P'' = 2 x P' - k (k + 1) P */
static long double lobatto_node(int k, long double x) {
    for (int step = 0; step < STEPS; step++) {
        long double p, before;
        legendre(&p, &before, k, x);
        const long double first = slope(k, x);
        const long double second = (2.0L * x * first - k * (k + 1) * p) / ((1.0L - x) * (1.0L + x));
        x -= first / second;
        if (fabsl(first / second) < 1e-19L) break;
    }
    return x;
}

/* node i of [-1, 1] with weight w, and its mirror image, moved to [0, 1] */
static void set_pair(dm_quadrature *q, int i, long double x, long double w) {
    const int mirror = q->r - 1 - i;
    q->c[i] = 0.5L * (1.0L - x);
    q->c[mirror] = i == mirror ? 0.5L : 0.5L * (1.0L + x);
    q->b[i] = q->b[mirror] = 0.5L * w;
}

/* Weights 2 / ((1 - x^2) P'_r(x)^2) on [-1, 1]. */
void dm_quadrature_gauss(dm_quadrature *out, int r) {
    out->r = r;
    for (int i = 0; i < (r + 1) / 2; i++) { /* from the largest zero down */
        const long double guess = cosl(PI * (i + 0.75L) / (r + 0.5L));
        const long double x = 2 * i + 1 == r ? 0.0L : gauss_node(r, guess);
        const long double d = slope(r, x);
        set_pair(out, i, x, 2.0L / ((1.0L - x) * (1.0L + x) * d * d));
    }
}

/* Weights 2 / (r (r - 1) P_(r-1)(x)^2), the ends too. */
void dm_quadrature_lobatto(dm_quadrature *out, int r) {
    out->r = r;
    for (int i = 0; i < (r + 1) / 2; i++) {
        long double p, before, x = i ? lobatto_node(r - 1, cosl(PI * i / (r - 1))) : 1.0L;
        if (2 * i + 1 == r) x = 0.0L;
        legendre(&p, &before, r - 1, x);
        set_pair(out, i, x, 2.0L / (r * (r - 1) * p * p));
    }
}

/* zero of P_r + P_(r-1) other than -1 */
static long double radau_node(int r, long double x) {
    for (int step = 0; step < STEPS; step++) {
        long double p, before;
        legendre(&p, &before, r, x);
        const long double dx = (p + before) / (slope(r, x) + slope(r - 1, x));
        x -= dx;
        if (fabsl(dx) < 1e-19L) break;
    }
    return x;
}

/* from the end -1; near the zeros are those of the Chebyshev polynomials: -cos(2 pi i / (2 r -
 * 1)) */
void dm_quadrature_radau_left(dm_quadrature *out, int r) {
    out->r = r;
    out->c[0] = 0.0L;
    out->b[0] = 1.0L / ((long double)r * r);
    for (int i = 1; i < r; i++) {
        long double p, before;
        const long double x = radau_node(r, -cosl(2.0L * PI * i / (2 * r - 1)));
        legendre(&p, &before, r - 1, x);
        out->c[i] = 0.5L * (1.0L + x);
        out->b[i] = 0.5L * (1.0L - x) / ((long double)r * r * p * p);
    }
}

/* The mirror image of the other one. */
void dm_quadrature_radau(dm_quadrature *out, int r) {
    dm_quadrature left;
    dm_quadrature_radau_left(&left, r);
    out->r = r;
    for (int i = 0; i < r; i++) {
        out->c[i] = 1.0L - left.c[r - 1 - i];
        out->b[i] = left.b[r - 1 - i];
    }
}

/* Clenshaw and Curtis 1960: the integral of the cosine series of the interpolant */
void dm_quadrature_clenshaw_curtis(dm_quadrature *out, int r) {
    const int n = r - 1;
    out->r = r;
    for (int i = 0; i < r; i++) {
        const long double x = i < r - 1 - i ? cosl(PI * i / n) : -cosl(PI * (n - i) / n);
        long double w = 1.0L;
        for (int j = 1; 2 * j <= n; j++)
            w -= (2 * j == n ? 1.0L : 2.0L) * cosl(2.0L * PI * ((i * j) % n) / n) / (4 * j * j - 1);
        out->c[i] = 2 * i == n ? 0.5L : 0.5L * (1.0L - x);
        out->b[i] = (i == 0 || i == n ? 0.5L : 1.0L) * w / n;
    }
}

const dm_quadrature_row dm_quadratures[] = {{"gauss", 1, dm_quadrature_gauss},
                                            {"lobatto", 2, dm_quadrature_lobatto},
                                            {"radau", 1, dm_quadrature_radau},
                                            {"radau-left", 1, dm_quadrature_radau_left},
                                            {"clenshaw-curtis", 2, dm_quadrature_clenshaw_curtis},
                                            {NULL, 0, NULL}};

/* By the name that a rule gives it. */
const dm_quadrature_row *dm_quadrature_find(const char *name) {
    for (const dm_quadrature_row *row = dm_quadratures; row->name; row++)
        if (strcmp(row->name, name) == 0) return row;
    return NULL;
}

/* by Legendre polynomials, whose integrals are zero: powers of large degree could not be told
 * apart */
int dm_quadrature_degree(const dm_quadrature *q, double tolerance) {
    for (int k = 0; k < 2 * q->r; k++) {
        long double sum = k ? 0.0L : -1.0L;
        for (int i = 0; i < q->r; i++) {
            long double p, before;
            legendre(&p, &before, k, 2.0L * q->c[i] - 1.0L);
            sum += q->b[i] * p;
        }
        if (!(fabsl(sum) <= (long double)tolerance)) return k - 1;
    }
    return 2 * q->r - 1;
}

/* l_j(x) of the nodes c[s]. */
static long double basis(const long double *c, int s, int j, long double x) {
    long double l = 1.0L;
    for (int k = 0; k < s; k++)
        if (k != j) l *= (x - c[k]) / (c[j] - c[k]);
    return l;
}

/* All of them at x. */
void dm_lagrange_value(long double *value, const long double *c, int s, long double x) {
    for (int j = 0; j < s; j++) value[j] = basis(c, s, j, x);
}

/* The integrals by Gauss nodes, exactly: no coefficients of powers, which lose digits. */
void dm_lagrange(long double *value, long double *integral, const long double *c, int s,
                 long double x) {
    dm_quadrature g;
    dm_quadrature_gauss(&g, (s + 1) / 2); /* exact to degree s - 1 */
    for (int j = 0; j < s; j++) {
        value[j] = basis(c, s, j, x);
        integral[j] = 0.0L;
        for (int i = 0; i < g.r; i++) integral[j] += x * g.b[i] * basis(c, s, j, x * g.c[i]);
    }
}

/* The weights are integrals of the Lagrange polynomials over [0, 1]. */
void dm_quadrature_interpolate(dm_quadrature *q) {
    long double value[DM_QUADRATURE_NODES];
    dm_lagrange(value, q->b, q->c, q->r, 1.0L);
}
