/* terms.c - the store of terms: hash-consed like nodes, so that equal terms are equal numbers.
 * What a term is known by (first, count) never changes; what it is made of (body, size) is
 * rewritten when factors are pulled out, without making it another term. Products and sums are
 * in canonical form: parts sorted by number, like ones gathered, a common coefficient in front.
 * `unfit` is set where a coefficient overflows or underflows on the way; the graph is then left
 * as it was. */
#include "algebra/terms.h"

#include "graph/nodes.h"

#include <math.h>
#include <string.h>

enum { FIRST_TERMS = 256 };

/* no memory: the graph has failed, too */
static int fail(dm_terms *s) {
    dm_graph_fail(s->g, DM_NO_MEMORY);
    return 0;
}

/* the sum over the parts is free of order, so that they need not wait for each other */
static uint64_t hash_part(const dm_part *p) {
    uint64_t x;
    memcpy(&x, &p->c, sizeof x);
    x ^= x >> 32 ^ p->t ^ (uint64_t)(uint32_t)p->e << 24;
    x *= 0x9E3779B97F4A7C15u;
    return x ^ x >> 29;
}

/* of what a term is known by; leaves by their node */
static uint32_t hash(const dm_term_entry *head, const dm_part *parts) {
    uint64_t h = (uint64_t)head->kind << 8 | head->op;
    if (head->count == 0) h += (uint64_t)head->node << 16;
    for (uint32_t i = 0; i < head->count; i++) h += hash_part(parts + i);
    return (uint32_t)(h * 0xD6E8FEB86659FD93u >> 32);
}

/* is t the term of this content? */
static int same(const dm_terms *s, dm_term t, const dm_term_entry *head, const dm_part *parts) {
    const dm_term_entry *e = s->entries + t;
    if (e->kind != head->kind || e->op != head->op || e->count != head->count) return 0;
    if (e->count == 0) return e->node == head->node;
    const dm_part *own = s->parts + e->first;
    for (uint32_t i = 0; i < e->count; i++)
        if (own[i].c != parts[i].c || own[i].t != parts[i].t || own[i].e != parts[i].e) return 0;
    return 1;
}

/* where it is in the table, or would be */
static uint32_t slot_of(const dm_terms *s, const dm_term_entry *head, const dm_part *parts) {
    uint32_t slot = hash(head, parts) & s->mask;
    while (s->table[slot] && !same(s, s->table[slot], head, parts)) slot = (slot + 1) & s->mask;
    return slot;
}

/* room for `want` terms, a power of two; the table, at most half full, is filled anew */
static int grow_entries(dm_terms *s, size_t want) {
    dm_arena *arena = s->arena;
    const size_t held = s->capacity;
    dm_term_entry *entries =
        dm_arena_grow(arena, s->entries, held * sizeof *entries, want * sizeof *entries);
    dm_term *table = dm_arena_take(arena, 2 * want * sizeof *table);
    if (entries) s->entries = entries;
    if (!entries || !table) return fail(s);
    memset(table, 0, 2 * want * sizeof *table);
    s->table = table;
    s->mask = (uint32_t)(2 * want - 1);
    s->capacity = (uint32_t)want;
    for (dm_term t = 1; t < s->size; t++)
        s->table[slot_of(s, s->entries + t, s->parts + s->entries[t].first)] = t;
    return 1;
}

/* an array of parts that holds at least `want` */
static int grow_parts(dm_terms *s, dm_part **parts, uint32_t *capacity, uint32_t want) {
    if (want <= *capacity) return 1;
    uint32_t room = *capacity ? *capacity : FIRST_TERMS;
    while (room < want) room *= 2;
    dm_part *grown =
        dm_arena_grow(s->arena, *parts, *capacity * sizeof **parts, room * sizeof **parts);
    if (!grown) return fail(s);
    *parts = grown;
    *capacity = room;
    return 1;
}

/* scratch may move: pointers into it do not outlive this */
int dm_terms_reserve(dm_terms *s, uint32_t count) {
    return grow_parts(s, &s->scratch, &s->scratch_capacity, count);
}

/* an exact zero is no underflow */
double dm_terms_times(dm_terms *s, double a, double b) {
    const double c = a * b;
    if (c == 0.0 && a != 0.0 && b != 0.0) s->unfit = 1;
    return c;
}

/* term 0 is the empty product, 1 */
int dm_terms_open(dm_terms *s, dm_graph *g, uint32_t operations, dm_arena *arena) {
    size_t room = FIRST_TERMS;
    *s = (dm_terms){.g = g, .arena = arena};
    while (room < operations) room *= 2;
    if (!grow_entries(s, room) || !dm_terms_reserve(s, 4 * DM_MOST_FACTORS)) return 0;
    s->entries[0] = (dm_term_entry){.kind = DM_TERM_PRODUCT, .nonnegative = 1};
    s->size = 1;
    return 1;
}

