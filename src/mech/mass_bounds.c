#include "mech/mass_bounds.h"

#include "algebra/compact.h"
#include "algebra/derive.h"
#include "graph/analyse.h"
#include "linalg/signature.h"

#include <math.h>
#include <string.h>

enum {
    MOST_NODES = DM_MASS_MOST_NODES,
    MOST = 12
}; /* nodes of M, and dim Q, that looks are worth */

void dm_mass_bounds_bend(const dm_mass_bounds *b, const dm_interval *in, const dm_interval *rate_in,
                         double *shift, double *bend, dm_interval *scratch) {
    dm_interval *value = scratch, *rate = value + b->size, *bent = rate + b->size;
    dm_bounds(b->graph, in, value);
    dm_bounds_rate(b->graph, rate_in, value, rate);
    dm_bounds_bend(b->graph, NULL, value, rate, bent);
    for (uint32_t i = 0; i < b->n * b->n; i++) {
        const dm_interval x = bent[b->roots[i]], y = rate[b->roots[i]];
        bend[i] = fmax(fabs(x.lo), fabs(x.hi));
        shift[i] = fmax(fabs(y.lo), fabs(y.hi));
    }
}

int dm_mass_is_definite(const dm_mass_bounds *b, dm_interval *scratch) {
    const uint32_t n = b->n;
    dm_interval *in = scratch, *value = in + b->inputs;
    double C[MOST * MOST], radius[MOST * MOST];
    for (uint32_t i = 0; i < b->inputs; i++) in[i] = (dm_interval)DM_ANYWHERE;
    dm_bounds(b->graph, in, value);
    for (uint32_t k = 0; k < n * n; k++) {
        const dm_interval m = value[b->roots[k]];
        C[k] = k / n == k % n ? m.lo : 0.5 * m.lo + 0.5 * m.hi;
        radius[k] = k / n == k % n ? 0.0 : 0.5 * m.hi - 0.5 * m.lo;
    }
    return dm_surely_positive(C, radius, n);
}

static int has_zero(dm_interval x) {
    return x.lo <= 0.0 && x.hi >= 0.0;
}

/* x of a power of x, or itself. */
static dm_node base_of(const dm_graph *g, dm_node x) {
    const dm_expr *e = dm_graph_at(g, x);
    const int square = e->op == DM_OP_MUL && e->as.arg[0] == e->as.arg[1];
    const int power = e->op == DM_OP_SQRT || e->op == DM_OP_POW || e->op == DM_OP_NEG;
    return square || power ? base_of(g, e->as.arg[0]) : x;
}

/* Does M end where x is zero, since its root or logarithm stands in it? No run goes on behind that
 * without a word. */
static int is_edge(const dm_mass_bounds *b, dm_node x, const dm_interval *value) {
    for (uint32_t k = 0; k < b->size && value[x].lo < 0.0; k++) {
        const dm_expr *e = dm_graph_at(b->graph, k);
        const int ends = e->op == DM_OP_SQRT || e->op == DM_OP_RSQRT || e->op == DM_OP_RSQRT3 ||
                         e->op == DM_OP_LOG;
        if (ends && e->as.arg[0] == x) return 1;
    }
    return 0;
}

/* Can the node be infinite where its operands are finite, and go on behind that place? */
static int is_unbounded(const dm_mass_bounds *b, dm_node x, const dm_interval *value) {
    const dm_expr *e = dm_graph_at(b->graph, x);
    const dm_interval of = value[e->as.arg[0]], by = value[e->as.arg[1]];
    switch (e->op) {
    case DM_OP_DIV:
        return has_zero(by) && !is_edge(b, base_of(b->graph, e->as.arg[1]), value);
    case DM_OP_POW:
        return has_zero(of) && by.lo < 0.0 && !is_edge(b, base_of(b->graph, e->as.arg[0]), value);
    case DM_OP_RSQRT:
    case DM_OP_RSQRT3:
    case DM_OP_LOG:
        return of.lo == 0.0;
    case DM_OP_TAN:
        return 1;
    default:
        return 0;
    }
}

