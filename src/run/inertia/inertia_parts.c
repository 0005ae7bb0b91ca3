/* inertia_parts.c - does d2L/dv2 lose a value inside a step that has the right inertia at both
 * ends? Where a mass M(q) goes to zero, M v^2 stays finite: v grows like 1/sqrt(M) and the place
 * is reached in no time, but a long step is thrown back by it or jumps over it. So a step before
 * which a value fell steeply is made again in parts, shorter ones as the value nears zero, and so
 * is an open one (inertia_step.c) with a place beside its way. */
#include "mech/group.h"
#include "run/inertia/inertia_look.h"

#include <math.h>
#include <string.h>

/* A part is at least so short a part of the step. What fails is passed by one of WIDEST such parts
 * or by none. */
enum { FINEST = 1 << 26, WIDEST = 16 };
/* Steps in which a place is met that has thrown back the end of one. */
enum { FARTHER = 3 };
/* Where M vanishes and M v^2 does not, v grows with this power of what a value has lost, or one
 * between these two. By less: the momentum vanishes there, too. By more, 1: coordinates have a pole
 * there, and a momentum that stays turns the motion back. Seen first after so large a loss. */
static const double LEAST_POWER = 0.25, MOST_POWER = 0.75, LOSS = 16.0;
/* of the sum of |p_i v_i|: less is no motion */
static const double MOVES = 1e-6;
/* What is left of the way to the place, over the part that comes next, at least. */
static const double NEXT = 3.0;

/* Parts of a step that is made again: where they are, in FINEST-ths of it, and what is there. */
typedef struct {
    dm_inertia *x;
    dm_stepper *s;
    double t, h;     /* of the step */
    int by_position; /* M is M(q) */
    double *state, *next, *memory, *velocity;
    int done, size, end; /* end: where parts end, FINEST but for more than a step */
    double first;        /* the value next to zero before the step */
    double least, ahead; /* what it is now, and FINEST-ths until it vanishes as it fell last */
} parts;

static double time_of(const parts *w) {
    return w->t + w->h * w->done / FINEST;
}

/* The memory of the engine, to or from a place. */
static void copy_memory(const parts *w, double *to, const double *from) {
    double *place;
    if (!w->x->memory_size) return;
    dm_stepper_memory(w->s, &place);
    memcpy(to ? to : place, from ? from : place, w->x->memory_size * sizeof *place);
}

/* A velocity to w->velocity; 0: none is known. */
static int find_velocity(const parts *w, const double *state, double t) {
    const double *v = dm_inertia_velocity(w->x, state, t);
    if (v) memcpy(w->velocity, v, w->x->model->n * sizeof *v);
    return v != NULL;
}

/* Entries of a velocity that are of the orbit: first ones, whose momenta are the last ones. */
static uint32_t velocities(const parts *w) {
    return dm_momenta(w->x->model) - w->x->tangent;
}

/* The largest difference from that one in the units of the start; infinite: none is known. */
static double difference(const parts *w, const double *state, double t) {
    const double *v = dm_inertia_velocity(w->x, state, t);
    double out = v ? 0.0 : INFINITY;
    for (uint32_t i = 0; v && i < velocities(w); i++)
        out = fmax(out, fabs((v[i] - w->velocity[i]) / w->x->scale[i]));
    return out;
}

/* One part from w->state to w->next: 0 where there is none, or no value at its end. */
static int make_part(parts *w, uint32_t *negative, double *least) {
    const double from = time_of(w), length = w->h * w->size / FINEST;
    memcpy(w->next, w->state, dm_state_size(w->x->model->n) * sizeof *w->next);
    return w->s->engine->step(w->s, w->next, from, length) == DM_OK &&
           dm_state_is_finite(w->next, w->x->model->n) &&
           dm_inertia_at(w->x, w->next, from + length, negative, least);
}

/* The shortest part ends at no value: is it at a fold, behind which there is no velocity, or one
 * far away? 0 where the velocity goes on, as that of L = v^4 does through zero; w->next is then a
 * state behind it. */
static int is_fold(parts *w, double *least) {
    uint32_t negative;
    while (w->size <= WIDEST && w->done + 2 * w->size <= w->end) {
        w->size *= 2;
        copy_memory(w, NULL, w->memory);
        if (!make_part(w, &negative, least)) continue;
        if (negative != w->x->seen.negative || !find_velocity(w, w->state, time_of(w))) return 1;
        return difference(w, w->next, time_of(w) + w->h * w->size / FINEST) >
               difference(w, w->x->state, w->t);
    }
    return 1;
}

/* sum of |p_i v_i| */
static double motion(const double *p, const double *v, size_t n) {
    double out = 0.0;
    for (size_t i = 0; i < n; i++) out += fabs(p[i] * v[i]);
    return out;
}

