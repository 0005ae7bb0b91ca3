/* inertia_line.c - values of d2L/dv2 along a line. */
#include "run/inertia/inertia_line.h"
#include "linalg/signature.h"
#include "mech/group.h"
#include "run/inertia/inertia_values.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { TRIES = 200 }; /* of the golden section, to round-off of an end that is very near */

dm_inertia_spot dm_inertia_spot_in(const dm_inertia *x, const double *v, double *room) {
    const uint32_t n = x->model->n;
    dm_inertia_spot at = {.x = x, .v = v, .q = room, .lost = room + n, .to = 1.0};
    at.there = at.lost + n, at.tried = at.there + n, at.normal = at.tried + n;
    return at;
}

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
 * be smaller ones than the one that vanishes. Less than rounding is zero; what grows without bound
 * rounds the others away (`inverse`). */
static double value_found(const dm_inertia_spot *at, uint32_t b) {
    static const double ROUNDING = 16 * DBL_EPSILON;
    const dm_inertia *x = at->x;
    dm_inertia_value found;
    if (dm_inertia_is_far(x, b, &found)) return found.all;
    const dm_inertia_form f = dm_inertia_place(x, b);
    const double across = f.rows ? largest_of(f.A, f.n, 1) : 0.0;
    const size_t n = f.rows ? dm_restrict(f.A, f.n, f.G, f.rows, f.border) : f.n;
    dm_inertia_negative_in(&f, (uint32_t)n, &found);
    if (at->inverse) return found.all;
    const double beside = found.least > DM_INERTIA_FAR ? 0.0 : largest_of(f.copy, n, 0);
    return found.least <= ROUNDING * fmax(across, beside) ? 0.0 : found.all;
}

/* Of the inverse, where that is asked for. */
static double value_of(const dm_inertia_spot *at, uint32_t b) {
    const double value = value_found(at, b);
    return at->inverse ? 1.0 / value : value;
}

/* The largest of it for velocities v, 0 and -v, of blocks from b on: of a place that has none for
 * any. Where v is not in the domain of L, as a speed limit that depends on q, it says nothing; NaN:
 * none of them is. */
static void find_values(const dm_inertia_spot *at, const double *q, double t, uint32_t b,
                        uint32_t count, double *out) {
    if (!at->v) {
        dm_inertia_find(at->x, q, q, t);
        for (uint32_t k = 0; k < count; k++) out[k] = value_of(at, b + k);
        return;
    }
    for (uint32_t k = 0; k < count; k++) out[k] = NAN;
    for (int side = -1; side < 2; side++) {
        for (uint32_t i = 0; i < at->x->model->n; i++) at->tried[i] = side * at->v[i];
        dm_inertia_find(at->x, q, at->tried, t);
        for (uint32_t k = 0; k < count; k++) {
            const double value = value_of(at, b + k);
            if (isfinite(value) && !(value <= out[k])) out[k] = value;
        }
    }
}

/* Of the block of the place. */
double dm_inertia_value_at(const dm_inertia_spot *at, const double *q, double t) {
    double out;
    find_values(at, q, t, at->block, 1, &out);
    return out;
}

/* On the chord, at s. */
void dm_inertia_put_on(dm_inertia_spot *at, const dm_chord *c, double s) {
    for (uint32_t i = 0; i < at->x->model->n; i++) at->q[i] = c->a[i] + s * (c->b[i] - c->a[i]);
    at->t = c->ta + s * (c->tb - c->ta), at->s = s;
}

/* The value there, where the place is put. */
static double value_on(dm_inertia_spot *at, const dm_chord *c, double s) {
    dm_inertia_put_on(at, c, s);
    return dm_inertia_value_at(at, at->q, at->t);
}

/* Those of all blocks there. */
void dm_inertia_find_on(dm_inertia_spot *at, const dm_chord *c, double s, double *out) {
    dm_inertia_put_on(at, c, s);
    find_values(at, at->q, at->t, 0, at->x->blocks.count, out);
}

/* The least of it, or one that is small enough, by the golden section, and its place. */
double dm_inertia_least_on(dm_inertia_spot *at, const dm_chord *c) {
    const double golden = 0.5 * (sqrt(5.0) - 1.0);
    double lo = at->from, hi = at->to, s = hi - golden * (hi - lo), z = lo + golden * (hi - lo);
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

/* The kernel of the end of a step on a group; NULL: there is none. */
static const dm_kernel *finish_of(const dm_group *g) {
    return g->finish.eval ? &g->finish : g->joints.finish.eval ? &g->joints.finish : NULL;
}

/* A body velocity w[d] as a change of coordinates, at the place. */
void dm_inertia_carry(dm_inertia_spot *at, const double *w) {
    const dm_group *g = at->x->model->group;
    const dm_kernel *k = finish_of(g);
    const size_t n = at->x->model->n, d = g->momenta;
    double *in = at->x->room, *out = in + n + 2 * d, largest = 0.0;
    for (size_t i = 0; i < d; i++) largest = fmax(largest, fabs(w[i]));
    memcpy(at->there, w, d * sizeof *w);
    memcpy(in, at->q, n * sizeof *in);
    memset(in + n + d, 0, d * sizeof *in);
    for (int side = -1; side < 2; side += 2) {
        for (size_t i = 0; i < d; i++) in[n + i] = side * DM_INERTIA_SHORT / largest * at->there[i];
        dm_kernel_prepare(k, out);
        dm_kernel_eval(k, in, out);
        for (size_t i = 0; i < n; i++) at->lost[i] = side > 0 ? out[i] - at->lost[i] : out[i];
    }
}

/* In coordinates whose differences are velocities, or on a group that can be stepped. */
int dm_inertia_can_carry(const dm_inertia *x) {
    const dm_group *g = x->model->group;
    return !g || finish_of(g);
}
