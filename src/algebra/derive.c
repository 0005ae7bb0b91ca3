/* derive.c - derivatives as nodes. A reverse sweep carries df/dn ("bar") from f down to the
 * inputs, a forward sweep dn/dx ("dot") from one input up to the results, by the local rules of
 * derive_rules.c. A sweep goes only where something is to be done: one bit a node, in order of
 * number, so that a row or column of a large sparse matrix costs what stands in it and not a
 * look at every node. Both orders are tried where they may differ, and the smaller graph is
 * kept. */
#include "algebra/derive.h"

#include "algebra/compact.h"
#include "algebra/derive_inside.h"
#include "graph/analyse.h"
#include "graph/nodes.h"

#include <string.h>

typedef dm_derive_sweep sweep;

static dm_node one(dm_graph *g) {
    return dm_constant(g, 1.0);
}

/* sets of nodes, 64 to a word */
static int has_bit(const uint64_t *bits, dm_node n) {
    return bits[n / 64] >> n % 64 & 1;
}

static void set_bit(uint64_t *bits, dm_node n) {
    bits[n / 64] |= (uint64_t)1 << n % 64;
}

static uint32_t lowest(uint64_t bits) {
    return (uint32_t)__builtin_ctzll(bits);
}

static uint32_t highest(uint64_t bits) {
    return 63 - (uint32_t)__builtin_clzll(bits);
}

/* active: depending on the inputs first .. first+n-1 */
static void find_active(const sweep *s, const dm_graph *g) {
    for (dm_node n = 0; n < s->room; n++) {
        const dm_expr *e = dm_at(g, n);
        uint8_t on = e->op == DM_OP_INPUT && e->as.input - s->first < s->n;
        for (int k = 0; k < dm_arity(e->op); k++) on |= s->active[e->as.arg[k]];
        s->active[n] = on;
    }
}

/* for derivatives of f[m], and so of nothing behind them */
static int sweep_open(sweep *s, dm_graph *g, const dm_node *f, uint32_t m, uint32_t first,
                      uint32_t n) {
    uint32_t room = 1;
    for (uint32_t i = 0; i < m; i++) room = f[i] < room ? room : f[i] + 1;
    const uint32_t words = room / 64 + 1;
    *s = (sweep){.first = first, .n = n, .room = room};
    s->d = dm_arena_take(g->arena, room * sizeof *s->d);
    s->active = dm_arena_take(g->arena, room);
    s->pending = dm_arena_take(g->arena, 2 * words * sizeof *s->pending);
    if (!s->d || !s->active || !s->pending) return dm_graph_fail(g, DM_NO_MEMORY), 0;
    s->known = s->pending + words;
    memset(s->pending, 0, 2 * words * sizeof *s->pending);
    find_active(s, g);
    return 1;
}

/* is n part of what was marked, and depends on the inputs? */
static int needs(const sweep *s, const dm_graph *g, dm_node n) {
    return dm_is_marked(g, n) && s->active[n];
}

/* d[n] counts only while n is pending; what is left from the last row is not looked at */
dm_node dm_derive_held(const dm_derive_sweep *s, dm_node n) {
    return has_bit(s->pending, n) ? s->d[n] : 0;
}

/* n will be come to: operands have smaller numbers, so it lies ahead of a reverse sweep */
void dm_derive_hold(dm_derive_sweep *s, dm_node n, dm_node d) {
    s->d[n] = d;
    set_bit(s->pending, n);
}

/* df/dn to the operands of n, those that depend on the inputs in question */
static void hand_down(sweep *s, dm_graph *g, dm_node n) {
    const dm_expr e = *dm_at(g, n);
    for (int k = 0; k < dm_arity(e.op); k++) {
        const dm_node a = e.as.arg[k];
        if (!s->active[a]) continue;
        dm_derive_hold(s, a, dm_derive_pass(g, n, k, s->d[n], dm_derive_held(s, a)));
    }
}

/* out[n] = df/dx_i */
static void reverse(sweep *s, dm_graph *g, dm_node f, dm_node *out) {
    memset(out, 0, s->n * sizeof *out);
    s->roots = NULL;
    if (!s->active[f]) return;
    dm_derive_hold(s, f, one(g));
    for (uint32_t w = f / 64 + 1; w-- > 0;)
        while (s->pending[w]) {
            const dm_node n = 64 * w + highest(s->pending[w]);
            const dm_expr *e = dm_at(g, n);
            s->pending[w] ^= (uint64_t)1 << n % 64;
            if (!s->d[n] || g->status != DM_OK) continue;
            if (e->op == DM_OP_INPUT)
                out[e->as.input - s->first] = s->d[n];
            else if (e->op == DM_OP_ROOT || e->op == DM_OP_WITH)
                dm_derive_root(s, g, n);
            else
                hand_down(s, g, n);
        }
}

