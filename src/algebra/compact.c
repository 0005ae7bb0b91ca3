/* compact.c - the same functions with fewer operations. A graph is read as sums of products of
 * powers (terms.h), rewritten there, and written back; what comes out is counted, and the
 * cheapest form found is taken, which may be the one that was there. Three roads are followed as
 * long as they gain: from the roots as they are, and from expanded forms, in which like terms
 * meet and sin^2 + cos^2 = 1 is seen; sums that others share are opened in them, or not. Kernels
 * are what pays for an expression, so this runs before each is made.
 *
 * A compacted graph is one of its own, with its nodes in the order of a walk from the roots. So
 * what else the first graph holds makes no difference, and all kernels of the same roots round
 * alike; the last ones are kept by the graph, as a force alone and in lanes have the same
 * roots.
 * Speed: henon, kahan-li(8): 1.31x, common factors; routh, J2 satellite: 1.14x. */
#include "algebra/compact.h"

#include "algebra/terms.h"
#include "graph/analyse.h"
#include "graph/nodes.h"

#include <string.h>

enum {
    LARGEST = 20000, /* operations; larger graphs stay as they are */
    LARGE = 200,     /* one pass for these: a search takes a millisecond, saving little */
    WORTH = 2,       /* cost; there is nothing to gain below */
    MOST_PASSES = 6
};

/* clock cycles, roughly, of what a kernel has to do */
static uint32_t cost_of(const uint32_t counts[DM_OP_COUNT]) {
    static const uint8_t cycles[DM_OP_COUNT] =
        {[DM_OP_NEG] = 1,   [DM_OP_ABS] = 1,    [DM_OP_SIGN] = 3, [DM_OP_SQRT] = 6,
         [DM_OP_RSQRT] = 5, [DM_OP_RSQRT3] = 6, [DM_OP_ADD] = 1,  [DM_OP_SUB] = 1,
         [DM_OP_MUL] = 1,   [DM_OP_DIV] = 5,    [DM_OP_MIN] = 1,  [DM_OP_MAX] = 1,
         [DM_OP_WHERE] = 2, [DM_OP_FMA] = 1,    [DM_OP_FMS] = 1,  [DM_OP_FNMA] = 1};
    uint32_t sum = 0;
    for (int op = DM_OP_NEG; op < DM_OP_COUNT; op++)
        sum += counts[op] * (cycles[op] ? cycles[op] : 20);
    return sum;
}

/* of what the roots need */
static uint32_t cost(dm_graph *g, const dm_node *roots, uint32_t m) {
    uint32_t counts[DM_OP_COUNT];
    dm_operation_counts(g, roots, m, counts);
    return cost_of(counts);
}

/* roots on their way to fewer operations */
typedef struct {
    dm_graph *g;
    uint32_t m, operations;
    dm_node *now, *best;
    uint64_t least;  /* cost of the best */
    uint32_t kept;   /* nodes of the graph when it was found: later ones are for nothing */
    int passes;      /* at most, on one road */
    uint32_t shared; /* sums of the expanded form whose parts others share */
} search;

/* how a road begins: as it is, expanded, expanded but for what sums share */
typedef enum { AS_IT_IS, EXPANDED, SHARED } road;

/* one pass over `now`; its cost, or UINT64_MAX where it failed */
static uint64_t pass(search *x, road way) {
    dm_terms s;
    dm_arena *scratch = dm_arena_scratch(x->g->arena);
    dm_scaled *value = scratch ? dm_arena_take(scratch, (x->m + 1) * sizeof *value) : NULL;
    if (!value) dm_graph_fail(x->g, DM_NO_MEMORY);
    if (!value || !dm_terms_open(&s, x->g, x->operations, scratch)) return UINT64_MAX;
    if (!dm_terms_read(&s, x->now, x->m, value)) return UINT64_MAX;
    if (way != AS_IT_IS) x->shared = dm_terms_expand(&s, value, x->m, way == SHARED);
    dm_terms_factor(&s, value, x->m);
    if (s.unfit || dm_graph_status(x->g) != DM_OK) return UINT64_MAX;
    dm_terms_write(&s, value, x->m, x->now);
    return dm_graph_status(x->g) == DM_OK ? cost(x->g, x->now, x->m) : UINT64_MAX;
}

/* the part of its cost that a pass has to save: small graphs take no time */
static uint64_t patience(uint64_t own) {
    return own < 150 ? 64 : 12;
}

/* passes from the roots on, each over what the one before left, as long as they help and are
 * not far behind the best; costs of the expanded road count `percent` */
