/* simplex.c - clipping by bisection: where an affine function has both signs on a simplex, an edge
 * is cut at its zero and the simplex falls into two, of which each has one vertex less of one sign.
 * So it works in any dimension, and pieces never overlap. */
#include "dec/transfer/simplex.h"

#include <math.h>
#include <string.h>

enum { MOST = DM_SIMPLEX_VERTICES };

/* The Gram matrix of the edges is positive definite unless the simplex is flat. */
dm_status dm_placer_make(dm_placer *p, const double *const *vertex, uint32_t n, uint32_t N) {
    *p = (dm_placer){.n = n, .N = N};
    for (uint32_t j = 0; j <= n; j++) p->vertex[j] = vertex[j];
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            double sum = 0.0;
            for (uint32_t c = 0; c < N; c++)
                sum += (vertex[i + 1][c] - vertex[0][c]) * (vertex[j + 1][c] - vertex[0][c]);
            if (i == j) p->size = fmax(p->size, sqrt(sum));
            for (uint32_t k = 0; k < j; k++) sum -= p->factor[i][k] * p->factor[j][k];
            if (i != j) {
                p->factor[i][j] = sum / p->factor[j][j];
                continue;
            }
            if (!(sum > 0.0)) return DM_SINGULAR;
            p->factor[i][i] = sqrt(sum);
        }
    }
    return DM_OK;
}

/* y[n]: products of the edges with what lambda leaves of x; returns the square of that */
static double products(const dm_placer *p, double *y, const double *lambda, const double *x) {
    double square = 0.0;
    for (uint32_t i = 0; i < p->n; i++) y[i] = 0.0;
    for (uint32_t c = 0; c < p->N; c++) {
        double rest = x[c] - p->vertex[0][c];
        for (uint32_t j = 1; j <= p->n; j++)
            rest -= lambda[j] * (p->vertex[j][c] - p->vertex[0][c]);
        for (uint32_t i = 0; i < p->n; i++) y[i] += (p->vertex[i + 1][c] - p->vertex[0][c]) * rest;
        square += rest * rest;
    }
    return square;
}

/* lambda moves by the solution of the normal equations */
static void add_coordinates(const dm_placer *p, double *lambda, double *y) {
    for (uint32_t i = 0; i < p->n; i++) {
        for (uint32_t k = 0; k < i; k++) y[i] -= p->factor[i][k] * y[k];
        y[i] /= p->factor[i][i];
    }
    for (uint32_t i = p->n; i-- > 0;) {
        for (uint32_t k = i + 1; k < p->n; k++) y[i] -= p->factor[k][i] * y[k];
        y[i] /= p->factor[i][i];
        lambda[i + 1] += y[i];
        lambda[0] -= y[i];
    }
}

/* Least squares, twice: what is left of x after the first time has the digits that the normal
 * equations of a thin simplex lose. What is left in the end is its distance. */
double dm_placer_place(const dm_placer *p, double *lambda, const double *x) {
    double y[DM_DIMENSION];
    for (uint32_t j = 0; j <= p->n; j++) lambda[j] = j == 0 ? 1.0 : 0.0;
    for (int pass = 0; pass < 2; pass++) {
        products(p, y, lambda, x);
        add_coordinates(p, lambda, y);
    }
    return sqrt(products(p, y, lambda, x));
}

/* Gaussian elimination with partial pivots. */
double dm_determinant(double a[][MOST], uint32_t size) {
    double product = 1.0;
    for (uint32_t k = 0; k < size; k++) {
        uint32_t best = k;
        for (uint32_t i = k + 1; i < size; i++)
            if (fabs(a[i][k]) > fabs(a[best][k])) best = i;
        if (a[best][k] == 0.0) return 0.0;
        for (uint32_t j = 0; best != k && j < size; j++) {
            const double other = a[k][j];
            a[k][j] = a[best][j];
            a[best][j] = other;
        }
        if (best != k) product = -product;
        product *= a[k][k];
        for (uint32_t i = k + 1; i < size; i++) {
            const double factor = a[i][k] / a[k][k];
            for (uint32_t j = k; j < size; j++) a[i][j] -= factor * a[k][j];
        }
    }
    return product;
}

/* what is clipped, and how far */
typedef struct {
    dm_simplex_part *out;
    uint32_t k, n;
    const double (*value)[MOST];
    double least;
} clipping;

/* a simplex in the barycentric coordinates of T */
typedef struct {
    double at[MOST][MOST];
} piece;

/* In barycentric coordinates the volume of a simplex, beside that of T, is their determinant. */
static void add_piece(const clipping *c, const piece *p) {
    piece copy = *p;
    const double share = fabs(dm_determinant(copy.at, c->k + 1));
    c->out->share += share;
    for (uint32_t j = 0; j <= c->k; j++)
        for (uint32_t i = 0; i <= c->k; i++) c->out->centre[i] += share * p->at[j][i] / (c->k + 1);
}

/* function `which` at vertex j of p */
static double value_at(const clipping *c, const piece *p, uint32_t which, uint32_t j) {
    double sum = 0.0;
    for (uint32_t i = 0; i <= c->k; i++) sum += p->at[j][i] * c->value[which][i];
    return fabs(sum) <= c->least ? 0.0 : sum;
}

static void clip(const clipping *c, const piece *p, uint32_t which);

/* vertex `replaced` goes to the zero of the function on the edge of a and b */
static void clip_cut(const clipping *c, const piece *p, uint32_t which, uint32_t replaced,
                     const double *cut) {
    piece part = *p;
    memcpy(part.at[replaced], cut, sizeof part.at[replaced]);
    clip(c, &part, which);
}

static void clip(const clipping *c, const piece *p, uint32_t which) {
    uint32_t plus = MOST, minus = MOST;
    double high = 0.0, low = 0.0, cut[MOST] = {0.0};
    if (which > c->n) {
        add_piece(c, p);
        return;
    }
    for (uint32_t j = 0; j <= c->k; j++) {
        const double x = value_at(c, p, which, j);
        if (x > high) high = x, plus = j;
        if (x < low) low = x, minus = j;
    }
    if (minus == MOST) {
        clip(c, p, which + 1);
        return;
    }
    if (plus == MOST) return;
    for (uint32_t i = 0; i <= c->k; i++)
        cut[i] = (high * p->at[minus][i] - low * p->at[plus][i]) / (high - low);
    /* one part without the lowest vertex, one without the highest; they meet in the cut */
    clip_cut(c, p, which, minus, cut);
    clip_cut(c, p, which, plus, cut);
}

void dm_simplex_clip(dm_simplex_part *out, uint32_t k, uint32_t n, const double value[][MOST],
                     double least) {
    const clipping c = {out, k, n, value, least};
    piece all = {{{0.0}}};
    *out = (dm_simplex_part){.share = 0.0};
    for (uint32_t j = 0; j <= k; j++) all.at[j][j] = 1.0;
    clip(&c, &all, 0);
    for (uint32_t i = 0; i <= k && out->share > 0.0; i++) out->centre[i] /= out->share;
}
