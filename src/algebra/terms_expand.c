/* terms_expand.c - (a + b) c = a c + b c, so that like terms of different roads meet; and the
 * squares of sums of sines and cosines, so that sin^2 + cos^2 = 1 can be seen. This is more
 * than a saving: a rod whose velocity is written by components is found to have a constant mass
 * by it.
 *
 * One sum a product at most is opened: with two, small differences would become differences of
 * large products. Sums of plain inputs stay closed for the same reason: x - y is exact, x c - y
 * c is not. What is divided by or under a root stays as it is. */
#include "algebra/terms.h"

#include "graph/nodes.h"

#include <string.h>

enum { LONGEST_SUM = 48, LONGEST_SQUARE = 8 };

/* terms on their way, parts before wholes */
typedef struct {
    dm_terms *s;
    dm_scaled *now;       /* [terms] what each became */
    const uint32_t *uses; /* [terms] how often each was a part */
    int closes;           /* shared parts that meet nothing */
    uint32_t shared;      /* sums with such parts */
    dm_part list[LONGEST_SUM * (LONGEST_SQUARE + 1)];
    uint32_t count;
} expansion;

/* a number or an input */
static int is_leaf(const dm_terms *s, dm_term t) {
    return t == 0 || (s->entries[t].kind == DM_TERM_ATOM && s->entries[t].count == 0);
}

/* a sum that may be multiplied out */
static int is_open(const dm_terms *s, dm_term t) {
    const dm_term_entry *e = s->entries + t;
    if (e->kind != DM_TERM_SUM || e->count > LONGEST_SUM) return 0;
    for (uint32_t i = 0; i < e->count; i++)
        if (!is_leaf(s, s->parts[e->first + i].t)) return 1;
    return 0;
}

/* sine or cosine */
static int is_angle_function(const dm_terms *s, dm_term t) {
    const dm_term_entry *e = s->entries + t;
    return e->kind == DM_TERM_ATOM && (e->op == DM_OP_SIN || e->op == DM_OP_COS);
}

/* one of them, or a product with one */
static int has_angle_function(const dm_terms *s, dm_term t) {
    const dm_term_entry *e = s->entries + t;
    if (is_angle_function(s, t)) return 1;
    for (uint32_t i = 0; e->kind == DM_TERM_PRODUCT && i < e->count; i++)
        if (is_angle_function(s, s->parts[e->first + i].t)) return 1;
    return 0;
}

/* every term has a sine or cosine: as a square it may collapse */
static int is_trigonometric(const dm_terms *s, dm_term t) {
    const dm_term_entry *e = s->entries + t;
    if (e->kind != DM_TERM_SUM || e->count > LONGEST_SQUARE) return 0;
    for (uint32_t i = 0; i < e->count; i++)
        if (!has_angle_function(s, s->parts[e->first + i].t)) return 0;
    return 1;
}

/* c * (rest[count] * t) onto the list; 0 when it is full */
static int push_product(expansion *x, double c, const dm_part *rest, uint32_t count, dm_term t) {
    dm_terms *s = x->s;
    if (x->count == sizeof x->list / sizeof x->list[0]) return 0;
    if (!dm_terms_reserve(s, count + 2 * DM_MOST_FACTORS)) return 0;
    if (count) memcpy(s->scratch, rest, count * sizeof *rest);
    const uint32_t more = dm_terms_factors(s, t, s->scratch + count);
    const dm_scaled p = dm_terms_product(s, c, count + more);
    x->list[x->count++] = (dm_part){.c = p.c, .t = p.t};
    return 1;
}

/* the list as a term; `otherwise` where it has become too long */
static dm_scaled sum_of_list(expansion *x, dm_scaled otherwise) {
    if (x->count > 2 * LONGEST_SUM || !dm_terms_reserve(x->s, x->count + 1)) return otherwise;
    memcpy(x->s->scratch, x->list, x->count * sizeof *x->list);
    return dm_terms_sum(x->s, x->count);
}

