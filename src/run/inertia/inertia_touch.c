/* inertia_touch.c - does d2L/dv2 lose a value on a short way without a change of sign, so that the
 * motion ends there? The velocity that the value belongs to becomes infinite. Where it leads off
 * the place, there is no motion behind it, as in L = x^2 v^2/2, nor where all places lose it at one
 * time; at a pole of coordinates it leads along it, and motions pass. A value that some velocities
 * keep, as v^4 does, is none: momenta still determine them. */
#include "linalg/signature.h"
#include "mech/group.h"
#include "run/inertia/inertia_look.h"
#include "run/inertia/inertia_values.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* of the values at both ends of the way: what is none */
static const double NONE = 1e-12;
/* of a value at an end: what the velocity that is lost gives back over the same distance */
static const double GIVEN_BACK = 1e-2;
/* of the way: less along that velocity is no motion */
static const double MOVES = 1e-6;
enum { TRIES = 200 }; /* of the golden section, to round-off of an end that is very near */

/* the place: position q[n] at time t; the velocity that it has no mass for, as a change of q[n],
 * the block that this is of, and what is none there */
typedef struct {
    const dm_inertia *x;
    const double *v;
    double *q, *lost, *there, *tried; /* [n] each */
    double t, none;
    uint32_t block;
} place;

/* ---- values ---- */

/* The largest size of what terms of values cancel in: entries of A[n*n] beside the diagonal, and on
 * it where rows of constraints are taken out. */
static double largest_of(const double *A, size_t n, int diagonal) {
    double out = 0.0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            if (i != j || diagonal) out = fmax(out, fabs(A[i * n + j]));
    return out;
}

/* The size of the product of the values of block b of the mass that was found last, since there may
 * be smaller ones than the one that vanishes. Less than rounding is zero. */
static double value_found(const dm_inertia *x, uint32_t b) {
    static const double ROUNDING = 16 * DBL_EPSILON;
    dm_inertia_value found;
    if (dm_inertia_is_far(x, b, &found)) return found.all;
    const dm_inertia_form f = dm_inertia_place(x, b);
    const double across = f.rows ? largest_of(f.A, f.n, 1) : 0.0;
    const size_t n = f.rows ? dm_restrict(f.A, f.n, f.G, f.rows, f.border) : f.n;
    dm_inertia_negative_in(&f, (uint32_t)n, &found);
    const double beside = found.least > DM_INERTIA_FAR ? 0.0 : largest_of(f.copy, n, 0);
    return found.least <= ROUNDING * fmax(across, beside) ? 0.0 : found.all;
}

/* The largest of it for velocities v, 0 and -v, of blocks from b on: of a place that has none for
 * any. Where v is not in the domain of L, as a speed limit that depends on q, it says nothing; NaN:
 * none of them is. */
static void find_values(const place *at, const double *q, double t, uint32_t b, uint32_t count,
                        double *out) {
    if (!at->v) {
        dm_inertia_find(at->x, q, q, t);
        for (uint32_t k = 0; k < count; k++) out[k] = value_found(at->x, b + k);
        return;
    }
    for (uint32_t k = 0; k < count; k++) out[k] = NAN;
    for (int side = -1; side < 2; side++) {
        for (uint32_t i = 0; i < at->x->model->n; i++) at->tried[i] = side * at->v[i];
        dm_inertia_find(at->x, q, at->tried, t);
        for (uint32_t k = 0; k < count; k++) {
            const double value = value_found(at->x, b + k);
            if (isfinite(value) && !(value <= out[k])) out[k] = value;
        }
    }
}

/* Of the block of the place. */
static double value_at(const place *at, const double *q, double t) {
    double out;
    find_values(at, q, t, at->block, 1, &out);
    return out;
}

/* On the chord, at s. */
static void put_on(place *at, const dm_chord *c, double s) {
    for (uint32_t i = 0; i < at->x->model->n; i++) at->q[i] = c->a[i] + s * (c->b[i] - c->a[i]);
    at->t = c->ta + s * (c->tb - c->ta);
}

/* The value there, where the place is put. */
static double value_on(place *at, const dm_chord *c, double s) {
    put_on(at, c, s);
    return value_at(at, at->q, at->t);
}

/* Those of all blocks there. */
static void find_on(place *at, const dm_chord *c, double s, double *out) {
    put_on(at, c, s);
    find_values(at, at->q, at->t, 0, at->x->blocks.count, out);
}

