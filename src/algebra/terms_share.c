/* Common parts of two: a pair of factors, or of terms up to a multiple, that several products
 * or sums contain becomes a term of its own. Pairs are counted, the commonest goes first, and
 * the rounds go on until no pair is left twice. */
#include "algebra/terms.h"

#include "graph/nodes.h"

#include <math.h>
#include <string.h>

enum {
    MOST_ROUNDS = 12,
    FEW = 2,     /* pairs shared in a round: the next one is not worth its time */
    LONGEST = 40 /* parts; a longer whole is left out */
};

typedef struct {
    dm_part a, b;         /* a before b; a.c = 1, b.c relative to a */
    uint32_t count, list; /* wholes that have it; the newest occurrence, plus one */
} pair;

typedef struct {
    dm_term whole;
    uint32_t next; /* occurrence of the same pair, plus one */
} occurrence;

typedef struct {
    dm_terms *s;
    dm_term_kind kind;
    pair *pairs;
    uint32_t *table; /* number of a pair plus one, 0 is free */
    occurrence *seen;
    uint32_t *uses; /* [terms] as parts */
    uint32_t pairs_size, seen_size, mask, room;
} sharing;

static uint32_t hash(const pair *p) {
    uint64_t bits, h;
    memcpy(&bits, &p->b.c, sizeof bits);
    h = (bits ^ (uint64_t)p->a.t << 32 ^ p->b.t) * 0x9E3779B97F4A7C15u;
    h = (h ^ h >> 31 ^ (uint64_t)(uint32_t)p->a.e << 32 ^ (uint32_t)p->b.e) * 0xD6E8FEB86659FD93u;
    return (uint32_t)(h >> 32);
}

static int same(const pair *p, const pair *q) {
    return p->a.t == q->a.t && p->b.t == q->b.t && p->a.e == q->a.e && p->b.e == q->b.e &&
           p->b.c == q->b.c;
}

/* coefficient of b when that of a is 1 */
static double relative(const dm_part *a, const dm_part *b) {
    return a->c == 1.0 ? b->c : b->c / a->c;
}

static pair pair_of(const dm_part *x, const dm_part *y) {
    const int swap = x->t > y->t || (x->t == y->t && x->e > y->e);
    pair p = {.a = swap ? *y : *x, .b = swap ? *x : *y};
    p.b.c = relative(&p.a, &p.b);
    p.a.c = 1.0;
    return p;
}

static void note(sharing *w, dm_term whole, const dm_part *x, const dm_part *y) {
    const pair p = pair_of(x, y);
    uint32_t slot = hash(&p) & w->mask;
    while (w->table[slot] && !same(w->pairs + w->table[slot] - 1, &p)) slot = (slot + 1) & w->mask;
    if (!w->table[slot]) {
        w->pairs[w->pairs_size++] = p;
        w->table[slot] = w->pairs_size;
    }
    pair *q = w->pairs + w->table[slot] - 1;
    if (q->list && w->seen[q->list - 1].whole == whole) return; /* x x y: x y once */
    w->seen[w->seen_size++] = (occurrence){whole, q->list};
    q->list = w->seen_size;
    q->count++;
}

/* whole powers of a term written out, x^2 as x x, so that x y can be found in x^2 y */
static void write_out(dm_terms *s, dm_term t) {
    uint32_t count = 0;
    int changed = 0;
    const dm_term_entry *e = s->entries + t;
    if (!dm_terms_reserve(s, 4 * e->size)) return;
    for (uint32_t i = 0; i < e->size; i++) {
        dm_part p = s->parts[e->body + i];
        const int units = p.e > 2 && p.e <= 6 && p.e % 2 == 0 ? p.e / 2 : 1;
        changed |= units > 1;
        if (units > 1) p.e = 2;
        for (int k = 0; k < units; k++) s->scratch[count++] = p;
    }
    if (changed) dm_terms_rewrite(s, t, count);
}

