/* crossing_weights.c - in which lengths coordinates are compared where constraints are looked at:
 * those in which masses are 1. */
#include "mech/crossing.h"

#include <math.h>
#include <string.h>

/* of the entry (i, j), none off a diagonal that stands alone */
static double size_of(const dm_crossing_mass *m, size_t i, size_t j) {
    return m->pitch ? fabs(m->M[i * m->pitch + j]) : i == j ? fabs(m->M[i]) : 0.0;
}

/* Of a coordinate without a mass of its own, such that the largest entry of its row is 1; where it
 * is coupled with such ones alone, as in L = v1 v2, nothing tells apart their units. */
static double coupled_weight(const dm_crossing_mass *m, const double *weight, size_t i) {
    double among = 0.0, beside = 0.0;
    for (size_t j = 0; j < m->n; j++) {
        const double entry = size_of(m, i, j);
        if (size_of(m, j, j) > 0.0)
            beside = fmax(beside, entry * entry * weight[j]);
        else
            among = fmax(among, entry);
    }
    return beside > 0.0 ? 1.0 / beside : among > 0.0 ? 1.0 / among : 1.0;
}

/* the upper right quarter of M~ = [B, M; M, 0] */
static dm_crossing_mass quarter(const dm_crossing_mass *m) {
    const uint32_t half = m->n / 2;
    return (dm_crossing_mass){m->M + (m->pitch ? half : 0), half, m->pitch};
}

int dm_crossing_weights(double *weight, const dm_crossing_mass *mass, int prolonged) {
    const dm_crossing_mass m = prolonged ? quarter(mass) : *mass;
    int open = 0, good = 1;
    for (size_t i = 0; i < m.n; i++) {
        const double own = size_of(&m, i, i);
        weight[i] = 1.0 / own;
        open |= !(own > 0.0);
    }
    for (size_t i = 0; i < m.n && open; i++)
        if (!(size_of(&m, i, i) > 0.0)) weight[i] = coupled_weight(&m, weight, i);
    for (size_t i = 0; i < m.n; i++) good &= weight[i] > 0.0 && weight[i] < INFINITY;
    if (prolonged) memcpy(weight + m.n, weight, m.n * sizeof *weight);
    return good;
}
