/* inertia_step.c - does d2L/dv2 lose a value inside a step and have it again at its end, unseen by
 * looks at states, as in a dip that is narrower than the step? Not where M cannot bend so much:
 * between two states M leaves the line through theirs by h^2/8 times its second derivative at most,
 * which is enclosed in interval arithmetic, first for any state, then for boxes around the motion.
 * Where that does not tell, M itself is enclosed along the step. */
#include "linalg/lu.h"
#include "mech/mass_bounds.h"
#include "run/inertia/inertia.h"

#include <math.h>
#include <string.h>

/* Of the least value, what M may bend inside a step. */
static const double SLIGHT = 0.25;
/* Of the least value, what M may move at speeds that are counted on until the next look: half of
 * that at the present one. */
static const double MOVED = 1.5;
/* Steps that regions are made for, and by what the next one is longer or shorter; where none can be
 * made so many steps are looked into one by one. */
enum { FIRST = 64, LEAST = 4, WIDEST = 4096, WIDER = 8, NARROWER = 4, WAIT = 6 };
/* Nodes whose bounds may be found in a run: more of them, one every twenty steps, cost 12 % of the
 * steps of a satellite in angles, and found nothing more. */
static const double CREDIT = 2000.0;
enum { PASSES = 3 }; /* over the nodes of a region */
/* Speeds up to this multiple of the present one are counted on. */
static const double FASTER = 2.0;
enum { FINEST = 1 << 12 }; /* parts of a step into which it is cut at most */
enum { TOUCH = 80 };       /* values of M that a look for a touch takes */

/* What lies where in x->boxes. */
typedef struct {
    dm_interval *in, *rate_in, *box, *nodes; /* [inputs], [inputs], [n], [3 size] */
    double (*curve)[4];                      /* [n]: q(s) = sum_k curve[k] s^k along a step */
    double *velocity;                        /* [n] */
    double *ends, *place;                    /* [4n], [5n] */
    double *centre, *inverse, *radius;       /* [n*n] */
    uint32_t *pivot;                         /* [n] */
} rooms;

size_t dm_inertia_boxes(const dm_model *m) {
    const dm_mass_bounds *b = m->mass_bounds;
    const size_t n = m->n;
    return b ? 4 * (size_t)b->inputs + 6 * (size_t)b->size + 17 * n + 3 * n * n : 0;
}

static rooms open(const dm_inertia *x) {
    const dm_mass_bounds *b = x->model->mass_bounds;
    const size_t n = x->model->n;
    rooms r = {.in = (dm_interval *)(void *)x->boxes};
    r.rate_in = r.in + b->inputs;
    r.box = r.rate_in + b->inputs;
    r.nodes = r.box + n;
    r.curve = (double(*)[4])(void *)(r.nodes + 3 * (size_t)b->size);
    r.velocity = (double *)(void *)(r.curve + n);
    r.ends = r.velocity + n, r.place = r.ends + 4 * n;
    r.centre = r.place + 5 * n;
    r.inverse = r.centre + n * n;
    r.radius = r.inverse + n * n;
    r.pivot = (uint32_t *)(void *)(r.radius + n * n);
    return r;
}

/* the largest row sum of |S A S|, A[n*n], S the scales */
static double size_of(const dm_inertia *x, const double *A) {
    const uint32_t n = x->model->n;
    double out = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        double sum = 0.0;
        for (uint32_t j = 0; j < n; j++) sum += A[i * n + j] * x->scale[j];
        out = fmax(out, sum * x->scale[i]);
    }
    return isnan(out) ? INFINITY : out;
}

void dm_inertia_expect(dm_inertia *x) {
    const dm_mass_bounds *b = x->model->mass_bounds;
    dm_inertia_seen *s = &x->seen;
    double longest = 0.0;
    s->wide = FIRST, s->wait = 0, s->credit = CREDIT;
    s->anywhere = s->bend = s->shift_anywhere = s->shift = INFINITY;
    if (!b || b->timed) return;
    for (uint32_t i = 0; i < b->n; i++) longest = fmax(longest, x->scale[i]);
    s->anywhere = size_of(x, b->bend) * longest * longest;
    s->shift_anywhere = size_of(x, b->shift) * longest;
}

/* Is a second derivative by time too small to matter within a step of h? */
static int is_slight(const dm_inertia *x, double bend, double h) {
    return bend * h * h / 8.0 <= SLIGHT * x->seen.least;
}

/* ---- regions ---- */