/* c * (a b) as a product with the factor c, so that c a can be shared too */
static void take_coefficient(dm_terms *s, dm_part *p, const uint32_t *uses) {
    const dm_term_entry *e = s->entries + p->t;
    if (fabs(p->c) == 1.0 || uses[p->t] != 1 || p->t == 0 || e->size < 1 ||
        e->kind != DM_TERM_PRODUCT)
        return;
    const double c = fabs(p->c);
    const dm_part operand = {.c = c, .t = 0};
    const dm_term_entry head = {.kind = DM_TERM_ATOM,
                                .op = DM_OP_CONSTANT,
                                .nonnegative = 1,
                                .count = 1};
    const dm_term constant = dm_terms_make(s, &head, &operand);
    e = s->entries + p->t;
    if (!dm_terms_reserve(s, e->size + 1)) return;
    memcpy(s->scratch, s->parts + e->body, e->size * sizeof *s->scratch);
    s->scratch[e->size] = (dm_part){.c = 1.0, .t = constant, .e = 2};
    p->t = dm_terms_product(s, 1.0, e->size + 1).t;
    p->c = p->c < 0.0 ? -1.0 : 1.0;
}

static void take_coefficients(dm_terms *s, dm_scaled *roots, uint32_t m) {
    dm_term *order;
    uint32_t *uses;
    const uint32_t count = dm_terms_order(s, roots, m, &order, &uses);
    if (dm_graph_status(s->g) != DM_OK) return;
    for (uint32_t i = 0; i < count; i++) {
        const dm_term t = order[i];
        if (s->entries[t].kind != DM_TERM_SUM) continue;
        for (uint32_t k = 0; k < s->entries[t].size; k++) {
            dm_part p = s->parts[s->entries[t].body + k];
            take_coefficient(s, &p, uses);
            s->parts[s->entries[t].body + k] = p;
        }
    }
    for (uint32_t i = 0; i < m; i++) {
        dm_part p = {.c = roots[i].c, .t = roots[i].t};
        take_coefficient(s, &p, uses);
        roots[i] = (dm_scaled){p.c, p.t};
    }
}

/* a part that nothing else has is in no pair that something else has: those left, copied to `to` */
static uint32_t parts_of_several(const sharing *w, dm_term t, dm_part *to) {
    const dm_term_entry *e = w->s->entries + t;
    const dm_part *p = w->s->parts + e->body;
    uint32_t kept = 0;
    if (e->kind != w->kind || e->size > LONGEST) return 0;
    for (uint32_t i = 0; i < e->size; i++)
        if (w->uses[p[i].t] > 1) to[kept++] = p[i];
    return kept;
}

static uint32_t count_pairs(const sharing *w, const dm_term *order, uint32_t count) {
    uint32_t sum = 0;
    dm_part parts[LONGEST];
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t kept = parts_of_several(w, order[i], parts);
        sum += kept * (kept - (kept > 0)) / 2;
    }
    return sum;
}

static int open_round(sharing *w, uint32_t room) {
    dm_arena *arena = w->s->arena;
    uint32_t slots = 64;
    while (slots < 2 * room) slots *= 2;
    if (room > w->room) {
        w->pairs = dm_arena_take(arena, room * sizeof *w->pairs);
        w->seen = dm_arena_take(arena, room * sizeof *w->seen);
        w->table = dm_arena_take(arena, slots * sizeof *w->table);
        w->room = room;
    }
    if (!w->pairs || !w->seen || !w->table) return (int)dm_graph_fail(w->s->g, DM_NO_MEMORY);
    memset(w->table, 0, slots * sizeof *w->table);
    w->mask = slots - 1;
    w->pairs_size = w->seen_size = 0;
    return 1;
}

static void note_pairs(sharing *w, dm_term t) {
    dm_part p[LONGEST];
    const uint32_t count = parts_of_several(w, t, p);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = i + 1; j < count; j++) note(w, t, p + i, p + j);
}

