/* gauss.h - Gauss collocation of s = 2 ... 8 stages for q'' = a(q, q'), one stage per SIMD lane.
 * A fixed number k of fixed-point sweeps; the first starts from the polynomial of the last step. */
#ifndef BENCH_GAUSS_H
#define BENCH_GAUSS_H

#include "lanes.h"
#include "search.h"

/* column j of a matrix whose rows are the stages; unused lanes repeat the start of the step */
typedef struct {
    int s;
    v8 c, b, b2;            /* nodes, weights of v and (b A) of q */
    v8 A[8], A2[8];         /* A, A^2 */
    v8 ahead[8], ahead2[8]; /* A E, A^2 E with E = extrapolation by one step */
} gauss_table;

extern gauss_table bench_gauss[9]; /* by s */
void bench_make_gauss(void);

typedef void acceleration8(v8 *a, const v8 *q, const v8 *v);

/* base + sum over stages of columns times the forces of one coordinate */
INLINE v8 columns(v8 base, const v8 *M, const double *f, int s) {
    v8 even = base + M[0] * f[0], odd = M[1] * f[1];
    for (int j = 2; j < s; j += 2) even += M[j] * f[j];
    for (int j = 3; j < s; j += 2) odd += M[j] * f[j];
    return even + odd;
}

/* y += d, low = the round-off (Kahan 1965) */
INLINE void add_exactly(double *y, double *low, double d) {
    const double e = d + *low, sum = *y + e;
    *low = e + (*y - sum);
    *y = sum;
}

/* the tables of a step: V = v + M f, Q = q + c v + M2 f, with h inside */
typedef struct {
    v8 c, b, b2, A[8], A2[8], ahead[8], ahead2[8];
} gauss_step;

INLINE void scale(gauss_step *out, const gauss_table *t, double h, int s) {
    out->c = h * t->c, out->b = h * t->b, out->b2 = h * h * t->b2;
    for (int j = 0; j < s; j++) {
        out->A[j] = h * t->A[j], out->A2[j] = h * h * t->A2[j];
        out->ahead[j] = h * t->ahead[j], out->ahead2[j] = h * h * t->ahead2[j];
    }
}

/* stage positions (and velocities where the force needs them) from the forces f */
INLINE void stages(v8 *Q, v8 *V, const v8 *start, const double *v, const v8 *M, const v8 *M2,
                   const double (*f)[8], int s, int n, int needs_v) {
    for (int i = 0; i < n; i++) {
        Q[i] = columns(start[i], M2, f[i], s);
        if (needs_v) V[i] = columns(v[i] + (v8){0}, M, f[i], s);
    }
}

/* s and n are constants where this is called, so that everything unrolls */
INLINE void gauss(double *out, int s, int n, int needs_v, int sweeps, long steps, acceleration8 *a,
                  double *q, double *v, double T) {
    gauss_step t;
    const double h = T / BENCH_OUTPUTS / (double)steps;
    double f[n][8] __attribute__((aligned(64))), q_low[n], v_low[n];
    v8 Q[n], V[n], F[n], straight[n];
    scale(&t, &bench_gauss[s], h, s);
    for (int i = 0; i < n; i++) {
        q_low[i] = v_low[i] = 0.0;
        *(v8 *)f[i] = (v8){0};
    }
    int count = sweeps + 8; /* the first step has nothing to start from */
    for (int row = 0; row < BENCH_OUTPUTS; row++) {
        for (long step = 0; step < steps; step++) {
            for (int i = 0; i < n; i++) straight[i] = q[i] + v[i] * t.c;
            stages(Q, V, straight, v, t.ahead, t.ahead2, f, s, n, needs_v);
            for (int k = 1; k <= count; k++) {
                a(F, Q, V);
                for (int i = 0; i < n; i++) *(v8 *)f[i] = F[i];
                __asm__ volatile("" : "+m"(f)); /* lanes are read back from memory, as broadcasts */
                if (k < count) stages(Q, V, straight, v, t.A, t.A2, f, s, n, needs_v);
            }
            count = sweeps;
            for (int i = 0; i < n; i++) {
                add_exactly(q + i, q_low + i, h * v[i] + sum8(t.b2 * F[i]));
                add_exactly(v + i, v_low + i, sum8(t.b * F[i]));
            }
        }
        for (int i = 0; i < n; i++) out[row * n + i] = q[i];
    }
}

/* the loop for each s that the methods of a problem use; n and the force are constants */
#define GAUSS_CASES(out, m, n, needs_v, steps, a, q, v, T)                                         \
    switch (((const gauss_table *)(m)->table)->s) {                                                \
    case 2:                                                                                        \
        gauss(out, 2, n, needs_v, (m)->k, steps, a, q, v, T);                                      \
        break;                                                                                     \
    case 3:                                                                                        \
        gauss(out, 3, n, needs_v, (m)->k, steps, a, q, v, T);                                      \
        break;                                                                                     \
    case 4:                                                                                        \
        gauss(out, 4, n, needs_v, (m)->k, steps, a, q, v, T);                                      \
        break;                                                                                     \
    case 5:                                                                                        \
        gauss(out, 5, n, needs_v, (m)->k, steps, a, q, v, T);                                      \
        break;                                                                                     \
    case 6:                                                                                        \
        gauss(out, 6, n, needs_v, (m)->k, steps, a, q, v, T);                                      \
        break;                                                                                     \
    case 7:                                                                                        \
        gauss(out, 7, n, needs_v, (m)->k, steps, a, q, v, T);                                      \
        break;                                                                                     \
    default:                                                                                       \
        gauss(out, 8, n, needs_v, (m)->k, steps, a, q, v, T);                                      \
        break;                                                                                     \
    }

/* rows for a problem: gauss(s) with k sweeps */
#define GAUSS_ROW(run, s, k)                                                                       \
    { "gauss(" #s ") x" #k, run, &bench_gauss[s], k }
#define GAUSS_METHODS(run)                                                                         \
    GAUSS_ROW(run, 8, 6), GAUSS_ROW(run, 8, 4), GAUSS_ROW(run, 8, 5), GAUSS_ROW(run, 8, 8),        \
        GAUSS_ROW(run, 8, 3), GAUSS_ROW(run, 8, 2), GAUSS_ROW(run, 8, 1), GAUSS_ROW(run, 7, 6),    \
        GAUSS_ROW(run, 7, 4), GAUSS_ROW(run, 7, 5), GAUSS_ROW(run, 7, 3), GAUSS_ROW(run, 7, 2),    \
        GAUSS_ROW(run, 6, 6), GAUSS_ROW(run, 6, 4), GAUSS_ROW(run, 6, 3), GAUSS_ROW(run, 6, 2),    \
        GAUSS_ROW(run, 6, 1), GAUSS_ROW(run, 4, 6), GAUSS_ROW(run, 4, 4), GAUSS_ROW(run, 4, 3),    \
        GAUSS_ROW(run, 4, 2), GAUSS_ROW(run, 3, 4), GAUSS_ROW(run, 3, 3), GAUSS_ROW(run, 3, 2)

#endif
