/* terms_write.c - from terms to nodes. Powers of one base share their chain; a denominator that
 * one product has alone divides it, one that several have is turned over once: w = 1/sqrt(u),
 * w^3, w^5. A sum may be written negated where all its users would negate it; `minus` says so. */
#include "algebra/terms.h"

#include "graph/nodes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHAIN = 64 }; /* powers above are made by squaring without looking for sums */

/* how a base is used by all products together */
typedef struct {
    uint64_t above, below; /* bit k: the power k of the base, of its reciprocal, is needed */
    uint32_t under;        /* products that divide by it */
    uint32_t squares;      /* products that have its square */
    uint8_t by_root;       /* odd halves below: w = 1/sqrt(base), else w = 1/base */
} usage;

enum { EITHER = 0, PLUS = 1, MINUS = 2 }; /* signs that the users of a term would like */

/* what is known of every term before the first one is written */
typedef struct {
    dm_terms *s;
    dm_graph *g;
    dm_node one;    /* the number 1 */
    usage *use;     /* [terms] */
    uint8_t *wish;  /* [terms] PLUS and MINUS, or-ed; sums take any sign */
    uint8_t *minus; /* [terms] 1: the node is the term's value negated */
} writer;

/* in order of number; a factor 1 is left out */
static dm_node multiply(dm_graph *g, dm_node a, dm_node b) {
    double one;
    if (dm_is_constant(g, a, &one) && one == 1.0) return b;
    if (dm_is_constant(g, b, &one) && one == 1.0) return a;
    if (dm_is_op(g, a, DM_OP_CONSTANT) && dm_is_op(g, b, DM_OP_CONSTANT)) return dm_mul(g, a, b);
    return a < b ? dm_node_plain(g, DM_OP_MUL, a, b, 0) : dm_node_plain(g, DM_OP_MUL, b, a, 0);
}

/* c a, where c may be 1 */
static dm_node times(dm_graph *g, double c, dm_node a) {
    return c == 1.0 ? a : dm_mul(g, dm_constant(g, c), a);
}

/* the power of the base, or of its reciprocal root, that a factor is */
static uint32_t whole_steps(const writer *w, const dm_part *p) {
    const uint32_t size = (uint32_t)abs(p->e);
    return p->e < 0 && w->use[p->t].by_root ? size : size / 2;
}

/* gather who needs what; a base below in one product only is a plain denominator */
static void find_usage(writer *w, const dm_term *order, uint32_t count) {
    const dm_terms *s = w->s;
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < count; i++) {
            const dm_term_entry *e = s->entries + order[i];
            for (uint32_t k = 0; e->kind == DM_TERM_PRODUCT && k < e->size; k++) {
                const dm_part *p = s->parts + e->body + k;
                usage *u = w->use + p->t;
                if (pass == 0) {
                    u->under += p->e < 0;
                    u->squares += p->e == 4;
                    u->by_root |= p->e < 0 && p->e % 2 != 0;
                    continue;
                }
                const uint32_t steps = whole_steps(w, p);
                if (steps >= CHAIN) continue;
                if (p->e > 0)
                    u->above |= (uint64_t)1 << steps;
                else
                    u->below |= (uint64_t)1 << steps;
            }
        }
}

/* which users would have to negate: roots and operands with a negative coefficient pass a wish
 * down, a product hands its own to one sum that nobody else uses */
static void find_wishes(writer *w, const dm_scaled *roots, uint32_t m, const dm_term *order,
                        const uint32_t *uses, uint32_t count) {
    const dm_terms *s = w->s;
    for (uint32_t i = 0; i < m; i++) w->wish[roots[i].t] |= roots[i].c < 0.0 ? MINUS : PLUS;
    for (uint32_t i = count; i-- > 0;) {
        const dm_term_entry *e = s->entries + order[i];
        const dm_part *p = s->parts + e->body;
        int handed = w->wish[order[i]] != MINUS;
        for (uint32_t k = 0; k < e->size; k++) {
            if (e->kind == DM_TERM_ATOM) w->wish[p[k].t] |= p[k].c < 0.0 ? MINUS : PLUS;
            if (e->kind != DM_TERM_PRODUCT || handed || uses[p[k].t] != 1) continue;
            if (p[k].e % 4 == 0 || s->entries[p[k].t].kind == DM_TERM_ATOM) continue;
            w->wish[p[k].t] |= MINUS;
            handed = 1;
        }
    }
}

