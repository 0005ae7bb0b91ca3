/* implicit_kernel.c - kernels of graphs with implicit functions. The graph is cut at them: in a
 * new graph their outputs are inputs behind the others, y[r] and, where products with J^-1 are
 * asked for, its entries [r*r]. For each function and set of arguments, in their order, the
 * kernel finds the arguments and solves; then comes one kernel of that new graph. All parts are
 * made by the same backend, which never sees an implicit function. */
#include "code/implicit/implicit_kernel.h"

#include "algebra/derive.h"
#include "algebra/derive_inside.h"
#include "code/implicit/implicit_solve.h"
#include "graph/nodes.h"

#include <math.h>
#include <string.h>

/* one function of one set of arguments */
typedef struct {
    const dm_implicit *f;
    dm_node with;    /* last link of its arguments */
    dm_node *a;      /* [n] */
    uint32_t at;     /* its first input in the new graph */
    int has_inverse; /* J^-1 is asked for */
} instance;

/* a graph with its implicit functions, and the one without them */
typedef struct {
    dm_graph *from, *to;
    uint32_t end;
    instance *instances; /* sorted: those that an argument needs come before */
    uint32_t count;
    dm_node *now; /* [end] what nodes of `from` are in `to` */
} cut;

/* ---- what there is ---- */

/* the link where the arguments of the function alone end */
static dm_node last_argument(const dm_graph *g, dm_node with) {
    dm_node leaf = with;
    while (dm_is_op(g, leaf, DM_OP_WITH)) leaf = dm_at(g, leaf)->as.arg[0];
    const dm_implicit *f = dm_implicit_find(g, dm_at(g, leaf)->as.value);
    for (uint32_t length = dm_implicit_length(g, with); length > f->inputs; length--)
        with = dm_at(g, with)->as.arg[0];
    return with;
}

/* the instance of these arguments, NULL: not met before */
static instance *find(const cut *c, dm_node with) {
    for (uint32_t i = 0; i < c->count; i++)
        if (c->instances[i].with == with) return c->instances + i;
    return NULL;
}

/* links have growing numbers, so that sorting by them sorts by need */
static instance *insert(cut *c, dm_node with) {
    uint32_t i = c->count++;
    for (; i > 0 && c->instances[i - 1].with > with; i--) c->instances[i] = c->instances[i - 1];
    c->instances[i] = (instance){.with = with};
    return c->instances + i;
}

/* its function and its arguments, by the chain of links */
static int read_instance(cut *c, instance *x) {
    x->a = dm_arena_take(c->from->arena, (dm_implicit_length(c->from, x->with) + 1) * sizeof *x->a);
    if (x->a) x->f = dm_implicit_read(c->from, x->with, x->a);
    return x->a != NULL;
}

/* every function with every set of arguments once, in the order in which they can be solved; 0
 * without memory */
static int find_instances(cut *c) {
    uint32_t roots = 0;
    for (dm_node n = 0; n < c->end; n++)
        roots += dm_is_marked(c->from, n) && dm_is_op(c->from, n, DM_OP_ROOT);
    c->instances = dm_arena_take(c->from->arena, roots * sizeof *c->instances);
    if (!c->instances) return 0;
    for (dm_node n = 0; n < c->end; n++) {
        if (!dm_is_marked(c->from, n) || !dm_is_op(c->from, n, DM_OP_ROOT)) continue;
        const dm_node chain = dm_at(c->from, n)->as.arg[0], with = last_argument(c->from, chain);
        instance *x = find(c, with);
        if (!x) x = insert(c, with);
        if (chain != with) x->has_inverse = 1;
    }
    for (uint32_t i = 0; i < c->count; i++)
        if (!read_instance(c, c->instances + i)) return 0;
    return 1;
}

/* ---- the new graph ---- */

/* inputs of the new graph: those of the old one, then the roots (and matrices) of every
 * instance */
static int open_graph(cut *c) {
    uint32_t inputs = c->from->inputs;
    for (uint32_t i = 0; i < c->count; i++) {
        instance *x = c->instances + i;
        const uint32_t r = x->f->unknowns;
        x->at = inputs;
        inputs += r + (x->has_inverse ? r * r : 0);
    }
    c->to = dm_graph_new(c->from->arena, inputs);
    c->now = dm_arena_take(c->from->arena, c->end * sizeof *c->now);
    if (!c->to || !c->now) return 0;
    c->to->verbatim = c->from->verbatim;
    return 1;
}

/* S at the root */
static dm_node value_of(cut *c, const instance *x) {
    const uint32_t r = x->f->unknowns, n = x->f->inputs;
    dm_node out = 0, *with = dm_arena_take(c->to->arena, (n + 3 * (size_t)r) * sizeof *with);
    if (!with) return dm_graph_fail(c->to, DM_NO_MEMORY);
    memset(with, 0, (n + 3 * (size_t)r) * sizeof *with);
    for (uint32_t k = 0; k < r; k++) with[k] = dm_input(c->to, x->at + k);
    for (uint32_t j = 0; j < n; j++) with[r + j] = c->now[x->a[j]];
    dm_transplant(c->to, x->f->graph, x->f->value, 1, with, &out);
    return out;
}

