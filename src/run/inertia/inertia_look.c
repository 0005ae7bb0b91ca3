/* inertia_look.c - looks along a run, and when the next one is due. */
#include "run/inertia/inertia_look.h"

#include <math.h>

#define W 1
#define HOW
#define DM_LANES_FUSED 0
#include "run/inertia/urgent_text.h"

static kind kind_of(const dm_model *m, const dm_inertia_seen *s) {
    return (kind){.by_velocity = dm_inertia_sees_velocity(m),
                  .bounded = m->mass_bounds != NULL,
                  .told = s->told};
}

double dm_inertia_left(const dm_inertia *x, double before, double now, double since) {
    return left_of(before, now, since, dm_inertia_sees_velocity(x->model));
}

static int is_strange(double before, double now) {
    return now < DM_INERTIA_PART * before || before < DM_INERTIA_PART * now;
}

/* Of the last step of those that choose their length, how much longer the next one may be. */
static const double GROW = 4.0;

/* What a value that falls keeps in one step, if it was not thrown back. */
static const double KEPT = 0.9;

/* known: the products at both ends */
static int has_touched(const dm_inertia *x, const double *state, double t, int known) {
    const dm_chord line = {x->place, state, x->seen.at, t, known, 1};
    return dm_inertia_has_touched(x, &line);
}

/* Has the one that was near zero a step ago not gone on falling, or has one jumped? That of a
 * speed near to its limit does. */
static int has_turned(kind k, const course *c, const move *w) {
    return (c->left <= NEAR && w->is > KEPT * w->was) || (!k.by_velocity && jumps(w));
}

void dm_inertia_go_on(dm_inertia *x, const double *state, double t) {
    int grown = 0;
    if (dm_inertia_sees_velocity(x->model)) return;
    for (uint32_t b = 0; b < x->blocks.count; b++)
        grown |= has_grown(x->course[b].ones, x->course[b].all);
    if (!grown) return;
    dm_inertia_scale_again(x, state, t);
    dm_inertia_foresee(x, state, t, x->seen.looked);
}

/* What looks at the blocks tell: is one strange, has one turned, is the line looked at, whose ends
 * are known? */
typedef struct {
    int strange, turned, line, known;
    urgent next;
} verdict;

/* block b, which is `there` after so many steps; 0: nothing was found */
static void judge_block(dm_inertia *x, kind k, uint32_t b, dm_inertia_value there, double since,
                        int found, verdict *out) {
    course c = load_course(x->course + b, 0);
    const move w = move_since(k, &c, there.least, there.all, since);
    out->strange |= is_strange(w.was, w.is);
    out->turned |= has_turned(k, &c, &w);
    out->line |= sees_line(k, &c, &w);
    out->known &= w.whole;
    x->first[b] = w.was, x->last[b] = w.is;
    note(k, &c, there.least, there.all, &w);
    if (!found) c.reach = 1.0;
    store_course(x->course + b, &c, 0);
    take_urgent(&out->next, &c);
}

/* What a look tells that found `there`, or nothing (NULL): so near to a fold that no velocity is
 * known. */
static int judge(dm_inertia *x, const double *state, double t, long done,
                 const dm_inertia_there *there) {
    static const dm_inertia_value nothing = {0};
    dm_inertia_seen *s = &x->seen;
    const int found = there != NULL, changed = found && there->negative != s->negative;
    if (done == s->looked) return changed ? DM_INERTIA_CHANGED : 0; /* a step from here failed */
    const kind k = kind_of(x->model, s);
    const double since = done > s->looked ? (double)(done - s->looked) : 1.0;
    verdict v = {.known = 1, .next = none_urgent()};
    for (uint32_t b = 0; b < x->blocks.count; b++)
        judge_block(x, k, b, found ? there->of[b] : nothing, since, found, &v);
    const int touched = found && !changed && v.line && has_touched(x, state, t, v.known);
    x->before = s->left;
    if (x->own) s->h = x->next ? *x->next : GROW * (t - s->at) / since;
    store_urgent(k, s, &v.next, 0, done, t);
    if (found && !changed) dm_inertia_foresee(x, state, t, done);
    dm_inertia_keep_place(x, state);
    if (changed || touched) return DM_INERTIA_CHANGED;
    if (!found) return 0;
    if (since > 1.0) return v.strange ? DM_INERTIA_STRANGE : 0;
    return v.turned ? DM_INERTIA_TURNED : 0;
}

int dm_inertia_look(dm_inertia *x, const double *state, double t, long done,
                    const dm_inertia_there *told) {
    dm_inertia_there there;
    const int found = told || (x->seen.known && dm_inertia_values(x, state, t, &there));
    return judge(x, state, t, done, told ? told : found ? &there : NULL);
}

void dm_inertia_begin_closely(dm_inertia *x) {
    uint32_t negative;
    x->close_left = x->kept_left;
    if (!dm_inertia_at(x, x->state, x->t, &negative, &x->close_least)) x->close_least = 0.0;
}

int dm_inertia_look_closely(dm_inertia *x, const double *state, double t, int *steep) {
    const dm_chord line = {.a = x->state, .b = state, .ta = x->t, .tb = t, .poles = 1};
    const double before = x->close_least;
    uint32_t negative;
    double least;
    *steep = 0;
    x->before = x->close_left;
    if (!x->seen.known || !dm_inertia_at(x, state, t, &negative, &least)) return 0;
    x->close_least = least, x->close_left = dm_inertia_left(x, before, least, 1.0);
    *steep = x->before <= (least > KEPT * before ? NEAR : DM_INERTIA_STEEP);
    const int changed = negative != x->seen.negative || dm_inertia_has_touched(x, &line);
    return changed ? DM_INERTIA_CHANGED : 0;
}

int dm_inertia_is_fading(const dm_inertia *x) {
    static const double STEPS = 2.5;
    return x->seen.known && x->seen.left <= STEPS;
}

int dm_inertia_is_steep(const dm_inertia_seen *s) {
    return s->known && s->left <= DM_INERTIA_STEEP;
}
