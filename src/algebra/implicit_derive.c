/* implicit_derive.c - reverse sweeps through implicit functions. Adjoints of all outputs of a
 * chain are gathered at its last link, which comes after them in the sweep, and then go on at
 * once: with a of the root, c of the value, w = J^-T a,  x gets c S_x - F_x^T w; with b of w =
 * J^-T s and u = J^-1 b: s gets u, and y, x get -d(w^T J u); the same for J^-1 s with w = J^-T
 * b. */
#include "algebra/derive.h"
#include "algebra/derive_inside.h"
#include "graph/nodes.h"

#include <string.h>

/* one chain of arguments in a sweep */
typedef struct {
    dm_derive_sweep *s;
    dm_graph *g;
    const dm_implicit *f;
    dm_node root;  /* last link of the arguments x alone */
    dm_node *a;    /* [n + r] arguments of the chain: x, then s */
    dm_node *with; /* [n + 3 r] what the inputs of the function's graph are */
    uint32_t r, n;
} place;

/* nodes that are zero */
static dm_node *take(dm_graph *g, size_t count) {
    dm_node *nodes = dm_arena_take(g->arena, (count + 1) * sizeof *nodes);
    if (nodes)
        memset(nodes, 0, (count + 1) * sizeof *nodes);
    else
        dm_graph_fail(g, DM_NO_MEMORY);
    return nodes;
}

/* zero everywhere */
static int all_zero(const dm_node *a, uint32_t m) {
    for (uint32_t i = 0; i < m; i++)
        if (a[i]) return 0;
    return 1;
}

/* ---- what has been gathered ---- */

/* what the chain has got so far, made when it gets something first */
static dm_root_adjoint *gathered(dm_derive_sweep *s, dm_graph *g, dm_node with, uint32_t outputs) {
    dm_root_adjoint *all = s->roots;
    while (all && all->with != with) all = all->next;
    if (all) return all;
    all = dm_arena_take(g->arena, sizeof *all);
    dm_node *of = take(g, outputs);
    if (!all || !of) return dm_graph_fail(g, DM_NO_MEMORY), NULL;
    *all = (dm_root_adjoint){.next = s->roots, .with = with, .of = of};
    return s->roots = all;
}

/* output k of the chain gets d; its last link will be come to */
static void gather(const place *p, dm_node with, uint32_t k, dm_node d) {
    if (!d || with >= p->s->room || !p->s->active[with]) return;
    dm_root_adjoint *all = gathered(p->s, p->g, with, 2 * p->r + 1);
    if (!all) return;
    all->of[k] = dm_derive_join(p->g, all->of[k], d);
    dm_derive_hold(p->s, with, dm_constant(p->g, 1.0));
}

/* an argument gets d, where the sweep wants to know of it */
static void give(const place *p, dm_node to, dm_node d) {
    if (d && p->s->active[to])
        dm_derive_hold(p->s, to, dm_derive_join(p->g, dm_derive_held(p->s, to), d));
}

/* ---- conditions ---- */

enum { MOST_CONDITIONS = 8 };

/* conditions under which alone adjoints differ from zero: there a root need not be */
typedef struct {
    dm_node condition[MOST_CONDITIONS];
    int otherwise[MOST_CONDITIONS]; /* where it is not > 0 */
    int count;
} guard;

/* one condition that all of a[m] stand under is taken off them; 0: there is none */
static int strip_one(guard *c, const dm_graph *g, dm_node *a, uint32_t m) {
    dm_node condition = 0;
    int side = 0;
    for (uint32_t i = 0; i < m; i++) {
        const dm_expr *e = dm_at(g, a[i]);
        if (!a[i]) continue;
        if (e->op != DM_OP_WHERE || (e->as.arg[1] && e->as.arg[2])) return 0;
        const int own = e->as.arg[1] ? 1 : 2;
        if (condition && (e->as.arg[0] != condition || own != side)) return 0;
        condition = e->as.arg[0];
        side = own;
    }
    if (!condition) return 0;
    for (uint32_t i = 0; i < m; i++)
        if (a[i]) a[i] = dm_at(g, a[i])->as.arg[side];
    c->condition[c->count] = condition;
    c->otherwise[c->count++] = side == 2;
    return 1;
}

/* conditions from the outermost on */
static void strip(guard *c, const dm_graph *g, dm_node *a, uint32_t m) {
    c->count = 0;
    while (c->count < MOST_CONDITIONS && strip_one(c, g, a, m)) {}
}

/* d under these conditions again */
static dm_node guarded(const guard *c, dm_graph *g, dm_node d) {
    for (int k = c->count; k-- > 0;)
        d = dm_apply(g, DM_OP_WHERE, c->condition[k], c->otherwise[k] ? 0 : d,
                     c->otherwise[k] ? d : 0);
    return d;
}