static void follow(search *x, const dm_node *roots, road way, uint32_t percent) {
    const uint64_t far = way != AS_IT_IS ? 140 : 105; /* percent of the best */
    uint64_t before = UINT64_MAX;
    memcpy(x->now, roots, x->m * sizeof *roots);
    for (int passes = 0; passes < x->passes; passes++) {
        const uint64_t own = pass(x, passes == 0 ? way : AS_IT_IS);
        if (own == UINT64_MAX) return;
        const uint64_t now = own * percent;
        if (now < x->least) {
            x->least = now;
            x->kept = dm_graph_size(x->g);
            memcpy(x->best, x->now, x->m * sizeof *x->best);
        }
        if (100 * now > far * x->least || own > before - before / patience(own)) return;
        before = own;
    }
}

/* the cheapest form found; the expanded ones counted at `favour` percent of their cost */
static void compact(dm_graph *g, const dm_node *roots, uint32_t m, uint32_t favour, dm_node *out) {
    search x = {.g = g, .m = m, .kept = dm_graph_size(g)};
    dm_node *start = dm_arena_take(g->arena, (m + 1) * sizeof *start);
    if (out != roots) memcpy(out, roots, m * sizeof *out);
    uint32_t counts[DM_OP_COUNT];
    if (!start || g->verbatim) return;
    dm_operation_counts(g, roots, m, counts);
    for (int op = 0; op < DM_OP_COUNT; op++) x.operations += counts[op];
    if (x.operations > LARGEST) return;
    x.now = dm_arena_take(g->arena, (m + 1) * sizeof *x.now);
    x.best = out;
    if (!x.now) return;
    memcpy(start, roots, m * sizeof *start);
    x.least = 100 * (uint64_t)cost_of(counts);
    if (x.least < 100 * WORTH) return;
    x.passes = x.operations > LARGE ? 1 : MOST_PASSES;
    if (x.operations <= LARGE) follow(&x, start, EXPANDED, favour);
    if (x.shared) follow(&x, start, SHARED, favour);
    follow(&x, start, AS_IT_IS, 100);
    if (g->status == DM_OK) dm_graph_forget(g, x.kept);
}

/* 1/sqrt(u) where n = sqrt(u) and that is needed too, else 0 */
static dm_node inverse_of_root(dm_graph *g, dm_node n) {
    if (!dm_is_op(g, n, DM_OP_SQRT)) return 0;
    const dm_expr inverse = {.op = DM_OP_RSQRT, .as.arg = {dm_at(g, n)->as.arg[0]}};
    const dm_node found = dm_node_find(g, &inverse);
    return dm_is_marked(g, found) ? found : 0;
}

/* anywhere in the graph, needed or not */
static int has_op(const dm_graph *g, dm_op op) {
    for (dm_node n = 1; n < g->size; n++)
        if (dm_is_op(g, n, op)) return 1;
    return 0;
}

/* is there something to gain? */
static int has_inverse_roots(dm_graph *g, uint32_t end) {
    for (dm_node n = 1; n < end; n++)
        if (dm_is_marked(g, n) && inverse_of_root(g, n)) return 1;
    return 0;
}

/* sqrt(u) = u * 1/sqrt(u), 0 at u = 0: a root less where the reciprocal is there */
static dm_node by_inverse(dm_graph *g, dm_node u) {
    const dm_node inverse = dm_node_plain(g, DM_OP_RSQRT, u, 0, 0);
    const dm_node bound = dm_constant(g, 1e300);
    return dm_node_plain(g, DM_OP_MUL, u, dm_node_plain(g, DM_OP_MIN, inverse, bound, 0), 0);
}

/* roots whose reciprocal is needed anyway become products */
static void replace_roots(dm_graph *g, dm_node *roots, uint32_t m) {
    if (!has_op(g, DM_OP_SQRT)) return;
    const uint32_t end = dm_mark(g, roots, m);
    if (!has_inverse_roots(g, end)) return;
    dm_node *now = dm_arena_take(g->arena, end * sizeof *now);
    if (!now) dm_graph_fail(g, DM_NO_MEMORY);
    for (dm_node n = 0; now && n < end; n++) {
        dm_expr e = *dm_at(g, n);
        if (!dm_is_marked(g, n)) continue;
        for (int k = 0; k < dm_arity(e.op); k++) e.as.arg[k] = now[e.as.arg[k]];
        now[n] = inverse_of_root(g, n) ? by_inverse(g, e.as.arg[0]) : dm_node_make(g, &e);
    }
    for (uint32_t i = 0; now && i < m; i++) roots[i] = now[roots[i]];
}