/* Size of velocity i since the step began: there, or on the way, if that counts. */
static double since_start(const parts *w, int on_way, uint32_t i) {
    const double gone = w->state[i] - w->x->state[i], took = time_of(w) - w->t;
    const double there = fabs(w->velocity[i]);
    const int counts = on_way && took != 0.0 && !w->x->model->group;
    return counts ? fmax(there, fabs(gone / took)) : there;
}

/* How much faster the velocity that grew most is than before, of those that move something now and
 * moved something then. */
static double growth(parts *w, int on_way) {
    const uint32_t n = velocities(w), first = w->x->model->n + w->x->tangent;
    const double *then = w->velocity, *p = w->state + first, *before = w->x->state + first;
    if (!find_velocity(w, w->x->state, w->t)) return 0.0;
    const double *v = dm_inertia_velocity(w->x, w->state, time_of(w));
    if (!v) return 0.0;
    const double some = MOVES * motion(p, v, n), once = MOVES * motion(before, then, n);
    double out = 0.0;
    for (uint32_t i = 0; i < n; i++)
        if (fabs(p[i] * v[i]) > some && fabs(before[i] * then[i]) > once)
            out = fmax(out, fabs(v[i] / since_start(w, on_way, i)));
    return out;
}

/* Do velocities grow as they do where M vanishes? Since they began the step, or, `on_way`, over
 * what they were in its course, too: one that passes zero at its start grows by any factor. */
static int grow_so(parts *w, int on_way) {
    const double loss = w->first / w->least, by = growth(w, on_way);
    return by > pow(loss, LEAST_POWER) && by < pow(loss, MOST_POWER);
}

/* A part of twice the size of the last one, if that does not reach too far. */
static void choose_size(parts *w) {
    if (w->size < FINEST / 2) w->size *= 2;
    while (w->size > 1 && w->size * NEXT > w->ahead) w->size /= 2;
    if (w->size > w->end - w->done) w->size = w->end - w->done;
}

/* The part that was made is behind; it leaves so many of its size. */
static void go_on(parts *w, double least, double left) {
    double *from = w->state;
    w->state = w->next, w->next = from;
    w->least = least, w->ahead = left * w->size;
    w->done += w->size;
    copy_memory(w, w->memory, NULL);
    choose_size(w);
}

/* From the kept state on. */
static int walk(parts *w) {
    choose_size(w);
    while (w->done < w->end) {
        uint32_t negative = 0;
        double least = 0.0;
        const int found = make_part(w, &negative, &least);
        if (found && negative != w->x->seen.negative) return 1;
        double left = dm_inertia_left(w->x, w->least, least, 1.0);
        const int near = !found || left <= DM_INERTIA_STEEP;
        if (near && w->size > 1) {
            w->size /= 2;
            copy_memory(w, NULL, w->memory);
            continue;
        }
        if (found && near && grow_so(w, 1)) return 1;
        if (!found && (w->done == 0 || w->ahead > DM_INERTIA_STEEP)) return 0;
        if (!found && is_fold(w, &least)) return 1;
        if (!found) left = INFINITY;
        const int seen = w->first > LOSS * w->least;
        go_on(w, least, left);
        if (!seen && w->first > LOSS * least && w->by_position && !grow_so(w, 1)) return 0;
    }
    return 0;
}

/* ---- an open step ---- */

enum { FIRST_PART = FINEST / 16, LAST_PART = 16 };
/* Nodes that parts may take, and what of them counts: places beside the way are rare. */
static const double OF_PARTS = 1e5, COUNTED = 1e3;

/* Does the part that was made go over a place? DM_INERTIA_NEAR: or comes near to one. */
static int part_hides(parts *w, int found, uint32_t negative) {
    const double from = time_of(w), length = w->h * w->size / FINEST;
    if (!found) return DM_INERTIA_NEAR;
    if (negative != w->x->seen.negative) return DM_INERTIA_HIDDEN;
    return dm_inertia_hides(w->x, w->state, from, w->next, from + length);
}

/* From the kept state on, shorter parts where one does not tell; the place is reached where the
 * shortest does not, either. */
static int walk_openly(parts *w) {
    const double credit = w->x->seen.credit;
    int hides = 0;
    w->x->seen.credit = OF_PARTS;
    for (w->size = FIRST_PART; w->done < FINEST && !hides && w->x->seen.credit > 0.0;) {
        uint32_t negative = 0;
        double least = 0.0;
        hides = part_hides(w, make_part(w, &negative, &least), negative);
        if (hides == DM_INERTIA_NEAR && w->size > LAST_PART) {
            w->size /= 2, hides = 0;
            copy_memory(w, NULL, w->memory);
            continue;
        }
        const int size = w->size < FIRST_PART ? 2 * w->size : FIRST_PART;
        go_on(w, least, INFINITY);
        w->size = size < FINEST - w->done ? size : FINEST - w->done;
    }
    w->x->seen.credit = credit - COUNTED;
    return hides;
}

