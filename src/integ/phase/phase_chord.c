/* phase_chord.c - the stages of a step on H by chords: Newton's method with the derivative M of the
 * field at one place of the step for those at all stages. In the eigenvectors of the coefficients
 * I - h A x M falls apart into complex matrices I - h value M of 2n rows, one for each pair of
 * eigenvalues (phase_modes.h), where Newton's has 2 n r rows. */
#include "integ/phase/phase_inside.h"
#include "linalg/complex_lu.h"

#include <math.h>
#include <string.h>

/* of the scratch memory of Newton's method */
typedef struct {
    const dm_phase *g;
    double *re, *im; /* [count][n2*n2] factors */
    uint32_t *pivot; /* [count][n2] */
    double *x, *y;   /* [n2] */
    double *R, *to;  /* [m] residual, increment */
    double *size;    /* [n2] of the entries of the state and their displacements */
} factors;

/* fewer unknowns: their dense matrix is as fast */
enum { FEW_UNKNOWNS = 24 };

static size_t unknowns(const dm_phase *g) {
    return 2 * (size_t)g->n * g->r;
}

/* the factors of r stages take no more than their dense matrix, of three on */
int dm_phase_has_chords(dm_phase *g) {
    if (g->r < 3 || unknowns(g) <= FEW_UNKNOWNS) return 0;
    if (!g->sought) dm_phase_modes_find(&g->modes, &g->table, g->modes_memory);
    g->sought = 1;
    return g->modes.count > 0;
}

static factors lay_out(const dm_phase *g) {
    const size_t n2 = 2 * (size_t)g->n, all = g->modes.count * n2 * n2, m = unknowns(g);
    factors f = {.g = g, .re = g->scratch};
    f.im = f.re + all;
    f.x = f.im + all;
    f.y = f.x + n2;
    f.R = f.y + n2;
    f.to = f.R + m;
    f.size = f.to + m;
    f.pivot = (uint32_t *)(void *)(f.size + n2);
    return f;
}

/* I - h value M, factored */
static dm_status factor(factors *f, uint32_t mode, const double *M) {
    const dm_phase *g = f->g;
    const uint32_t n2 = 2 * g->n;
    const double a = g->h * g->modes.value[2 * mode], b = g->h * g->modes.value[2 * mode + 1];
    double *re = f->re + mode * (size_t)n2 * n2, *im = f->im + mode * (size_t)n2 * n2;
    for (size_t k = 0; k < (size_t)n2 * n2; k++) {
        re[k] = -a * M[k];
        im[k] = -b * M[k];
    }
    for (size_t k = 0; k < n2; k++) re[k * n2 + k] += 1.0;
    return dm_complex_lu_factor(re, im, f->pivot + mode * (size_t)n2, n2);
}

/* x + i y += sum of down_i Z_i */
static void go_down(const factors *f, uint32_t mode, const double *Z) {
    const dm_phase *g = f->g;
    const uint32_t n2 = 2 * g->n;
    const double *w = g->modes.down + 2 * (size_t)mode * g->r;
    memset(f->x, 0, n2 * sizeof *f->x);
    memset(f->y, 0, n2 * sizeof *f->y);
    for (uint32_t i = 0; i < g->r; i++)
        for (uint32_t k = 0; k < n2; k++) {
            f->x[k] += w[2 * i] * Z[i * n2 + k];
            f->y[k] += w[2 * i + 1] * Z[i * n2 + k];
        }
}

/* to_i += Re up_i (x + i y), of a pair twice */
static void come_up(const factors *f, uint32_t mode) {
    const dm_phase *g = f->g;
    const uint32_t n2 = 2 * g->n;
    const double *w = g->modes.up + 2 * (size_t)mode * g->r;
    const double twice = g->modes.value[2 * mode + 1] > 0.0 ? 2.0 : 1.0;
    for (uint32_t i = 0; i < g->r; i++)
        for (uint32_t k = 0; k < n2; k++)
            f->to[i * n2 + k] += twice * (w[2 * i] * f->x[k] - w[2 * i + 1] * f->y[k]);
}

