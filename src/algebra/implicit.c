/* implicit.c - implicit functions: made with their derivatives, kept by graphs, written as
 * chains of nodes. A function has a graph of its own for F, F_y, F_x, and one for the second
 * derivatives along two vectors; who uses it in another graph has a copy there, node for node, so
 * that kernels of both round alike. Functions are told apart by their serial numbers, whole and
 * above 0. */
#include "algebra/implicit.h"

#include "algebra/compact.h"
#include "algebra/derive.h"
#include "graph/nodes.h"

#include <string.h>

/* ---- chains ---- */

/* newest first; there are few */
const dm_implicit *dm_implicit_find(const dm_graph *g, double serial) {
    const dm_implicit *f = g->implicits;
    while (f && f->serial != serial) f = f->next;
    return f;
}

/* one link an argument */
dm_node dm_implicit_with(dm_graph *g, dm_node f, const dm_node *a, uint32_t m) {
    for (uint32_t i = 0; i < m; i++) f = dm_node_plain(g, DM_OP_WITH, f, a[i], 0);
    return f;
}

/* the entry is a constant node, so that passes see two operands */
dm_node dm_implicit_root(dm_graph *g, dm_node with, uint32_t k) {
    const dm_node entry = dm_constant(g, k);
    return dm_node_plain(g, DM_OP_ROOT, with, entry, 0);
}

/* links down to the leaf */
uint32_t dm_implicit_length(const dm_graph *g, dm_node with) {
    uint32_t m = 0;
    for (; dm_is_op(g, with, DM_OP_WITH); m++) with = dm_at(g, with)->as.arg[0];
    return m;
}

/* arguments in the order in which they were given */
const dm_implicit *dm_implicit_read(const dm_graph *g, dm_node with, dm_node *a) {
    for (uint32_t m = dm_implicit_length(g, with); m-- > 0;) {
        a[m] = dm_at(g, with)->as.arg[1];
        with = dm_at(g, with)->as.arg[0];
    }
    return dm_implicit_find(g, dm_at(g, with)->as.value);
}

/* for most graphs a look at one pointer */
int dm_has_roots(dm_graph *g, const dm_node *roots, uint32_t m) {
    if (!g->implicits || g->status != DM_OK) return 0;
    const uint32_t end = dm_mark(g, roots, m);
    for (dm_node n = 0; n < end; n++)
        if (dm_is_marked(g, n) && dm_is_op(g, n, DM_OP_ROOT)) return 1;
    return 0;
}

/* ---- copies ---- */

/* a text in the arena; NULL stays NULL */
static const char *copy_text(dm_arena *arena, const char *text) {
    const size_t size = text ? strlen(text) + 1 : 0;
    char *copy = size ? dm_arena_take(arena, size) : NULL;
    if (copy) memcpy(copy, text, size);
    return copy;
}

/* how many nodes a function has in one array */
static size_t count_nodes(const dm_implicit *f) {
    const size_t r = f->unknowns, n = f->inputs;
    return r + r * r + 1 + r * n + 1 + n + f->starts * r;
}

/* the parts of an array of all nodes */
static void lay_out(dm_implicit *f, const dm_node *nodes) {
    const size_t r = f->unknowns, n = f->inputs;
    f->equation = nodes;
    f->slope = f->equation + r + r * r + 1;
    f->value = f->slope + r * n;
    f->start = f->value + 1 + n;
}

/* texts, nodes, bend and trouble of its own; 0 without memory */
static int own(dm_implicit *f, const dm_node *nodes, dm_arena *arena) {
    const size_t count = count_nodes(f), size = f->unknowns + (size_t)f->inputs;
    const char *advice = f->advice;
    dm_node *kept = dm_arena_take(arena, count * sizeof *kept);
    f->trouble = dm_arena_take(arena, sizeof *f->trouble);
    f->bend = dm_arena_take(arena, sizeof *f->bend);
    double *where = dm_arena_take(arena, (size + 1) * sizeof *where);
    f->name = copy_text(arena, f->name);
    f->advice = copy_text(arena, advice);
    if (!kept || !f->trouble || !f->bend || !where || !f->name || (advice && !f->advice)) return 0;
    memcpy(kept, nodes, count * sizeof *kept);
    memset(where, 0, (size + 1) * sizeof *where);
    *f->trouble = (dm_root_trouble){.y = where, .x = where + f->unknowns};
    *f->bend = (dm_implicit_bend){.nodes = NULL};
    lay_out(f, kept);
    return 1;
}

