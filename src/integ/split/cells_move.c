/* cells_move.c - forces, kicks and drifts of entries: two by two, their forces in registers, four
 * passes over memory in all. Loops that are run most often have constants of their own. */
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
    double *x, *p, *low_q, *low_p, *force; /* of the first entry */
    const double *w;
    const uint32_t *start, *list; /* of the first entry: its terms are list[k] with k from *start */
    const double *slope;          /* NULL: forces are those in `force` */
    int keeps;                    /* forces are stored */
    dm_cells_move v;
} moved_block;

/* the sum of the terms of entry k; `terms` each (a constant where this is called) or, 0, as many as
 * it has */
__attribute__((always_inline)) static inline double force_of(const moved_block *b, uint32_t k,
                                                             const uint32_t terms) {
    const uint32_t *list = b->list + (terms ? (size_t)k * terms : b->start[k] - b->start[0]);
    const uint32_t count = terms ? terms : b->start[k + 1] - b->start[k];
    double sum = 0.0;
#pragma GCC unroll 6
    for (uint32_t j = 0; j < count; j++) sum += b->slope[list[j]];
    return sum;
}

/* Kicks and drift of entry k. The kick that begins a step is in p with the next one, by way of the
 * low part, where there are such. */
__attribute__((always_inline)) static inline void move_one(const moved_block *b, uint32_t k,
                                                           double f, const int plain,
                                                           const int usual) {
    const dm_cells_move *v = &b->v;
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

/* the same of two: their forces stay in registers, so that no load waits for their stores */
__attribute__((always_inline)) static inline void move_two(const moved_block *b, uint32_t k, v2 f,
                                                           const int plain, const int usual) {
    const dm_cells_move *v = &b->v;
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

/* Forces, kicks and drift of `count` entries. Constants where this is called: terms, plain and
 * usual, which says that there are slopes, both kicks and a drift, and no force is kept. */
__attribute__((always_inline)) static inline void move_block(moved_block b, uint32_t count,
                                                             const uint32_t terms, const int plain,
                                                             const int usual) {
    uint32_t k = 0;
    for (; k + 2 <= count; k += 2) {
        v2 f;
        if (usual || b.slope)
            f = (v2){force_of(&b, k, terms), force_of(&b, k + 1, terms)};
        else
            f = *(v2 *)(void *)(b.force + k);
        if (!usual && b.keeps) *(v2 *)(void *)(b.force + k) = f;
        move_two(&b, k, f, plain, usual);
    }
    for (; k < count; k++) {
        const double f = usual || b.slope ? force_of(&b, k, terms) : b.force[k];
        if (!usual && b.keeps) b.force[k] = f;
        move_one(&b, k, f, plain, usual);
    }
}

/* entries of surfaces inside of a burst have loops of their own: edges have two terms, vertices of
 * regular meshes six */
static void move(const moved_block *b, uint32_t count, uint32_t terms, int plain) {
    const dm_cells_move *v = &b->v;
    const int usual = b->slope && !b->keeps && v->kicks && v->begins && v->drift != 0.0;
    if (plain && usual && terms == 2)
        move_block(*b, count, 2, 1, 1);
    else if (plain && usual && terms == 6)
        move_block(*b, count, 6, 1, 1);
    else if (plain && usual)
        move_block(*b, count, 0, 1, 1);
    else if (plain)
        move_block(*b, count, 0, 1, 0);
    else if (usual && terms == 2)
        move_block(*b, count, 2, 0, 1);
    else if (usual && terms == 6)
        move_block(*b, count, 6, 0, 1);
    else if (usual)
        move_block(*b, count, 0, 0, 1);
    else
        move_block(*b, count, 0, 0, 0);
}

/* block of `count` entries from i on */
static moved_block block_at(const dm_cells_split *s, const dm_cells_move *v, uint32_t i) {
    const dm_cells *c = s->cells;
    double *p = s->state + s->m->n + i, *low_q = p + s->m->n;
    return (moved_block){.x = s->x + i,
                         .p = p,
                         .low_q = low_q,
                         .low_p = low_q + s->m->n,
                         .force = s->force + i,
                         .w = s->m->inverse_mass + i,
                         .start = c->start + i,
                         .list = c->list + c->start[i],
                         .v = *v};
}

/* Bits do not depend on where blocks begin. */
void dm_cells_move_block(const dm_cells_split *s, const dm_cells_move *v, uint32_t i,
                         uint32_t count, int how) {
    moved_block b = block_at(s, v, i);
    if (how != DM_CELLS_KNOWN) b.slope = s->slope;
    b.keeps = how == DM_CELLS_KEPT;
    move(&b, count, b.slope ? dm_cells_alike(s->cells, i, count) : 0, s->plain);
}
