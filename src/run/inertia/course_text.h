/* course_text.h - how values moved since the last look and when the next one is due, of W members;
 * a text for files that have numbers/lanes_text.h.
 * Speed: ensembles, double spherical pendulum midpoint: 1.02x, against members one by one. */
#ifndef DM_COURSE_TEXT_H
#define DM_COURSE_TEXT_H

#include "numbers/lanes_text.h"
#include "run/inertia/inertia.h"

#if W == 1
INLINE V root_of(V x) {
    return sqrt(x);
}

/* W numbers that are so far apart, and the one of a lane */
INLINE V gather(const double *x, size_t apart) {
    (void)apart;
    return *x;
}

INLINE double of_lane(V x, uint32_t lane) {
    (void)lane;
    return x;
}
#else
#if W == 8
INLINE V root_of(V x) {
    return (V)_mm512_sqrt_pd((__m512d)x);
}
INLINE V gather(const double *x, size_t a) {
    return (V){x[0], x[a], x[2 * a], x[3 * a], x[4 * a], x[5 * a], x[6 * a], x[7 * a]};
}
#else
INLINE V root_of(V x) {
    return (V)_mm256_sqrt_pd((__m256d)x);
}
INLINE V gather(const double *x, size_t a) {
    return (V){x[0], x[a], x[2 * a], x[3 * a]};
}
#endif

INLINE double of_lane(V x, uint32_t lane) {
    return x[lane];
}
#endif

/* What looks leave of a block: dm_inertia_course. */
typedef struct {
    V least, all, ones, nearest, left, rate, way, turn, reach, fell;
} course;

/* M depends on v; has bounds; they told how it moves since the last look. */
typedef struct {
    int by_velocity, bounded, told;
} kind;

/* How values moved since the last look: the product of all (`whole`), where bounds do not tell how
 * those move that are not the least, or the one next to zero; steps until it vanishes, or could if
 * it fell as fast as it rose; by what its logarithm moved, and by how much that missed what it
 * would have done if it had gone on as before. */
typedef struct {
    V was, is, falling, left, since, moved, missed;
    I whole;
} move;

/* Steps until a value may vanish, so few that one which does not go on falling may have been thrown
 * back. */
static const double NEAR = 4.0;

/* of two, the first where the second is not a number */
INLINE V lesser(V a, V b) {
    return pick(WHERE(b < a), b, a);
}

/* Like (t0 - t)^(2/3) where the mass depends on positions alone, since M v^2 stays finite; else
 * like the root of t0 - t, as at a fold of the momentum. Infinite: it does not fall. */
INLINE V left_of(V before, V now, V since, int by_velocity) {
    const V ratio = before / now, power = ratio * (by_velocity ? ratio : root_of(ratio));
    return pick(WHERE(ratio > same(1.0)), since / (power - same(1.0)), same(INFINITY));
}

/* One that grew may fall as fast. Of a ratio r the logarithm is 2 (r - 1)/(r + 1) as long as that
 * is little. */
INLINE move move_since(kind k, const course *c, V least, V all, V since) {
    move w = {.since = since, .whole = WHERE(c->all * all > same(0.0))};
    if (k.by_velocity || k.told) w.whole = not_of(all_lanes());
    w.was = pick(w.whole, c->all, c->least), w.is = pick(w.whole, all, least);
    const V back = left_of(w.is, w.was, since, k.by_velocity) + since;
    const V least_left = left_of(c->least, least, since, k.by_velocity);
    w.falling = lesser(least_left, left_of(w.was, w.is, since, k.by_velocity));
    w.left = lesser(w.falling, back);
    w.moved = same(2.0) - same(4.0) / (w.is / w.was + same(1.0));
    const V expected = c->rate + same(0.5) * c->turn * (c->way + since);
    w.missed = magnitude(w.moved - expected * since);
    return w;
}

/* Did it miss that by so much, e^(1/2), that it may have been behind zero, or thrown back? */
INLINE I jumps(const move *w) {
    return not_of(WHERE(w->missed <= same(0.5)));
}

/* Has M grown by far since its scales were found, where the product of all was `ones`? */
INLINE I has_grown(V ones, V all) {
    return WHERE(ones > same(0.0)) & WHERE(all > same(16.0) * ones);
}

/* Did it rise or fall by that factor, or more? */
INLINE I moves_by(const move *w, V factor) {
    return not_of(WHERE(w->is < factor * w->was) & WHERE(w->is * factor > w->was));
}

