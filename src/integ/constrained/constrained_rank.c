/* constrained_rank.c - which constraint cannot be held at a point of a step. */
#include "integ/constrained/constrained_inside.h"

#include <math.h>

/* Rolling conditions are held at the Gauss points, where G is not known, and, with the momentum,
 * at the end. */
uint32_t dm_constrained_dependent(dm_constrained *g, int ended) {
    const uint32_t last = ended || !g->l ? g->K : g->K - 1;
    const dm_constraints *c = g->constraints;
    uint32_t lost = 0;
    for (uint32_t k = 0; k <= last && !lost; k++)
        lost =
            dm_constraints_dependent(c, dm_constrained_holonomic(g, k),
                                     dm_constrained_rolling(g, k), DM_CONSTRAINTS_NEAR, g->scratch);
    for (uint32_t k = 0; k < g->K && !lost && !g->k; k++)
        lost = dm_constraints_dependent(c, NULL, g->roll + k * g->l * (1 + 3 * (size_t)g->n),
                                        DM_CONSTRAINTS_NEAR, g->scratch);
    return lost;
}

/* `count` rows of a point, each coordinate in the unit in which its mass is 1, behind `values`
 * entries that are not looked at; where those end. NULL: a coordinate has no mass of its own, as
 * those of tangent maps, whose vectors may have any length: no unit tells which rows are near. */
static double *place_rows(const dm_constrained *g, double *out, const double *rows, size_t values,
                          size_t count) {
    const size_t n = g->n;
    out += values;
    for (size_t i = 0; i < n; i++) {
        const double own = fabs(g->mass[n + i * n + i]);
        if (!(own > 0.0)) return NULL;
        const double unit = 1.0 / sqrt(own);
        for (size_t c = 0; c < count; c++) out[c * n + i] = rows[values + c * n + i] * unit;
    }
    return out + count * n;
}

int dm_constrained_is_lost(dm_constrained *g, uint32_t k) {
    static const double NONE = 1e-14; /* a velocity has seven digits left there */
    enum { FEW = 8 };                 /* more would be felt in the time of a step */
    const size_t hol = g->k, roll = g->l;
    double *rows = g->scratch;
    if (hol + roll < 2 || hol + roll > FEW) return 0;
    double *rolling = place_rows(g, rows, dm_constrained_holonomic(g, k), hol, hol);
    double *work =
        rolling ? place_rows(g, rolling, dm_constrained_rolling(g, k), roll, 2 * roll) : NULL;
    return work && dm_constraints_dependent(g->constraints, rows, rolling, NONE, work) != 0;
}

/* ---- places between the ends ---- */

size_t dm_constrained_crossing_work(const dm_constraints *c) {
    return c->holonomic ? c->n + dm_crossing_work(c) : 0;
}

static int find_weights(const dm_constrained *g, double *weight) {
    const dm_crossing_mass mass = {g->mass + g->n, g->n, g->n};
    return dm_crossing_weights(weight, &mass, g->constraints->prolonged);
}

/* The volume at the end; g->scratch is room. 0: it is not known. */
static int find_volume(dm_constrained *g) {
    double *weight = g->scratch;
    if (g->volume.part > 0.0) return 1;
    if (!find_weights(g, weight)) return 0;
    g->volume = dm_crossing_volume(g->constraints, dm_constrained_holonomic(g, g->K), weight,
                                   weight + g->n);
    return 1;
}

int dm_constrained_crosses(dm_constrained *g) {
    double *weight = g->scratch, *watched = g->memory + DM_CONSTRAINED_VOLUMES;
    const dm_crossing_way way = {g->state, g->next, weight, g->t, g->t + g->h, NULL};
    dm_crossing_place place;
    if (!g->k || g->constraints->crossings || !find_volume(g)) return 0;
    if (dm_crossing_is_calm(watched, g->volume)) return 0;
    if (!find_weights(g, weight)) return 0;
    if (!dm_crossing_in_step(g->constraints, watched, g->volume, &way, &place, weight + g->n))
        return 0;
    g->lost = place.row, g->crosses = 1, g->at = place.t;
    return 1;
}
