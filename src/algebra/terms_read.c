/* terms_read.c - from nodes to terms: chains of additions become one sum, products are
 * flattened. */
#include "algebra/terms.h"

#include "graph/nodes.h"

#include <math.h>
#include <string.h>

/* nodes and the terms that they are */
typedef struct {
    dm_terms *s;
    dm_scaled *value;
    uint8_t *inner;  /* part of the sum of its only user */
    uint32_t *stack; /* nodes of one sum still to be looked at ... */
    double *factor;  /* ... and what they are multiplied by */
} reader;

/* adds or takes away */
static int is_sum(const dm_expr *e) {
    return e->op == DM_OP_ADD || e->op == DM_OP_SUB;
}

/* a multiple by a number */
static int is_scale(const dm_graph *g, const dm_expr *e) {
    return e->op == DM_OP_NEG || (e->op == DM_OP_MUL && dm_is_op(g, e->as.arg[0], DM_OP_CONSTANT));
}

/* additions, and multiples, that are used once and by a sum: uses[n] and the last user */
static void find_inner(reader *r, const dm_graph *g, uint32_t end, uint32_t *uses, uint32_t *user) {
    for (dm_node n = 0; n < end; n++) {
        const dm_expr *e = dm_at(g, n);
        for (int k = 0; dm_is_marked(g, n) && k < dm_arity(e->op); k++) {
            uses[e->as.arg[k]]++;
            user[e->as.arg[k]] = n;
        }
    }
    for (dm_node n = end; n-- > 0;) {
        const dm_expr *e = dm_at(g, n), *u = dm_at(g, user[n]);
        if (!dm_is_marked(g, n) || uses[n] != 1) continue;
        if (!is_sum(e) && !is_scale(g, e)) continue;
        r->inner[n] = is_sum(u) || (r->inner[user[n]] && is_scale(g, u));
    }
}

/* op of what n has as operands: the operation of n, or the root that n is the reciprocal of */
static dm_scaled atom(reader *r, dm_node n, dm_op op) {
    const dm_expr *e = dm_at(r->s->g, n);
    dm_term_entry head = {.kind = DM_TERM_ATOM, .op = (uint8_t)op};
    dm_part arg[3];
    head.nonnegative = r->s->g->nonnegative[n];
    head.count = (uint32_t)dm_arity(e->op);
    if (head.count == 0) head.node = n;
    for (uint32_t k = 0; k < head.count; k++)
        arg[k] = (dm_part){.c = r->value[e->as.arg[k]].c, .t = r->value[e->as.arg[k]].t};
    return (dm_scaled){1.0, dm_terms_make(r->s, &head, arg)};
}

/* one more part of the sum, or the operands of an inner one; returns the new depth */
static uint32_t open_part(reader *r, uint32_t depth, uint32_t *count) {
    const dm_graph *g = r->s->g;
    const dm_node n = r->stack[--depth];
    const double c = r->factor[depth];
    const dm_expr *e = dm_at(g, n);
    if (!r->inner[n]) {
        const dm_scaled v = r->value[n];
        r->s->scratch[(*count)++] = (dm_part){.c = dm_terms_times(r->s, c, v.c), .t = v.t};
        return depth;
    }
    if (is_scale(g, e)) {
        const int neg = e->op == DM_OP_NEG;
        r->stack[depth] = e->as.arg[neg ? 0 : 1];
        const double by = neg ? -1.0 : dm_at(g, e->as.arg[0])->as.value;
        r->factor[depth++] = dm_terms_times(r->s, c, by);
        return depth;
    }
    r->stack[depth] = e->as.arg[1];
    r->factor[depth++] = e->op == DM_OP_SUB ? -c : c;
    r->stack[depth] = e->as.arg[0];
    r->factor[depth++] = c;
    return depth;
}

/* parts of the sum with its top at n */
static dm_scaled read_sum(reader *r, dm_node n) {
    uint32_t depth = 1, count = 0;
    const uint8_t was = r->inner[n];
    r->stack[0] = n;
    r->factor[0] = 1.0;
    r->inner[n] = 1;
    while (depth > 0) {
        if (!dm_terms_reserve(r->s, count + 2)) return (dm_scaled){0.0, 0};
        depth = open_part(r, depth, &count);
        r->inner[n] = was;
    }
    return dm_terms_sum(r->s, count);
}