/* Bits do not depend on who asks: the search has no memory beside the graph. */
void dm_compact(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out) {
    compact(g, roots, m, 100, out);
    if (g->status == DM_OK && !g->verbatim) replace_roots(g, out, m);
}

/* an expanded form may cost a third more: derivatives are taken of it, where like terms meet */
dm_node dm_compact_source(dm_graph *g, dm_node f) {
    dm_node out = f;
    if (f == g->source[0]) return g->source[1];
    compact(g, &f, 1, 75, &out);
    if (g->status != DM_OK) return 0;
    g->source[0] = f;
    g->source[1] = out;
    return out;
}

/* a node on the way down: which operand comes next */
typedef struct {
    dm_node n;
    int next;
} visit;

/* copy what is below n, operands first; copied[] is the number in h plus one */
static void copy_below(dm_graph *h, const dm_graph *g, dm_node top, visit *stack, dm_node *copied) {
    uint32_t depth = 0;
    if (!copied[top]) stack[depth++] = (visit){top, 0};
    while (depth > 0) {
        visit *v = stack + depth - 1;
        const dm_expr *e = dm_at(g, v->n);
        const int count = dm_arity(e->op);
        while (v->next < count && copied[e->as.arg[v->next]]) v->next++;
        if (v->next < count) {
            stack[depth++] = (visit){e->as.arg[v->next++], 0};
            continue;
        }
        dm_expr own = *e;
        for (int k = 0; k < count; k++) own.as.arg[k] = copied[own.as.arg[k]] - 1;
        copied[v->n] = dm_node_copy(h, &own, g->nonnegative[v->n]) + 1;
        depth--;
    }
}

dm_graph *dm_graph_copy(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out) {
    const uint32_t end = dm_mark(g, roots, m), needed = g->marked;
    dm_graph *h = dm_graph_sized(g->arena, g->inputs, needed + 1);
    dm_arena *scratch = dm_arena_scratch(g->arena);
    if (!h || !scratch) return NULL;
    visit *stack = dm_arena_take(scratch, (needed + 1) * sizeof *stack);
    dm_node *copied = dm_arena_take(scratch, (end + 1) * sizeof *copied);
    if (!stack || !copied) return NULL;
    h->verbatim = g->verbatim;
    h->exact = g->exact;
    h->implicits = g->implicits;
    memset(copied, 0, (end + 1) * sizeof *copied);
    for (uint32_t i = 0; i < m; i++) {
        copy_below(h, g, roots[i], stack, copied);
        out[i] = copied[roots[i]] - 1;
    }
    return h->status == DM_OK ? h : NULL;
}

/* copied once more where compaction has left nodes that nobody needs */
static dm_graph *compact_graph(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out) {
    dm_graph *h = g->status == DM_OK ? dm_graph_copy(g, roots, m, out) : NULL;
    if (!h) return NULL;
    const uint32_t size = h->size;
    dm_compact(h, out, m, out);
    if (h->status != DM_OK) return NULL;
    return h->size == size ? h : dm_graph_copy(h, out, m, out);
}

/* several kernels have the same roots: a force alone, and in lanes */
typedef struct dm_compacted {
    struct dm_compacted *next;
    uint32_t m;
    int verbatim, exact;
    dm_graph *to;
    const dm_node *roots, *out;
} compacted;

/* by the roots, node by node */
static const compacted *find_compacted(const dm_graph *g, const dm_node *roots, uint32_t m) {
    const compacted *c = g->compacted;
    while (c && (c->m != m || c->verbatim != g->verbatim || c->exact != g->exact ||
                 memcmp(c->roots, roots, m * sizeof *roots) != 0))
        c = c->next;
    return c;
}

/* before `out` is written, which may be the same array; NULL without memory, and then nothing is
 * kept */
static dm_node *copy_roots(dm_graph *g, const dm_node *roots, uint32_t m) {
    dm_node *both = dm_arena_take(g->arena, 2 * (size_t)m * sizeof *both);
    if (both) memcpy(both, roots, m * sizeof *both);
    return both;
}

/* the one that was made before, if there is one for these roots */
dm_graph *dm_compact_graph(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out) {
    const compacted *last = find_compacted(g, roots, m);
    if (last && g->status == DM_OK) {
        memcpy(out, last->out, m * sizeof *out);
        return last->to;
    }
    dm_node *both = copy_roots(g, roots, m);
    dm_graph *h = compact_graph(g, roots, m, out);
    compacted *c = h && both ? dm_arena_take(g->arena, sizeof *c) : NULL;
    if (!c) return h;
    memcpy(both + m, out, m * sizeof *out);
    *c = (compacted){g->compacted, m, g->verbatim, g->exact, h, both, both + m};
    g->compacted = c;
    return h;
}