/* Steps of h at that speed until a state can leave the region; 0: it is outside, or too fast. */
static double steps_inside(const dm_inertia *x, const double *q, double t, double h, double speed) {
    const uint32_t n = x->model->n;
    const dm_inertia_seen *s = &x->seen;
    if (!is_slight(x, s->bend, h) || !(speed <= s->speed)) return 0.0;
    double out = x->model->mass_bounds->timed ? (s->until - t) / h : WIDEST;
    for (uint32_t i = 0; i < n; i++) {
        const double room = fmin(q[i] - x->region[i], x->region[n + i] - q[i]);
        if (!(room >= 0.0)) return 0.0;
        out = fmin(out, room / (fabs(h) * speed * x->scale[i]));
    }
    return out;
}

/* A box that so many steps stay in, as the region; is M nearly straight in there? */
static int enclose(dm_inertia *x, const double *q, double t, double h, double speed, long steps) {
    const dm_mass_bounds *b = x->model->mass_bounds;
    const rooms r = open(x);
    const uint32_t n = b->n;
    const double end = t + (double)steps * h, reach = FASTER * (double)steps * fabs(h) * speed;
    for (uint32_t i = 0; i < b->inputs; i++) {
        r.in[i] = (dm_interval)DM_ANYWHERE;
        r.rate_in[i] = (dm_interval){0.0, 0.0};
    }
    for (uint32_t i = 0; i < n; i++) {
        const double rate = FASTER * speed * x->scale[i];
        r.in[i] = (dm_interval){q[i] - reach * x->scale[i], q[i] + reach * x->scale[i]};
        r.rate_in[i] = (dm_interval){-rate, rate};
        x->region[i] = r.in[i].lo, x->region[n + i] = r.in[i].hi;
    }
    r.in[2 * n] = (dm_interval){fmin(t, end), fmax(t, end)};
    r.rate_in[2 * n] = (dm_interval){1.0, 1.0};
    dm_mass_bounds_bend(b, r.in, r.rate_in, r.centre, r.radius, r.nodes);
    x->seen.bend = size_of(x, r.radius);
    x->seen.shift = size_of(x, r.centre);
    x->seen.speed = FASTER * speed, x->seen.until = end;
    x->seen.credit -= PASSES * (double)b->size;
    return is_slight(x, x->seen.bend, h);
}

/* A region around a state: the steps that it is made for, 0 where there is none. */
static long find_region(dm_inertia *x, const double *q, double t, double h, double speed) {
    dm_inertia_seen *s = &x->seen;
    for (long steps = s->wide; steps >= LEAST && s->credit > 0.0; steps /= NARROWER) {
        s->wide = steps;
        if (!enclose(x, q, t, h, speed, steps)) continue;
        s->wide = steps * WIDER < WIDEST ? steps * WIDER : WIDEST;
        return steps;
    }
    s->bend = INFINITY;
    s->wait = WAIT;
    return 0;
}

/* How fast values move there, in units of the scales; `surely`: by the velocity itself. */
static double speed_at(const dm_inertia *x, const double *state, double t, int surely) {
    const uint32_t n = x->model->n;
    const double *p = state + n, *v = surely ? dm_inertia_velocity(x, state, t) : p;
    double out = 0.0, squares = 0.0;
    for (uint32_t i = 0; i < n && v; i++) {
        out = fmax(out, fabs(v[i]) / x->scale[i]);
        squares += p[i] * x->scale[i] * (p[i] * x->scale[i]);
    }
    return !v ? INFINITY : surely ? out : sqrt(squares) / x->seen.least;
}

/* Steps from here that hide nothing; infinite: all. */
static double safe_steps(dm_inertia *x, const double *state, double t, double h, int surely) {
    const double speed = speed_at(x, state, t, surely);
    if (is_slight(x, x->seen.anywhere * speed * speed, FASTER * h)) return INFINITY;
    const double inside = steps_inside(x, state, t, h, speed);
    if (inside >= 1.0 || !surely || --x->seen.wait > 0) return inside;
    return (double)find_region(x, state, t, h, speed);
}

/* Steps from here in which no value can fall to zero and rise again, all of them between looks;
 * infinite: no bound is known. */
static double short_steps(dm_inertia *x, const double *state, double t, double h, int surely) {
    const dm_inertia_seen *s = &x->seen;
    const double speed = speed_at(x, state, t, surely);
    const int inside = steps_inside(x, state, t, h, speed) >= 1.0;
    const double anywhere = s->shift_anywhere * FASTER * speed;
    const double rate = inside ? fmin(s->shift, anywhere) : anywhere;
    return rate < INFINITY ? MOVED * s->least / (rate * fabs(h)) : INFINITY;
}