/* Is the line from the last look looked at, on which one may have touched zero? Where bounds told
 * how M moves, which they do at the speed of before, if it moved by much in one step: where momenta
 * stay, as of f(q) v1 v2, speeds grow like 1/M. Else if the product of all values moved by more
 * than it was let, or otherwise than before, or does not go on falling, or was so few steps from
 * its end that one step may go over it. */
INLINE I sees_line(kind k, const course *c, const move *w) {
    const V moved = same(1.4), few = same(4.0), surprise = same(0.1);
    if (k.told) return WHERE(w->since == same(1.0)) & moves_by(w, same(1.2));
    return WHERE(c->way == same(0.0)) | not_of(WHERE(w->missed < surprise)) |
           (WHERE(c->fell > same(0.0)) & WHERE(w->is > w->was)) | moves_by(w, moved) |
           (WHERE(w->since == same(1.0)) & WHERE(lesser(c->nearest, w->left) < few));
}

/* Steps that may come before the next look, so that the value moves by little meanwhile, since to
 * go back costs more than to look: by how fast its logarithm moved, and how that changed, as that
 * of a value that is about to turn does. Ways grow slowly from `let`, but for a value that hardly
 * moves. */
INLINE V still_steps(course *c, const move *w, V let) {
    const V little = same(0.6), surely = same(0.25), since = w->since, rate = w->moved / since;
    const I known = WHERE(rate == rate);
    const V change = same(2.0) * (rate - c->rate) / (since + c->way);
    const V bend = pick(WHERE(c->way > same(0.0)), change, same(0.0));
    const V now = magnitude(rate + same(0.5) * bend * since);
    const V steps = little / (now + root_of(now * now + little * magnitude(bend)));
    c->rate = pick(known, rate, same(0.0)), c->turn = pick(known, bend, same(0.0));
    c->way = pick(known, since, same(0.0));
    return lesser(larger_of(let + same(1.0), lesser(same(2.0) * let, surely * steps)), steps);
}

/* What is kept of a look that found values: the next one is due in so many steps (`reach`). */
INLINE void note(kind k, course *c, V least, V all, const move *w) {
    /* Of the steps until a value vanishes, the part that is not looked at. */
    const V part = same(k.by_velocity ? 0.4 : 0.5), most = same(512.0);
    const V let = k.bounded ? w->since : larger_of(c->reach, w->since);
    c->left = w->falling, c->nearest = w->left;
    const V still = still_steps(c, w, let);
    const V far = lesser(still, lesser(part * c->nearest, most));
    c->reach = larger_of(pick(WHERE(c->left <= same(NEAR)), same(1.0), far), same(1.0));
    c->least = least, c->all = all;
    c->fell = pick(WHERE(w->is < w->was), same(1.0), same(0.0));
}

/* The last of the next `far` steps that is a multiple of a power of 2, which is 2 or half of `far`
 * or less: of members in lanes more look at once, and hardly earlier than they have to, but where
 * little is known yet: a look at step 3 for one at 2 misses masses that touch zero in between.
 * Speed: steps, double spherical pendulum midpoint: 1.02x, against one up to `far`. */
INLINE long meet(long done, long far) {
    long unit = far > 1 ? 2 : 1;
    while (4 * unit <= far) unit *= 2;
    return (done + far) & -unit;
}

/* ---- of a block of W members, whose courses are so many numbers apart ---- */

INLINE course load_course(const dm_inertia_course *s, size_t apart) {
    return (course){.least = gather(&s->least, apart),
                    .all = gather(&s->all, apart),
                    .ones = gather(&s->ones, apart),
                    .nearest = gather(&s->nearest, apart),
                    .left = gather(&s->left, apart),
                    .rate = gather(&s->rate, apart),
                    .way = gather(&s->way, apart),
                    .turn = gather(&s->turn, apart),
                    .reach = gather(&s->reach, apart),
                    .fell = gather(&s->fell, apart)};
}

/* of one lane; where the scales were found stays */
INLINE void store_course(dm_inertia_course *s, const course *c, uint32_t l) {
    s->least = of_lane(c->least, l), s->all = of_lane(c->all, l);
    s->nearest = of_lane(c->nearest, l), s->left = of_lane(c->left, l);
    s->rate = of_lane(c->rate, l), s->way = of_lane(c->way, l);
    s->turn = of_lane(c->turn, l);
    s->reach = of_lane(c->reach, l), s->fell = of_lane(c->fell, l);
}

#endif