/* base^k, the square being there whenever more is, through two powers that are needed anyway
 * where there are such */
static dm_node chain(dm_graph *g, dm_node base, uint32_t k, uint64_t needed) {
    if (k == 0) return dm_constant(g, 1.0);
    if (k == 1) return base;
    if (needed >> 3) needed |= 1 << 2;
    for (uint32_t i = k - 1; k < CHAIN && 2 * i >= k; i--)
        if ((needed >> i & 1 || i == 1) && (needed >> (k - i) & 1 || k - i == 1)) {
            const dm_node high = chain(g, base, i, needed);
            return multiply(g, high, chain(g, base, k - i, needed));
        }
    const uint32_t half = k / 2;
    if (k % 2) return multiply(g, base, chain(g, base, k - 1, needed));
    const dm_node root = chain(g, base, half, needed);
    return multiply(g, root, root);
}

/* sqrt(base) */
static dm_node root_of(dm_graph *g, dm_node base) {
    return dm_apply(g, DM_OP_SQRT, base, 0, 0);
}

/* base^(size/2) */
static dm_node power(const writer *w, dm_term t, uint32_t size) {
    const dm_node base = w->s->entries[t].node;
    const dm_node whole = chain(w->g, base, size / 2, w->use[t].above);
    return size % 2 ? multiply(w->g, root_of(w->g, base), whole) : whole;
}

/* a power of a root divides: no division, as 1/sqrt is one operation */
static int is_under_root(const writer *w, dm_term t) {
    return w->use[t].by_root || dm_is_op(w->g, w->s->entries[t].node, DM_OP_SQRT);
}

/* base^(-size/2) as a power of the shared reciprocal; the cube of a reciprocal root that is
 * needed alone is one operation */
static dm_node inverse_power(const writer *w, const dm_part *p) {
    const dm_node base = w->s->entries[p->t].node;
    const uint32_t steps = whole_steps(w, p);
    if (!is_under_root(w, p->t)) {
        const dm_node turned = dm_node_plain(w->g, DM_OP_DIV, w->one, base, 0);
        return chain(w->g, turned, steps, w->use[p->t].below);
    }
    const dm_node under = w->use[p->t].by_root ? base : dm_at(w->g, base)->as.arg[0];
    if (w->use[p->t].below == (uint64_t)1 << 3) return dm_apply(w->g, DM_OP_RSQRT3, under, 0, 0);
    return chain(w->g, dm_apply(w->g, DM_OP_RSQRT, under, 0, 0), steps, w->use[p->t].below);
}

/* squares that nobody else has as one square, x^2 y^2 = (x y)^2: their factors leave p[count] */
static dm_node joint_square(const writer *w, dm_part *p, uint32_t *count) {
    dm_node joint = w->one;
    uint32_t own = 0, kept = 0;
    for (uint32_t i = 0; i < *count; i++) own += p[i].e == 4 && w->use[p[i].t].squares == 1;
    if (own < 2) return joint;
    for (uint32_t i = 0; i < *count; i++)
        if (p[i].e == 4 && w->use[p[i].t].squares == 1)
            joint = multiply(w->g, joint, w->s->entries[p[i].t].node);
        else
            p[kept++] = p[i];
    *count = kept;
    return multiply(w->g, joint, joint);
}

/* what is above, joint squares first, over what is below */
static dm_node write_product(writer *w, dm_term t) {
    dm_terms *s = w->s;
    uint32_t count = s->entries[t].size;
    if (!dm_terms_reserve(s, count)) return 0;
    if (count) memcpy(s->scratch, s->parts + s->entries[t].body, count * sizeof *s->scratch);
    dm_node above = joint_square(w, s->scratch, &count), below = w->one;
    for (uint32_t i = 0; i < count; i++) {
        const dm_part p = s->scratch[i];
        if (p.e % 4 != 0) w->minus[t] ^= w->minus[p.t];
        if (p.e > 0)
            above = multiply(w->g, above, power(w, p.t, (uint32_t)p.e));
        else if (w->use[p.t].under > 1 || is_under_root(w, p.t))
            above = multiply(w->g, above, inverse_power(w, &p));
        else
            below = multiply(w->g, below, power(w, p.t, (uint32_t)-p.e));
    }
    return below == w->one ? above : dm_node_plain(w->g, DM_OP_DIV, above, below, 0);
}