/* p[count] with the sum p[at] to the first power: a c + b c + ... */
static dm_scaled multiply_out(expansion *x, dm_scaled whole, dm_part *p, uint32_t count,
                              uint32_t at) {
    const dm_term sum = p[at].t;
    const uint32_t parts = x->s->entries[sum].count;
    p[at] = p[count - 1];
    x->count = 0;
    for (uint32_t i = 0; i < parts; i++) {
        const dm_part part = x->s->parts[x->s->entries[sum].first + i];
        const double c = dm_terms_times(x->s, whole.c, part.c);
        if (!push_product(x, c, p, count - 1, part.t)) return whole;
    }
    return sum_of_list(x, whole);
}

/* p[count] with the sum p[at] squared: a a c + 2 a b c + ... */
static dm_scaled square_out(expansion *x, dm_scaled whole, dm_part *p, uint32_t count,
                            uint32_t at) {
    const dm_terms *s = x->s;
    const dm_term sum = p[at].t;
    const uint32_t parts = s->entries[sum].count;
    p[at] = p[count - 1];
    x->count = 0;
    for (uint32_t i = 0; i < parts; i++)
        for (uint32_t j = i; j < parts; j++) {
            const dm_part a = s->parts[s->entries[sum].first + i];
            const dm_part b = s->parts[s->entries[sum].first + j];
            dm_part rest[DM_MOST_FACTORS * 2 + 1];
            if (count > 1) memcpy(rest, p, (count - 1) * sizeof *p);
            const uint32_t more = dm_terms_factors(s, a.t, rest + count - 1);
            const double c = dm_terms_times(x->s, whole.c * a.c, b.c) * (i == j ? 1.0 : 2.0);
            if (!push_product(x, c, rest, count - 1 + more, b.t)) return whole;
        }
    return sum_of_list(x, whole);
}

/* factors of a factor's new form; the coefficient goes into *c */
static uint32_t new_factors(expansion *x, const dm_part *p, dm_part *to, double *c) {
    const dm_scaled now = x->now[p->t];
    const dm_term_entry *e = x->s->entries + now.t;
    const int whole = p->e > 0 && p->e % 2 == 0;
    *to = *p;
    if (!whole || e->kind == DM_TERM_PRODUCT || now.t == 0) return 1;
    to->t = now.t;
    for (int32_t k = 0; k < p->e; k += 2) *c = dm_terms_times(x->s, *c, now.c);
    return 1;
}

/* the term became another one, or is a sum that may be multiplied out */
static int is_touched(const expansion *x, dm_term t) {
    return x->now[t].t != t || x->now[t].c != 1.0 || is_open(x->s, t);
}

/* nothing below is touched: the term stays */
static int is_settled(const expansion *x, dm_term t) {
    const dm_term_entry *e = x->s->entries + t;
    for (uint32_t i = 0; i < e->count; i++) {
        const dm_part *p = x->s->parts + e->first + i;
        if (is_touched(x, p->t) || (p->e == 4 && is_trigonometric(x->s, p->t))) return 0;
    }
    return 1;
}

/* opened where exactly one factor may be */
static dm_scaled expand_product(expansion *x, dm_term t) {
    dm_terms *s = x->s;
    const uint32_t count = s->entries[t].count;
    dm_part p[DM_MOST_FACTORS];
    uint32_t open = 0, square = 0, at = 0;
    double c = 1.0;
    if (count > DM_MOST_FACTORS || is_settled(x, t)) return (dm_scaled){1.0, t};
    for (uint32_t i = 0; i < count; i++) {
        const dm_part old = s->parts[s->entries[t].first + i];
        new_factors(x, &old, p + i, &c);
        if (p[i].e == 2 && is_open(s, p[i].t))
            open++, at = i;
        else if (p[i].e == 4 && is_trigonometric(s, p[i].t))
            square++, at = i;
    }
    if (count) memcpy(s->scratch, p, count * sizeof *p);
    const dm_scaled whole = dm_terms_product(s, c, count);
    if (open + square != 1) return whole;
    dm_scaled bare = {c, whole.t};
    return open ? multiply_out(x, bare, p, count, at) : square_out(x, bare, p, count, at);
}