/* entry k of J^-T s, or k - r of J^-1 s; a branch that makes s zero makes the product zero */
static dm_node product_of(cut *c, const instance *x, dm_node chain, uint32_t k) {
    const uint32_t r = x->f->unknowns, inverse = x->at + r;
    dm_node sum = 0;
    for (uint32_t l = r; l-- > 0;) { /* the last s is the outermost link */
        const uint32_t entry = k < r ? l * r + k : (k - r) * r + l;
        const dm_node s = c->now[dm_at(c->from, chain)->as.arg[1]];
        const dm_node J = dm_input(c->to, inverse + entry);
        sum = dm_derive_join(c->to, sum, dm_derive_times(c->to, s, J));
        chain = dm_at(c->from, chain)->as.arg[0];
    }
    return sum;
}

/* a root is an input now, S and products with the inverse are made of inputs */
static dm_node root_of(cut *c, const dm_expr *e) {
    const instance *x = find(c, last_argument(c->from, e->as.arg[0]));
    const uint32_t k = (uint32_t)dm_at(c->from, e->as.arg[1])->as.value;
    if (x->with != e->as.arg[0]) return product_of(c, x, e->as.arg[0], k);
    return k < x->f->unknowns ? dm_input(c->to, x->at + k) : value_of(c, x);
}

/* the node of the new graph that n becomes; links to arguments become nothing */
static dm_node node_of(cut *c, dm_node n) {
    const dm_expr e = *dm_at(c->from, n);
    dm_node arg[3] = {0, 0, 0};
    switch (e.op) {
    case DM_OP_CONSTANT:
        return dm_constant(c->to, e.as.value);
    case DM_OP_INPUT:
        return dm_input(c->to, e.as.input);
    case DM_OP_IMPLICIT:
    case DM_OP_WITH:
        return 0;
    case DM_OP_ROOT:
        return root_of(c, &e);
    default:
        for (int k = 0; k < dm_arity(e.op); k++) arg[k] = c->now[e.as.arg[k]];
        return dm_apply(c->to, e.op, arg[0], arg[1], arg[2]);
    }
}

/* all marked nodes in their order, so that operands are there */
static dm_status cut_graph(cut *c, const dm_node *roots, uint32_t m) {
    c->end = dm_mark(c->from, roots, m);
    if (!find_instances(c) || !open_graph(c)) return DM_NO_MEMORY;
    for (dm_node n = 0; n < c->end; n++) c->now[n] = dm_is_marked(c->from, n) ? node_of(c, n) : 0;
    return c->to->status;
}

/* ---- the kernel ---- */

/* one implicit function of one set of arguments, as a step of the kernel */
typedef struct {
    dm_root_solver solver;
    dm_kernel arguments;  /* to next[n]; no eval: they are copied */
    const uint32_t *from; /* [n] from here, then */
    double *next;         /* [n] the arguments that are asked for */
    /* in the memory of the kernel: */
    double *y, *inverse;       /* of the root that there is, [r*r] */
    double *known, *x, *slope; /* is there one? its arguments [n]; dy/dx [r*n] */
} stage;

/* what the kernel is: all functions, then the straight line; `remembers` is the last entry of its
 * memory */
typedef struct {
    double *in; /* of `last`: inputs, then roots; then the rest of the memory */
    uint32_t inputs, count;
    stage *stages;
    dm_kernel last;
    const double *remembers;
} composite;

/* y + dy/dx (next - x) */
static void continue_root(const stage *s) {
    const uint32_t r = s->solver.r, n = s->solver.n;
    for (uint32_t i = 0; i < r; i++)
        for (uint32_t j = 0; j < n; j++)
            s->y[i] += s->slope[i * (size_t)n + j] * (s->next[j] - s->x[j]);
}

/* The root for the present arguments: the last one where they have not changed, from the last
 * one continued where the kernel remembers, else from the starts of the function. */
static void solve(stage *s, const double *in, int remembers) {
    const uint32_t n = s->solver.n;
    dm_root_outcome outcome;
    if (s->arguments.eval)
        dm_kernel_eval(&s->arguments, in, s->next);
    else
        for (uint32_t i = 0; i < n; i++) s->next[i] = in[s->from[i]];
    if (*s->known != 0.0 && memcmp(s->x, s->next, n * sizeof *s->x) == 0) return;
    if (remembers && *s->known != 0.0) {
        continue_root(s);
        outcome = dm_root_solve_near(&s->solver, s->next, s->y, s->inverse);
    } else {
        outcome = dm_root_solve(&s->solver, s->next, s->y, s->inverse);
    }
    memcpy(s->x, s->next, n * sizeof *s->x);
    *s->known = outcome == DM_ROOT_FOUND;
    if (remembers && *s->known != 0.0) dm_root_slope(&s->solver, s->slope, s->inverse);
}