/* in order of number */
static dm_node add(dm_graph *g, dm_node a, dm_node b) {
    return a < b ? dm_node_plain(g, DM_OP_ADD, a, b, 0) : dm_node_plain(g, DM_OP_ADD, b, a, 0);
}

/* c * term, the sign of how the term was written taken in */
static double coefficient(const writer *w, const dm_part *p) {
    return w->minus[p->t] ? -p->c : p->c;
}

/* first what is added, then what is taken away; turned round where all users want that or
 * nothing is added */
static dm_node write_sum(writer *w, dm_term t) {
    const dm_term_entry *e = w->s->entries + t;
    const dm_part *p = w->s->parts + e->body;
    uint32_t added = 0;
    dm_node sum = 0;
    int begun = 0; /* a sum that has cancelled so far is node 0, the constant, too */
    for (uint32_t i = 0; i < e->size; i++) added += coefficient(w, p + i) > 0.0;
    w->minus[t] = added == 0 || (added < e->size && w->wish[t] == MINUS);
    for (int minus = 0; minus < 2; minus++)
        for (uint32_t i = 0; i < e->size; i++) {
            const double c = coefficient(w, p + i);
            if (((c < 0.0) ^ w->minus[t]) != minus) continue;
            const dm_node n = times(w->g, fabs(c), w->s->entries[p[i].t].node);
            if (!begun++)
                sum = n;
            else
                sum = minus ? dm_sub(w->g, sum, n) : add(w->g, sum, n);
        }
    return sum;
}

/* the function of its operands, signs taken in */
static dm_node write_atom(const writer *w, dm_term t) {
    const dm_term_entry *e = w->s->entries + t;
    const dm_part *p = w->s->parts + e->body;
    dm_node arg[3] = {0, 0, 0};
    if (e->size == 0) return e->node;
    if (e->op == DM_OP_CONSTANT) return dm_constant(w->g, p->c);
    for (uint32_t k = 0; k < e->size; k++)
        arg[k] = times(w->g, coefficient(w, p + k), w->s->entries[p[k].t].node);
    return dm_apply(w->g, (dm_op)e->op, arg[0], arg[1], arg[2]);
}

/* the node of t; its parts have theirs */
static dm_node write_term(writer *w, dm_term t) {
    switch (w->s->entries[t].kind) {
    case DM_TERM_PRODUCT:
        return write_product(w, t);
    case DM_TERM_SUM:
        return write_sum(w, t);
    default:
        return write_atom(w, t);
    }
}

/* nothing is known yet; 0 without memory */
static int open_writer(writer *w, dm_terms *s) {
    dm_arena *arena = s->arena;
    *w = (writer){.s = s, .g = s->g, .one = dm_constant(s->g, 1.0)};
    w->use = dm_arena_take(arena, s->size * sizeof *w->use);
    w->wish = dm_arena_take(arena, s->size);
    w->minus = dm_arena_take(arena, s->size);
    if (!w->use || !w->wish || !w->minus) return (int)dm_graph_fail(s->g, DM_NO_MEMORY);
    memset(w->use, 0, s->size * sizeof *w->use);
    memset(w->wish, 0, s->size);
    memset(w->minus, 0, s->size);
    return 1;
}

/* users look first (usage, wishes), then every term is written after its parts */
void dm_terms_write(dm_terms *s, const dm_scaled *roots, uint32_t m, dm_node *out) {
    writer w;
    dm_term *order;
    uint32_t *uses;
    const uint32_t count = dm_terms_order(s, roots, m, &order, &uses);
    if (dm_graph_status(s->g) != DM_OK || !open_writer(&w, s)) return;
    find_usage(&w, order, count);
    find_wishes(&w, roots, m, order, uses, count);
    for (uint32_t i = 0; i < count; i++) s->entries[order[i]].node = write_term(&w, order[i]);
    for (uint32_t i = 0; i < m; i++) {
        const double c = w.minus[roots[i].t] ? -roots[i].c : roots[i].c;
        out[i] = times(s->g, c, s->entries[roots[i].t].node);
    }
}
