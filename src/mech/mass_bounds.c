#include "mech/mass_bounds.h"

#include "algebra/compact.h"
#include "algebra/derive.h"
#include "graph/analyse.h"

#include <math.h>
#include <string.h>

enum { MOST_NODES = 2000, MOST = 12 }; /* nodes of M, and dim Q, that looks are worth */

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

/* ---- sums of squares ---- */

/* What is read off L in a graph of its own: degrees in v, MOST_DEGREE and more as one, and bounds
 * of all nodes for any state. */
enum { MOST_DEGREE = 3 };

typedef struct {
    const dm_graph *g;
    uint32_t n;
    unsigned char *degree;
    dm_interval *value;
} reading;

static unsigned char lesser(int degree) {
    return (unsigned char)(degree < MOST_DEGREE ? degree : MOST_DEGREE);
}

/* Of a power: k degrees where k is 1 or 2. */
static int of_power(const reading *r, const dm_expr *e) {
    const dm_expr *k = dm_graph_at(r->g, e->as.arg[1]);
    const int degree = r->degree[e->as.arg[0]];
    const int low = k->op == DM_OP_CONSTANT && (k->as.value == 1.0 || k->as.value == 2.0);
    return degree ? low ? degree * (int)k->as.value : MOST_DEGREE : r->degree[e->as.arg[1]];
}

static int degree_of(const reading *r, const dm_expr *e) {
    int all[3] = {0, 0, 0}, most = 0;
    for (int i = 0; i < dm_op_operands(e->op); i++) {
        all[i] = r->degree[e->as.arg[i]];
        most = all[i] > most ? all[i] : most;
    }
    switch (e->op) {
    case DM_OP_INPUT:
        return r->n <= e->as.input && e->as.input < 2 * r->n;
    case DM_OP_NEG:
    case DM_OP_ADD:
    case DM_OP_SUB:
        return most;
    case DM_OP_MUL:
        return all[0] + all[1];
    case DM_OP_DIV:
        return all[1] ? MOST_DEGREE : all[0];
    case DM_OP_POW:
        return of_power(r, e);
    default:
        return most ? MOST_DEGREE : 0;
    }
}

/* 1 or -1 where a node is not negative, or not positive, whatever the state; 0: not known */
static int sign_of(const reading *r, dm_node at) {
    return r->value[at].lo >= 0.0 ? 1 : r->value[at].hi <= 0.0 ? -1 : 0;
}

/* What is left of a node without factors that do not depend on v, whose signs go into *sign. */
static dm_node strip(const reading *r, dm_node at, int *sign) {
    for (;;) {
        const dm_expr *e = dm_graph_at(r->g, at);
        const dm_node a = e->as.arg[0], b = e->as.arg[1];
        const int product = e->op == DM_OP_MUL, free = product || e->op == DM_OP_DIV;
        if (e->op == DM_OP_NEG)
            *sign = -*sign, at = a;
        else if (free && r->degree[a] && !r->degree[b])
            *sign *= sign_of(r, b), at = a;
        else if (product && r->degree[b] && !r->degree[a])
            *sign *= sign_of(r, a), at = b;
        else
            return at;
    }
}

/* Is sign times it, as a function of v, convex for any state: a sum of squares of what is linear in
 * v, each times something that is not negative, and of what is linear? */
static int is_convex(const reading *r, dm_node at, int sign) {
    if (r->degree[at] <= 1) return 1;
    at = strip(r, at, &sign);
    const dm_expr *e = dm_graph_at(r->g, at);
    const dm_node a = e->as.arg[0], b = e->as.arg[1];
    switch (e->op) {
    case DM_OP_ADD:
        return sign && is_convex(r, a, sign) && is_convex(r, b, sign);
    case DM_OP_SUB:
        return sign && is_convex(r, a, sign) && is_convex(r, b, -sign);
    case DM_OP_POW:
        return sign > 0 && r->degree[a] == 1 && r->degree[at] == 2;
    case DM_OP_MUL: {
        const dm_node one = a == b ? a : strip(r, a, &sign),
                      other = a == b ? b : strip(r, b, &sign);
        return sign > 0 && one == other && r->degree[one] == 1;
    }
    default:
        return 0;
    }
}

int dm_mass_is_convex(dm_graph *g, dm_node L, uint32_t n, dm_arena *arena) {
    dm_node alone;
    reading r = {.g = dm_graph_copy(g, &L, 1, &alone), .n = n};
    const uint32_t size = r.g ? dm_graph_size(r.g) : 0, inputs = dm_graph_inputs(g);
    r.degree = dm_arena_take(arena, size + 1);
    r.value = dm_arena_take(arena, ((size_t)size + inputs) * sizeof *r.value);
    if (!r.g || !r.degree || !r.value || size > MOST_NODES) return 0;
    dm_interval *in = r.value + size;
    for (uint32_t i = 0; i < inputs; i++) in[i] = (dm_interval)DM_ANYWHERE;
    dm_bounds(r.g, in, r.value);
    for (dm_node i = 0; i < size; i++) r.degree[i] = lesser(degree_of(&r, dm_graph_at(r.g, i)));
    return is_convex(&r, alone, 1);
}

/* ---- the mass ---- */

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