/* roots first, in their order, then the straight line */
static void evaluate(const void *pool, const double *in, double *out) {
    const composite *c = pool;
    const int remembers = *c->remembers != 0.0;
    if (c->inputs) memcpy(c->in, in, c->inputs * sizeof *in);
    for (uint32_t i = 0; i < c->count; i++) solve(c->stages + i, c->in, remembers);
    dm_kernel_eval(&c->last, c->in, out);
}

/* arguments that are inputs are copied, others have a kernel */
static dm_status make_arguments(stage *s, const cut *c, const instance *x, dm_compile *compile,
                                dm_arena *arena) {
    const uint32_t n = x->f->inputs;
    uint32_t *from = dm_arena_take(arena, (n + 1) * sizeof *from), copied = 0;
    dm_node *node = dm_arena_take(c->to->arena, (n + 1) * sizeof *node);
    if (!from || !node) return DM_NO_MEMORY;
    for (uint32_t i = 0; i < n; i++) {
        node[i] = c->now[x->a[i]];
        if (!dm_is_op(c->to, node[i], DM_OP_INPUT)) continue;
        from[i] = dm_at(c->to, node[i])->as.input;
        copied++;
    }
    s->from = from;
    if (copied == n) return DM_OK;
    const dm_status status = compile(&s->arguments, c->to, node, n, arena);
    if (status == DM_OK) dm_kernel_prepare(&s->arguments, s->next);
    return status;
}

/* the memory of a stage beside y (and J^-1, where that is an input too) at *at, which moves on */
static void place(stage *s, const composite *k, const instance *x, double **at) {
    const uint32_t r = x->f->unknowns, n = x->f->inputs;
    s->y = k->in + x->at;
    s->inverse = s->y + r;
    if (!x->has_inverse) s->inverse = *at, *at += r * (size_t)r;
    s->known = *at;
    s->x = s->known + 1;
    s->slope = s->x + n;
    *at = s->slope + r * (size_t)n;
}

/* arguments, then the solver of the function */
static dm_status make_stage(stage *s, const cut *c, const instance *x, dm_compile *compile,
                            dm_arena *arena) {
    const uint32_t n = x->f->inputs;
    s->next = dm_arena_take(arena, (n + (size_t)1) * sizeof *s->next);
    if (!s->next) return DM_NO_MEMORY;
    memset(s->next, 0, (n + (size_t)1) * sizeof *s->next);
    const dm_status status = make_arguments(s, c, x, compile, arena);
    if (status != DM_OK) return status;
    return dm_root_solver_build(&s->solver, x->f, compile, compile, arena, arena == c->from->arena);
}

/* room for inputs, roots and the rest of the memory; 0 without memory */
static int take_memory(composite *k, const cut *c, dm_arena *arena) {
    const size_t inputs = dm_graph_inputs(c->to);
    size_t size = inputs + 1;
    for (uint32_t i = 0; i < c->count; i++) {
        const size_t r = c->instances[i].f->unknowns, n = c->instances[i].f->inputs;
        size += r * r + 1 + n + r * n;
    }
    k->in = dm_arena_take(arena, size * sizeof *k->in);
    k->stages = dm_arena_take(arena, c->count * sizeof *k->stages);
    if (!k->in || !k->stages) return 0;
    memset(k->in, 0, size * sizeof *k->in);
    memset(k->stages, 0, c->count * sizeof *k->stages);
    double *at = k->in + inputs;
    for (uint32_t i = 0; i < c->count; i++) place(k->stages + i, k, c->instances + i, &at);
    k->remembers = at;
    return 1;
}

/* memory, one stage an instance in their order, then the kernel of the rest */
static dm_status build(composite *k, const cut *c, const dm_node *roots, uint32_t m,
                       dm_compile *compile, dm_arena *arena) {
    dm_node *node = dm_arena_take(c->to->arena, m * sizeof *node);
    k->inputs = c->from->inputs;
    if (!node || !take_memory(k, c, arena)) return DM_NO_MEMORY;
    for (; k->count < c->count; k->count++) {
        const dm_status status =
            make_stage(k->stages + k->count, c, c->instances + k->count, compile, arena);
        if (status != DM_OK) return status;
    }
    for (uint32_t i = 0; i < m; i++) node[i] = c->now[roots[i]];
    return compile(&k->last, c->to, node, m, arena);
}

/* What the kernel remembers lies behind its inputs, so that a run can save and restore it at
 * once. */
dm_status dm_root_kernel(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                         dm_compile *compile, dm_arena *arena) {
    cut c = {.from = g};
    composite *k = dm_arena_take(arena, sizeof *k);
    if (!k) return DM_NO_MEMORY;
    *k = (composite){.in = NULL};
    dm_status status = cut_graph(&c, roots, m);
    if (status == DM_OK) status = build(k, &c, roots, m, compile, arena);
    if (status != DM_OK) return status;
    *out = k->last;
    out->eval = evaluate;
    out->pool = k;
    out->inputs = k->inputs;
    out->memory = k->in + k->inputs;
    out->memory_size = (uint32_t)(k->remembers + 1 - out->memory);
    for (uint32_t i = 0; i < k->count; i++)
        out->operations +=
            k->stages[i].arguments.operations + k->stages[i].solver.equation.operations;
    return DM_OK;
}