/* to = (I - h A x M)^-1 R */
static void solve(const factors *f) {
    const dm_phase *g = f->g;
    const uint32_t n2 = 2 * g->n;
    memset(f->to, 0, unknowns(g) * sizeof *f->to);
    for (uint32_t mode = 0; mode < g->modes.count; mode++) {
        const size_t at = mode * (size_t)n2 * n2;
        go_down(f, mode, f->R);
        dm_complex_lu_solve(f->x, f->y, f->re + at, f->im + at, f->pivot + mode * (size_t)n2, n2);
        come_up(f, mode);
    }
}

/* M at the mean of the stages, and its factors */
static dm_status prepare(factors *f, dm_phase *g, const double *Z) {
    const uint32_t n2 = 2 * g->n;
    dm_status status = DM_OK;
    memset(f->x, 0, n2 * sizeof *f->x);
    for (uint32_t i = 0; i < g->r; i++)
        for (uint32_t k = 0; k < n2; k++)
            f->x[k] += dm_weight_double(g->table.b[i]) * Z[i * n2 + k];
    const double *M = dm_phase_derivative(g, f->x, 0.5 * g->h);
    for (uint32_t mode = 0; mode < g->modes.count && status == DM_OK; mode++)
        status = factor(f, mode, M);
    return status;
}

/* An entry that is as good as nothing beside the others is measured by those of its kind. */
static void find_sizes(factors *f, const double *Z) {
    const dm_phase *g = f->g;
    const uint32_t n = g->n;
    for (uint32_t k = 0; k < 2 * n; k++) {
        f->size[k] = fabs(g->state[k]);
        for (uint32_t i = 0; i < g->r; i++)
            f->size[k] = fmax(f->size[k], fabs(Z[i * 2 * (size_t)n + k]));
    }
    for (uint32_t k = 0; k < 2; k++) {
        double largest = 0.0, *size = f->size + k * n;
        for (uint32_t i = 0; i < n; i++) largest = fmax(largest, size[i]);
        for (uint32_t i = 0; i < n; i++) size[i] = fmax(size[i], largest / DM_SWEEP_APART);
    }
}

/* Z -= to; how much that is, relative to the sizes. NaN stays. */
static double move(const factors *f, double *Z) {
    const uint32_t n2 = 2 * f->g->n;
    double change = 0.0, bad = 0.0;
    for (uint32_t i = 0; i < f->g->r; i++)
        for (uint32_t k = 0; k < n2; k++) {
            const double d = f->to[i * n2 + k];
            Z[i * n2 + k] -= d;
            bad += 0.0 * d;
            if (d != 0.0) change = fmax(change, fabs(d) / f->size[k]);
        }
    return change + bad;
}

/* With one M, to round-off: what increments leave counts for nothing then. Of changes that are
 * mostly rounding the contraction is that of those before, the larger of the last two. */
static dm_status iterate(factors *f, dm_phase *g, double *Z, dm_stepper *stepper) {
    enum { MOST = 60 };
    static const double SLOWEST = 0.5, CLEAN = 1e-14;
    double before = INFINITY, ratio = 0.0, rate = SLOWEST;
    dm_report *report = &stepper->report;
    for (int k = 0; k < MOST; k++) {
        report->residual = dm_phase_residual(g, f->R, Z);
        solve(f);
        double change = move(f, Z);
        report->iterations++;
        if (!isfinite(change)) return DM_NOT_FINITE;
        if (before <= CLEAN && change <= 100.0 * CLEAN) {
            change = fmin(change, rate * before);
        } else if (k > 0) {
            rate = fmax(ratio, change / before);
            ratio = change / before;
            if (ratio > SLOWEST) return DM_NO_CONVERGENCE;
        }
        if (rate * change <= DM_SWEEP_LEFT * stepper->tolerance) return DM_OK;
        before = change;
    }
    return DM_NO_CONVERGENCE;
}

/* A first chord may leave a guess that was far away for a place whose M serves. */
dm_status dm_phase_chords(dm_phase *g, dm_stepper *stepper, double *Z) {
    enum { CHORDS = 3 };
    factors f = lay_out(g);
    dm_status status = DM_NO_CONVERGENCE;
    stepper->report.iterations = 0;
    for (int k = 0; k < CHORDS && status == DM_NO_CONVERGENCE; k++) {
        status = prepare(&f, g, Z);
        if (status != DM_OK) break;
        find_sizes(&f, Z);
        stepper->report.matrices++;
        status = iterate(&f, g, Z, stepper);
    }
    return status;
}
