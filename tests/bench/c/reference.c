/* reference.c - reference solutions: Gauss collocation of 10 stages (order 20), checked by
 * extrapolation of the explicit midpoint rule to order 20 (Gragg 1965; HNW I, II.9).
 *   reference KEY FILE          positions at 32 equally spaced times
 *   reference KEY FILE check    the same, and the difference of the two methods in the header */
#include "reference.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { S = 10, LEVELS = 10 };
static real A[S][S], B[S], C[S]; /* stages: integrals of the Lagrange polynomials */
static real A2[S][S], B2[S];     /* A^2, b A: for q'' = a */
static real AHEAD[S][S];         /* value at 1 + c_i of the polynomial through the stages */

static real absolute(real x) {
    return x < 0 ? -x : x;
}

/* Legendre P_S on [-1, 1] and its slope */
static real legendre(real *slope, real x) {
    real p0 = 1, p1 = x;
    for (int k = 2; k <= S; k++) {
        const real p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1, p1 = p2;
    }
    *slope = S * (x * p1 - p0) / (x * x - 1);
    return p1;
}

static real lagrange(int j, real x) {
    real y = 1;
    for (int k = 0; k < S; k++)
        if (k != j) y *= (x - C[k]) / (C[j] - C[k]);
    return y;
}

static void make_tables(void) {
    real w[S], slope;
    for (int i = 0; i < S; i++) {
        real x = -FN(cos)(REAL(3.141592653589793) * (i + REAL(0.75)) / (S + REAL(0.5)));
        for (int k = 0; k < 60; k++) x -= legendre(&slope, x) / slope;
        legendre(&slope, x);
        C[i] = (1 + x) / 2;
        w[i] = 1 / ((1 - x * x) * slope * slope);
    }
    /* the S-point rule itself integrates polynomials of degree S - 1 over [0, x] */
    for (int j = 0; j < S; j++) {
        B[j] = 0;
        for (int k = 0; k < S; k++) B[j] += w[k] * lagrange(j, C[k]);
        for (int i = 0; i < S; i++) {
            A[i][j] = 0;
            for (int k = 0; k < S; k++) A[i][j] += C[i] * w[k] * lagrange(j, C[i] * C[k]);
            AHEAD[i][j] = lagrange(j, 1 + C[i]);
        }
    }
    for (int j = 0; j < S; j++) {
        B2[j] = B[j] * (1 - C[j]);
        for (int i = 0; i < S; i++) {
            A2[i][j] = 0;
            for (int k = 0; k < S; k++) A2[i][j] += A[i][k] * A[k][j];
        }
    }
}

static real F[S][LARGEST], Q[LARGEST], V[LARGEST];

/* one fixed-point sweep over the stages; returns the largest relative change */
static real sweep(const real *q, const real *v, real h) {
    const reference_problem *p = reference_now;
    static real G[S][LARGEST];
    real change = 0, size = REAL(1e-30);
    for (int i = 0; i < S; i++) {
        for (int k = 0; k < p->n; k++) {
            real x = 0, y = 0;
            for (int j = 0; j < S; j++) x += A2[i][j] * F[j][k], y += A[i][j] * F[j][k];
            Q[k] = q[k] + h * (C[i] * v[k] + h * x);
            V[k] = v[k] + h * y;
        }
        p->force(G[i], Q, V);
    }
    for (int i = 0; i < S; i++)
        for (int k = 0; k < p->n; k++) {
            const real d = absolute(G[i][k] - F[i][k]), m = absolute(G[i][k]);
            if (d > change) change = d;
            if (m > size) size = m;
            F[i][k] = G[i][k];
        }
    return change / size;
}

static void ahead(int n) {
    for (int k = 0; k < n; k++) {
        real y[S];
        for (int i = 0; i < S; i++) {
            y[i] = 0;
            for (int j = 0; j < S; j++) y[i] += AHEAD[i][j] * F[j][k];
        }
        for (int i = 0; i < S; i++) F[i][k] = y[i];
    }
}

/* sweeps until round-off stops the change from shrinking */
static void gauss(real *q, real *v, real h, int steps) {
    const int n = reference_now->n;
    for (int step = 0; step < steps; step++) {
        ahead(n);
        real before = 1, change = 1;
        for (int k = 0; k < 100 && change > 0; k++) {
            change = sweep(q, v, h);
            if (k > 2 && change >= before && change < REAL(1e-15)) break;
            before = change;
        }
        for (int k = 0; k < n; k++) {
            real dq = 0, dv = 0;
            for (int j = 0; j < S; j++) dq += B2[j] * F[j][k], dv += B[j] * F[j][k];
            q[k] += h * (v[k] + h * dq);
            v[k] += h * dv;
        }
    }
}

/* explicit midpoint rule on y = (q, v), m substeps over h, with Gragg's smoothing left out */
static void midpoint(real *y, const real *y0, real h, int m) {
    const int n = reference_now->n;
    static real last[2 * LARGEST], f[2 * LARGEST];
    const real d = h / m;
    memcpy(last, y0, 2 * (size_t)n * sizeof *last);
    memcpy(y, y0, 2 * (size_t)n * sizeof *y);
    for (int step = 0; step < m; step++) {
        memcpy(f, y + n, (size_t)n * sizeof *f);
        reference_now->force(f + n, y, y + n);
        for (int k = 0; k < 2 * n; k++) {
            const real next = (step ? last[k] + 2 * d * f[k] : y[k] + d * f[k]);
            last[k] = y[k], y[k] = next;
        }
    }
}

