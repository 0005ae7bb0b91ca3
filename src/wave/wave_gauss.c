/* wave_gauss.c - Gauss collocation of a wave in modes of H, or of a part of it. A mode of energy E
 * is turned by R(-i theta), theta = h E/hbar, the diagonal Pade approximation of degree s: exactly
 * a phase. What the modes do not have, N(psi) = (rest + g |psi|^2) psi at the stages, comes in by
 *   psi_i = r_i psi_0 + sum_j S_ij N_j,   psi_1 = R psi_0 + sum_j w_j N_j,
 * M = I + i theta A, r = M^-1 1, S = -i h/hbar M^-1 A, w = -i h/hbar b M^-1, iterated to round-off.
 * The state are the coefficients in the modes. */
#include "wave/complex_number.h"
#include "wave/turn.h"
#include "wave/wave_stepper.h"

#include "integ/method/quadrature.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_ITERATIONS = 100 };

typedef struct {
    int s;
    dm_modes modes;
    const double *rest;   /* [n] or NULL */
    double *R;            /* [n] phases */
    int linear;           /* N = 0; what follows is not there then */
    dm_complex_number *r; /* [s][n] */
    dm_complex_number *S; /* [s][s][n] */
    dm_complex_number *w; /* [s][n] */
    double *stage;        /* [s][stride] coefficients of the stages */
    double *N;            /* [s][stride] of N at the stages */
    double *a, *c;        /* [2 n] */
    size_t stride;        /* 2 n, up to what is aligned to 64 bytes */
} gauss;

/* ---- phases ---- */

/* P_s by P_0 = 1, P_1 = 2 + z, P_(k+1) = 2 (2 k + 1) P_k + z^2 P_(k-1), z = -i theta: P_s(-z) is
 * its conjugate. Scaled as it grows. */
double dm_gauss_phase(int s, double theta) {
    dm_complex_number before = {1.0, 0.0}, now = {2.0, -theta};
    for (int k = 1; k < s; k++) {
        const dm_complex_number next =
            dm_csum(dm_cscaled(2.0 * (2.0 * k + 1.0), now), dm_cscaled(-theta * theta, before));
        const double size = sqrt(dm_csquare(next));
        before = dm_cscaled(1.0 / size, now), now = dm_cscaled(1.0 / size, next);
    }
    return 2.0 * atan2(now.im, now.re);
}

/* ---- coefficients of N ---- */

/* b, and A by integrals of the Lagrange polynomials */
static void read_table(double b[], double A[][DM_WAVE_STAGES], int s) {
    dm_quadrature q;
    dm_quadrature_gauss(&q, s);
    for (int i = 0; i < s; i++) {
        long double value[DM_QUADRATURE_NODES], integral[DM_QUADRATURE_NODES];
        dm_lagrange(value, integral, q.c, s, q.c[i]);
        b[i] = (double)q.b[i];
        for (int j = 0; j < s; j++) A[i][j] = (double)integral[j];
    }
}

typedef dm_complex_number small[DM_WAVE_STAGES][DM_WAVE_STAGES];

/* rows x and y */
static void exchange(dm_complex_number *x, dm_complex_number *y, int s) {
    for (int j = 0; j < s; j++) {
        const dm_complex_number t = x[j];
        x[j] = y[j], y[j] = t;
    }
}

/* row x of both += factor row y */
static void add_row(small M, small X, int x, dm_complex_number factor, int y, int s) {
    for (int j = 0; j < s; j++) {
        M[x][j] = dm_csum(M[x][j], dm_cproduct(factor, M[y][j]));
        X[x][j] = dm_csum(X[x][j], dm_cproduct(factor, X[y][j]));
    }
}

/* X = M^-1 by Gauss and Jordan with pivots; I + i theta A is regular for every theta */
static void invert(small M, small X, int s) {
    for (int i = 0; i < s; i++)
        for (int j = 0; j < s; j++) X[i][j] = (dm_complex_number){i == j, 0.0};
    for (int k = 0; k < s; k++) {
        int best = k;
        for (int i = k + 1; i < s; i++)
            if (dm_csquare(M[i][k]) > dm_csquare(M[best][k])) best = i;
        exchange(M[k], M[best], s);
        exchange(X[k], X[best], s);
        const dm_complex_number inverse = dm_cquotient((dm_complex_number){1.0, 0.0}, M[k][k]);
        for (int j = 0; j < s; j++) {
            M[k][j] = dm_cproduct(inverse, M[k][j]);
            X[k][j] = dm_cproduct(inverse, X[k][j]);
        }
        for (int i = 0; i < s; i++)
            if (i != k) add_row(M, X, i, dm_cscaled(-1.0, M[i][k]), k, s);
    }
}