int dm_mass_may_have_pole(const dm_mass_bounds *b, dm_interval *scratch) {
    dm_interval *in = scratch, *rate_in = in + b->inputs, *value = rate_in + b->inputs;
    dm_interval *rate = value + b->size;
    for (uint32_t i = 0; i < b->inputs; i++) {
        in[i] = (dm_interval)DM_ANYWHERE;
        rate_in[i] = i < b->n ? (dm_interval){-1.0, 1.0} : (dm_interval){0.0, 0.0};
    }
    dm_bounds(b->graph, in, value);
    dm_bounds_rate(b->graph, rate_in, value, rate);
    for (uint32_t k = 0; k < b->size; k++) {
        const dm_expr *e = dm_graph_at(b->graph, k);
        const int moves = dm_op_operands(e->op) > 0 && !(rate[k].lo == 0.0 && rate[k].hi == 0.0);
        if (moves && is_unbounded(b, k, value)) return 1;
    }
    return 0;
}

/* Anywhere, along lines with |dq_i/ds| <= 1; 0: no memory. */
static int bend_anywhere(dm_mass_bounds *b, dm_arena *arena) {
    const size_t boxes = 2 * (size_t)b->inputs + 3 * (size_t)b->size;
    dm_interval *in = dm_arena_take(arena, boxes * sizeof *in);
    double *shift = dm_arena_take(arena, 2 * (size_t)b->n * b->n * sizeof *shift);
    if (!in || !shift) return 0;
    double *bend = shift + (size_t)b->n * b->n;
    dm_interval *rate_in = in + b->inputs;
    for (uint32_t i = 0; i < b->inputs; i++) {
        in[i] = (dm_interval)DM_ANYWHERE;
        rate_in[i] = i < b->n ? (dm_interval){-1.0, 1.0} : (dm_interval){0.0, 0.0};
    }
    dm_mass_bounds_bend(b, in, rate_in, shift, bend, rate_in + b->inputs);
    b->shift = shift, b->bend = bend;
    return 1;
}

/* Is L_v something where v = 0? In a graph of its own: g stays as it is. */
static int is_shifted(dm_graph *g, const dm_node *momentum, uint32_t n, dm_arena *arena) {
    const uint32_t inputs = dm_graph_inputs(g);
    dm_node *with = dm_arena_take(arena, ((size_t)inputs + 2 * (size_t)n) * sizeof *with);
    if (!with) return 1;
    dm_node *alone = with + inputs, *at_rest = alone + n;
    dm_graph *own = dm_graph_copy(g, momentum, n, alone);
    if (!own) return 1;
    for (uint32_t i = 0; i < inputs; i++) with[i] = i >= n && i < 2 * n ? 0 : dm_input(own, i);
    dm_substitute(own, alone, n, with, at_rest);
    int out = 0;
    for (uint32_t i = 0; i < n; i++) out |= at_rest[i] != 0;
    return out;
}

const dm_mass_bounds *dm_mass_bounds_new(dm_graph *g, const dm_node *momentum, const dm_node *mass,
                                         uint32_t n, dm_arena *arena) {
    if (n > MOST) return NULL;
    const uint32_t count = n * n;
    dm_mass_bounds *b = dm_arena_take(arena, sizeof *b);
    dm_node *roots = dm_arena_take(arena, count * sizeof *roots);
    if (!b || !roots) return NULL;
    const int timed = dm_depends(g, mass, count, 2 * n, 1);
    const dm_graph *alone = dm_graph_copy(g, mass, count, roots);
    if (!alone || dm_graph_size(alone) > MOST_NODES) return NULL;
    *b = (dm_mass_bounds){.graph = alone,
                          .roots = roots,
                          .n = n,
                          .inputs = dm_graph_inputs(alone),
                          .size = dm_graph_size(alone),
                          .timed = timed,
                          .shifted = is_shifted(g, momentum, n, arena)};
    return bend_anywhere(b, arena) ? b : NULL;
}
