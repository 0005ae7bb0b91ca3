/* cells_move.c - kicks and drifts of entries: two by two, in one pass over memory. Loops that are
 * run most often have constants of their own. */
#include "integ/split/cells_split_inside.h"
#include "numbers/compensated.h"

typedef double v2 __attribute__((vector_size(16), aligned(8), may_alias));

/* high + low += x of two entries (numbers/compensated.h); returns high */
static inline v2 add_two(double *high, double *low, v2 x) {
    const v2 a = *(v2 *)(void *)high, e = *(v2 *)(void *)low + x, sum = a + e;
    *(v2 *)(void *)low = e + (a - sum);
    *(v2 *)(void *)high = sum;
    return sum;
}

/* A block of entries and what they are moved by, laid out so that loops keep it in registers. */
typedef struct {
    double *x, *p, *low_q, *low_p; /* of the first entry */
    const double *w, *force;
    dm_cells_move v;
} moved_block;

/* Kicks and drift of entry k. The kick that begins a step is in p with the next one, by way of the
 * low part, where there are such. */
__attribute__((always_inline)) static inline void move_one(const moved_block *b, uint32_t k,
                                                           const int plain, const int usual) {
    const dm_cells_move *v = &b->v;
    const double f = b->force[k];
    double now = b->p[k];
    if (usual || v->kicks) {
        if (plain)
            b->p[k] = now + v->kick * f;
        else
            dm_sum_add(b->p + k, b->low_p + k, v->kick * f);
        now = b->p[k];
    }
    if (usual || v->begins) {
        now += v->begin * f;
        if (plain)
            b->p[k] = now;
        else
            b->low_p[k] += v->begin * f;
    }
    const double drift = (v->drift * b->w[k]) * now;
    if (!usual && v->drift == 0.0) return;
    if (plain)
        b->x[k] += drift;
    else
        dm_sum_add(b->x + k, b->low_q + k, drift);
}

/* the same of two */
__attribute__((always_inline)) static inline void move_two(const moved_block *b, uint32_t k,
                                                           const int plain, const int usual) {
    const dm_cells_move *v = &b->v;
    const v2 f = *(const v2 *)(const void *)(b->force + k);
    const v2 kick = v->kick * f, begin = v->begin * f;
    v2 now = *(v2 *)(void *)(b->p + k);
    if (usual || v->kicks) {
        if (plain)
            now += kick;
        else
            now = add_two(b->p + k, b->low_p + k, kick);
    }
    if (usual || v->begins) now += begin;
    if (plain)
        *(v2 *)(void *)(b->p + k) = now;
    else if (usual || v->begins)
        *(v2 *)(void *)(b->low_p + k) += begin;
    const v2 drift = (v->drift * *(const v2 *)(const void *)(b->w + k)) * now;
    if (!usual && v->drift == 0.0) return;
    if (plain)
        *(v2 *)(void *)(b->x + k) += drift;
    else
        add_two(b->x + k, b->low_q + k, drift);
}

/* Kicks and drift of `count` entries. Constants where this is called: plain, and usual, which says
 * that there are both kicks and a drift. */
__attribute__((always_inline)) static inline void move(const moved_block *b, uint32_t count,
                                                       const int plain, const int usual) {
    const moved_block own = *b;
    uint32_t k = 0;
    for (; k + 2 <= count; k += 2) move_two(&own, k, plain, usual);
    for (; k < count; k++) move_one(&own, k, plain, usual);
}

/* Bits do not depend on where blocks begin. */
void dm_cells_move_block(const dm_cells_split *s, const dm_cells_move *v, uint32_t i,
                         uint32_t count) {
    double *p = s->state + s->m->n + i, *low_q = p + s->m->n;
    const moved_block b = {.x = s->x + i,
                           .p = p,
                           .low_q = low_q,
                           .low_p = low_q + s->m->n,
                           .w = s->m->inverse_mass + i,
                           .force = s->force + i,
                           .v = *v};
    const int usual = v->kicks && v->begins && v->drift != 0.0; /* inside of a burst */
    if (s->plain && usual)
        move(&b, count, 1, 1);
    else if (s->plain)
        move(&b, count, 1, 0);
    else if (usual)
        move(&b, count, 0, 1);
    else
        move(&b, count, 0, 0);
}
