/* inertia_pole.c - does M = d2L/dv2 grow without bound on a short way, so that the motion ends
 * there? Then its inverse loses a value, and v = M^-1 p what moves along the direction of that.
 * Motions pass where they may still cross the place, as the axis of polar coordinates, L = (v1^2 +
 * v2^2/q1^2)/2; none does where M^-1 loses the normal of the place, as in L = v^2/(1 - q^2)^2, but
 * if the place itself moves. */
#include "mech/group.h"
#include "run/inertia/inertia_line.h"
#include "run/inertia/inertia_values.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* of the way: how far from the place its normal is found, and over what difference; of what
 * round-off is of a short way, at least */
static const double ASIDE = 1e-5, APART = 1e-8, ASIDE_GRAINS = 1e4, APART_GRAINS = 1e2;
/* What round-off is of a way on which a normal is still found; grains between a place and a value
 * that is none. */
static const double COARSE = 1e-7, NONE_GRAINS = 256.0;
/* of what M^-1 makes of the normal at an end: what it is near the place. It is of that order for M
 * ~ 1/distance, less for higher powers; the normal is off by less. */
static const double LOST = 1e-3;
/* ways of fewer grains are round-off; how many of them are looked around then; of values there,
 * that at a pole */
static const double LEAST_GRAINS = 500.0, BESIDE = 5e6, NEAR = 1e-4;
/* Of the way: a step into it; how steeply the logarithm of M grows before M ~ 1/distance is
 * infinite on it, and the highest power of that that is thought of. */
static const double STEP = 1e-8, STEEP = 1.0, HIGHEST = 8.0;
/* of how the way nears the place: less is a place that stands still */
static const double STANDS = 1e-3;

/* How the logarithm of the value changes about the place over so much of `change` to either side,
 * and of a time. */
static double slope(const dm_inertia_spot *at, const double *change, double far, double later) {
    double out = 0.0;
    for (int side = -1; side < 2; side += 2) {
        for (uint32_t i = 0; i < at->x->model->n; i++)
            at->there[i] = at->q[i] + side * far * change[i];
        out += side * log(dm_inertia_value_at(at, at->there, at->t + side * later));
    }
    return out;
}

/* The velocity i alone, of size 1 in its scale, as a change of coordinates to at->lost. */
static void move_along(dm_inertia_spot *at, uint32_t i) {
    const dm_inertia *x = at->x;
    const uint32_t n = x->model->n;
    memset(at->lost, 0, n * sizeof *at->lost);
    at->lost[i] = 1.0;
    if (x->model->group) dm_inertia_carry(at, at->lost);
    const double by = x->scale[i] / (x->model->group ? 2.0 * DM_INERTIA_SHORT : 1.0);
    for (uint32_t k = 0; k < n; k++) at->lost[k] *= by;
}

/* Velocities of the orbit alone. */
static uint32_t velocities(const dm_inertia *x) {
    return dm_momenta(x->model) - x->tangent;
}

/* The length of the change at->lost in the scales of velocities. */
static double length_of(const dm_inertia_spot *at) {
    const dm_inertia *x = at->x;
    double squares = 0.0, most = 0.0;
    for (uint32_t i = 0; i < velocities(x); i++) most = fmax(most, x->scale[i]);
    for (uint32_t i = 0; i < x->model->n - x->tangent; i++) {
        const double d = at->lost[i] / (x->model->group ? most : x->scale[i]);
        squares += d * d;
    }
    return sqrt(squares);
}

/* Does the place move, as the way nears it? */
static int moves(dm_inertia_spot *at, const dm_chord *way, double apart) {
    for (uint32_t i = 0; i < at->x->model->n; i++) at->lost[i] = way->b[i] - way->a[i];
    const double nears = slope(at, at->lost, apart, 0.0);
    return fabs(slope(at, at->lost, 0.0, apart * (way->tb - way->ta))) > STANDS * fabs(nears);
}

/* The normal of the place, to at->normal, scaled; at->lost is the way. */
static void find_normal(dm_inertia_spot *at, double apart) {
    const double length = length_of(at);
    for (uint32_t i = 0; i < velocities(at->x); i++) {
        move_along(at, i);
        at->normal[i] = slope(at, at->lost, apart * length, 0.0);
    }
}

/* How fast the normal as a momentum leads off the place, there; 0: it is not known. Errors of the
 * normal count by their squares. */
