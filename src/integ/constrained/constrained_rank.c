/* constrained_rank.c - which constraint cannot be held: S = rows of the equations . rows of the
 * reactions, both of length 1, loses rank where one depends on those before it, and where its
 * reactions do not act against it. */
#include "integ/constrained/constrained_inside.h"

#include <math.h>

typedef struct {
    const double *along, *across;
} rows;

/* outputs of the kernels of the constraints at one point */
typedef struct {
    const double *holonomic, *rolling;
} point;

/* Rows c of the equations and of the reactions at a point; the same for holonomic constraints. */
static rows rows_of(const dm_constrained *g, point p, uint32_t c) {
    const uint32_t n = g->n;
    const double *G = p.holonomic + g->k + c * (size_t)n;
    if (c < g->k) return (rows){G, G};
    const double *E = p.rolling + g->l + (c - g->k) * (size_t)n;
    return (rows){E + g->l * (size_t)n, E};
}

static double dot(const double *a, const double *b, uint32_t n) {
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* S[m][m]: cosines of the angles between equations and reactions. */
static void fill(const dm_constrained *g, double *S, point p) {
    const uint32_t m = g->k + g->l, n = g->n;
    for (uint32_t b = 0; b < m; b++) {
        const double *row = rows_of(g, p, b).along, length = sqrt(dot(row, row, n));
        for (uint32_t c = 0; c < m; c++) {
            const double *across = rows_of(g, p, c).across;
            S[b * m + c] = dot(row, across, n) / (length * sqrt(dot(across, across, n)));
        }
    }
}

/* row b after the rows before it, whose pivots stand in columns `taken` */
static double eliminate(double *S, uint32_t *taken, uint32_t b, uint32_t m) {
    double *row = S + b * (size_t)m, most = 0.0;
    for (uint32_t a = 0; a < b; a++) {
        const double *before = S + a * (size_t)m;
        const double factor = row[taken[a]] / before[taken[a]];
        for (uint32_t c = 0; c < m; c++) row[c] -= factor * before[c];
        row[taken[a]] = 0.0;
    }
    for (uint32_t c = 0; c < m; c++) {
        if (!(fabs(row[c]) > most)) continue;
        most = fabs(row[c]);
        taken[b] = c;
    }
    return most;
}

/* Elimination with the largest entry of each row as its pivot: a row that vanishes depends on those
 * before it. */
static uint32_t dependent_at(dm_constrained *g, point p) {
    static const double LEAST = 1e-10; /* square of the sine of an angle */
    const uint32_t m = g->k + g->l;
    double *S = g->scratch;
    uint32_t *taken = (uint32_t *)(void *)(S + m * (size_t)m);
    fill(g, S, p);
    for (uint32_t b = 0; b < m; b++)
        if (!(eliminate(S, taken, b, m) > LEAST)) return b + 1;
    return 0;
}

/* Rolling conditions are held at the Gauss points, where G is not known, and, with the momentum,
 * at the end. */
uint32_t dm_constrained_dependent(dm_constrained *g, int ended) {
    const uint32_t last = ended || !g->l ? g->K : g->K - 1;
    uint32_t lost = 0;
    for (uint32_t k = 0; k <= last && !lost; k++)
        lost =
            dependent_at(g, (point){dm_constrained_holonomic(g, k), dm_constrained_rolling(g, k)});
    for (uint32_t k = 0; k < g->K && !lost && !g->k; k++)
        lost = dependent_at(g, (point){NULL, g->roll + k * g->l * (1 + 3 * (size_t)g->n)});
    return lost;
}