/* t with the sin^2 of its factor `at` replaced by cos^2, and without it; 0: no such factor */
static dm_term turned(dm_terms *s, dm_term t, uint32_t at, dm_term *without) {
    dm_part p[DM_MOST_FACTORS];
    const uint32_t count = dm_terms_factors(s, t, p);
    const dm_term_entry *e = s->entries + p[at].t;
    if (!is_angle_function(s, p[at].t) || e->op != DM_OP_SIN || p[at].e < 4) return 0;
    const dm_part angle = s->parts[e->first];
    const dm_term_entry cosine = {.kind = DM_TERM_ATOM, .op = DM_OP_COS, .count = 1};
    const dm_part square = {.c = 1.0, .t = dm_terms_make(s, &cosine, &angle), .e = 4};
    uint32_t kept = 0;
    p[at].e -= 4;
    for (uint32_t k = 0; k < count; k++)
        if (p[k].e != 0) s->scratch[kept++] = p[k];
    *without = dm_terms_product(s, 1.0, kept).t;
    kept = dm_terms_factors(s, *without, s->scratch);
    s->scratch[kept++] = square;
    return dm_terms_product(s, 1.0, kept).t;
}

/* m sin^2 + m cos^2 = m for term i of the list and another; 1 when there was one */
static int collapse_term(expansion *x, uint32_t i) {
    dm_part p[DM_MOST_FACTORS];
    const uint32_t count = dm_terms_factors(x->s, x->list[i].t, p);
    for (uint32_t at = 0; at < count; at++) {
        dm_term without;
        const dm_term other = turned(x->s, x->list[i].t, at, &without);
        for (uint32_t j = 0; other && j < x->count; j++) {
            if (x->list[j].t != other || x->list[j].c != x->list[i].c) continue;
            x->list[j].t = without;
            x->list[i] = x->list[--x->count];
            return 1;
        }
    }
    return 0;
}

/* else nothing can collapse */
static int has_squared_cosine(const dm_terms *s, dm_term t) {
    const dm_term_entry *e = s->entries + t;
    for (uint32_t i = 0; e->kind == DM_TERM_PRODUCT && i < e->count; i++) {
        const dm_part *p = s->parts + e->first + i;
        if (p->e >= 4 && is_angle_function(s, p->t) && s->entries[p->t].op == DM_OP_COS) return 1;
    }
    return 0;
}

/* one pair of terms; 1 when there was one */
static int collapse(expansion *x) {
    uint32_t cosines = 0;
    for (uint32_t i = 0; i < x->count; i++)
        cosines += (uint32_t)has_squared_cosine(x->s, x->list[i].t);
    if (cosines == 0) return 0;
    for (uint32_t i = 0; i < x->count; i++)
        if (collapse_term(x, i)) return 1;
    return 0;
}

/* parts[count] of what they became, none opened */
static dm_scaled closed_sum(expansion *x, const dm_part *parts, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const dm_scaled now = x->now[parts[i].t];
        x->s->scratch[i] = (dm_part){.c = dm_terms_times(x->s, parts[i].c, now.c), .t = now.t};
    }
    return dm_terms_sum(x->s, count);
}

/* Is one of these parts a sum that others have, too? */
static int is_shared(const expansion *x, const dm_part *parts, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        if (x->uses[parts[i].t] > 1 && is_open(x->s, x->now[parts[i].t].t)) return 1;
    return 0;
}

/* parts that became sums are opened in place, then pairs collapse as long as there are some. Where
 * nothing meets shared parts may stay closed: a force and its opposite are one sum then, and
 * opposite to the last bit. */
