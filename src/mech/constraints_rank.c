/* constraints_rank.c - which constraint cannot be held: S = rows of the equations . rows of the
 * reactions, both of length 1, loses rank where one depends on those before it, and where its
 * reactions do not act against it. */
#include "mech/constraints.h"

#include <math.h>

typedef struct {
    const double *along, *across;
} rows;

/* outputs of the kernels of the constraints at one point */
typedef struct {
    const double *holonomic, *rolling;
} point;

/* Rows c of the equations and of the reactions at a point; the same for holonomic constraints. */
static rows rows_of(const dm_constraints *t, point p, uint32_t c) {
    const uint32_t n = t->n, k = t->holonomic, l = t->rolling;
    if (c < k) return (rows){p.holonomic + k + c * (size_t)n, p.holonomic + k + c * (size_t)n};
    const double *E = p.rolling + l + (c - k) * (size_t)n;
    return (rows){E + l * (size_t)n, E};
}

static double dot(const double *a, const double *b, uint32_t n) {
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* S[m][m]: cosines of the angles between equations and reactions. */
static void fill(const dm_constraints *t, double *S, point p) {
    const uint32_t m = t->holonomic + t->rolling, n = t->n;
    for (uint32_t b = 0; b < m; b++) {
        const double *row = rows_of(t, p, b).along, length = sqrt(dot(row, row, n));
        for (uint32_t c = 0; c < m; c++) {
            const double *across = rows_of(t, p, c).across;
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

size_t dm_constraints_dependent_work(const dm_constraints *t) {
    const size_t m = (size_t)t->holonomic + t->rolling;
    return m * m + m;
}

/* Elimination with the largest entry of each row as its pivot: a row that vanishes depends on those
 * before it. */
uint32_t dm_constraints_dependent(const dm_constraints *t, const double *holonomic,
                                  const double *rolling, double least, double *work) {
    const uint32_t m = t->holonomic + t->rolling;
    uint32_t *taken = (uint32_t *)(void *)(work + m * (size_t)m);
    fill(t, work, (point){holonomic, rolling});
    for (uint32_t b = 0; b < m; b++)
        if (!(eliminate(work, taken, b, m) > least)) return b + 1;
    return 0;
}
