/* folds.c - where a search looks: from every start along curves, at switches, and downhill. */
#include "level/folds.h"

#include "base/random.h"
#include "level/trail.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    DOWN = 12,    /* nodes towards lesser angles, */
    ON = 4,       /* and of every turn after that, on sets that are curves */
    ACROSS = 12,  /* nodes both ways on others */
    BESIDE = 12,  /* and from a switch, */
    HAIRPIN = 40, /* where the set is a curve */
    STRIDE = 7,   /* so that starts are taken of all kinds of angles */
    SWEEPS = 12,  /* searches along lines */
    STARTS = 64,
    SEED = 17
};
static const double FIRST = 0.1, /* step, beside the size of the points; */
    FINE = 2e-3,                 /* where nothing is known of what is near */
    NARROW = 0.2,                /* widths of switches, beside the same */
    BY_SLANT = 0.75,             /* of descents */
    ZONE = 4,                    /* of a switch, in its scale */
    AROUND = 0.5,                /* starts */
    WIDE = 10,                   /* how far out a descent may come */
    LINE = 0.15, SHORTEST = 1e-3;

typedef struct {
    dm_search *s;
    dm_footing place[STARTS];
    uint32_t count, dimension, aims, descents;
    uint32_t which[2], at_switches; /* that a descent stays at */
    double u[2], widest;
    dm_trail curve[2], both[STARTS][2];
    dm_footing aimed, best, side[3];
    double *x, *v;
    int by_slant; /* downhill */
} plan;

/* ---- starts ---- */

static int by_sine(const void *a, const void *b) {
    const double one = fabs(((const dm_footing *)a)->sine),
                 other = fabs(((const dm_footing *)b)->sine);
    return (one > other) - (one < other);
}

static int find_starts(plan *p, const double *x, const double *step, uint32_t count) {
    for (uint32_t i = 0; i < count && p->count < STARTS; i++) {
        dm_footing *at = p->place + p->count;
        if (!at->x && !dm_footing_take(p->s, at)) return 0;
        const int is = dm_footing_step(p->s, at, x + (size_t)i * p->s->l->n, NULL, 0, step[i]);
        if (is && at->inside) p->count++;
    }
    qsort(p->place, p->count, sizeof *p->place, by_sine);
    return 1;
}

/* ---- along curves ---- */

static void both_ways(plan *p, dm_trail *c, const dm_footing *at, double *v, double step) {
    dm_trail_begin(p->s, c, at, v, step);
    for (uint32_t k = 0; k < p->s->l->n; k++) v[k] = -v[k];
    dm_trail_begin(p->s, c + 1, at, v, step);
}

static int has_more(const plan *p, uint32_t until) {
    return !p->s->over && p->s->spent < until;
}

/* a set that is a curve: towards lesser angles, then on to both sides; 0: no memory */
static int along(plan *p, uint32_t until) {
    for (uint32_t i = 0; i < p->count && has_more(p, until); i++) {
        dm_trail *c = p->both[i];
        const dm_footing *at = p->place + i;
        if (!dm_trail_take(p->s, c) || !dm_trail_take(p->s, c + 1)) return 0;
        if (!dm_random_tangent(p->s, at, p->v)) continue;
        both_ways(p, c, at, p->v, FIRST * at->size);
        dm_trail_follow(p->s, c, 1, 0);
        dm_trail_follow(p->s, fabs(c->at.sine) < fabs(at->sine) ? c : c + 1, DOWN, 1);
    }
    for (uint32_t before = 0; has_more(p, until) && before != p->s->spent;) {
        before = p->s->spent;
        for (uint32_t i = 0; i < p->count && has_more(p, until); i++)
            for (int k = 0; k < 2; k++)
                if (p->both[i][k].at.x) dm_trail_follow(p->s, p->both[i] + k, ON, 0);
    }
    return 1;
}

/* one of several dimensions: in directions at random */
static void across(plan *p, uint32_t until) {
    for (uint32_t i = 0; i < p->count && has_more(p, until); i++) {
        const dm_footing *at = p->place + i;
        if (!dm_random_tangent(p->s, at, p->v)) continue;
        both_ways(p, p->curve, at, p->v, FIRST * at->size);
        for (int k = 0; k < 2; k++) dm_trail_follow(p->s, p->curve + k, ACROSS, 0);
    }
}

/* ---- downhill ---- */

