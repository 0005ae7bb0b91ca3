#include "run/control.h"

#include <math.h>
#include <string.h>

static const double SHORTEST = 4e-15; /* of the time that is left, or of t */
static const double SAFETY = 0.9, SHRINK = 0.2, GROW = 4.0;
/* Shortest steps in a row that are taken although their error, over the largest |y_i|, is above the
 * tolerance, if it is small: they cross a jump of the forces, other than a singularity. */
enum { FORCED = 64 };
static const double SMALL = 1e-11;

/* the step whole, its halves, the state in the middle, the largest |y_i| so far */
typedef struct {
    double *whole, *halves, *middle, *size;
} rooms;

/* Three states and the sizes of q and p. */
size_t dm_control_room(uint32_t n) {
    return 3 * dm_state_size(n) + 2 * (size_t)n;
}

/* what lies where in c->room */
static rooms open(const dm_control *c, uint32_t n) {
    double *x = c->room;
    const size_t size = dm_state_size(n);
    return (rooms){x, x + size, x + 2 * size, x + 3 * size};
}

const double *dm_control_middle(const dm_control *c, uint32_t n) {
    return open(c, n).middle;
}

/* y = (q, p) is met */
static void note_size(double *size, const double *y, uint32_t n) {
    for (uint32_t i = 0; i < 2 * n; i++) size[i] = fmax(size[i], fabs(y[i]));
}

/* Sizes are those of the start, which may be zero: they grow as steps are made. */
void dm_control_begin(dm_control *c, const dm_stepper *s, const double *state, double t, double h) {
    const uint32_t n = s->model->n;
    rooms r = open(c, n);
    memset(r.size, 0, 2 * (size_t)n * sizeof(double));
    note_size(r.size, state, n);
    c->t = t, c->h = h, c->passed = c->forced = c->rejected = c->unseen = 0;
    c->place = NAN;
}

/* the largest entry of y[n] */
static double largest(const double *y, uint32_t n) {
    double out = 0.0;
    for (uint32_t i = 0; i < n; i++) out = fmax(out, y[i]);
    return out;
}

/* error of the halves in parts of the tolerance, by the order p: the whole one errs by 2^p as
 * much */
static double error_of(const dm_control *c, const rooms *r, uint32_t n, int order) {
    const double least[2] = {1e-6 * largest(r->size, n), 1e-6 * largest(r->size + n, n)};
    double worst = 0.0;
    for (uint32_t i = 0; i < 2 * n; i++) {
        const double size = fmax(fmax(r->size[i], fabs(r->halves[i])), least[i >= n]);
        const double d = fabs(r->whole[i] - r->halves[i]);
        if (d > 0.0) worst = fmax(worst, d / size);
        if (!isfinite(d)) return INFINITY;
    }
    return worst / (ldexp(1.0, order) - 1.0) / c->tolerance;
}

/* a step of h from `from` to `to`, which takes up nothing of the steps before */
static dm_status step(dm_stepper *s, double *to, const double *from, double t, double h) {
    const size_t size = dm_state_size(s->model->n), pair = 2 * (size_t)s->model->n;
    memcpy(to, from, size * sizeof *to);
    dm_status status = dm_stepper_start(s, to, t, h);
    memcpy(to + pair, from + pair, (size - pair) * sizeof *to);
    if (status == DM_OK) status = s->engine->step(s, to, t, h);
    return status == DM_OK && !dm_state_is_finite(to, s->model->n) ? DM_NOT_FINITE : status;
}

/* whole and in halves */
static dm_status try_step(const rooms *r, dm_stepper *s, const double *state, double t, double h) {
    const double half = 0.5 * h;
    dm_status status = step(s, r->whole, state, t, h);
    if (status == DM_OK) status = step(s, r->middle, state, t, half);
    if (status == DM_OK) status = step(s, r->halves, r->middle, t + half, half);
    return status;
}

/* not over the end of the run, nor over the next time at which a step ends; what would be left of
 * either is no step */