/* the last gradient is asked for again by who compiles what somebody else has looked at */
static int is_last(const dm_graph *g, dm_node f, uint32_t first, uint32_t n) {
    const dm_gradient_cache *last = &g->gradient;
    return g->status == DM_OK && last->of && last->f == f && last->first == first && last->n == n;
}

/* the arrays of later gradients take its place; verbatim graphs are made for rounding and keep
 * none */
static void keep_gradient(dm_graph *g, dm_node f, uint32_t first, uint32_t n, const dm_node *out) {
    dm_node *of = dm_arena_take(g->arena, n * sizeof *of);
    if (!of || g->status != DM_OK || g->verbatim) return;
    memcpy(of, out, n * sizeof *of);
    g->gradient = (dm_gradient_cache){f, first, n, of};
}

/* of f as it is, the last one again where it is asked for again */
static void gradient_of(dm_graph *g, dm_node f, uint32_t first, uint32_t n, dm_node *out) {
    sweep s;
    if (is_last(g, f, first, n)) {
        memcpy(out, g->gradient.of, n * sizeof *out);
        return;
    }
    memset(out, 0, n * sizeof *out);
    if (!sweep_open(&s, g, &f, 1, first, n)) return;
    reverse(&s, g, f, out);
    keep_gradient(g, f, first, n, out);
}

/* of the form of f whose derivatives are short */
void dm_gradient(dm_graph *g, dm_node f, uint32_t first, uint32_t n, dm_node *out) {
    gradient_of(g, dm_compact_source(g, f), first, n, out);
}

/* one reverse sweep a row; bits and arrays are used again */
static void jacobian_by_rows(sweep *s, dm_graph *g, const dm_node *f, uint32_t m, dm_node *out) {
    for (uint32_t i = 0; i < m; i++) reverse(s, g, f[i], out + (size_t)i * s->n);
}

/* what uses n, of all that f is made of and that is active: user[start[n]], ..., user[start[n +
 * 1] - 1] */
typedef struct {
    uint32_t *start;
    dm_node *user;
} users;

/* counted first, then filled in, as a sparse matrix by columns; 0 without memory */
static int find_users(users *u, const sweep *s, dm_graph *g, uint32_t end) {
    uint32_t sum = 0;
    u->start = dm_arena_take(g->arena, ((size_t)end + 2) * sizeof *u->start);
    if (!u->start) return (int)dm_graph_fail(g, DM_NO_MEMORY);
    memset(u->start, 0, ((size_t)end + 2) * sizeof *u->start);
    for (dm_node n = 0; n < end; n++)
        for (int k = 0; needs(s, g, n) && k < dm_arity(dm_at(g, n)->op); k++)
            u->start[dm_at(g, n)->as.arg[k] + 2]++;
    for (dm_node n = 0; n < end; n++) sum = u->start[n + 2] += sum;
    u->user = dm_arena_take(g->arena, (sum + 1) * sizeof *u->user);
    if (!u->user) return (int)dm_graph_fail(g, DM_NO_MEMORY);
    for (dm_node n = 0; n < end; n++)
        for (int k = 0; needs(s, g, n) && k < dm_arity(dm_at(g, n)->op); k++)
            u->user[u->start[dm_at(g, n)->as.arg[k] + 1]++] = n;
    return 1;
}

/* dn/dx out of those of its operands, which are there or zero */
static dm_node dot(const sweep *s, dm_graph *g, dm_node n) {
    dm_node sum = 0;
    const dm_expr e = *dm_at(g, n);
    for (int k = 0; k < dm_arity(e.op); k++)
        if (has_bit(s->known, e.as.arg[k]))
            sum = dm_derive_join(g, sum, dm_derive_share(g, n, k, s->d[e.as.arg[k]]));
    return sum;
}

/* d[n] = dn/dx_j for all nodes that are known in the end; the others' are zero */
static void forward(sweep *s, dm_graph *g, const users *u, uint32_t end, dm_node leaf) {
    const uint32_t words = end / 64 + 1;
    memset(s->known, 0, words * sizeof *s->known);
    set_bit(s->pending, leaf);
    for (uint32_t w = leaf / 64; w < words; w++)
        while (s->pending[w]) {
            const dm_node n = 64 * w + lowest(s->pending[w]);
            s->pending[w] &= s->pending[w] - 1;
            s->d[n] = n == leaf ? one(g) : dot(s, g, n);
            if (!s->d[n] || g->status != DM_OK) continue;
            set_bit(s->known, n);
            for (uint32_t i = u->start[n]; i < u->start[n + 1]; i++)
                set_bit(s->pending, u->user[i]);
        }
}

