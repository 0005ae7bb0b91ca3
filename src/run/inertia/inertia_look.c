/* inertia_look.c - looks along a run, and when the next one is due. */
#include "run/inertia/inertia_look.h"

#include <math.h>

enum { MOST = 512 }; /* steps between looks */
/* Of the steps until a value vanishes, the part that is not looked at: of a mass that depends on
 * positions alone, and of others. */
static const double OF_POSITION = 0.5, OF_VELOCITY = 0.4;

static double lesser(double a, double b) {
    return b < a ? b : a;
}

static double larger(double a, double b) {
    return b > a ? b : a;
}

/* Like (t0 - t)^(2/3) where the mass depends on positions alone, since M v^2 stays finite; else
 * like the root of t0 - t, as at a fold of the momentum. */
static double left_of(const dm_model *m, double before, double now, double since) {
    const double ratio = before / now;
    if (!(ratio > 1.0)) return INFINITY;
    return since / (ratio * (dm_inertia_sees_velocity(m) ? ratio : sqrt(ratio)) - 1.0);
}

double dm_inertia_left(const dm_inertia *x, double before, double now, double since) {
    return left_of(x->model, before, now, since);
}

/* Did a value fall by more than a part of the way to zero leaves of it, or rise from less? What was
 * behind zero in between came back. */
static int is_strange(double before, double now) {
    static const double PART = 0.63; /* (1/2)^(2/3): after half of the way */
    return now < PART * before || before < PART * now;
}

/* Steps until a value may vanish, so few that one which does not go on falling may have been thrown
 * back: by what it kept in one step. */
static const double NEAR = 4.0, KEPT = 0.9;

/* How values moved since the last look: the product of all (`whole`), where bounds do not tell how
 * those move that are not the least, or the one next to zero; and steps until it could vanish. */
typedef struct {
    double was, is, left;
    long since;
    int whole;
} way;

/* One that grew may fall as fast. */
static way way_since(const dm_model *m, const dm_inertia_seen *s, const dm_inertia_there *there,
                     long since) {
    const int whole = !dm_inertia_sees_velocity(m) && !m->mass_bounds && s->all * there->all > 0.0;
    way w = {.since = since, .whole = whole};
    w.was = whole ? s->all : s->least, w.is = whole ? there->all : there->least;
    const double falling = left_of(m, w.was, w.is, (double)since);
    w.left = lesser(falling, left_of(m, w.is, w.was, (double)since) + (double)since);
    return w;
}

/* Is the line from the last look looked at, on which one may have touched zero? Where bounds do not
 * tell how M moves, and the product of all values moved by more than it was let, or does not go on
 * falling, or was so few steps from its end that one step may go over it. */
static int sees_line(const dm_model *m, const dm_inertia_seen *s, const way *w) {
    static const double MOVED = 1.4, FEW = 4.0;
    if (m->mass_bounds) return 0;
    return (s->fell && w->is > w->was) || !(w->is < MOVED * w->was && w->is * MOVED > w->was) ||
           (w->since == 1 && lesser(s->nearest, w->left) < FEW);
}

static int has_touched(const dm_inertia *x, const double *state, double t, const way *w) {
    const int told = w->whole && !dm_inertia_sees_velocity(x->model); /* of any velocity */
    const double first = told ? w->was : 0.0, last = told ? w->is : 0.0;
    const dm_chord line = {x->region, state, x->seen.at, t, first, last};
    return sees_line(x->model, &x->seen, w) && dm_inertia_has_touched(x, &line);
}

/* Steps that may come before the next look, so that the value moves by little meanwhile, since to
 * go back costs more than to look: by how fast its logarithm moved, and how that changed, as that
 * of a value that is about to turn does. Ways grow slowly from `let`, but for a value that hardly
 * moves. */
static double still_steps(dm_inertia_seen *s, double ratio, double since, double let) {
    static const double LITTLE = 0.3, SURELY = 0.25;
    const double rate = log(ratio) / since;
    const double bend = s->way > 0.0 ? 2.0 * (rate - s->rate) / (since + s->way) : 0.0;
    const double now = fabs(rate + 0.5 * bend * since);
    const double steps = 2.0 * LITTLE / (now + sqrt(now * now + 2.0 * LITTLE * fabs(bend)));
    s->rate = rate, s->way = since;
    return fmin(steps, larger(let + 1.0, lesser(2.0 * let, SURELY * steps)));
}