/* Aitken-Neville in h^2, substeps 2, 4, ..., 2 LEVELS */
static void extrapolate(real *q, real *v, real h, int steps) {
    const int n = reference_now->n;
    static real table[LEVELS][2 * LARGEST], y[2 * LARGEST];
    memcpy(y, q, (size_t)n * sizeof *y);
    memcpy(y + n, v, (size_t)n * sizeof *y);
    for (int step = 0; step < steps; step++) {
        for (int j = 0; j < LEVELS; j++) {
            midpoint(table[j], y, h, 2 * (j + 1));
            for (int i = j - 1; i >= 0; i--) {
                const real ratio = (real)(j + 1) / (i + 1), w = 1 / (ratio * ratio - 1);
                for (int k = 0; k < 2 * n; k++)
                    table[i][k] = table[i + 1][k] + w * (table[i + 1][k] - table[i][k]);
            }
        }
        memcpy(y, table[0], 2 * (size_t)n * sizeof *y);
    }
    memcpy(q, y, (size_t)n * sizeof *y);
    memcpy(v, y + n, (size_t)n * sizeof *y);
}

static real POSITIONS[OUTPUTS][LARGEST];

static void solve(void (*advance)(real *, real *, real, int), int steps) {
    const reference_problem *p = reference_now;
    static real q[LARGEST], v[LARGEST];
    p->start(q, v);
    memset(F, 0, sizeof F);
    for (int i = 0; i < OUTPUTS; i++) {
        advance(q, v, p->T / OUTPUTS / steps, steps);
        if (p->position)
            p->position(POSITIONS[i], q);
        else
            memcpy(POSITIONS[i], q, (size_t)p->n * sizeof *q);
    }
}

/* the exact solution of P1 at pericentre start, from Kepler's equation E - e sin E = t */
static real kepler_difference(void) {
    const real e = (real)(int)(reference_now->parameter * 10 + 0.5) / 10;
    real worst = 0;
    for (int i = 0; i < OUTPUTS; i++) {
        const real t = reference_now->T / OUTPUTS * (i + 1);
        real E = t;
        for (int k = 0; k < 200; k++)
            E -= (E - e * FN(sin)(E) - t) / (1 - e * FN(cos)(E)) / (k < 40 ? 2 : 1);
        const real dx = absolute(POSITIONS[i][0] - (FN(cos)(E) - e));
        const real dy = absolute(POSITIONS[i][1] - FN(sqrt)(1 - e * e) * FN(sin)(E));
        if (dx > worst) worst = dx;
        if (dy > worst) worst = dy;
    }
    return worst;
}

static real difference(real (*keep)[LARGEST]) {
    real worst = 0;
    for (int i = 0; i < OUTPUTS; i++)
        for (int k = 0; k < reference_now->n; k++) {
            const real d = absolute(POSITIONS[i][k] - keep[i][k]);
            if (d > worst) worst = d;
        }
    return worst;
}

/* long chains: only every 64th particle goes into the file that is kept */
static void write_file(FILE *file, int stride, int digits) {
    char text[64];
    for (int i = 0; i < OUTPUTS; i++)
        for (int k = 0; k < reference_now->n; k += stride) {
            PRINT_REAL(text, sizeof text, digits, POSITIONS[i][k]);
            fprintf(file, "%s%c", text, k + stride < reference_now->n ? ' ' : '\n');
        }
}

static void write_check(FILE *file) {
    char text[64];
    static real keep[OUTPUTS][LARGEST];
    if (strncmp(reference_now->key, "P1", 2) == 0) {
        PRINT_REAL(text, sizeof text, 1, kepler_difference());
        fprintf(file, "# largest difference from the solution of Kepler's equation: %s\n", text);
        return;
    }
    memcpy(keep, POSITIONS, sizeof keep);
    solve(extrapolate, reference_now->steps * 2);
    PRINT_REAL(text, sizeof text, 1, difference(keep));
    fprintf(file, "# largest difference from extrapolation of order 20: %s\n", text);
    memcpy(POSITIONS, keep, sizeof keep);
}

int main(int argc, char **argv) {
    if (argc < 3) {
        fprintf(stderr, "usage: reference KEY FILE [check]\n");
        return 2;
    }
    const reference_problem *p = reference_problems;
    while (p->key && strcmp(p->key, argv[1]) != 0) p++;
    FILE *file = p->key ? fopen(argv[2], "w") : NULL;
    if (!file) {
        fprintf(stderr, "reference: no problem '%s', or '%s' cannot be written\n", argv[1],
                argv[2]);
        return 1;
    }
    const int kept = argc > 3;
    reference_now = p;
    make_tables();
    solve(gauss, p->steps);
    fprintf(file, "# positions of %s at t = T/32, 2T/32, ..., T, one line each\n", p->key);
    if (kept) {
        fprintf(file, "# made by: tests/bench/run --reference (Gauss, 10 stages, quad "
                      "precision)\n");
        write_check(file);
    }
    write_file(file, kept && p->n > 64 ? 64 : 1, kept ? 27 : 20);
    return fclose(file) == 0 ? 0 : 1;
}