/* r, S, w of mode k */
static void fill_mode(gauss *p, size_t k, double theta, double time, const double *b,
                      double A[][DM_WAVE_STAGES]) {
    const int s = p->s;
    const size_t n = p->modes.n;
    const dm_complex_number unit = {0.0, -time};
    small M, X;
    for (int i = 0; i < s; i++)
        for (int j = 0; j < s; j++) M[i][j] = (dm_complex_number){i == j, theta * A[i][j]};
    invert(M, X, s);
    for (int i = 0; i < s; i++) {
        dm_complex_number r = {0.0, 0.0}, weight = {0.0, 0.0};
        for (int j = 0; j < s; j++) {
            dm_complex_number product = {0.0, 0.0};
            for (int l = 0; l < s; l++) product = dm_csum(product, dm_cscaled(A[l][j], X[i][l]));
            p->S[((size_t)i * (size_t)s + (size_t)j) * n + k] = dm_cproduct(unit, product);
            r = dm_csum(r, X[i][j]);
            weight = dm_csum(weight, dm_cscaled(b[j], X[j][i]));
        }
        p->r[(size_t)i * n + k] = r;
        p->w[(size_t)i * n + k] = dm_cproduct(unit, weight);
    }
}

/* those of all modes */
static void fill_modes(gauss *p, const dm_wave *w, double h) {
    double b[DM_WAVE_STAGES], A[DM_WAVE_STAGES][DM_WAVE_STAGES];
    read_table(b, A, p->s);
    for (size_t k = 0; k < p->modes.n; k++)
        fill_mode(p, k, h * p->modes.energy[k] / w->hbar, h / w->hbar, b, A);
}

/* ---- steps ---- */

/* N of the coefficients c, into out; returns nothing to look at: sizes are those of the state */
static void nonlinear(const dm_wave_stepper *st, double *out, const double *c) {
    const gauss *p = st->data;
    const dm_wave *w = st->wave;
    double *a = p->a;
    dm_from_modes(a, &p->modes, c);
    for (uint32_t j = 0; j < w->n; j++) {
        const double density = (a[2 * j] * a[2 * j] + a[2 * j + 1] * a[2 * j + 1]) / w->weight[j];
        const double energy = (p->rest ? p->rest[j] : 0.0) + w->g * density;
        a[2 * j] *= energy, a[2 * j + 1] *= energy;
    }
    dm_to_modes(out, &p->modes, a);
}

/* sum_j factor[j][n] N_j of mode k, added to sum */
static dm_complex_number add_N(const gauss *p, dm_complex_number sum,
                               const dm_complex_number *factor, size_t k) {
    for (size_t j = 0; j < (size_t)p->s; j++) {
        const double *N = p->N + j * p->stride + 2 * k;
        sum =
            dm_csum(sum, dm_cproduct(factor[j * p->modes.n + k], (dm_complex_number){N[0], N[1]}));
    }
    return sum;
}

/* stage i of the present N; sum of squares of what has changed */
static double renew_stage(const gauss *p, const double *state, int i) {
    const size_t n = p->modes.n, s = (size_t)p->s;
    double *out = p->stage + (size_t)i * p->stride, changed = 0.0;
    for (size_t k = 0; k < n; k++) {
        const dm_complex_number at = {state[2 * k], state[2 * k + 1]},
                                was = {-out[2 * k], -out[2 * k + 1]};
        const dm_complex_number free = dm_cproduct(p->r[(size_t)i * n + k], at);
        const dm_complex_number is = add_N(p, free, p->S + (size_t)i * s * n, k);
        changed += dm_csquare(dm_csum(is, was));
        out[2 * k] = is.re, out[2 * k + 1] = is.im;
    }
    return changed;
}

/* Until what changes is rounding and no longer falls. */
static dm_status solve(dm_wave_stepper *st, double norm) {
    const gauss *p = st->data;
    double before = INFINITY;
    memset(p->N, 0, (size_t)p->s * p->stride * sizeof *p->N);
    for (int i = 0; i < p->s; i++) renew_stage(p, st->state, i);
    for (int round = 0; round < MOST_ITERATIONS; round++) {
        double changed = 0.0;
        for (int j = 0; j < p->s; j++)
            nonlinear(st, p->N + (size_t)j * p->stride, p->stage + (size_t)j * p->stride);
        for (int i = 0; i < p->s; i++) changed += renew_stage(p, st->state, i);
        st->iterations++;
        st->residual = sqrt(changed / ((double)p->s * norm));
        if (!isfinite(changed)) return round ? DM_NO_CONVERGENCE : DM_NOT_FINITE;
        if (st->residual <= 2 * DBL_EPSILON) return DM_OK;
        if (st->residual < 1e-13 && st->residual >= 0.5 * before) return DM_OK;
        before = st->residual;
    }
    return DM_NO_CONVERGENCE;
}