static double fitting(dm_control *c) {
    double h = fmin(c->h, c->largest), next = c->reach;
    while (c->passed < c->end_count && c->ends[c->passed] <= c->t) c->passed++;
    if (c->passed < c->end_count) next = fmin(next, c->ends[c->passed]);
    const double left = next - c->t;
    if (!(left > 0.0)) return h; /* the run is over, but a step was asked for */
    return h > 0.999 * left ? left : h > 0.5 * left ? 0.5 * left : h;
}

/* Where does something begin that the step has not seen? NaN: nowhere */
static double unseen(const dm_control *c, const rooms *r, const dm_stepper *s, const double *state,
                     double h) {
    const uint32_t n = s->model->n;
    double where = NAN;
    if (!c->hidden) return where;
    const double *p[3] = {state + n, r->middle + n, r->halves + n};
    const double *q[3] = {state, r->middle, r->halves};
    double position = largest(r->size, n), momentum = largest(r->size + n, n);
    for (uint32_t i = 0; i < n; i++) {
        position = fmax(position, fmax(fabs(q[1][i]), fabs(q[2][i])));
        momentum = fmax(momentum, fmax(fabs(p[1][i]), fabs(p[2][i])));
    }
    const dm_swept swept = {.t = c->t,
                            .h = h,
                            .q = {q[0], q[1], q[2]},
                            .p = {p[0], p[1], p[2]},
                            .position = position,
                            .momentum = momentum};
    dm_hidden_nothing(c->hidden, &swept, &where);
    return where;
}

/* Is the error of a step that cannot be shorter that of a jump of the forces? From rest, where
 * nothing has a size yet, it is small beside 1. */
static int crosses_jump(const rooms *r, uint32_t n) {
    for (uint32_t i = 0; i < 2 * n; i++)
        if (!(fabs(r->whole[i] - r->halves[i]) <= SMALL * (1.0 + r->size[i]))) return 0;
    return 1;
}

/* the step was made: by its error, how long the next one may be */
static void accept(dm_control *c, const rooms *r, const dm_stepper *s, double *state, double h,
                   double factor) {
    memcpy(state, r->halves, dm_state_size(s->model->n) * sizeof *state);
    note_size(r->size, state, s->model->n);
    c->half = c->t + 0.5 * h;
    c->t = fabs(c->t + h - c->reach) <= SHORTEST * fabs(c->reach) ? c->reach : c->t + h;
    if (c->passed < c->end_count && fabs(c->t - c->ends[c->passed]) <= SHORTEST * fabs(c->t))
        c->t = c->ends[c->passed];
    c->h = h == c->h || factor < 1.0 ? h * factor : fmax(c->h, h * factor);
}

dm_status dm_control_step(dm_control *c, dm_stepper *s, double *state) {
    const int order = dm_rule_order(s->rule) > 0 ? dm_rule_order(s->rule) : 1;
    const rooms r = open(c, s->model->n);
    const double shortest = SHORTEST * fmax(fabs(c->t), fabs(c->reach - c->t));
    for (double h = fitting(c);; c->rejected++) {
        const int last = h <= shortest;
        const dm_status status = try_step(&r, s, state, c->t, h);
        const double err = status == DM_OK ? error_of(c, &r, s->model->n, order) : INFINITY;
        const double better = SAFETY * pow(err, -1.0 / (order + 1));
        const double where = err <= 1.0 ? unseen(c, &r, s, state, h) : NAN;
        if (last && status != DM_OK) return status;
        if (last && (!crosses_jump(&r, s->model->n) || ++c->forced > FORCED)) {
            c->place = where;
            return DM_TOO_SHORT;
        }
        if (last || (err <= 1.0 && isnan(where))) {
            if (!last) c->forced = 0;
            accept(c, &r, s, state, h, fmin(GROW, fmax(SHRINK, better)));
            return DM_OK;
        }
        c->unseen += err <= 1.0;
        const double before = where - c->t; /* the step that ends where the unseen begins */
        h = err > 1.0           ? h * fmin(0.8, fmax(SHRINK, better))
            : before > h / 16.0 ? before * (1.0 - 1e-9)
                                : h / 8.0;
        h = c->h = fmax(h, shortest);
    }
}