/* The narrowest switch where the level was looked at, its direction in v; its width. */
static double narrowest(plan *p, const dm_footing *at, double *v) {
    dm_level *l = p->s->l;
    double least = NARROW * at->size;
    int is = 0;
    for (uint32_t j = 0; j < l->s; j++) {
        const double width = dm_level_width(l, j, p->x);
        if (l->kind[j] == DM_BREAKS || !(width < least)) continue;
        least = width, is = 1;
        memcpy(v, p->x, l->n * sizeof *v);
    }
    return is ? least : 0;
}

/* A direction from the best node: by turns across the narrowest switch there, and beside it. */
static int direction(plan *p, int turn, double *h) {
    dm_level *l = p->s->l;
    double *row = l->rows + (size_t)l->c * l->n;
    if (!dm_level_look(l, p->best.x)) return 0;
    const double width = narrowest(p, &p->best, p->v);
    if (width > 0 && turn % 3 == 0) {
        *h = width / 2;
        return 1;
    }
    const int beside = width > 0 && p->dimension > 1;
    for (uint32_t k = 0; k < l->n; k++) p->x[k] = p->v[k];
    if (!dm_random_tangent(p->s, &p->best, p->v)) return 0;
    if (beside) memcpy(row, p->x, l->n * sizeof *row);
    return dm_level_turn(l, p->v, (uint32_t)beside);
}

/* what is to become less */
static double height(const plan *p, const dm_footing *at) {
    return fabs(p->by_slant ? at->slant : at->sine);
}

/* Is the node made last still at the switches of the descent? */
static int is_near(const plan *p) {
    const dm_level *l = p->s->l;
    int is = 1;
    for (uint32_t i = 0; i < p->at_switches; i++) {
        const dm_switch kind = l->kind[p->which[i]];
        const double u = fabs(l->u[p->which[i]]);
        if (kind == DM_BENDS) is &= u < ZONE;
        if (kind == DM_DIVIDES) is &= u < ZONE * p->u[i];
    }
    return is;
}

/* is the node a better one? Tells where the sign changes. */
static int is_lower(plan *p, const dm_footing *m, int is) {
    if (!is || !m->inside || p->s->over || !(m->size < p->widest) || !is_near(p)) return 0;
    if (m->sine * p->best.sine < 0) {
        dm_search_tell(p->s, &p->best, m, NULL);
        return -1;
    }
    return height(p, m) < height(p, &p->best);
}

/* where a parabola through three heights one step apart has its least one, in steps */
static double least_of(double minus, double middle, double plus) {
    const double slope = (plus - minus) / 2, bend = plus + minus - 2 * middle;
    if (!(bend > 0)) return plus < minus ? 2 : -2;
    return fmax(-3, fmin(3, -slope / bend));
}

/* the best of both sides and of a parabola's least becomes the best node; -1: a fold; 1: better */
static int line(plan *p, double h) {
    dm_footing *side = p->side;
    int is[3], better[3] = {0, 0, 0}, found = 0;
    double value[2] = {INFINITY, INFINITY};
    for (int k = 0; k < 2 && found >= 0; k++) {
        is[k] = dm_footing_step(p->s, side + k, p->best.x, p->v, k ? h : -h, h);
        found = better[k] = is_lower(p, side + k, is[k]);
        if (is[k] && side[k].inside) value[k] = height(p, side + k);
    }
    if (found < 0) return -1;
    double t = 0;
    if (isfinite(value[0]) && isfinite(value[1]))
        t = least_of(value[0], height(p, &p->best), value[1]);
    else if (better[0] || better[1])
        t = better[1] ? 2 : -2;
    if (fabs(t) > 0.1 && fabs(fabs(t) - 1) > 0.1) {
        is[2] = dm_footing_step(p->s, side + 2, p->best.x, p->v, t * h, fabs(t) * h);
        better[2] = is_lower(p, side + 2, is[2]);
        if (better[2] < 0) return -1;
    }
    int best = -1;
    for (int k = 0; k < 3; k++)
        if (better[k] > 0 && (best < 0 || height(p, side + k) < height(p, side + best))) best = k;
    if (best >= 0) dm_footing_copy(p->s, &p->best, side + best);
    return best >= 0;
}

/* the direction of the last line, from the best node */
static int straight_on(plan *p) {
    return dm_level_look(p->s->l, p->best.x) && dm_level_turn(p->s->l, p->v, 0);
}