/* The least of it, or one that is small enough, by the golden section, and its place. */
static double least_value(place *at, const dm_chord *c) {
    const double golden = 0.5 * (sqrt(5.0) - 1.0);
    double lo = 0.0, hi = 1.0, s = hi - golden * (hi - lo), z = lo + golden * (hi - lo);
    double left = value_on(at, c, s), right = value_on(at, c, z);
    for (int k = 0; k < TRIES && fmin(left, right) > at->none && lo < s && z < hi; k++) {
        if (left < right) {
            hi = z, z = s, right = left;
            s = hi - golden * (hi - lo), left = value_on(at, c, s);
        } else {
            lo = s, s = z, left = right;
            z = lo + golden * (hi - lo), right = value_on(at, c, z);
        }
    }
    return value_on(at, c, left < right ? s : z);
}

/* ---- the velocity that is lost ---- */

/* The kernel of the end of a step on a group; NULL: there is none. */
static const dm_kernel *finish_of(const dm_group *g) {
    return g->finish.eval ? &g->finish : g->joints.finish.eval ? &g->joints.finish : NULL;
}

/* A body velocity w[d] as a change of coordinates, at the place. */
static void carry(place *at, const double *w) {
    static const double SHORT = 1e-4;
    const dm_group *g = at->x->model->group;
    const dm_kernel *k = finish_of(g);
    const size_t n = at->x->model->n, d = g->momenta;
    double *in = at->x->room, *out = in + n + 2 * d, largest = 0.0;
    for (size_t i = 0; i < d; i++) largest = fmax(largest, fabs(w[i]));
    memcpy(at->there, w, d * sizeof *w);
    memcpy(in, at->q, n * sizeof *in);
    memset(in + n + d, 0, d * sizeof *in);
    for (int side = -1; side < 2; side += 2) {
        for (size_t i = 0; i < d; i++) in[n + i] = side * SHORT / largest * at->there[i];
        dm_kernel_prepare(k, out);
        dm_kernel_eval(k, in, out);
        for (size_t i = 0; i < n; i++) at->lost[i] = side > 0 ? out[i] - at->lost[i] : out[i];
    }
}

/* To at->lost, on the velocities that constraints allow, which others have so much more mass for;
 * 0: none is found. */
static int find_lost(place *at) {
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
    if (x->model->group) carry(at, w);
    return 1;
}

/* ---- where it leads ---- */

/* How far an end of the way is from the place: along that velocity, and in all. */
typedef struct {
    double along, all;
} distance;

static distance distance_of(const place *at, const double *end) {
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
static double value_along(place *at, double far) {
    for (uint32_t i = 0; i < at->x->model->n; i++) at->there[i] = at->q[i] + far * at->lost[i];
    return value_at(at, at->there, at->t);
}

/* Does that velocity lead off the place, as an end with this value does? One at the place does not
 * tell. */
static int leads_off(place *at, const double *end, double value) {
    const double much = GIVEN_BACK * value;
    if (value <= at->none) return 1;
    const distance d = distance_of(at, end);
    return goes_along(d) && (value_along(at, d.along) > much || value_along(at, d.all) > much);
}

/* Is it lost at that time at an end of the way, too, which goes along it? */
static int is_lost_there(place *at, const double *end, double value) {
    return (value <= at->none || goes_along(distance_of(at, end))) &&
           value_at(at, end, at->t) <= at->none;
}

/* Does one of the block of the place? */
static int block_touches(place *at, const dm_chord *c, const dm_chord *way) {
    const double first = at->x->first[at->block], last = at->x->last[at->block];
    const double most = fmax(first, last), least = fmin(first, last);
    if (!(at->x->middle[at->block] < DM_INERTIA_VALLEY * most)) return 0;
    const double some = fmin(most, 1.0);                    /* as at the start */
    at->none = NONE * (least > NONE * some ? least : some); /* an end may be the place */
    if (!(least_value(at, c) <= at->none) || !find_lost(at)) return 0;
    return (leads_off(at, way->a, first) && leads_off(at, way->b, last)) ||
           (is_lost_there(at, way->a, first) && is_lost_there(at, way->b, last));
}

int dm_inertia_touches(const dm_inertia *x, const dm_chord *c, const dm_chord *way, const double *v,
                       double *room) {
    const uint32_t n = x->model->n;
    place at = {.x = x, .v = v, .q = room, .lost = room + n};
    at.there = at.lost + n, at.tried = at.there + n;
    if (!way->known) {
        find_on(&at, way, 0.0, x->first);
        find_on(&at, way, 1.0, x->last);
    }
    find_on(&at, c, 0.5, x->middle);
    for (; at.block < x->blocks.count; at.block++)
        if (block_touches(&at, c, way)) return 1;
    return 0;
}

/* In coordinates whose differences are velocities, or on a group that can be stepped. */
static int may_touch(const dm_inertia *x) {
    const dm_group *g = x->model->group;
    return !g || finish_of(g);
}

int dm_inertia_has_touched(const dm_inertia *x, const dm_chord *way) {
    const size_t n = x->model->n;
    double *room = x->aside + 2 * n, *v = NULL;
    if (!may_touch(x)) return 0;
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
