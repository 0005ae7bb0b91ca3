#include "gauss.h"

gauss_table bench_gauss[9];

/* Legendre polynomial of degree s and its slope */
static long double legendre(long double *slope, int s, long double x) {
    long double p0 = 1, p1 = x;
    for (int k = 2; k <= s; k++) {
        const long double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1, p1 = p2;
    }
    *slope = s * (x * p1 - p0) / (x * x - 1);
    return p1;
}

static void nodes(long double *c, long double *w, int s) {
    long double slope;
    for (int i = 0; i < s; i++) {
        long double x = -cosl(3.141592653589793L * (i + 0.75L) / (s + 0.5L));
        for (int k = 0; k < 20; k++) x -= legendre(&slope, s, x) / slope;
        legendre(&slope, s, x);
        c[i] = (1 + x) / 2;
        w[i] = 1 / ((1 - x * x) * slope * slope);
    }
}

static long double lagrange(const long double *c, int s, int j, long double x) {
    long double y = 1;
    for (int k = 0; k < s; k++)
        if (k != j) y *= (x - c[k]) / (c[j] - c[k]);
    return y;
}

static void multiply(long double out[8][8], long double A[8][8], long double B[8][8], int s) {
    for (int i = 0; i < s; i++)
        for (int j = 0; j < s; j++) {
            out[i][j] = 0;
            for (int k = 0; k < s; k++) out[i][j] += A[i][k] * B[k][j];
        }
}

static void columns_of(v8 *out, long double M[8][8], int s) {
    for (int j = 0; j < 8; j++)
        for (int i = 0; i < 8; i++) out[j][i] = i < s && j < s ? (double)M[i][j] : 0.0;
}

static void make(gauss_table *t, int s) {
    long double c[8], w[8], A[8][8], E[8][8], A2[8][8], M[8][8];
    nodes(c, w, s);
    for (int i = 0; i < s; i++)
        for (int j = 0; j < s; j++) {
            A[i][j] = 0; /* the rule itself integrates lagrange_j over [0, c_i] exactly */
            for (int k = 0; k < s; k++) A[i][j] += c[i] * w[k] * lagrange(c, s, j, c[i] * c[k]);
            E[i][j] = lagrange(c, s, j, 1 + c[i]);
        }
    *t = (gauss_table){.s = s};
    for (int i = 0; i < s; i++) {
        t->c[i] = (double)c[i];
        t->b[i] = (double)w[i];
        t->b2[i] = (double)(w[i] * (1 - c[i]));
    }
    columns_of(t->A, A, s);
    multiply(A2, A, A, s);
    columns_of(t->A2, A2, s);
    multiply(M, A, E, s);
    columns_of(t->ahead, M, s);
    multiply(M, A2, E, s);
    columns_of(t->ahead2, M, s);
}

void bench_make_gauss(void) {
    for (int s = 1; s <= 8; s++) make(&bench_gauss[s], s);
}