/* lesser sine or slant from a node, along lines */
static void downhill(plan *p, const dm_footing *from) {
    double step = LINE * from->size;
    dm_footing_copy(p->s, &p->best, from);
    p->by_slant = dm_random_uniform(SEED, p->descents++, 0) < BY_SLANT;
    p->widest = WIDE * (1 + from->size);
    for (int i = 0, again = 0; i < SWEEPS && !p->s->over && step > SHORTEST * from->size; i++) {
        double h = step, breaks;
        if (!(again ? straight_on(p) : direction(p, i, &h))) return;
        const double reach = dm_level_reach(p->s->l, p->v, &breaks);
        const int got = line(p, fmin(h, fmax(reach, SHORTEST * from->size)));
        if (got < 0) return;
        again = got > 0 && h == step;
        if (h == step) step *= got ? 1.6 : 0.5;
    }
}

/* ---- at switches ---- */

/* from a node at switches: across and beside them */
static void beside(plan *p, const dm_footing *at, const uint32_t *which, uint32_t count) {
    dm_level *l = p->s->l;
    const uint32_t j = which[count - 1];
    if (!dm_level_look(l, at->x)) return;
    p->at_switches = count;
    for (uint32_t i = 0; i < count; i++) {
        p->which[i] = which[i];
        p->u[i] = fabs(l->u[which[i]]);
    }
    if (!(dm_level_width(l, j, p->v) < INFINITY) && !dm_random_tangent(p->s, at, p->v)) return;
    both_ways(p, p->curve, at, p->v, FINE * at->size);
    const int nodes = p->dimension > 1 ? BESIDE : HAIRPIN;
    for (int k = 0; k < 2; k++) dm_trail_follow(p->s, p->curve + k, nodes, 0);
    if (p->dimension > 1) downhill(p, at);
    p->at_switches = 0;
}

/* from start after start to switches, and then from around them */
static void aim(plan *p, const uint32_t *which, uint32_t count) {
    const uint32_t n = p->s->l->n;
    dm_footing *at = &p->aimed;
    const uint32_t number = p->aims++, i = p->s->random++;
    const dm_footing *from = p->place + STRIDE * number % p->count;
    const double far = number < p->count ? 0 : AROUND * from->size;
    for (uint32_t k = 0; k < n; k++)
        p->x[k] = from->x[k] + (far > 0 ? far * dm_random_normal(SEED, i, k) : 0);
    if (!dm_level_aim(p->s->l, p->x, which, count)) return;
    if (!dm_footing_step(p->s, at, p->x, NULL, 0, fmax(from->size, 1)) || !at->inside) return;
    beside(p, at, which, count);
}

/* to every switch, and to every two of them */
static void switches(plan *p, uint32_t until) {
    const dm_level *l = p->s->l;
    for (uint32_t i = 0; i < p->count; i++)
        for (uint32_t j = 0; j < l->s; j++) {
            if (l->kind[j] == DM_TURNS) continue;
            const uint32_t others = p->dimension > 1 ? j : 0;
            for (uint32_t k = 0; k <= others && has_more(p, until); k++)
                if (k == others || l->kind[k] != DM_TURNS)
                    aim(p, (uint32_t[]){j, k}, k < others ? 2 : 1);
        }
}

/* ---- all of it ---- */

static int take_memory(plan *p) {
    dm_search *s = p->s;
    const size_t n = s->l->n;
    for (int i = 0; i < 4; i++)
        if (!dm_footing_take(s, s->spare + i)) return 0;
    for (int i = 0; i < 3; i++)
        if (!dm_footing_take(s, p->side + i)) return 0;
    double *block = dm_arena_take(s->arena, 3 * n * sizeof *block);
    if (!block || !dm_footing_take(s, &p->best) || !dm_footing_take(s, &p->aimed)) return 0;
    s->v = block, p->x = block + n, p->v = block + 2 * n;
    return dm_trail_take(s, p->curve) && dm_trail_take(s, p->curve + 1);
}

dm_status dm_folds_search(const dm_folds *how, const double *x, const double *step, uint32_t count,
                          dm_arena *arena) {
    dm_search s = {.how = how, .l = how->level, .arena = arena};
    plan *p = dm_arena_take(arena, sizeof *p);
    if (!p) return DM_NO_MEMORY;
    *p = (plan){.s = &s, .dimension = s.l->n - s.l->c};
    if (s.l->n <= s.l->c) return DM_OK;
    if (!take_memory(p) || !find_starts(p, x, step, count)) return DM_NO_MEMORY;
    s.spent = 0;
    switches(p, 3 * how->most);
    const uint32_t until = s.spent + how->most;
    if (p->dimension == 1) return along(p, until) ? DM_OK : DM_NO_MEMORY;
    across(p, until);
    for (uint32_t i = 0; i < p->count && has_more(p, until + how->most); i++)
        downhill(p, p->place + i);
    return DM_OK;
}
