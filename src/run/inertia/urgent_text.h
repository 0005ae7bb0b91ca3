/* urgent_text.h - of all blocks of W masses, what is most urgent: it says when the next look is
 * due; a text for files that have numbers/lanes_text.h. */
#ifndef DM_URGENT_TEXT_H
#define DM_URGENT_TEXT_H

#include "run/inertia/course_text.h"

/* What is most urgent. */
typedef struct {
    V least, left, reach;
} urgent;

INLINE urgent none_urgent(void) {
    return (urgent){same(INFINITY), same(INFINITY), same(INFINITY)};
}

INLINE void take_urgent(urgent *u, const course *c) {
    u->least = lesser(u->least, c->least);
    u->left = lesser(u->left, c->left);
    u->reach = lesser(u->reach, c->reach);
}

/* of one lane, after a look at time t */
INLINE void store_urgent(kind k, dm_inertia_seen *s, const urgent *u, uint32_t l, long done,
                         double t) {
    const long far = (long)of_lane(u->reach, l);
    s->least = of_lane(u->least, l), s->left = of_lane(u->left, l);
    s->due = k.bounded ? done + far : meet(done, far);
    s->open = s->told = 0, s->looked = done, s->at = t;
}

#endif