void dm_inertia_foresee(dm_inertia *x, const double *state, double t, long done) {
    const dm_mass_bounds *b = x->model->mass_bounds;
    dm_inertia_seen *s = &x->seen;
    const double h = s->h;
    s->open = s->told = 0;
    if (!b || !(s->least > 0.0)) return;
    double steps = b->shifted ? 0.0 : safe_steps(x, state, t, h, 0);
    if (steps < 1.0) steps = safe_steps(x, state, t, h, 1);
    if (steps < 1.0 && s->credit <= 0.0) return; /* too dear for this run */
    s->open = steps < 1.0, s->told = 1;
    if (x->own) s->due = done + 1; /* the step behind that may be longer */
    const long least = steps < 1.0 ? 1 : steps < WIDEST ? (long)steps : WIDEST;
    if (steps < INFINITY && s->due > done + least) s->due = done + least;
    for (int surely = b->shifted; surely < 2 && s->due > done + 1; surely++) {
        const double few = short_steps(x, state, t, h, surely);
        if (few >= (double)(s->due - done)) return;
        if (surely) s->due = done + (few < 1.0 ? 1 : (long)few);
    }
}

/* ---- one step ---- */

/* Ways between two states: the line, the cubic through q and v at both ends where these are known,
 * and where the first velocity leads alone. */
enum { LINE, CUBIC, FLIGHT, WAYS };

static void find_curve(dm_inertia *x, const rooms *r, const double *from, double t0,
                       const double *to, double t1, int way) {
    const uint32_t n = x->model->n;
    const double h = t1 - t0;
    const double *v = way == LINE ? NULL : dm_inertia_velocity(x, from, t0);
    if (v) memcpy(r->velocity, v, n * sizeof *v);
    if (v && way == CUBIC) v = dm_inertia_velocity(x, to, t1);
    for (uint32_t i = 0; i < n; i++) {
        double *k = r->curve[i];
        const double there = to[i] - from[i];
        k[0] = from[i], k[1] = there, k[2] = k[3] = 0.0;
        if (!v) continue;
        const double start = h * r->velocity[i], end = h * v[i];
        k[1] = start;
        if (way == CUBIC) k[2] = 3.0 * there - 2.0 * start - end, k[3] = start + end - 2.0 * there;
    }
}

/* The curve at s. */
static double curve_at(const double k[4], double s) {
    return k[0] + s * (k[1] + s * (k[2] + s * k[3]));
}

/* What it can be up to d away from there. */
static dm_interval curve_near(const double k[4], double s, double d) {
    const double slope = k[1] + s * (2.0 * k[2] + 3.0 * s * k[3]), bend = k[2] + 3.0 * s * k[3];
    const double value = curve_at(k, s);
    const double reach = d * (fabs(slope) + d * (fabs(bend) + d * fabs(k[3])));
    return (dm_interval){value - reach, value + reach};
}

/* Is every matrix in the boxes regular? So if C times what they are off their centre, C its
 * inverse, has row sums below 1 (then 1 + C (M - centre) is regular). */
static int is_regular(dm_inertia *x, const rooms *r) {
    const dm_mass_bounds *b = x->model->mass_bounds;
    const uint32_t n = b->n;
    for (uint32_t i = 0; i < n * n; i++) {
        const dm_interval m = r->nodes[b->roots[i]];
        const double scale = x->scale[i / n] * x->scale[i % n];
        r->centre[i] = 0.5 * (m.lo + m.hi) * scale;
        r->radius[i] = 0.5 * (m.hi - m.lo) * scale;
        if (!isfinite(r->centre[i])) return 0;
    }
    if (dm_lu_inverse(r->inverse, r->centre, r->pivot, r->velocity, n) != DM_OK) return 0;
    for (uint32_t i = 0; i < n; i++) {
        double sum = 0.0;
        for (uint32_t k = 0; k < n; k++)
            for (uint32_t j = 0; j < n; j++)
                sum += fabs(r->inverse[i * n + k]) * r->radius[k * n + j];
        if (!(sum < 1.0 - 1e-9)) return 0;
    }
    return 1;
}

/* Is M regular anywhere in the box of coordinates r->box and between these times? */
static int is_clear_in(dm_inertia *x, const rooms *r, double t0, double t1) {
    const dm_mass_bounds *b = x->model->mass_bounds;
    for (uint32_t i = 0; i < b->inputs; i++) r->in[i] = (dm_interval)DM_ANYWHERE;
    memcpy(r->in, r->box, b->n * sizeof *r->in);
    r->in[2 * b->n] = (dm_interval){fmin(t0, t1), fmax(t0, t1)};
    dm_bounds(b->graph, r->in, r->nodes);
    x->seen.credit -= (double)b->size;
    return is_regular(x, r);
}