/* ---- the rules ---- */

/* out[r] = J^-T s (from = 0) or J^-1 s (from = r) */
static void solve(const place *p, const dm_node *s, uint32_t from, dm_node *out) {
    const dm_node with = dm_implicit_with(p->g, p->root, s, p->r);
    for (uint32_t k = 0; k < p->r; k++) out[k] = dm_implicit_root(p->g, with, from + k);
}

/* out[m] = nodes of the function's graph at the root, with w and u where they are asked for */
static void bring(const place *p, const dm_node *nodes, uint32_t m, dm_node *out) {
    dm_transplant(p->g, p->f->graph, nodes, m, p->with, out);
}

/* adjoints a[r] of y, and c of the value */
static void pass_root(const place *p, dm_node *a) {
    const uint32_t r = p->r, n = p->n;
    dm_node *w = take(p->g, r), *slope = take(p->g, n * (size_t)(r + 1));
    guard c;
    strip(&c, p->g, a, r + 1);
    if (!w || !slope) return;
    if (!all_zero(a, r)) {
        solve(p, a, 0, w);
        bring(p, p->f->slope, r * n, slope);
    }
    if (a[r]) bring(p, p->f->value + 1, n, slope + r * (size_t)n);
    for (uint32_t j = 0; j < n; j++) {
        dm_node d = dm_mul(p->g, a[r], slope[r * (size_t)n + j]);
        for (uint32_t k = 0; k < r; k++)
            d = dm_sub(p->g, d, dm_mul(p->g, w[k], slope[k * (size_t)n + j]));
        give(p, p->a[j], guarded(&c, p->g, d));
    }
}

/* adjoints b[r] of J^-T s (from = 0) or J^-1 s (from = r) */
static void pass_solution(const place *p, dm_node with, dm_node *b, uint32_t from) {
    const uint32_t r = p->r, n = p->n;
    dm_node *other = take(p->g, r), *bend = take(p->g, r + (size_t)n);
    const dm_implicit_bend *second;
    guard c;
    if (all_zero(b, r) || !other || !bend) return;
    if (!(second = dm_implicit_find_bend(p->f))) {
        dm_graph_fail(p->g, DM_NO_MEMORY);
        return;
    }
    strip(&c, p->g, b, r);
    solve(p, b, r - from, other);
    dm_node *w = p->with + r + n, *u = w + r;
    for (uint32_t k = 0; k < r; k++) {
        const dm_node own = dm_implicit_root(p->g, with, from + k);
        w[k] = from ? other[k] : own;
        u[k] = from ? own : other[k];
        give(p, p->a[n + k], guarded(&c, p->g, other[k]));
    }
    dm_transplant(p->g, second->graph, second->nodes, r + n, p->with, bend);
    for (uint32_t k = 0; k < r; k++)
        gather(p, p->root, k, guarded(&c, p->g, dm_neg(p->g, bend[k])));
    for (uint32_t j = 0; j < n; j++) give(p, p->a[j], guarded(&c, p->g, dm_neg(p->g, bend[r + j])));
}

/* what the chain is; 0 without memory */
static int find_place(place *p, dm_node with) {
    const uint32_t length = dm_implicit_length(p->g, with);
    p->a = take(p->g, length);
    if (!p->a || !(p->f = dm_implicit_read(p->g, with, p->a))) return 0;
    p->r = p->f->unknowns;
    p->n = p->f->inputs;
    p->root = with;
    for (uint32_t k = p->n; k < length; k++) p->root = dm_at(p->g, p->root)->as.arg[0];
    p->with = take(p->g, p->n + 3 * (size_t)p->r);
    if (!p->with) return 0;
    for (uint32_t k = 0; k < p->r; k++) p->with[k] = dm_implicit_root(p->g, p->root, k);
    memcpy(p->with + p->r, p->a, p->n * sizeof *p->a);
    return p->g->status == DM_OK;
}

void dm_derive_root(dm_derive_sweep *s, dm_graph *g, dm_node n) {
    place p = {.s = s, .g = g};
    const dm_expr e = *dm_at(g, n);
    const int is_root = e.op == DM_OP_ROOT;
    const dm_node with = is_root ? e.as.arg[0] : n;
    if (!find_place(&p, with)) return;
    if (is_root) {
        gather(&p, with, (uint32_t)dm_at(g, e.as.arg[1])->as.value, s->d[n]);
        return;
    }
    dm_root_adjoint *all = gathered(s, g, with, 2 * p.r + 1);
    if (all && with == p.root) {
        pass_root(&p, all->of);
    } else if (all) {
        pass_solution(&p, with, all->of, 0);
        pass_solution(&p, with, all->of + p.r, p.r);
    }
}