/* the term with this content, made when it is not there */
dm_term dm_terms_make(dm_terms *s, const dm_term_entry *head, const dm_part *parts) {
    uint32_t slot = slot_of(s, head, parts);
    if (s->table[slot]) return s->table[slot];
    if (s->size == s->capacity) {
        if (!grow_entries(s, 2 * (size_t)s->capacity)) return 0;
        slot = slot_of(s, head, parts);
    }
    if (!grow_parts(s, &s->parts, &s->parts_capacity, s->parts_size + head->count)) return 0;
    dm_term_entry *e = s->entries + s->size;
    *e = *head;
    e->first = e->body = s->parts_size;
    e->size = e->count;
    if (head->count) memcpy(s->parts + e->first, parts, head->count * sizeof *parts);
    s->parts_size += head->count;
    return s->table[slot] = s->size++;
}

/* the old parts stay behind in the array; there are few rewritings */
void dm_terms_rewrite(dm_terms *s, dm_term t, uint32_t count) {
    dm_term_entry *e = s->entries + t;
    if (!grow_parts(s, &s->parts, &s->parts_capacity, s->parts_size + count)) return;
    e->body = s->parts_size;
    e->size = count;
    if (count) memcpy(s->parts + e->body, s->scratch, count * sizeof *s->scratch);
    s->parts_size += count;
}

/* by term, then by exponent */
static int comes_after(const dm_part *a, const dm_part *b) {
    return a->t != b->t ? a->t > b->t : a->e > b->e;
}

/* insertion for the short, shell gaps for the long */
static void sort_parts(dm_part *p, uint32_t count) {
    static const uint32_t gaps[] = {29524, 9841, 3280, 1093, 364, 121, 40, 13, 4, 1};
    for (size_t k = 0; k < sizeof gaps / sizeof gaps[0]; k++)
        for (uint32_t gap = gaps[k], i = gap; i < count; i++) {
            const dm_part x = p[i];
            uint32_t j = i;
            for (; j >= gap && comes_after(p + j - gap, &x); j -= gap) p[j] = p[j - gap];
            p[j] = x;
        }
}

uint32_t dm_terms_factors(const dm_terms *s, dm_term t, dm_part *to) {
    const dm_term_entry *e = s->entries + t;
    if (e->kind != DM_TERM_PRODUCT || e->count > DM_MOST_FACTORS) {
        *to = (dm_part){.c = 1.0, .t = t, .e = 2};
        return 1;
    }
    for (uint32_t i = 0; i < e->count; i++) to[i] = s->parts[e->first + i];
    return e->count;
}

/* x^a x^b = x^(a+b), but not where a NaN at x = 0 would become finite */
static int may_gather(int32_t a, int32_t b) {
    return (a > 0) == (b > 0) || a + b < 0;
}

/* equal neighbours into one where allowed; drops nothing */
static uint32_t gather_factors(dm_part *p, uint32_t count) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t k = kept;
        while (k > 0 && p[k - 1].t == p[i].t && !may_gather(p[k - 1].e, p[i].e)) k--;
        if (k > 0 && p[k - 1].t == p[i].t)
            p[k - 1].e += p[i].e;
        else
            p[kept++] = p[i];
    }
    return kept;
}

/* a power with exponent 1 is the term itself */
static dm_scaled as_value(dm_terms *s, double c, uint32_t count) {
    dm_part *p = s->scratch;
    if (c == 0.0) return (dm_scaled){0.0, 0}; /* terms that cancelled */
    if (!isnormal(c)) s->unfit = 1;
    if (count == 0) return (dm_scaled){c, 0};
    if (count == 1 && p->e == 2) return (dm_scaled){c, p->t};
    dm_term_entry head = {.kind = DM_TERM_PRODUCT, .nonnegative = 1, .count = count};
    for (uint32_t i = 0; i < count; i++)
        if (!s->entries[p[i].t].nonnegative && p[i].e % 4 != 0) head.nonnegative = 0;
    return (dm_scaled){c, dm_terms_make(s, &head, p)};
}

/* sorted, so that equal bases are neighbours */
dm_scaled dm_terms_product(dm_terms *s, double c, uint32_t count) {
    sort_parts(s->scratch, count);
    return as_value(s, c, gather_factors(s->scratch, count));
}