/* x y, or x / y with the exponents of y turned over */
static dm_scaled read_product(reader *r, dm_node x, dm_node y, int sign) {
    dm_terms *s = r->s;
    const dm_scaled a = r->value[x], b = r->value[y];
    const double c = sign > 0 ? dm_terms_times(s, a.c, b.c) : a.c / b.c;
    if (c == 0.0 && a.c != 0.0) s->unfit |= b.c != 0.0;
    const uint32_t from = dm_terms_factors(s, a.t, s->scratch);
    const uint32_t count = from + dm_terms_factors(s, b.t, s->scratch + from);
    for (uint32_t i = from; i < count; i++) s->scratch[i].e *= sign;
    return dm_terms_product(s, c, count);
}

/* sqrt(c u)^e = sqrt(c)^e u^(e/2), where u is known to be >= 0; elsewhere a power of the atom
 * sqrt(u) */
static dm_scaled read_root(reader *r, dm_node n, int e) {
    const dm_scaled a = r->value[dm_at(r->s->g, n)->as.arg[0]];
    const dm_term_entry *u = r->s->entries + a.t;
    const int opens = a.c > 0.0 && u->nonnegative && u->kind != DM_TERM_PRODUCT;
    if (!opens && e == 1) return atom(r, n, DM_OP_SQRT);
    const dm_term base = opens ? a.t : atom(r, n, DM_OP_SQRT).t;
    r->s->scratch[0] = (dm_part){.c = 1.0, .t = base, .e = opens ? e : 2 * e};
    return dm_terms_product(r->s, opens ? pow(sqrt(a.c), e) : 1.0, 1);
}

/* the term of node n; those of its operands are there */
static dm_scaled read_node(reader *r, dm_node n) {
    const dm_expr e = *dm_at(r->s->g, n);
    const dm_node a = e.as.arg[0], b = e.as.arg[1];
    switch (e.op) {
    case DM_OP_CONSTANT:
        return (dm_scaled){e.as.value, 0};
    case DM_OP_NEG:
        return (dm_scaled){-r->value[a].c, r->value[a].t};
    case DM_OP_ADD:
    case DM_OP_SUB:
        return read_sum(r, n);
    case DM_OP_MUL:
        return read_product(r, a, b, 1);
    case DM_OP_DIV:
        return read_product(r, a, b, -1);
    case DM_OP_SQRT:
        return read_root(r, n, 1);
    case DM_OP_RSQRT:
        return read_root(r, n, -1);
    case DM_OP_RSQRT3:
        return read_root(r, n, -3);
    default:
        return atom(r, n, e.op);
    }
}

/* nodes in order of number; inner parts of sums are read with their sum */
int dm_terms_read(dm_terms *s, const dm_node *roots, uint32_t m, dm_scaled *out) {
    dm_arena *arena = s->arena;
    const uint32_t end = dm_mark(s->g, roots, m);
    uint32_t *uses = dm_arena_take(arena, (end + 1) * sizeof *uses);
    uint32_t *user = dm_arena_take(arena, (end + 1) * sizeof *user);
    reader r = {.s = s};
    r.value = dm_arena_take(arena, (end + 1) * sizeof *r.value);
    r.inner = dm_arena_take(arena, end + 1);
    r.stack = dm_arena_take(arena, (end + 2) * sizeof *r.stack);
    r.factor = dm_arena_take(arena, (end + 2) * sizeof *r.factor);
    if (!uses || !user || !r.value || !r.inner || !r.stack || !r.factor)
        return (int)dm_graph_fail(s->g, DM_NO_MEMORY);
    memset(uses, 0, (end + 1) * sizeof *uses);
    memset(user, 0, (end + 1) * sizeof *user);
    memset(r.inner, 0, end + 1);
    for (uint32_t i = 0; i < m; i++) uses[roots[i]]++;
    find_inner(&r, s->g, end, uses, user);
    for (dm_node n = 0; n < end && !s->unfit; n++)
        if (dm_is_marked(s->g, n) && !r.inner[n]) r.value[n] = read_node(&r, n);
    for (uint32_t i = 0; i < m; i++) out[i] = r.value[roots[i]];
    return !s->unfit && dm_graph_status(s->g) == DM_OK;
}
