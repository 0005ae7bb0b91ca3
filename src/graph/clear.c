/* clear.c - halving intervals until bounds tell. */
#include "graph/clear.h"

#include <math.h>

enum { MOST = 24 }; /* finest intervals in which a root may be zero: more than zeros make */

/* are all roots that are not vague told apart from zero in [from, to]? */
static int is_clear(const dm_clear *line, double from, double to) {
    for (uint32_t i = 0; i < line->inputs; i++) {
        const double d = line->d[i];
        const dm_interval move = dm_interval_multiply((dm_interval){from, to}, (dm_interval){d, d});
        line->box[i] = dm_interval_add((dm_interval){line->x[i], line->x[i]}, move);
    }
    dm_bounds(line->g, line->box, line->value);
    for (uint32_t j = 0; j < line->m; j++) {
        const dm_interval v = line->value[line->roots[j]];
        if (line->vague[j] <= MOST && v.lo <= 0 && v.hi >= 0) return 0;
    }
    return 1;
}

/* count the roots that the bounds looked at last leave open; 1: one became vague by it */
static int count_open(const dm_clear *line) {
    int more = 0;
    for (uint32_t j = 0; j < line->m; j++) {
        const dm_interval v = line->value[line->roots[j]];
        if (line->vague[j] <= MOST && v.lo <= 0 && v.hi >= 0) more |= ++line->vague[j] > MOST;
    }
    return more;
}

/* 0: a root became vague */
static int look(const dm_clear *line, double from, double to, int tell) {
    if (is_clear(line, from, to)) {
        if (tell) line->found(line->ud, from, to);
        return 1;
    }
    if (to - from <= line->fine * (1 + fmax(fabs(from), fabs(to))))
        return tell || !count_open(line);
    const double middle = from / 2 + to / 2;
    return look(line, from, middle, tell) && look(line, middle, to, tell);
}

/* from 0 both ways, so that what is near is looked at finely */
static int look_along(const dm_clear *line, int tell) {
    return look(line, -line->reach, 0, tell) && look(line, 0, line->reach, tell);
}

void dm_clear_line(dm_clear *line) {
    for (uint32_t j = 0; j < line->m; j++) line->vague[j] = 0;
    while (!look_along(line, 0))
        for (uint32_t j = 0; j < line->m; j++)
            if (line->vague[j] <= MOST) line->vague[j] = 0;
    look_along(line, 1);
}
