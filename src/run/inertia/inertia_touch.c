/* inertia_touch.c - does d2L/dv2 lose a value on a short way without a change of sign, so that the
 * motion ends there? The velocity that the value belongs to becomes infinite. Where it leads off
 * the place, there is no motion behind it, as in L = x^2 v^2/2, nor where all places lose it at one
 * time; at a pole of coordinates it leads along it, and motions pass. A value that some velocities
 * keep, as v^4 does, is none: momenta still determine them. */
#include "run/inertia/inertia_line.h"
#include "run/inertia/inertia_look.h"
#include "run/inertia/inertia_values.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* of a value at an end: what the velocity that is lost gives back over the same distance */
static const double GIVEN_BACK = 1e-2;
/* of the way: less along that velocity is no motion */
static const double MOVES = 1e-6;
/* ---- the velocity that is lost ---- */

/* To at->lost, on the velocities that constraints allow, which others have so much more mass for;
 * 0: none is found. */
static int find_lost(dm_inertia_spot *at) {
    static const double SHIFT = 1e-13, MORE = 1e5, ROUNDING = 128 * DBL_EPSILON;
    const dm_inertia *x = at->x;
    double *w = at->lost, largest = 0.0;
    dm_inertia_find(x, at->q, at->v ? at->v : at->q, at->t);
    const dm_inertia_form f = dm_inertia_place(x, at->block);
    const size_t n = f.n;
    for (size_t i = 0; i < n; i++) largest = fmax(largest, fabs(f.A[i * n + i]));
    if (!(largest > 0.0)) largest = 1.0;
    const double shift = f.rows ? MORE * ROUNDING : SHIFT;
    for (size_t i = 0; i < n; i++) f.A[i * n + i] += shift * largest;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            for (size_t c = 0; c < f.rows; c++)
                f.A[i * n + j] += MORE * largest * f.G[c * n + i] * f.G[c * n + j];
    for (size_t i = 0; i < n; i++) at->there[i] = 1.0;
    if (!(dm_inertia_find_least(f.A, at->there, at->tried, f.n) > 0.0)) return 0;
    memset(w, 0, x->model->n * sizeof *w);
    for (size_t i = 0; i < n; i++) w[f.order[i]] = at->tried[i] * x->scale[f.order[i]];
    if (x->model->group) dm_inertia_carry(at, w);
    return 1;
}

/* ---- where it leads ---- */

/* How far an end of the way is from the place: along that velocity, and in all. */
typedef struct {
    double along, all;
} distance;

static distance distance_of(const dm_inertia_spot *at, const double *end) {
    const dm_inertia *x = at->x;
    const uint32_t n = x->model->n - x->tangent; /* of the orbit alone */
    double squares = 0.0, along = 0.0, lost = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        const double unit = x->model->group ? 1.0 : x->scale[i];
        const double d = (end[i] - at->q[i]) / unit, w = at->lost[i] / unit;
        squares += d * d, along += d * w, lost += w * w;
    }
    return (distance){along / lost, copysign(sqrt(squares / lost), along)};
}

/* Does the way go along it? */
static int goes_along(distance d) {
    return fabs(d.along) > MOVES * fabs(d.all);
}

/* The value so far along that velocity from the place. */
static double value_along(dm_inertia_spot *at, double far) {
    for (uint32_t i = 0; i < at->x->model->n; i++) at->there[i] = at->q[i] + far * at->lost[i];
    return dm_inertia_value_at(at, at->there, at->t);
}

/* Does that velocity lead off the place, as an end with this value does? One at the place does not
 * tell. */
static int leads_off(dm_inertia_spot *at, const double *end, double value) {
    const double much = GIVEN_BACK * value;
    if (value <= at->none) return 1;
    const distance d = distance_of(at, end);
    return goes_along(d) && (value_along(at, d.along) > much || value_along(at, d.all) > much);
}

/* Is it lost at that time at an end of the way, too, which goes along it? */
static int is_lost_there(dm_inertia_spot *at, const double *end, double value) {
    return (value <= at->none || goes_along(distance_of(at, end))) &&
           dm_inertia_value_at(at, end, at->t) <= at->none;
}

/* Does one of the block of the place? */
static int block_touches(dm_inertia_spot *at, const dm_chord *c, const dm_chord *way) {
    const double first = at->x->first[at->block], last = at->x->last[at->block];
    const double most = fmax(first, last), least = fmin(first, last);
    if (!(at->x->middle[at->block] < DM_INERTIA_VALLEY * most)) return 0;
    const double some = fmin(most, 1.0); /* as at the start */
    at->none = DM_INERTIA_NONE *
               (least > DM_INERTIA_NONE * some ? least : some); /* an end may be the place */
    if (!(dm_inertia_least_on(at, c) <= at->none) || !find_lost(at)) return 0;
    return (leads_off(at, way->a, first) && leads_off(at, way->b, last)) ||
           (is_lost_there(at, way->a, first) && is_lost_there(at, way->b, last));
}

int dm_inertia_touches(const dm_inertia *x, const dm_chord *c, const dm_chord *way, const double *v,
                       double *room) {
    dm_inertia_spot at = dm_inertia_spot_in(x, v, room);
    if (!way->known) {
        dm_inertia_find_on(&at, way, 0.0, x->first);
        dm_inertia_find_on(&at, way, 1.0, x->last);
    }
    dm_inertia_find_on(&at, c, 0.5, x->middle);
    for (; at.block < x->blocks.count; at.block++)
        if (block_touches(&at, c, way) || (way->poles && dm_inertia_has_pole(&at, way))) return 1;
    return 0;
}

int dm_inertia_has_touched(const dm_inertia *x, const dm_chord *way) {
    const size_t n = x->model->n;
    double *room = x->aside + 2 * n, *v = NULL;
    if (!dm_inertia_can_carry(x)) return 0;
    if (!(x->model->structure & DM_QUADRATIC_IN_V)) {
        const double *found = dm_inertia_velocity(x, way->b, way->tb);
        if (!found) return 0;
        v = memcpy(room + 5 * n, found, n * sizeof *v);
    }
    return dm_inertia_touches(x, way, way, v, room);
}

void dm_inertia_keep_place(dm_inertia *x, const double *state) {
    memcpy(x->place, state, x->model->n * sizeof *state);
}
