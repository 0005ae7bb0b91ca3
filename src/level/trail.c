/* trail.c - curves along a level set: steps along tangents, brought back by the shortest way. */
#include "level/trail.h"

#include "base/random.h"

#include <math.h>
#include <string.h>

enum { GAP = 4, /* nodes outside */ DIPS = 4, SEED = 13 };
static const double FAR = 100,       /* how far out curves go */
    SMALL = 0.1,                     /* points smaller than this count as so large */
    LONGEST = 0.25, SHORTEST = 5e-4, /* steps, beside the size of the points */
    TURN = 0.8, BEND = 0.4,          /* cosine between tangents at most, angle as a rule, */
    CORNER = 0.05,                   /* and where the set may have one */
    LONGER = 1.6, SHORTER = 0.4, DEEPER = 0.7; /* a dip of |sine| falls by so much */

/* ---- nodes ---- */

int dm_footing_take(dm_search *s, dm_footing *p) {
    double *block = dm_arena_take(s->arena, 2 * (size_t)s->l->n * sizeof *block);
    *p = (dm_footing){.x = block, .v = block ? block + s->l->n : NULL};
    if (!block) s->over = 1;
    return block != NULL;
}

void dm_footing_copy(const dm_search *s, dm_footing *to, const dm_footing *from) {
    double *const x = to->x, *const v = to->v;
    memcpy(x, from->x, s->l->n * sizeof *x);
    memcpy(v, from->v, s->l->n * sizeof *v);
    *to = *from;
    to->x = x, to->v = v;
}

static double norm(const double *x, uint32_t n) {
    double sum = 0;
    for (uint32_t k = 0; k < n; k++) sum += x[k] * x[k];
    return sqrt(sum);
}

static double dot(const double *a, const double *b, uint32_t n) {
    double sum = 0;
    for (uint32_t k = 0; k < n; k++) sum += a[k] * b[k];
    return sum;
}

int dm_footing_step(dm_search *s, dm_footing *to, const double *from, const double *v, double h,
                    double fit) {
    dm_level *l = s->l;
    s->spent++;
    for (uint32_t k = 0; k < l->n; k++) to->x[k] = from[k] + (v ? h * v[k] : 0);
    if (v) memcpy(to->v, v, l->n * sizeof *v);
    if (!dm_level_bring(l, to->x, fit) || (v && !dm_level_turn(l, to->v, 0))) return 0;
    to->sine = dm_level_sine(l, &to->slant);
    to->size = fmax(norm(to->x, l->n), SMALL);
    to->reach = to->breaks = INFINITY;
    if (v) to->reach = dm_level_reach(l, to->v, &to->breaks);
    if (!isfinite(to->sine)) return 0;
    to->inside = s->how->inside(s->how->ud, to->x);
    return 1;
}

int dm_random_tangent(dm_search *s, const dm_footing *at, double *v) {
    const uint32_t i = s->random++;
    for (uint32_t k = 0; k < s->l->n; k++) v[k] = dm_random_normal(SEED, i, k);
    return dm_level_look(s->l, at->x) && dm_level_turn(s->l, v, 0);
}

/* ---- curves ---- */

int dm_trail_take(dm_search *s, dm_trail *c) {
    *c = (dm_trail){.ended = 1};
    return dm_footing_take(s, &c->at) && dm_footing_take(s, &c->before) &&
           dm_footing_take(s, &c->next) && dm_footing_take(s, c->left) &&
           dm_footing_take(s, c->left + 1);
}

void dm_trail_begin(dm_search *s, dm_trail *c, const dm_footing *at, const double *v, double step) {
    c->has_before = c->has_left = c->outside = 0;
    c->step = step;
    c->ended = !dm_level_look(s->l, at->x);
    if (c->ended) return;
    dm_footing_copy(s, &c->at, at);
    memcpy(c->at.v, v, s->l->n * sizeof *v);
    c->at.reach = dm_level_reach(s->l, v, &c->at.breaks);
}

static void swap(dm_footing *a, dm_footing *b) {
    const dm_footing kept = *a;
    *a = *b;
    *b = kept;
}

/* times a step, for the next one: so that the tangent turns by about BEND */
static double fitting(double turn) {
    const double angle = acos(fmin(1, fmax(-1, turn)));
    return fmax(SHORTER, fmin(LONGER, BEND / fmax(angle, 1e-9)));
}