/* M along the curve while s is in [a, a + width] */
static int is_clear(dm_inertia *x, const rooms *r, double a, double width, double t0, double t1) {
    const double middle = a + 0.5 * width, h = t1 - t0;
    for (uint32_t i = 0; i < x->model->n; i++)
        r->box[i] = curve_near(r->curve[i], middle, 0.5 * width);
    return is_clear_in(x, r, t0 + a * h, t0 + (a + width) * h);
}

/* Is there another inertia at s? */
static int is_another(const dm_inertia *x, const rooms *r, double s, double t) {
    uint32_t negative;
    double least;
    for (uint32_t i = 0; i < x->model->n; i++) r->velocity[i] = curve_at(r->curve[i], s);
    return dm_inertia_at(x, r->velocity, t, &negative, &least) && negative != x->seen.negative;
}

/* Does a value touch zero while s is in [a, a + width], a box that bounds do not tell of? */
static int is_touched(dm_inertia *x, const rooms *r, double a, double width, double t0, double t1) {
    const uint32_t n = x->model->n;
    const double s[4] = {0.0, 1.0, a, a + width}, h = t1 - t0;
    for (uint32_t k = 0; k < 4; k++)
        for (uint32_t i = 0; i < n; i++) r->ends[k * n + i] = curve_at(r->curve[i], s[k]);
    const dm_chord way = {r->ends, r->ends + n, t0, t1, 0, 0};
    const dm_chord part = {way.b + n, way.b + 2 * (size_t)n, t0 + a * h, t0 + (a + width) * h, 0,
                           0};
    x->seen.credit -= TOUCH * (double)x->model->mass_bounds->size;
    return dm_inertia_touches(x, &part, &way, NULL, r->place);
}

/* Boxes along the curve, halved until they tell: is there another inertia on it, or none? */
static int changes_on_curve(dm_inertia *x, const rooms *r, double t0, double t1) {
    double a = 0.0, width = 1.0;
    while (a < 1.0 && x->seen.credit > 0.0) {
        const double middle = a + 0.5 * width;
        const int clear = is_clear(x, r, a, width, t0, t1);
        if (!clear && is_another(x, r, middle, t0 + middle * (t1 - t0))) return 1;
        if (!clear && width > 1.0 / FINEST) {
            width *= 0.5;
            continue;
        }
        if (!clear && is_touched(x, r, a, width, t0, t1)) return 1;
        a += width;
        while (width < 1.0 && fmod(a, 2.0 * width) == 0.0) width *= 2.0;
    }
    return 0;
}

/* Does a value touch zero on the line? That takes few values of M, boxes beside the place many. */
static int touches_line(dm_inertia *x, const rooms *r, const double *from, double t0,
                        const double *to, double t1) {
    static const double FEW = 4.0;
    const dm_chord way = {from, to, t0, t1, 0, 1};
    x->seen.credit -= FEW * (double)x->model->mass_bounds->size;
    return dm_inertia_touches(x, &way, &way, NULL, r->place);
}

/* Where both the line and the cubic go through the place, so does any motion between its sides.
 * Where one does, or the first velocity leads there, the rule may have been thrown back by it. */
int dm_inertia_hides(dm_inertia *x, const double *from, double t0, const double *to, double t1) {
    const rooms r = open(x);
    const uint32_t n = x->model->n;
    int changes[WAYS];
    for (int way = 0; way < WAYS; way++) {
        find_curve(x, &r, from, t0, to, t1, way);
        for (uint32_t i = 0; i < n; i++) {
            const dm_interval reach = curve_near(r.curve[i], 0.5, 0.5);
            r.box[i].lo = way ? fmin(r.box[i].lo, reach.lo) : reach.lo;
            r.box[i].hi = way ? fmax(r.box[i].hi, reach.hi) : reach.hi;
        }
    }
    if (is_clear_in(x, &r, t0, t1)) return 0; /* mostly */
    if (touches_line(x, &r, from, t0, to, t1)) return DM_INERTIA_HIDDEN;
    for (int way = 0; way < WAYS; way++) {
        find_curve(x, &r, from, t0, to, t1, way);
        changes[way] = changes_on_curve(x, &r, t0, t1);
    }
    if (changes[LINE] && changes[CUBIC]) return DM_INERTIA_HIDDEN;
    return changes[LINE] || changes[CUBIC] || changes[FLIGHT] ? DM_INERTIA_NEAR : 0;
}
