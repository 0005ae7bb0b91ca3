/* inertia_parts.c - does d2L/dv2 lose a value inside a step that has the right inertia at both
 * ends? Where a mass M(q) goes to zero, M v^2 stays finite: v grows like 1/sqrt(M) and the place
 * is reached in no time, but a long step is thrown back by it or jumps over it. So a step before
 * which a value fell steeply is made again in parts, shorter ones as the value nears zero. */
#include "run/inertia.h"

#include <math.h>
#include <string.h>

/* A part is at least so short a part of the step. What fails is passed by one of WIDEST such parts
 * or by none. */
enum { FINEST = 1 << 16, WIDEST = 16 };
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
    int done, size;
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

/* The largest difference from that one in the units of the start; infinite: none is known. */
static double difference(const parts *w, const double *state, double t) {
    const double *v = dm_inertia_velocity(w->x, state, t);
    double out = v ? 0.0 : INFINITY;
    for (uint32_t i = 0; v && i < w->x->model->n; i++)
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
    while (w->size <= WIDEST && w->done + 2 * w->size <= FINEST) {
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

/* How much faster the velocity that grew most is than before the step, of those that move something
 * now and moved something then. */
static double growth(parts *w) {
    const size_t n = w->x->model->n;
    const double *then = w->velocity, *p = w->state + n, *before = w->x->state + n;
    if (!find_velocity(w, w->x->state, w->t)) return 0.0;
    const double *v = dm_inertia_velocity(w->x, w->state, time_of(w));
    if (!v) return 0.0;
    const double some = MOVES * motion(p, v, n), once = MOVES * motion(before, then, n);
    double out = 0.0;
    for (size_t i = 0; i < n; i++)
        if (fabs(p[i] * v[i]) > some && fabs(before[i] * then[i]) > once)
            out = fmax(out, fabs(v[i] / then[i]));
    return out;
}

/* Do velocities grow as they do where M vanishes? */
static int is_vanishing(parts *w) {
    const double loss = w->first / w->least, by = growth(w);
    return by > pow(loss, LEAST_POWER) && by < pow(loss, MOST_POWER);
}

/* A part of twice the size of the last one, if that does not reach too far. */
static void choose_size(parts *w) {
    if (w->size < FINEST / 2) w->size *= 2;
    while (w->size > 1 && w->size * NEXT > w->ahead) w->size /= 2;
    if (w->size > FINEST - w->done) w->size = FINEST - w->done;
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
    while (w->done < FINEST) {
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
        if (found && near && is_vanishing(w)) return 1;
        if (!found && (w->done == 0 || w->ahead > DM_INERTIA_STEEP)) return 0;
        if (!found && is_fold(w, &least)) return 1;
        if (!found) left = INFINITY;
        const int seen = w->first > LOSS * w->least;
        go_on(w, least, left);
        if (!seen && w->first > LOSS * least && w->by_position && !is_vanishing(w)) return 0;
    }
    return 0;
}

int dm_inertia_vanishes(dm_inertia *x, dm_stepper *s, double t, double h) {
    const size_t size = dm_state_size(x->model->n), memory = x->memory_size;
    const dm_report report = s->report;
    double *kept = x->aside + 2 * size + memory;
    parts w = {.x = x,
               .s = s,
               .t = t,
               .h = h,
               .by_position = (x->model->structure & DM_QUADRATIC_IN_V) != 0,
               .size = FINEST / 2,
               .ahead = x->before * FINEST};
    uint32_t negative;
    w.state = x->aside, w.next = w.state + size, w.memory = w.next + size;
    w.velocity = x->room + x->model->n; /* is written before it is read */
    copy_memory(&w, kept, NULL);
    memcpy(w.state, x->state, size * sizeof *w.state);
    if (memory) memcpy(w.memory, x->memory, memory * sizeof *w.memory);
    copy_memory(&w, NULL, w.memory);
    int out = dm_inertia_at(x, w.state, t, &negative, &w.first);
    w.least = w.first;
    out = out && walk(&w);
    copy_memory(&w, NULL, kept);
    s->report = report;
    return out;
}

int dm_inertia_vanishes_anew(dm_inertia *x, dm_stepper *s, const double *state, double t,
                             double h) {
    const size_t pair = 2 * (size_t)x->model->n, own = dm_state_size(x->model->n) - pair;
    double *from = x->aside;
    memcpy(from, state, (pair + own) * sizeof *from);
    if (dm_stepper_start(s, from, t, h) != DM_OK) return 0;
    memcpy(from + pair, state + pair, own * sizeof *from);
    dm_inertia_keep(x, s, from);
    return dm_inertia_vanishes(x, s, t, h);
}