static dm_scaled expand_sum(expansion *x, dm_term t) {
    dm_terms *s = x->s;
    const uint32_t count = s->entries[t].count;
    dm_part kept[LONGEST_SUM];
    if (count > LONGEST_SUM) return (dm_scaled){1.0, t};
    memcpy(kept, s->parts + s->entries[t].first, count * sizeof *kept);
    const int shared = is_shared(x, kept, count);
    x->count = 0;
    for (uint32_t i = 0; i < count; i++) {
        const dm_scaled now = x->now[kept[i].t];
        const dm_term_entry *e = s->entries + now.t;
        const uint32_t parts = is_open(s, now.t) ? e->count : 0;
        if (x->count + parts + 1 > 2 * LONGEST_SUM) return (dm_scaled){1.0, t};
        const double c = dm_terms_times(x->s, kept[i].c, now.c);
        if (!parts) x->list[x->count++] = (dm_part){.c = c, .t = now.t};
        for (uint32_t k = 0; k < parts; k++) {
            x->list[x->count] = s->parts[e->first + k];
            x->list[x->count++].c *= c;
        }
    }
    const uint32_t opened = x->count;
    dm_scaled sum = sum_of_list(x, (dm_scaled){1.0, t});
    int met = !(s->entries[sum.t].kind == DM_TERM_SUM && s->entries[sum.t].count == opened);
    while (s->entries[sum.t].kind == DM_TERM_SUM) {
        const dm_term_entry *e = s->entries + sum.t;
        x->count = e->count;
        for (uint32_t k = 0; k < e->count; k++) {
            x->list[k] = s->parts[e->first + k];
            x->list[k].c *= sum.c;
        }
        if (!collapse(x)) break;
        met = 1;
        sum = sum_of_list(x, sum);
    }
    if (!shared || met) return sum;
    x->shared++;
    return x->closes && dm_terms_reserve(s, count) ? closed_sum(x, kept, count) : sum;
}

/* the same function of what its operands became */
static dm_scaled expand_atom(expansion *x, dm_term t) {
    const dm_term_entry head = x->s->entries[t];
    dm_part arg[3];
    if (is_settled(x, t)) return (dm_scaled){1.0, t};
    for (uint32_t k = 0; k < head.count; k++) {
        arg[k] = x->s->parts[head.first + k];
        arg[k].c *= x->now[arg[k].t].c;
        arg[k].t = x->now[arg[k].t].t;
    }
    return (dm_scaled){1.0, head.count ? dm_terms_make(x->s, &head, arg) : t};
}

/* every term after its parts */
uint32_t dm_terms_expand(dm_terms *s, dm_scaled *roots, uint32_t m, int closes) {
    dm_arena *arena = s->arena;
    dm_term *order;
    uint32_t *uses;
    const uint32_t count = dm_terms_order(s, roots, m, &order, &uses);
    expansion *x = dm_arena_take(arena, sizeof *x);
    dm_scaled *now = dm_arena_take(arena, s->size * sizeof *now);
    if (!x || !now) dm_graph_fail(s->g, DM_NO_MEMORY);
    if (dm_graph_status(s->g) != DM_OK) return 0;
    x->s = s;
    x->closes = closes, x->shared = 0;
    x->now = now;
    x->uses = uses;
    for (uint32_t i = 0; i < count; i++) {
        const dm_term t = order[i];
        const uint8_t kind = s->entries[t].kind;
        now[t] = kind == DM_TERM_SUM       ? expand_sum(x, t)
                 : kind == DM_TERM_PRODUCT ? expand_product(x, t)
                                           : expand_atom(x, t);
    }
    for (uint32_t i = 0; i < m; i++) {
        const dm_scaled r = now[roots[i].t];
        roots[i] = (dm_scaled){roots[i].c * r.c, r.t};
    }
    return x->shared;
}
