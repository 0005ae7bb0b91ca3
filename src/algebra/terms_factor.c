/* terms_factor.c - a b + a c = a (b + c), as long as a sum has a factor that saves a
 * multiplication. A product that has other users is left whole: pulling it apart would make it
 * twice.
 * Speed: henon, kahan-li(8): 1.31x. */
#include "algebra/terms.h"

#include "graph/nodes.h"

#include <stdlib.h>
#include <string.h>

/* one power that occurs in the terms of a sum */
typedef struct {
    dm_term t;
    int32_t e; /* the smallest exponent, all of one sign */
    int saved; /* multiplications fewer when it is pulled out, plus one */
} candidate;

enum { MOST_CANDIDATES = 64, LONGEST_SUM = 400 };

/* terms while sums are looked at one after the other; new ones join the queue */
typedef struct {
    dm_terms *s;
    uint32_t *uses; /* [room] */
    dm_term *queue; /* sums still to be looked at */
    uint32_t room, queued;
    candidate found[MOST_CANDIDATES];
    uint32_t founds;
} factoring;

/* factors that may be taken from a term; a product of several users has none */
static uint32_t open_factors(const factoring *f, dm_term t, dm_part *to) {
    const dm_term_entry *e = f->s->entries + t;
    if (t == 0 || (e->kind == DM_TERM_PRODUCT && f->uses[t] > 1)) return 0;
    return dm_terms_factors(f->s, t, to);
}

/* a power that one more term has */
static void note(factoring *f, const dm_part *p, int saved) {
    for (uint32_t i = 0; i < f->founds; i++) {
        candidate *c = f->found + i;
        if (c->t != p->t || (c->e > 0) != (p->e > 0)) continue;
        if (abs(p->e) < abs(c->e)) c->e = p->e;
        c->saved += saved;
        return;
    }
    if (f->founds < MOST_CANDIDATES) f->found[f->founds++] = (candidate){p->t, p->e, saved};
}

/* the power that saves most in the sum t, NULL when none saves anything */
static const candidate *best_candidate(factoring *f, dm_term t) {
    const dm_term_entry *e = f->s->entries + t;
    const candidate *best = NULL;
    dm_part factors[DM_MOST_FACTORS];
    f->founds = 0;
    for (uint32_t i = 0; i < e->size; i++) {
        const dm_term part = f->s->parts[e->body + i].t;
        const uint32_t count = open_factors(f, part, factors);
        for (uint32_t k = 0; k < count; k++)
            note(f, factors + k, f->s->entries[part].kind == DM_TERM_PRODUCT);
    }
    for (uint32_t i = 0; i < f->founds; i++)
        if (f->found[i].saved > (best ? best->saved : 1)) best = f->found + i;
    return best;
}

/* is the power among them, with that sign? */
static int has_factor(const dm_part *factors, uint32_t count, const candidate *c) {
    for (uint32_t k = 0; k < count; k++)
        if (factors[k].t == c->t && (factors[k].e > 0) == (c->e > 0)) return 1;
    return 0;
}

/* t / (power), given that the power is a factor of it */
static dm_term quotient(factoring *f, dm_term t, const candidate *c) {
    dm_part *p = f->s->scratch;
    const uint32_t count = dm_terms_factors(f->s, t, p);
    uint32_t kept = 0;
    int taken = 0;
    for (uint32_t k = 0; k < count; k++) {
        p[kept] = p[k];
        if (!taken && p[k].t == c->t && (p[k].e > 0) == (c->e > 0)) {
            p[kept].e -= c->e;
            taken = 1;
        }
        kept += p[kept].e != 0;
    }
    return dm_terms_product(f->s, 1.0, kept).t;
}

/* one user more */
static void use(factoring *f, dm_term t) {
    if (t < f->room) f->uses[t]++;
}

/* power * sum, the sum opened when it came out as a product */
static dm_term power_times(factoring *f, const candidate *c, dm_term sum) {
    dm_part *p = f->s->scratch;
    p[0] = (dm_part){.c = 1.0, .t = c->t, .e = c->e};
    const uint32_t count = 1 + dm_terms_factors(f->s, sum, p + 1);
    return dm_terms_product(f->s, 1.0, count).t;
}

/* the sum t = rest + power * inner; returns 0 without memory */
static int pull_out(factoring *f, dm_term t, const candidate *c) {
    dm_terms *s = f->s;
    const uint32_t size = s->entries[t].size;
    dm_part *rest = dm_arena_take(s->arena, 2 * (size + 1) * sizeof *rest);
    dm_part *inner = rest + size + 1, factors[DM_MOST_FACTORS];
    uint32_t rests = 0, inners = 0;
    if (!rest) return (int)dm_graph_fail(s->g, DM_NO_MEMORY);
    for (uint32_t i = 0; i < size; i++) {
        const dm_part p = s->parts[s->entries[t].body + i];
        if (has_factor(factors, open_factors(f, p.t, factors), c)) {
            inner[inners] = (dm_part){.c = p.c, .t = quotient(f, p.t, c)};
            use(f, inner[inners++].t);
        } else {
            rest[rests++] = p;
        }
    }
    if (!dm_terms_reserve(s, size + 2 * DM_MOST_FACTORS)) return 0;
    memcpy(s->scratch, inner, inners * sizeof *inner);
    const dm_scaled sum = dm_terms_sum(s, inners);
    use(f, sum.t);
    if (s->entries[sum.t].kind == DM_TERM_SUM && sum.t < f->room && f->queued < f->room)
        f->queue[f->queued++] = sum.t;
    const dm_term whole = power_times(f, c, sum.t);
    use(f, whole);
    rest[rests++] = (dm_part){.c = sum.c, .t = whole};
    memcpy(s->scratch, rest, rests * sizeof *rest);
    dm_terms_rewrite(s, t, rests);
    return 1;
}

/* the best power first, again and again */
static void factor_sum(factoring *f, dm_term t) {
    const candidate *c;
    if (f->s->entries[t].size > LONGEST_SUM) return;
    while ((c = best_candidate(f, t))) {
        const candidate chosen = *c;
        if (!pull_out(f, t, &chosen)) return;
    }
}

/* sums from the inputs up; what is pulled out may be a sum again */
void dm_terms_factor(dm_terms *s, const dm_scaled *roots, uint32_t m) {
    factoring f = {.s = s, .room = 4 * s->size};
    dm_arena *arena = s->arena;
    dm_term *order;
    uint32_t *uses;
    const uint32_t size = s->size, count = dm_terms_order(s, roots, m, &order, &uses);
    f.uses = dm_arena_take(arena, f.room * sizeof *f.uses);
    f.queue = dm_arena_take(arena, f.room * sizeof *f.queue);
    if (!f.uses || !f.queue) dm_graph_fail(s->g, DM_NO_MEMORY);
    if (dm_graph_status(s->g) != DM_OK) return;
    memset(f.uses, 0, f.room * sizeof *f.uses);
    memcpy(f.uses, uses, size * sizeof *uses);
    for (uint32_t i = 0; i < count; i++)
        if (s->entries[order[i]].kind == DM_TERM_SUM) f.queue[f.queued++] = order[i];
    for (uint32_t i = 0; i < f.queued && s->size < f.room; i++) factor_sum(&f, f.queue[i]);
}