/* The last multiple of the largest power of 2 among the next `far` steps: where members in lanes
 * look, more of them do at once. */
static long meet(long done, long far) {
    long unit = 1;
    while (2 * unit <= far) unit *= 2;
    return (done + far) & -unit;
}

/* What is kept of a look, and when the next one is due; `aside`: of a member in lanes. Where bounds
 * tell how M moves looks have an account of their own, and do not come for company. */
static void note(const dm_model *m, dm_inertia_seen *s, const dm_inertia_there *there, int found,
                 const way *w, long done, double t, int aside) {
    const double part = dm_inertia_sees_velocity(m) ? OF_VELOCITY : OF_POSITION;
    const int meets = aside && !m->mass_bounds;
    const double since = (double)w->since, let = meets ? larger(s->reach, since) : since;
    s->left = left_of(m, s->least, there->least, since);
    s->nearest = lesser(s->left, w->left);
    const double still = still_steps(s, fmin(w->is / w->was, there->least / s->least), since, let);
    const double safe = lesser(part * s->nearest, MOST);
    const double far = s->left <= NEAR ? 1.0 : fmin(safe, still);
    s->reach = found && far >= 1.0 ? far : 1.0;
    s->due = meets ? meet(done, (long)s->reach) : done + (long)s->reach;
    s->least = there->least, s->all = there->all, s->fell = w->is < w->was;
    s->open = 0;
    s->looked = done, s->at = t;
}

/* What a look tells that found `there`, or nothing (NULL): so near to a fold that no velocity is
 * known. */
static int judge(dm_inertia *x, const double *state, double t, long done,
                 const dm_inertia_there *there, int aside) {
    static const dm_inertia_there nothing = {0};
    dm_inertia_seen *s = &x->seen;
    const int found = there != NULL, changed = found && there->negative != s->negative;
    if (!found) there = &nothing;
    if (done == s->looked) return changed ? DM_INERTIA_CHANGED : 0; /* a step from here failed */
    const way w = way_since(x->model, s, there, done > s->looked ? done - s->looked : 1);
    const int strange = found && w.since > 1 && is_strange(s->least, there->least);
    const int touched = found && !changed && has_touched(x, state, t, &w);
    const int turned = w.since == 1 && s->left <= NEAR && there->least > KEPT * s->least;
    x->before = s->left;
    note(x->model, s, there, found, &w, done, t, aside);
    if (found && !changed) dm_inertia_foresee(x, state, t, done);
    dm_inertia_keep_place(x, state);
    if (changed || touched) return DM_INERTIA_CHANGED;
    return strange ? DM_INERTIA_STRANGE : found && turned ? DM_INERTIA_TURNED : 0;
}

int dm_inertia_look(dm_inertia *x, const double *state, double t, long done) {
    dm_inertia_there there;
    const int found = x->seen.known && dm_inertia_values(x, state, t, &there);
    return judge(x, state, t, done, found ? &there : NULL, 0);
}

int dm_inertia_look_aside(dm_inertia *x, const double *state, double t, long done,
                          const dm_inertia_there *told) {
    dm_inertia_there there;
    const int found = told || (x->seen.known && dm_inertia_values(x, state, t, &there));
    return judge(x, state, t, done, told ? told : found ? &there : NULL, 1);
}

int dm_inertia_is_quiet(const dm_model *m, dm_inertia_seen *s, double t, long done,
                        const dm_inertia_there *told) {
    if (m->mass_bounds || told->negative != s->negative || done <= s->looked) return 0;
    const way w = way_since(m, s, told, done - s->looked);
    if (sees_line(m, s, &w) || (w.since == 1 && s->left <= NEAR)) return 0;
    note(m, s, told, 1, &w, done, t, 1);
    return 1;
}

void dm_inertia_begin_closely(dm_inertia *x) {
    uint32_t negative;
    x->close_left = x->kept_left;
    if (!dm_inertia_at(x, x->state, x->t, &negative, &x->close_least)) x->close_least = 0.0;
}

int dm_inertia_look_closely(dm_inertia *x, const double *state, double t, int *steep) {
    const dm_chord line = {.a = x->state, .b = state, .ta = x->t, .tb = t};
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

int dm_inertia_is_near(const dm_inertia_seen *s) {
    return s->known && s->left <= NEAR;
}
