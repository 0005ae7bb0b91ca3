#include "integ/multiscale/filon.h"

#include <math.h>
#include <string.h>

/* All integrals are found in long double, then rounded once. */
static const long double PI = 3.14159265358979323846264338327950288L;

typedef struct {
    long double re, im;
} number;

/* int_0^1 x^j exp(i z x) dx = sum_k (i z)^k / (k! (j + k + 1)) */
static number series(int j, long double z) {
    number sum = {0.0L, 0.0L}, power = {1.0L, 0.0L}; /* (i z)^k / k! */
    for (int k = 1; fabsl(power.re) + fabsl(power.im) > 1e-30L; k++) {
        sum.re += power.re / (j + k), sum.im += power.im / (j + k);
        power = (number){-power.im * z / k, power.re * z / k};
    }
    return sum;
}

/* Moments mu_j, j < r: by the series, or by parts, i z mu_j = exp(i z) - j mu_(j-1), which loses
 * nothing while j < |z|. */
static void moments(number *mu, int r, long double z) {
    const long double c = cosl(z), s = sinl(z);
    const int far = fabsl(z) >= (r > 6 ? r : 6);
    for (int j = 0; j < r; j++) {
        const number last = j ? mu[j - 1] : (number){1.0L, 0.0L};
        const long double factor = j ? j : 1.0L;
        mu[j] =
            far ? (number){(s - factor * last.im) / z, -(c - factor * last.re) / z} : series(j, z);
    }
}

/* a[j] of l_i(x) = sum_j a_j x^j */
static void coefficients(long double *a, const dm_quadrature *q, int i) {
    memset(a, 0, DM_FILON_NODES * sizeof *a);
    a[0] = 1.0L;
    for (int k = 0, degree = 0; k < q->r; k++) {
        if (k == i) continue;
        const long double d = q->c[i] - q->c[k];
        degree++;
        for (int j = degree; j >= 0; j--)
            a[j] = ((j ? a[j - 1] : 0.0L) - q->c[k] * (j < degree ? a[j] : 0.0L)) / d;
    }
}

/* From the moments by the coefficients of the Lagrange polynomials: in long double, whose digits
 * the powers of 8 nodes do not use up. */
void dm_filon_weights(double *re, double *im, const dm_quadrature *q, double z) {
    number mu[DM_FILON_NODES];
    long double a[DM_FILON_NODES];
    moments(mu, q->r, z);
    for (int i = 0; i < q->r; i++) {
        number sum = {0.0L, 0.0L};
        coefficients(a, q, i);
        for (int j = 0; j < q->r; j++) sum.re += a[j] * mu[j].re, sum.im += a[j] * mu[j].im;
        re[i] = (double)sum.re, im[i] = (double)sum.im;
    }
}

/* (h/M) sum_n Re[b_i(n w h) exp(-i n phi_m)], n from -(M-1)/2 to (M-1)/2, since the n-th harmonic
 * of F is sum_m F(., phi_m) exp(-i n phi_m)/M; b_i(-z) is the conjugate of b_i(z), so that n and -n
 * make twice the real part. */
void dm_filon_two_scales(double *weight, const dm_quadrature *q, int phases, double w, double h) {
    double re[DM_FILON_NODES], im[DM_FILON_NODES];
    memset(weight, 0, (size_t)q->r * (size_t)phases * sizeof *weight);
    for (int n = 0; n <= (phases - 1) / 2; n++) {
        dm_filon_weights(re, im, q, n * w * h);
        for (int i = 0; i < q->r; i++)
            for (int m = 0; m < phases; m++) {
                const long double phi = 2.0L * PI * ((long)n * m % phases) / phases;
                weight[i * phases + m] += (n ? 2.0 : 1.0) * h / phases *
                                          (re[i] * (double)cosl(phi) + im[i] * (double)sinl(phi));
            }
    }
}