/* like terms into one; what cancels goes */
static uint32_t gather_terms(dm_part *p, uint32_t count) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (kept > 0 && p[kept - 1].t == p[i].t)
            p[kept - 1].c += p[i].c;
        else
            p[kept++] = p[i];
        if (p[kept - 1].c == 0.0) kept--;
    }
    return kept;
}

/* how many coefficients are other than c and -c */
static uint32_t count_other(const dm_part *p, uint32_t count, double c) {
    uint32_t other = 0;
    for (uint32_t i = 0; i < count; i++) other += fabs(p[i].c) != c;
    return other;
}

/* is every coefficient c times a double, exactly? */
static int divides(const dm_part *p, uint32_t count, double c) {
    for (uint32_t i = 0; i < count; i++)
        if (fma(p[i].c / c, c, -p[i].c) != 0.0) return 0;
    return 1;
}

/* the coefficient to pull out of a sum: one that saves a multiplication, with the sign of
 * the first term, so that x - y and y - x are one sum */
static double common_coefficient(const dm_part *p, uint32_t count, int exact) {
    double best = 1.0;
    uint32_t least = count_other(p, count, 1.0);
    for (uint32_t i = 0; i < count && i < 8; i++) {
        const double c = fabs(p[i].c);
        if (c == 1.0 || !isnormal(c)) continue;
        const uint32_t others = count_other(p, count, c) + 1;
        if (others >= least || (exact && !divides(p, count, c))) continue;
        least = others;
        best = c;
    }
    return p[0].c < 0.0 ? -best : best;
}

/* sorted, like terms gathered, then the coefficient that saves most is pulled out */
dm_scaled dm_terms_sum(dm_terms *s, uint32_t count) {
    dm_part *p = s->scratch;
    dm_term_entry head = {.kind = DM_TERM_SUM, .nonnegative = 1};
    sort_parts(p, count);
    head.count = count = gather_terms(p, count);
    if (count == 0) return (dm_scaled){0.0, 0};
    if (count == 1) return (dm_scaled){p->c, p->t};
    for (uint32_t i = 0; i < count; i++) s->unfit |= !isnormal(p[i].c);
    const double c = common_coefficient(p, count, s->g->exact);
    for (uint32_t i = 0; i < count; i++) {
        p[i].c = fabs(p[i].c) == fabs(c) ? copysign(1.0, p[i].c * c) : p[i].c / c;
        if (p[i].c < 0.0 || !s->entries[p[i].t].nonnegative) head.nonnegative = 0;
    }
    return (dm_scaled){c, dm_terms_make(s, &head, p)};
}

/* an entry of the walk: a term, and how many of its parts have been seen */
typedef struct {
    dm_term t;
    uint32_t next;
} visit;

/* walk below `top` without recursion: order gets each term after its parts */
static uint32_t walk(const dm_terms *s, dm_term top, visit *stack, dm_term *order, uint32_t done,
                     uint32_t *uses) {
    uint32_t depth = 0;
    if (uses[top]++) return done;
    stack[depth++] = (visit){top, 0};
    while (depth > 0) {
        visit *v = stack + depth - 1;
        const dm_term_entry *e = s->entries + v->t;
        if (v->next == e->size) {
            order[done++] = v->t;
            depth--;
            continue;
        }
        const dm_term part = s->parts[e->body + v->next++].t;
        if (uses[part]++ > 0) continue;
        if (s->entries[part].size == 0)
            order[done++] = part; /* on and off the stack at once */
        else
            stack[depth++] = (visit){part, 0};
    }
    return done;
}

/* room for walks over all terms: there are several, the store hardly grows in between */
static int reserve_walk(dm_terms *s) {
    if (s->size <= s->walk_capacity) return 1;
    s->walk_capacity = s->capacity;
    s->stack = dm_arena_take(s->arena, s->capacity * sizeof(visit));
    s->order = dm_arena_take(s->arena, s->capacity * sizeof *s->order);
    s->uses = dm_arena_take(s->arena, s->capacity * sizeof *s->uses);
    if (s->stack && s->order && s->uses) return 1;
    s->walk_capacity = 0;
    return fail(s);
}

/* operands before users, as nodes have it by their numbers */
uint32_t dm_terms_order(dm_terms *s, const dm_scaled *roots, uint32_t m, dm_term **order,
                        uint32_t **uses) {
    uint32_t done = 0;
    if (!reserve_walk(s)) return 0;
    *order = s->order;
    *uses = s->uses;
    memset(s->uses, 0, s->size * sizeof *s->uses);
    for (uint32_t i = 0; i < m; i++) done = walk(s, roots[i].t, s->stack, s->order, done, s->uses);
    return done;
}
