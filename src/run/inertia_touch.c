/* inertia_touch.c - does d2L/dv2 lose a value on a short way without a change of sign, so that the
 * motion ends there? The velocity that the value belongs to becomes infinite. Where it leads off
 * the place, there is no motion behind it, as in L = x^2 v^2/2; at a pole of coordinates it leads
 * along it, and motions pass. */
#include "linalg/signature.h"
#include "mech/constraints.h"
#include "mech/group.h"
#include "run/inertia.h"

#include <math.h>
#include <string.h>

/* of the values at both ends of the way: what is none */
static const double NONE = 1e-12;
/* of the larger value at these ends: more in the middle of a chord is no valley. One that has its
 * zero between two ends has a fourth there at most. */
static const double LITTLE = 0.5;
/* of a value at an end: what the velocity that is lost gives back over the same distance */
static const double GIVEN_BACK = 1e-2;
/* of the way: less along that velocity is no motion */
static const double MOVES = 1e-6;
enum { TRIES = 200 }; /* of the golden section, to round-off of an end that is very near */

/* the place: position q[n] at time t */
typedef struct {
    double *q, t;
} place;

/* The product of the values at a place, where they are positive, since there may be smaller ones
 * than the one that vanishes; else the one next to zero. M(q) is the same for any velocity. */
static double value_at(const dm_inertia *x, const double *q, double t) {
    const uint32_t n = x->model->n;
    double *A = dm_inertia_mass(x, q, q, t), least, out = 1.0;
    uint32_t negative;
    if (!dm_all_positive(A, n, 0.0, &least))
        return dm_inertia_at(x, q, t, &negative, &least) ? least : INFINITY;
    for (uint32_t i = 0; i < n; i++) out *= A[i * n + i];
    return out;
}

/* The same on the chord, at s, where the place is put. */
static double value_on(const dm_inertia *x, const dm_chord *c, double s, place *at) {
    for (uint32_t i = 0; i < x->model->n; i++) at->q[i] = c->a[i] + s * (c->b[i] - c->a[i]);
    at->t = c->ta + s * (c->tb - c->ta);
    return value_at(x, at->q, at->t);
}

/* The least of it, or one that is small enough, by the golden section, and its place. */
static double least_value(const dm_inertia *x, const dm_chord *c, double enough, place *at) {
    const double golden = 0.5 * (sqrt(5.0) - 1.0);
    double lo = 0.0, hi = 1.0, s = hi - golden * (hi - lo), z = lo + golden * (hi - lo);
    double left = value_on(x, c, s, at), right = value_on(x, c, z, at);
    for (int k = 0; k < TRIES && fmin(left, right) > enough && lo < s && z < hi; k++) {
        if (left < right) {
            hi = z, z = s, right = left;
            s = hi - golden * (hi - lo), left = value_on(x, c, s, at);
        } else {
            lo = s, s = z, left = right;
            z = lo + golden * (hi - lo), right = value_on(x, c, z, at);
        }
    }
    return value_on(x, c, left < right ? s : z, at);
}

/* w[n] = the velocity that the place has no mass for, scaled, of size 1; 0: none is found */
static int find_lost(const dm_inertia *x, const place *at, double *w, double *room) {
    static const double SHIFT = 1e-13;
    const uint32_t n = x->model->n;
    double largest = 0.0;
    for (uint32_t i = 0; i < n; i++) w[i] = 0.0, room[i] = 1.0;
    double *A = dm_inertia_mass(x, at->q, w, at->t);
    for (uint32_t i = 0; i < n; i++) largest = fmax(largest, fabs(A[i * n + i]));
    for (uint32_t i = 0; i < n; i++) A[i * n + i] += SHIFT * (largest > 0.0 ? largest : 1.0);
    return dm_inertia_find_least(A, room, w, n) > 0.0;
}

/* Does that velocity lead off the place, as far as an end of the way is from it, and does the way
 * go along it? */