/* one forward sweep a column; an input that no node stands for has a column of zeros */
static void jacobian_by_columns(sweep *s, dm_graph *g, const dm_node *f, uint32_t m, dm_node *out) {
    users u;
    const uint32_t end = dm_mark(g, f, m);
    memset(out, 0, (size_t)m * s->n * sizeof *out);
    if (!find_users(&u, s, g, end)) return;
    for (uint32_t j = 0; j < s->n; j++) {
        const uint32_t input = s->first + j;
        const dm_node leaf = dm_leaf_of(g, input);
        if (!leaf || leaf >= end) continue;
        forward(s, g, &u, end, leaf);
        for (uint32_t i = 0; i < m; i++)
            out[(size_t)i * s->n + j] = has_bit(s->known, f[i]) ? s->d[f[i]] : 0;
    }
}

/* numbers only: no other order can be cheaper */
static int all_constant(const dm_graph *g, const dm_node *nodes, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!dm_is_op(g, nodes[i], DM_OP_CONSTANT)) return 0;
    return 1;
}

/* operations for f and its derivatives together: what a kernel of both has to do */
static uint32_t cost(dm_graph *g, dm_node *all, uint32_t m, const dm_node *d, size_t count) {
    memcpy(all + m, d, count * sizeof *d);
    return dm_operations(g, all, m + (uint32_t)count);
}

/* by rows, then by columns unless that cannot gain; the cheaper one with f itself counted in */
void dm_jacobian(dm_graph *g, const dm_node *f, uint32_t m, uint32_t first, uint32_t n,
                 dm_node *out) {
    sweep s;
    const size_t count = (size_t)m * n;
    memset(out, 0, count * sizeof *out);
    dm_node *other = dm_arena_take(g->arena, (count + 1) * sizeof *other);
    dm_node *all = dm_arena_take(g->arena, (m + count + 1) * sizeof *all);
    if (!other || !all) dm_graph_fail(g, DM_NO_MEMORY);
    if (g->status != DM_OK || !sweep_open(&s, g, f, m, first, n)) return;
    memcpy(all, f, m * sizeof *all);
    jacobian_by_rows(&s, g, f, m, out);
    if (all_constant(g, out, count)) return; /* as of a constant mass: nothing is less */
    if (dm_has_roots(g, f, m)) return;       /* whose rules are those of a reverse sweep */
    jacobian_by_columns(&s, g, f, m, other);
    if (g->status == DM_OK && cost(g, all, m, other, count) < cost(g, all, m, out, count))
        memcpy(out, other, count * sizeof *out);
}

/* copy one triangle over the other: the halves are equal, their expressions need not be
 */
static void mirror(dm_node *to, const dm_node *from, uint32_t n, int upper) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            const int keep = upper ? i <= j : i >= j;
            to[i * n + j] = keep ? from[i * n + j] : from[j * n + i];
        }
}

/* best of the two triangles of `tried` and what *least belongs to */
static void keep_smaller(dm_graph *g, dm_node *best, uint32_t *least, dm_node *all,
                         const dm_node *tried, uint32_t n) {
    const size_t count = (size_t)n * n;
    for (int upper = 0; upper < 2; upper++) {
        if (upper && memcmp(all + n, tried, count * sizeof *tried) == 0) return;
        mirror(all + n, tried, n, upper);
        const uint32_t now = dm_operations(g, all, n + (uint32_t)count);
        if (now >= *least) continue;
        *least = now;
        memcpy(best, all + n, count * sizeof *best);
    }
}

/* The Jacobian of the gradient by rows and by columns, each with either triangle mirrored. */
void dm_hessian(dm_graph *g, dm_node f, uint32_t first, uint32_t n, dm_node *gradient,
                dm_node *hessian) {
    sweep s;
    const size_t count = (size_t)n * n;
    uint32_t least = UINT32_MAX;
    memset(hessian, 0, count * sizeof *hessian);
    f = dm_compact_source(g, f);
    gradient_of(g, f, first, n, gradient);
    dm_node *tried = dm_arena_take(g->arena, (count + 1) * sizeof *tried);
    dm_node *all = dm_arena_take(g->arena, (n + count + 1) * sizeof *all);
    if (!tried || !all) dm_graph_fail(g, DM_NO_MEMORY);
    if (g->status != DM_OK || !sweep_open(&s, g, gradient, n, first, n)) return;
    memcpy(all, gradient, n * sizeof *all);
    jacobian_by_rows(&s, g, gradient, n, tried);
    keep_smaller(g, hessian, &least, all, tried, n);
    if (!all_constant(g, hessian, count) && !dm_has_roots(g, gradient, n)) {
        jacobian_by_columns(&s, g, gradient, n, tried);
        keep_smaller(g, hessian, &least, all, tried, n);
    }
    if (g->status != DM_OK) memset(hessian, 0, count * sizeof *hessian);
}