static double speed_of_normal(const dm_inertia_spot *at, const double *q, double t) {
    const dm_inertia *x = at->x;
    double *u = at->there, out = 0.0; /* has two vectors */
    for (int by = at->v != NULL; by >= 0 && !(out > 0.0 && isfinite(out)); by--) {
        for (uint32_t i = 0; i < x->model->n; i++) at->tried[i] = by ? at->v[i] : 0.0;
        dm_inertia_find(x, q, at->tried, t);
        const dm_inertia_form f = dm_inertia_place(x, x->blocks.count);
        memcpy(u, at->normal, f.n * sizeof *u);
        out = 0.0;
        if (f.n != velocities(x) || !dm_inertia_solve(&f, u)) continue;
        for (uint32_t i = 0; i < f.n; i++) out += at->normal[i] * u[i];
        out = fabs(out);
    }
    return isfinite(out) ? out : 0.0;
}

/* Is the normal lost at the place, which does not move? A way so short that no normal is found is
 * that of a motion that all but stands, as those do that come near such a place. */
static int is_closed(dm_inertia_spot *at, const dm_chord *way, double grain) {
    const double part = at->to - at->from, aside = fmax(ASIDE * part, ASIDE_GRAINS * grain);
    const double apart = fmax(APART * part, APART_GRAINS * grain);
    dm_inertia_put_on(at, way, at->s + (at->s < 0.5 ? aside : -aside));
    if (moves(at, way, apart)) return 0;
    if (grain > COARSE) return 1;
    find_normal(at, apart);
    const double there = speed_of_normal(at, at->q, at->t);
    const double first = speed_of_normal(at, way->a, way->ta);
    const double last = speed_of_normal(at, way->b, way->tb);
    return there > 0.0 && there < LOST * fmax(first, last);
}

/* What round-off of the coordinate that is moved most by its size is at the place, of the way. */
static double grain_at(const dm_inertia_spot *at, const dm_chord *way) {
    double out = INFINITY;
    for (uint32_t i = 0; i < at->x->model->n - at->x->tangent; i++)
        if (way->a[i] != way->b[i])
            out = fmin(out, DBL_EPSILON * fabs(at->q[i] / (way->b[i] - way->a[i])));
    return out;
}

/* A motion comes so near to the place that round-off decides on which side of it a state is: is it
 * that near? */
static int is_at_pole(dm_inertia_spot *at, const dm_chord *way, double grain) {
    double ends[2];
    at->from = -BESIDE * grain, at->to = 1.0 - at->from, at->none = 0.0;
    for (int k = 0; k < 2; k++) {
        dm_inertia_put_on(at, way, k ? at->to : at->from);
        ends[k] = dm_inertia_value_at(at, at->q, at->t);
    }
    return dm_inertia_least_on(at, way) < NEAR * fmin(ends[0], ends[1]);
}

/* The way over an end of it. */
static double times_moved(const dm_inertia *x, const dm_chord *way, const double *end) {
    double size = 0.0, moved = 0.0;
    for (uint32_t i = 0; i < x->model->n - x->tangent; i++) {
        size = fmax(size, fabs(end[i]));
        moved = fmax(moved, fabs(way->b[i] - way->a[i]));
    }
    return size > 0.0 ? moved / size : 1.0;
}

/* The part of the way that may have a pole: all of it where the middle has more than an end, and
 * where a step may have been thrown far what lies before the end that is nearer to it, by how
 * steeply M grows there. 0: none. */
static int find_part(dm_inertia_spot *at, const dm_chord *way, double first, double last) {
    const double most = fmax(first, last), least = fmin(first, last);
    at->from = 0.0, at->to = 1.0;
    if (!(isfinite(first) && isfinite(last))) return 0;
    if (DM_INERTIA_VALLEY * at->x->middle[at->block] > least) return 1;
    if (!(most > DM_INERTIA_THROWN * least)) return 0;
    const double step = STEP / fmax(1.0, times_moved(at->x, way, first > last ? way->a : way->b));
    dm_inertia_put_on(at, way, first > last ? step : 1.0 - step);
    const double rise = log(dm_inertia_value_at(at, at->q, at->t) / most) / step;
    if (!(rise > STEEP)) return 0;
    const double part = fmin(1.0, HIGHEST / rise);
    if (first > last)
        at->to = part;
    else
        at->from = 1.0 - part;
    return 1;
}

int dm_inertia_has_pole(dm_inertia_spot *at, const dm_chord *way) {
    const double first = at->x->first[at->block], last = at->x->last[at->block];
    const double most = fmax(first, last);
    int out = find_part(at, way, first, last);
    if (out) {
        at->inverse = 1;
        at->none = DM_INERTIA_NONE * DM_INERTIA_NONE / most;
        const double found = dm_inertia_least_on(at, way) * most, grain = grain_at(at, way);
        out = found <= fmin(NEAR, fmax(DM_INERTIA_NONE, NONE_GRAINS * grain)) &&
              is_closed(at, way, grain);
        if (!out && grain * LEAST_GRAINS > 1.0) out = is_at_pole(at, way, grain);
    }
    at->inverse = 0, at->from = 0.0, at->to = 1.0;
    return out;
}