/* sum |c|^2 */
static double squares(const double *c, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < 2 * n; i++) sum += c[i] * c[i];
    return sum;
}

/* The step is linear in N at the solution: R and w of every mode. */
static dm_status nonlinear_step(dm_wave_stepper *st) {
    const gauss *p = st->data;
    const size_t n = p->modes.n;
    const dm_status status = solve(st, squares(st->state, n));
    if (status != DM_OK) return status;
    for (int j = 0; j < p->s; j++)
        nonlinear(st, p->N + (size_t)j * p->stride, p->stage + (size_t)j * p->stride);
    dm_turn(st->state, p->R, n);
    for (size_t k = 0; k < n; k++) {
        const dm_complex_number at = {st->state[2 * k], st->state[2 * k + 1]};
        const dm_complex_number is = add_N(p, at, p->w, k);
        st->state[2 * k] = is.re, st->state[2 * k + 1] = is.im;
    }
    return DM_OK;
}

/* Without N a step is one product a mode, and exact for H as the computer has it. */
static dm_status advance(dm_wave_stepper *st, long count, long *done) {
    const gauss *p = st->data;
    dm_status status = DM_OK;
    for (long step = 0; status == DM_OK && step < count; step++) {
        if (p->linear)
            dm_turn(st->state, p->R, p->modes.n);
        else
            status = nonlinear_step(st);
        if (status == DM_OK) ++*done;
    }
    return status;
}

/* From amplitudes to coefficients; p->a is aligned, what is given may not be. */
static dm_status start(dm_wave_stepper *st, const double *a) {
    const gauss *p = st->data;
    memcpy(p->a, a, 2 * (size_t)p->modes.n * sizeof *a);
    dm_to_modes(st->state, &p->modes, p->a);
    return DM_OK;
}

static void amplitudes(const dm_wave_stepper *st, double *a) {
    const gauss *p = st->data;
    dm_from_modes(p->a, &p->modes, st->state);
    memcpy(a, p->a, 2 * (size_t)p->modes.n * sizeof *a);
}

static const dm_wave_engine engine = {start, advance, amplitudes, NULL};

/* ---- opening ---- */

/* room for what N needs; stages are 0 at first, so that nothing is read that was not set */
static dm_status take(gauss *p, dm_arena *arena) {
    const size_t n = p->modes.n, s = (size_t)p->s;
    p->r = dm_arena_take(arena, s * n * sizeof *p->r);
    p->S = dm_arena_take(arena, s * s * n * sizeof *p->S);
    p->w = dm_arena_take(arena, s * n * sizeof *p->w);
    p->stage = dm_arena_take(arena, s * p->stride * sizeof *p->stage);
    p->N = dm_arena_take(arena, s * p->stride * sizeof *p->N);
    if (!p->r || !p->S || !p->w || !p->stage || !p->N) return DM_NO_MEMORY;
    memset(p->stage, 0, s * p->stride * sizeof *p->stage);
    return DM_OK;
}

dm_status dm_wave_gauss(dm_wave_stepper *st, const dm_wave *w, double h, int degree,
                        dm_arena *arena, volatile const int *stop) {
    const size_t n = w->n, size = 2 * n * sizeof(double);
    gauss *p = dm_arena_take(arena, sizeof *p);
    *st = (dm_wave_stepper){.engine = &engine, .wave = w, .h = h, .size = 2 * n, .data = p};
    st->state = dm_arena_take(arena, size);
    if (!p || !st->state) return DM_NO_MEMORY;
    *p = (gauss){.s = degree, .stride = (2 * n + 7) / 8 * 8};
    p->R = dm_arena_take(arena, size);
    p->a = dm_arena_take(arena, size);
    if (!p->R || !p->a) return DM_NO_MEMORY;
    dm_status status = dm_wave_modes(&p->modes, &p->rest, w, arena, stop);
    if (status != DM_OK) return status;
    p->linear = w->g == 0.0 && !p->rest;
    if (!p->linear) status = degree <= DM_WAVE_STAGES ? take(p, arena) : DM_TOO_LARGE;
    for (size_t k = 0; status == DM_OK && k < n; k++) {
        const double phase = dm_gauss_phase(degree, h * p->modes.energy[k] / w->hbar);
        p->R[2 * k] = cos(phase), p->R[2 * k + 1] = sin(phase);
    }
    if (status == DM_OK && !p->linear) fill_modes(p, w, h);
    return status;
}