static int add_all(dm_graph *to, const dm_implicit *list);

/* node for node, so that kernels of both round alike */
static dm_graph *copy_graph(const dm_graph *from, dm_arena *arena) {
    dm_graph *to = dm_graph_sized(arena, from->inputs, from->size);
    if (!to || !add_all(to, from->implicits)) return NULL;
    for (dm_node n = 1; n < from->size; n++) dm_node_make(to, from->nodes + n);
    return to->status == DM_OK ? to : NULL;
}

/* f is among the functions of g; copied where g has another arena */
static int add(dm_graph *g, const dm_implicit *f) {
    if (dm_implicit_find(g, f->serial)) return 1;
    dm_implicit *kept = dm_arena_take(g->arena, sizeof *kept);
    if (!kept) return (int)dm_graph_fail(g, DM_NO_MEMORY);
    *kept = *f;
    if (f->graph->arena != g->arena) {
        kept->graph = copy_graph(f->graph, g->arena);
        if (!kept->graph || !own(kept, f->equation, g->arena))
            return (int)dm_graph_fail(g, DM_NO_MEMORY);
    }
    kept->next = g->implicits;
    g->implicits = kept;
    return 1;
}

/* the oldest first, since the newer ones may call them */
static int add_all(dm_graph *to, const dm_implicit *list) {
    return !list || (add_all(to, list->next) && add(to, list));
}

/* The number of the function is the content of the node. */
dm_node dm_implicit_leaf(dm_graph *g, const dm_implicit *f) {
    if (!add(g, f)) return 0;
    return dm_node_make(g, &(dm_expr){.op = DM_OP_IMPLICIT, .as.value = f->serial});
}

/* ---- making one ---- */

/* F_y and F_x of the nodes in f->equation */
static int differentiate(dm_implicit *f, dm_node *equation, dm_node *slope) {
    const uint32_t r = f->unknowns, n = f->inputs;
    dm_graph *g = f->graph;
    dm_node *all = dm_arena_take(g->arena, r * (size_t)(r + n) * sizeof *all);
    if (!all) return 0;
    dm_jacobian(g, equation, r, 0, r + n, all);
    for (uint32_t i = 0; i < r; i++) {
        const dm_node *row = all + i * (size_t)(r + n);
        memcpy(equation + r + i * (size_t)r, row, r * sizeof *row);
        memcpy(slope + i * (size_t)n, row + r, n * sizeof *row);
    }
    return 1;
}

/* d(w^T F_y u)/d(y, x): the gradient of w . F by y, of that along u, and its gradient */
static void find_bend(const dm_implicit *f, dm_graph *g, dm_node *by_y, dm_node *bend) {
    const uint32_t r = f->unknowns, n = f->inputs;
    dm_node sum = 0, along = 0;
    for (uint32_t k = 0; k < r; k++)
        sum = dm_add(g, sum, dm_mul(g, dm_input(g, r + n + k), f->equation[k]));
    dm_gradient(g, sum, 0, r, by_y);
    for (uint32_t k = 0; k < r; k++)
        along = dm_add(g, along, dm_mul(g, dm_input(g, 2 * r + n + k), by_y[k]));
    dm_gradient(g, along, 0, r + n, bend);
}

/* Rarely asked for, and as much work as all the rest: "frame ms" of tests/bench/frames.lua. In a
 * graph of its own, so that kernels of F have the same bits before and after. */
const dm_implicit_bend *dm_implicit_find_bend(const dm_implicit *f) {
    const size_t r = f->unknowns, n = f->inputs;
    dm_arena *arena = f->graph->arena;
    if (f->bend->nodes) return f->bend;
    dm_graph *g = copy_graph(f->graph, arena);
    dm_node *nodes = dm_arena_take(arena, (2 * r + n) * sizeof *nodes);
    if (!g || !nodes) return NULL;
    find_bend(f, g, nodes + r + n, nodes);
    if (dm_graph_status(g) != DM_OK) return NULL;
    *f->bend = (dm_implicit_bend){.graph = g, .nodes = nodes};
    return f->bend;
}