static int leads_off(const dm_inertia *x, const place *at, const double *w, const double *end,
                     double t, double value, double *there) {
    const uint32_t n = x->model->n;
    double squares = 0.0, along = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        const double d = (end[i] - at->q[i]) / x->scale[i];
        squares += d * d, along += d * w[i];
    }
    const double far = copysign(sqrt(squares), along);
    for (uint32_t i = 0; i < n; i++) there[i] = at->q[i] + far * x->scale[i] * w[i];
    return fabs(along) > MOVES * fabs(far) && value_at(x, there, t) > GIVEN_BACK * value;
}

int dm_inertia_touches(const dm_inertia *x, const dm_chord *c, const dm_chord *way, double *room) {
    const uint32_t n = x->model->n;
    double *w = room + n, *there = w + n;
    place at = {.q = room};
    const double first = way->first > 0.0 ? way->first : value_on(x, way, 0.0, &at);
    const double last = way->last > 0.0 ? way->last : value_on(x, way, 1.0, &at);
    if (!(value_on(x, c, 0.5, &at) < LITTLE * fmax(first, last))) return 0;
    const double none = NONE * fmin(first, last);
    if (!(least_value(x, c, none, &at) <= none)) return 0;
    return find_lost(x, &at, w, there) && leads_off(x, &at, w, way->a, way->ta, first, there) &&
           leads_off(x, &at, w, way->b, way->tb, last, there);
}

/* Only of M(q), whose lost velocity is that of the place, in coordinates whose differences are
 * velocities: not on groups. */
static int may_touch(const dm_inertia *x) {
    const dm_constraints *c = x->model->constraints;
    return (x->model->structure & DM_QUADRATIC_IN_V) && !(c && c->holonomic + c->rolling) &&
           dm_momenta(x->model) == x->model->n;
}

int dm_inertia_has_touched(const dm_inertia *x, const dm_chord *way) {
    return may_touch(x) && dm_inertia_touches(x, way, way, x->aside + 2 * (size_t)x->model->n);
}

/* One that grew may fall as fast. */
dm_inertia_way dm_inertia_way_since(const dm_inertia *x, double least, double all, long since) {
    const dm_inertia_seen *s = &x->seen;
    const int by_position = (x->model->structure & DM_QUADRATIC_IN_V) != 0;
    const int whole = by_position && !x->model->mass_bounds && s->all * all > 0.0;
    dm_inertia_way w = {.since = since, .whole = whole};
    w.was = whole ? s->all : s->least, w.is = whole ? all : least;
    w.left = fmin(dm_inertia_left(x, w.was, w.is, (double)since),
                  dm_inertia_left(x, w.is, w.was, (double)since) + (double)since);
    return w;
}

/* Is that line looked at? Where bounds do not tell how M moves, and the product of all values moved
 * by more than it was let, or does not go on falling, or was so few steps from its end that one
 * step may go over it. */
static int sees_line(const dm_inertia *x, const dm_inertia_way *w) {
    static const double MOVED = 1.4, FEW = 4.0;
    const double ratio = w->is / w->was;
    if (x->model->mass_bounds) return 0;
    return (x->seen.fell && ratio > 1.0) || !(ratio < MOVED && ratio * MOVED > 1.0) ||
           (w->since == 1 && fmin(x->seen.nearest, w->left) < FEW);
}

int dm_inertia_touches_since(const dm_inertia *x, const double *state, double t,
                             const dm_inertia_way *w) {
    const double first = w->whole ? w->was : 0.0, last = w->whole ? w->is : 0.0;
    const dm_chord way = {x->region, state, x->seen.at, t, first, last};
    return sees_line(x, w) && dm_inertia_has_touched(x, &way);
}

void dm_inertia_keep_place(dm_inertia *x, const double *state) {
    if (!x->model->mass_bounds) memcpy(x->region, state, x->model->n * sizeof *state);
}