/* where the pair is in a whole, now; 0 when it is gone */
static int find_pair(const dm_terms *s, dm_term whole, const pair *p, uint32_t at[2]) {
    const dm_term_entry *e = s->entries + whole;
    const dm_part *part = s->parts + e->body;
    for (uint32_t i = 0; i < e->size; i++) {
        if (part[i].t != p->a.t || part[i].e != p->a.e) continue;
        for (uint32_t j = 0; j < e->size; j++) {
            if (j == i || part[j].t != p->b.t || part[j].e != p->b.e) continue;
            if (relative(part + i, part + j) != p->b.c) continue;
            at[0] = i;
            at[1] = j;
            return 1;
        }
    }
    return 0;
}

static void replace_pair(sharing *w, dm_term whole, const uint32_t at[2], dm_scaled by) {
    dm_terms *s = w->s;
    dm_term_entry *e = s->entries + whole;
    dm_part *p = s->parts + e->body;
    const dm_part a = p[at[0]];
    p[at[0]] = (dm_part){.c = a.c * by.c, .t = by.t, .e = w->kind == DM_TERM_PRODUCT ? 2 : 0};
    p[at[1]] = p[--e->size];
}

static uint32_t still_there(const sharing *w, const pair *p) {
    uint32_t count = 0, at[2];
    for (uint32_t k = p->list; k; k = w->seen[k - 1].next)
        count += (uint32_t)find_pair(w->s, w->seen[k - 1].whole, p, at);
    return count;
}

/* make the pair a term and put it into all that have it */
static int share_pair(sharing *w, const pair *p) {
    dm_terms *s = w->s;
    uint32_t at[2];
    if (still_there(w, p) < 2) return 0;
    s->scratch[0] = p->a;
    s->scratch[1] = p->b;
    const dm_scaled both =
        w->kind == DM_TERM_PRODUCT ? dm_terms_product(s, 1.0, 2) : dm_terms_sum(s, 2);
    const dm_term_kind kind = s->entries[both.t].kind;
    if (dm_graph_status(s->g) != DM_OK || kind != w->kind) return 0;
    for (uint32_t k = p->list; k; k = w->seen[k - 1].next) {
        const dm_term whole = w->seen[k - 1].whole;
        while (whole != both.t && find_pair(s, whole, p, at)) replace_pair(w, whole, at, both);
    }
    return 1;
}

/* pairs by falling count, those of equal count as they were met; gives how many were shared */
static uint32_t share_round(sharing *w) {
    uint32_t most = 0, shared = 0;
    for (uint32_t i = 0; i < w->pairs_size; i++)
        if (w->pairs[i].count > most) most = w->pairs[i].count;
    for (uint32_t count = most > 64 ? 64 : most; count >= 2; count--)
        for (uint32_t i = 0; i < w->pairs_size; i++) {
            const uint32_t own = w->pairs[i].count > 64 ? 64 : w->pairs[i].count;
            if (own == count) shared += (uint32_t)share_pair(w, w->pairs + i);
        }
    return shared;
}

void dm_terms_share(dm_terms *s, dm_scaled *roots, uint32_t m, dm_term_kind kind) {
    sharing w = {.s = s, .kind = kind};
    if (kind == DM_TERM_PRODUCT) take_coefficients(s, roots, m);
    for (int round = 0; round < MOST_ROUNDS; round++) {
        dm_term *order;
        const uint32_t count = dm_terms_order(s, roots, m, &order, &w.uses);
        for (uint32_t i = 0; i < count && kind == DM_TERM_PRODUCT; i++)
            if (s->entries[order[i]].kind == kind) write_out(s, order[i]);
        if (!open_round(&w, count_pairs(&w, order, count) + 1)) return;
        for (uint32_t i = 0; i < count; i++) note_pairs(&w, order[i]);
        if (dm_graph_status(s->g) != DM_OK || share_round(&w) < FEW) return;
    }
}
