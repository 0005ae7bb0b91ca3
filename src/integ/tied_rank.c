/* tied_rank.c - which tie depends on the others: rows of [G; E] made orthogonal, one after the other. */
#include "integ/tied_inside.h"

#include <math.h>
#include <string.h>

static double dot(const double *a, const double *b, uint32_t n) {
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* twice is enough (Kahan; Parlett 1980, 6.9) */
static void make_orthogonal(double *row, const double *unit, uint32_t count, uint32_t n) {
    for (uint32_t b = 0; b < 2 * count; b++) {
        const double *u = unit + (b % count) * (size_t)n, part = dot(row, u, n);
        for (uint32_t i = 0; i < n; i++) row[i] -= part * u[i];
    }
}

uint32_t dm_tied_dependent(dm_tied *g, uint32_t k) {
    static const double LEAST = 1e-5; /* sine of the angle to the rows before */
    const uint32_t n = g->n;
    double *unit = g->scratch;
    for (uint32_t c = 0; c < g->k + g->l; c++) {
        const double *row = c < g->k ? dm_tied_holonomic(g, k) + g->k + c * n
                                     : dm_tied_rolling(g, k) + g->l + (c - g->k) * n;
        double *mine = unit + c * (size_t)n;
        const double length = sqrt(dot(row, row, n));
        memcpy(mine, row, n * sizeof *mine);
        make_orthogonal(mine, unit, c, n);
        const double left = sqrt(dot(mine, mine, n));
        if (!(left > LEAST * length)) return c + 1;
        for (uint32_t i = 0; i < n; i++) mine[i] /= left;
    }
    return 0;
}
