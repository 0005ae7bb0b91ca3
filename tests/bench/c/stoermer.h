/* stoermer.h - extrapolated Stoermer rule for q'' = a(q) (Gragg-Bulirsch-Stoer; HNW I, II.14):
 * leapfrogs of 1, 2, ..., L substeps over a step, combined to order 2 L. The L leapfrogs are
 * independent: each is a SIMD lane, and stops when its substeps are done. */
#ifndef BENCH_STOERMER_H
#define BENCH_STOERMER_H

#include "gauss.h"

/* weights of Aitken-Neville in h^2 with n_j = j: w_j = prod_(i != j) j^2 / (j^2 - i^2) */
INLINE void neville(v8 *w, v8 *share, int levels) {
    for (int j = 1; j <= 8; j++) {
        double x = j <= levels ? 1.0 : 0.0;
        for (int i = 1; i <= levels; i++)
            if (i != j) x *= (double)(j * j) / (double)(j * j - i * i);
        (*w)[j - 1] = x;
        (*share)[j - 1] = j <= levels ? 1.0 / j : 0.0;
    }
}

/* increments of q and v over h, summed over lanes */
INLINE void stoermer_step(double *dq, double *dv, const double *q, const double *v, v8 h, v8 w,
                          int levels, int n, acceleration8 *a) {
    v8 Q[n], U[n], F[n], D[n]; /* U = velocity at the half substep, D = q - q0 */
    for (int i = 0; i < n; i++) Q[i] = q[i] + (v8){0};
    a(F, Q, U);
    for (int i = 0; i < n; i++) {
        U[i] = v[i] + 0.5 * h * F[i];
        D[i] = (v8){0};
    }
    v8 hs = h;
#pragma GCC unroll 8
    for (int k = 1; k <= levels; k++) {
        for (int i = 0; i < n; i++) {
            D[i] += hs * U[i];
            Q[i] = q[i] + D[i];
        }
        a(F, Q, U);
        for (int j = 0; j < 8; j++)
            if (j < k) hs[j] = 0.0; /* lane j has done its j + 1 substeps ... */
        for (int i = 0; i < n; i++) {
            v8 kick = hs;
            kick[k - 1] = 0.5 * h[k - 1]; /* ... the last with half a kick */
            U[i] += kick * F[i];
        }
    }
    for (int i = 0; i < n; i++) {
        dq[i] = sum8(w * D[i]);
        dv[i] = sum8(w * (U[i] - v[i]));
    }
}

INLINE void stoermer(double *out, int levels, int n, long steps, acceleration8 *a, double *q,
                     double *v, double T) {
    v8 w, share;
    neville(&w, &share, levels);
    const v8 h = T / BENCH_OUTPUTS / (double)steps * share;
    double q_low[n], v_low[n], dq[n], dv[n];
    for (int i = 0; i < n; i++) q_low[i] = v_low[i] = 0.0;
    for (int row = 0; row < BENCH_OUTPUTS; row++) {
        for (long step = 0; step < steps; step++) {
            stoermer_step(dq, dv, q, v, h, w, levels, n, a);
            for (int i = 0; i < n; i++) {
                add_exactly(q + i, q_low + i, dq[i]);
                add_exactly(v + i, v_low + i, dv[i]);
            }
        }
        for (int i = 0; i < n; i++) out[row * n + i] = q[i];
    }
}

#define STOERMER_CASES(out, m, n, steps, a, q, v, T)                                               \
    switch ((m)->k) {                                                                              \
    case 4:                                                                                        \
        stoermer(out, 4, n, steps, a, q, v, T);                                                    \
        break;                                                                                     \
    case 6:                                                                                        \
        stoermer(out, 6, n, steps, a, q, v, T);                                                    \
        break;                                                                                     \
    default:                                                                                       \
        stoermer(out, 8, n, steps, a, q, v, T);                                                    \
        break;                                                                                     \
    }
#define STOERMER_METHODS(run)                                                                      \
    {"stoermer(8)", run, NULL, 4}, {"stoermer(12)", run, NULL, 6}, {                               \
        "stoermer(16)", run, NULL, 8                                                               \
    }

#endif
