#include "run/events.h"

#include "run/interpolate.h"

#include <math.h>
#include <string.h>

/* Three numbers for each function, two states. */
size_t dm_events_size(uint32_t count, uint32_t n) {
    return 3 * (size_t)count + 2 * dm_state_size(n);
}

void dm_events_lay_out(dm_events *e, double *memory, uint32_t n) {
    const uint32_t count = e->observer->count;
    e->before = memory;
    e->here = e->before + count;
    e->time = e->here + count;
    e->start = e->time + count;
    e->place = e->start + dm_state_size(n);
}

/* What the first step compares with. */
dm_status dm_events_begin(dm_events *e, const double *state, double t, double h) {
    e->h = h;
    return dm_observe(e->observer, e->before, state, t);
}

/* g_i is no number at time t */
static dm_status miss(dm_events *e, uint32_t i, double t) {
    e->observer->missing = i + 1, e->observer->missed = t;
    return DM_NO_VALUE;
}

/* g_i of the state at time t between `from` and the end of the step; the state is left in
 * e->place */
static dm_status value(dm_events *e, dm_stepper *s, uint32_t i, double *g, double from, double t) {
    dm_status status = dm_interpolate(s, e->place, e->start, from, t, e->h);
    if (status == DM_OK) status = dm_observe(e->observer, e->here, e->place, t);
    *g = e->here[i];
    return status == DM_OK && isnan(*g) ? miss(e, i, t) : status;
}

/* an interval with a change of sign */
typedef struct {
    double a, ga, b, gb;
} bracket;

/* regula falsi, weighted against a standing end (Anderson & Bjoerck 1973), bisection where that
 * is slow */
static double next_guess(const bracket *k, int tries) {
    const double middle = 0.5 * (k->a + k->b);
    const double t = k->b - k->gb * (k->b - k->a) / (k->gb - k->ga);
    return tries % 4 != 3 && t > fmin(k->a, k->b) && t < fmax(k->a, k->b) ? t : middle;
}

/* The standing end loses weight, so that both ends come near. */
static void narrow(bracket *k, double t, double g) {
    if ((g < 0.0) != (k->gb < 0.0)) {
        k->a = k->b, k->ga = k->gb;
    } else {
        const double weight = 1.0 - g / k->gb;
        k->ga *= weight > 0.0 ? weight : 0.5;
    }
    k->b = t, k->gb = g;
}

/* Does g fall off from its change of sign at t, as from a pole, and not grow, as from a zero? Seen
 * on the longer side, at distances of which one is 64 times the other. */
static dm_status falls_off(dm_events *e, dm_stepper *s, uint32_t i, double from, double to,
                           double t, double close, int *yes) {
    const double way = fabs(t - from) > fabs(to - t) ? from - t : to - t;
    const double far = copysign(fmin(4096.0 * close, 0.5 * fabs(way)), way);
    double beyond = 0.0, near = 0.0;
    dm_status status = value(e, s, i, &beyond, from, t + far);
    if (status == DM_OK) status = value(e, s, i, &near, from, t + far / 64.0);
    *yes = status == DM_OK && fabs(near) > 2.0 * fabs(beyond);
    return status;
}

/* A change of sign at which g is far beyond the ends of the step may be a pole. */
static int may_be_pole(double before, double after, double there) {
    static const double FAR = 16.0;
    return fabs(there) > FAR * fmax(fabs(before), fabs(after));
}

/* time of the zero of g_i, which changes its sign between `from` and `to`; infinite: it has none,
 * but a pole */
static dm_status locate(dm_events *e, dm_stepper *s, uint32_t i, double from, double to,
                        double g_to) {
    enum { TRIES = 200 };
    bracket k = {.a = from, .ga = e->before[i], .b = to, .gb = g_to};
    const double close = 4e-16 * fmax(fabs(from), fabs(to));
    double last = 0.0;
    int pole = 0;
    for (int tries = 0; tries < TRIES && k.gb != 0.0; tries++) {
        double g;
        const double t = next_guess(&k, tries);
        if (fabs(k.b - k.a) <= close || t == k.a || t == k.b) break;
        const dm_status status = value(e, s, i, &g, from, t);
        if (status != DM_OK) return status;
        narrow(&k, t, g);
        last = g;
    }
    if (may_be_pole(e->before[i], g_to, last)) {
        const dm_status status = falls_off(e, s, i, from, to, k.b, close, &pole);
        if (status != DM_OK || pole) return status;
    }
    /* the end behind the zero: a run that goes on from there does not meet it again */
    e->time[i] = k.gb == 0.0 || (k.gb < 0.0) == (g_to < 0.0) ? k.b : k.a;
    return DM_OK;
}

/* a zero at the start of a step was found in the step before */
static int changes(const dm_event *event, double before, double after) {
    const int rises = before < 0.0 && after >= 0.0, falls = before > 0.0 && after <= 0.0;
    return (rises && event->direction >= 0) || (falls && event->direction <= 0);
}

/* the earliest zero that is not told yet; count: none */
static uint32_t earliest(const dm_events *e) {
    const uint32_t count = e->observer->count;
    uint32_t first = count;
    for (uint32_t i = 0; i < count; i++)
        if (isfinite(e->time[i]) && (first == count || e->time[i] < e->time[first])) first = i;
    return first;
}

/* tell the zeros in the order of time, up to one that ends the run */
static dm_status tell(dm_events *e, dm_stepper *s, double *state, double from) {
    const size_t size = dm_state_size(s->model->n) * sizeof *state;
    for (uint32_t i; (i = earliest(e)) < e->observer->count; e->time[i] = INFINITY) {
        dm_status status = dm_interpolate(s, e->place, e->start, from, e->time[i], e->h);
        if (status == DM_OK) status = e->found(e->ud, i, e->time[i], e->place);
        if (status != DM_OK) return status;
        if (!e->list[i].stop) continue;
        e->ended = 1, e->end = e->time[i];
        memcpy(state, e->place, size);
        return DM_OK;
    }
    return DM_OK;
}

/* All functions are looked at before any zero is told: a zero that ends the run must be the
 * earliest. */
dm_status dm_events_look(dm_events *e, dm_stepper *s, double *state, double from, double to) {
    const uint32_t count = e->observer->count;
    int some = 0;
    dm_status status = dm_observe(e->observer, e->here, state, to);
    if (status != DM_OK) return status;
    /* `here` is used for other times below: keep what belongs to the end of the step in `time` */
    memcpy(e->time, e->here, count * sizeof *e->time);
    for (uint32_t i = 0; i < count; i++) {
        const double before = e->before[i], after = e->time[i];
        if (isnan(after)) return miss(e, i, to);
        const int seen = changes(e->list + i, before, after);
        e->time[i] = INFINITY;
        if (seen) status = locate(e, s, i, from, to, after), some = 1;
        if (status != DM_OK) return status;
        e->before[i] = after;
    }
    return some ? tell(e, s, state, from) : DM_OK;
}