/* the nodes of the draft in the graph of f */
static void transplant(dm_implicit *f, const dm_implicit_draft *d, const dm_node *from, uint32_t m,
                       dm_node *to) {
    dm_node with[DM_ROOT_MOST + 1], *all = with;
    const uint32_t inputs = d->unknowns + d->inputs;
    if (!m) return;
    if (inputs > DM_ROOT_MOST) all = dm_arena_take(f->graph->arena, inputs * sizeof *all);
    if (!all) {
        dm_graph_fail(f->graph, DM_NO_MEMORY);
        return;
    }
    for (uint32_t i = 0; i < inputs; i++) all[i] = dm_input(f->graph, i);
    dm_transplant(f->graph, d->graph, from, m, all, to);
}

/* What vanishes where f does, without functions around it that vanish at 0 alone and flatten far
 * from it: Newton's method sees no slope where tanh(50 y) is 1 to its last digit. */
static dm_node without_flattening(const dm_graph *g, dm_node f) {
    const dm_expr *x = dm_graph_at(g, f);
    double value;
    if (x->op == DM_OP_TANH || x->op == DM_OP_ATAN || x->op == DM_OP_SINH)
        return without_flattening(g, x->as.arg[0]);
    for (int k = 0; x->op == DM_OP_MUL && k < 2; k++) { /* a number times it, or its opposite */
        const dm_node other = x->as.arg[1 - k], inner = without_flattening(g, other);
        const int is_number = dm_is_constant(g, x->as.arg[k], &value);
        if (is_number && value != 0.0 && inner != other) return inner;
    }
    if (x->op != DM_OP_NEG) return f;
    const dm_node inner = without_flattening(g, x->as.arg[0]);
    return inner != x->as.arg[0] ? inner : f;
}

/* all nodes of f: the draft brought over, then derivatives */
static int fill(dm_implicit *f, const dm_implicit_draft *d, dm_node *nodes) {
    const uint32_t r = d->unknowns, n = d->inputs;
    lay_out(f, nodes);
    dm_node *equation = nodes, *slope = nodes + (f->slope - nodes);
    dm_node *value = nodes + (f->value - nodes);
    if (d->value) {
        transplant(f, d, d->value, 1, value);
        dm_gradient(f->graph, *value, 0, r, equation);
        dm_gradient(f->graph, *value, r, n, value + 1);
    } else {
        transplant(f, d, d->equation, r, equation);
        for (uint32_t i = 0; i < r; i++) equation[i] = without_flattening(f->graph, equation[i]);
    }
    if (d->branch) transplant(f, d, d->branch, 1, equation + r + (size_t)r * r);
    transplant(f, d, d->start, d->starts * r, value + 1 + n);
    return differentiate(f, equation, slope);
}

/* In a graph with inputs (y, x, w, u), w and u being the vectors of second derivatives. */
dm_implicit *dm_implicit_make(const dm_implicit_draft *d, dm_arena *arena, dm_status *status) {
    const uint32_t r = d->unknowns, n = d->inputs;
    dm_implicit *f = dm_arena_take(arena, sizeof *f);
    *status = DM_NO_MEMORY;
    if (!f) return NULL;
    *f = (dm_implicit){.serial = d->serial,
                       .name = d->name,
                       .advice = d->advice,
                       .unknowns = r,
                       .inputs = n,
                       .starts = d->starts,
                       .angles = d->angles,
                       .has_branch = d->branch != NULL,
                       .has_value = d->value != NULL,
                       .graph = dm_graph_new(arena, 3 * r + n)};
    dm_node *nodes = dm_arena_take(arena, count_nodes(f) * sizeof *nodes);
    if (!f->graph || !nodes) return NULL;
    memset(nodes, 0, count_nodes(f) * sizeof *nodes);
    const int whole = fill(f, d, nodes) && own(f, nodes, arena);
    *status = dm_graph_status(f->graph);
    if (*status == DM_OK && !whole) *status = DM_NO_MEMORY;
    return *status == DM_OK ? f : NULL;
}

/* ---- trouble ---- */

/* inner functions first: they are the cause */
const dm_implicit *dm_root_troubled(const dm_graph *g) {
    for (const dm_implicit *f = g->implicits; f; f = f->next) {
        const dm_implicit *inside = dm_root_troubled(f->graph);
        if (inside) return inside;
        if (f->trouble->outcome != DM_ROOT_FOUND) return f;
    }
    return NULL;
}

/* of all functions, inner ones too */
void dm_root_forget(const dm_graph *g) {
    for (const dm_implicit *f = g->implicits; f; f = f->next) {
        dm_root_forget(f->graph);
        f->trouble->outcome = DM_ROOT_FOUND;
    }
}