/* Is the end of the step, `to`, beyond a place that the parts have not gone over, as far as they
 * came? A step that is too long for its rule may jump over what lies ahead of the motion. */
static int leaps(parts *w, const double *to) {
    const double end = w->t + w->h, credit = w->x->seen.credit;
    if (!w->x->model->mass_bounds) return 0;
    w->x->seen.credit = OF_PARTS;
    const int hides = dm_inertia_hides(w->x, w->state, end, to, end);
    w->x->seen.credit = credit;
    return hides == DM_INERTIA_HIDDEN;
}

/* Is the end of the step, `to`, not where its parts have come, which near a place behind it? A step
 * that is too long is thrown back by what lies ahead, or ends in another part of the way. Parts
 * that lost little go on to the place, since a step may be that far off without one. */
static int is_astray(parts *w, const double *to) {
    static const double OFF = 2.0; /* by what values differ */
    uint32_t negative;
    double least;
    if (w->done < FINEST || !dm_inertia_at(w->x, to, w->t + w->h, &negative, &least)) return 0;
    if (!(least > OFF * w->least || w->least > OFF * least) || !grow_so(w, 0)) return 0;
    if (w->first > LOSS * w->least) return 1;
    w->end = FARTHER * FINEST, w->size = FINEST / 16;
    return w->ahead < INFINITY && walk(w);
}

static parts begin(dm_inertia *x, dm_stepper *s, double t, double h) {
    const size_t size = dm_state_size(x->model->n), memory = x->memory_size;
    parts w = {.x = x,
               .s = s,
               .t = t,
               .h = h,
               .by_position = (x->model->structure & DM_QUADRATIC_IN_V) != 0,
               .size = FINEST / 2,
               .end = FINEST,
               .ahead = x->before * FINEST};
    w.state = x->aside, w.next = w.state + size, w.memory = w.next + size;
    w.velocity = x->room + x->model->n; /* is written before it is read */
    memcpy(w.state, x->state, size * sizeof *w.state);
    if (memory) memcpy(w.memory, x->memory, memory * sizeof *w.memory);
    copy_memory(&w, NULL, w.memory);
    return w;
}

/* by one of both ways; what the engine has of the step behind it is kept */
static int vanishes_in_parts(dm_inertia *x, dm_stepper *s, const double *to, double t, double h,
                             int (*way)(parts *)) {
    const size_t size = dm_state_size(x->model->n);
    const dm_report report = s->report;
    double *kept = x->aside + 2 * size + x->memory_size;
    uint32_t negative;
    const parts here = {.x = x, .s = s};
    copy_memory(&here, kept, NULL);
    parts w = begin(x, s, t, h);
    int out = dm_inertia_at(x, w.state, t, &negative, &w.first);
    w.least = w.first;
    out = out && (way(&w) || leaps(&w, to) || is_astray(&w, to));
    copy_memory(&w, NULL, kept);
    s->report = report;
    return out;
}

int dm_inertia_vanishes(dm_inertia *x, dm_stepper *s, const double *to, double t, double h,
                        int steep, int open) {
    const int hides = open ? dm_inertia_hides(x, x->state, t, to, t + h) : 0;
    const int in_parts = !(s->rule->method->traits & DM_OWN_TIME);
    if (hides == DM_INERTIA_HIDDEN) return 1;
    if (hides && in_parts && vanishes_in_parts(x, s, to, t, h, walk_openly)) return 1;
    return steep && in_parts && vanishes_in_parts(x, s, to, t, h, walk);
}

int dm_inertia_vanishes_anew(dm_inertia *x, dm_stepper *s, const double *state, const double *to,
                             double t, double h, int steep, int open) {
    const size_t pair = 2 * (size_t)x->model->n, own = dm_state_size(x->model->n) - pair;
    double *from = x->aside;
    memcpy(from, state, (pair + own) * sizeof *from);
    if (dm_stepper_start(s, from, t, h) != DM_OK) return 0;
    memcpy(from + pair, state + pair, own * sizeof *from);
    dm_inertia_keep(x, s, from);
    return dm_inertia_vanishes(x, s, to, t, h, steep, open);
}

/* ---- the kept state ---- */

void dm_inertia_keep(dm_inertia *x, dm_stepper *s, const double *state) {
    double *place;
    memcpy(x->state, state, dm_state_size(x->model->n) * sizeof *state);
    x->kept_left = x->seen.left;
    if (!x->memory_size) return;
    dm_stepper_memory(s, &place);
    memcpy(x->memory, place, x->memory_size * sizeof *place);
}

void dm_inertia_go_back(const dm_inertia *x, dm_stepper *s, double *state) {
    double *place;
    memcpy(state, x->state, dm_state_size(x->model->n) * sizeof *state);
    if (!x->memory_size) return;
    dm_stepper_memory(s, &place);
    memcpy(place, x->memory, x->memory_size * sizeof *place);
}