/* one node further; 0: the curve ends */
static int advance(dm_search *s, dm_trail *c) {
    const double shortest = SHORTEST * c->at.size;
    while (!c->ended && c->step > shortest) {
        double h = fmax(fmin(c->step, c->at.reach), shortest);
        const int corner = c->at.breaks <= h;
        if (corner) h = c->at.breaks;
        const int is = dm_footing_step(s, &c->next, c->at.x, c->at.v, h, h);
        const double turn = is ? dot(c->next.v, c->at.v, s->l->n) : 0;
        if (turn > (corner ? CORNER : TURN)) {
            swap(&c->before, &c->at);
            swap(&c->at, &c->next);
            c->has_before = 1;
            c->outside = c->at.inside ? 0 : c->outside + 1;
            if (!corner) c->step = fmax(h, c->step) * fitting(turn);
            c->step = fmin(c->step, LONGEST * c->at.size);
            c->ended = !(c->at.size < FAR) || c->outside > GAP;
            return 1;
        }
        c->step = h * (is ? fitting(turn) : SHORTER);
    }
    c->ended = 1;
    return 0;
}

void dm_search_tell(dm_search *s, const dm_footing *a, const dm_footing *b, const dm_trail *left) {
    const double *pair[2] = {NULL, NULL};
    if (left) pair[0] = left->left[0].x, pair[1] = left->left[1].x;
    if (!s->how->found(s->how->ud, a->x, b->x, left ? pair : NULL)) s->over = 1;
}

/* The least |sine| between nodes a, b, c of a curve, of which b has the least so far, by
 * parabolas: 1 where it changes its sign. */
static int dip(dm_search *s, const dm_footing *before, const dm_footing *middle,
               const dm_footing *after) {
    const uint32_t n = s->l->n;
    dm_footing *a = s->spare, *b = s->spare + 1, *c = s->spare + 2, *m = s->spare + 3;
    dm_footing_copy(s, a, before), dm_footing_copy(s, b, middle), dm_footing_copy(s, c, after);
    for (int i = 0; i < DIPS; i++) {
        double p = 0, q = 0;
        for (uint32_t k = 0; k < n; k++) {
            p += (b->x[k] - a->x[k]) * (b->x[k] - a->x[k]);
            q += (c->x[k] - b->x[k]) * (c->x[k] - b->x[k]);
        }
        p = sqrt(p), q = sqrt(q);
        const double left = (fabs(b->sine) - fabs(a->sine)) / p,
                     right = (fabs(c->sine) - fabs(b->sine)) / q;
        const double bend = 2 * (right - left) / (p + q), slope = (left * q + right * p) / (p + q);
        const double least = fabs(b->sine) - slope * slope / (2 * bend);
        if (!(bend > 0 && least < DEEPER * fabs(b->sine))) return 0;
        dm_footing *other = slope < 0 ? c : a;
        const double length = slope < 0 ? q : p;
        const double share = fmin(fmax(fabs(slope / bend) / length, 0.05), 0.6);
        for (uint32_t k = 0; k < n; k++) s->v[k] = (other->x[k] - b->x[k]) / length;
        if (!dm_footing_step(s, m, b->x, s->v, share * length, share * length) || !m->inside)
            return 0;
        if (m->sine * b->sine < 0) {
            dm_search_tell(s, b, m, NULL);
            return 1;
        }
        if (fabs(m->sine) < fabs(b->sine)) {
            swap(slope < 0 ? a : c, b); /* b becomes the far end of the other side */
            swap(b, m);
        } else
            swap(other, m);
    }
    return 0;
}

void dm_trail_follow(dm_search *s, dm_trail *c, int count, int downhill) {
    while ((count-- > 0 || c->outside > 0) && !s->over) {
        const int had = c->has_before;
        /* next is where before was */
        if (!advance(s, c)) return;
        const dm_footing *one = &c->next, *two = &c->before, *three = &c->at;
        if (two->inside && three->inside) {
            const int grows = fabs(three->sine) > fabs(two->sine);
            if (three->sine * two->sine < 0) {
                dm_search_tell(s, two, three, NULL);
                c->ended = 1;
                return;
            }
            if (had && one->inside && grows && fabs(two->sine) < fabs(one->sine) &&
                dip(s, one, two, three)) {
                c->ended = 1;
                return;
            }
            if (downhill && grows) return;
        } else if (two->inside) {
            dm_footing_copy(s, c->left, two), dm_footing_copy(s, c->left + 1, three);
            c->has_left = 1;
        } else if (three->inside) {
            if (c->has_left) dm_search_tell(s, two, three, c);
            return;
        }
    }
}
