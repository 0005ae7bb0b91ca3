/* fused.c - force, kick, drift and their compensated sums of a stage as one graph from state to
 * state.
 * Speed: P1-0.6: 1.1x by blanes-moan(6, 11) as loops; members could not be stepped in lanes
 * without. */
#include "integ/split/fused.h"

#include "algebra/compact.h"
#include "algebra/contract.h"
#include "algebra/derive.h"
#include "code/native/jit.h"
#include "graph/analyse.h"

#include <string.h>

/* ---- what is added to momenta ---- */

/* What node n does. */
static dm_op op_of(const dm_graph *g, dm_node n) {
    return dm_graph_at(g, n)->op;
}

/* operand k of x is a coordinate: its number, else -1 */
static int32_t coordinate_of(const dm_graph *g, uint32_t n, dm_node factor) {
    const dm_expr *a = dm_graph_at(g, factor);
    return a->op == DM_OP_INPUT && a->as.input < n ? (int32_t)a->as.input : -1;
}

/* f without a constant that is added to it, which goes to *c; *sign = -1 where f has the rest
 * with a minus */
static dm_node without_constant(const dm_graph *g, dm_node f, double *c, double *sign) {
    const dm_expr *x = dm_graph_at(g, f);
    const double second = x->op == DM_OP_SUB ? -1.0 : 1.0;
    double value;
    *c = 0.0, *sign = 1.0;
    if (x->op != DM_OP_ADD && x->op != DM_OP_SUB) return f;
    if (dm_is_constant(g, x->as.arg[1], &value)) return *c = second * value, x->as.arg[0];
    if (dm_is_constant(g, x->as.arg[0], &value)) return *c = value, *sign = second, x->as.arg[1];
    return f;
}

/* f without a number that it is multiplied by */
static dm_node without_number(const dm_graph *g, dm_node f, double *times) {
    const dm_expr *x = dm_graph_at(g, f);
    *times = 1.0;
    for (int k = 0; x->op == DM_OP_MUL && k < 2; k++)
        if (dm_is_constant(g, x->as.arg[k], times)) return x->as.arg[1 - k];
    return f;
}

/* expression i as factor and coordinate, and perhaps a constant */
static void take_apart(dm_kicks *k, uint32_t n, dm_node f, uint32_t i) {
    dm_graph *g = k->graph;
    double sign, times;
    const dm_node whole = f,
                  rest = without_constant(g, without_number(g, f, &times), k->constant + i, &sign);
    const int minus = op_of(g, rest) == DM_OP_NEG;
    const uint8_t negative = minus != (sign < 0.0);
    const dm_expr *x = dm_graph_at(g, minus ? dm_graph_at(g, rest)->as.arg[0] : rest);
    k->coordinate[i] = -1;
    for (int a = 0; x->op == DM_OP_MUL && a < 2 && k->coordinate[i] < 0; a++) {
        k->coordinate[i] = coordinate_of(g, n, x->as.arg[a]);
        if (k->coordinate[i] < 0) continue;
        f = x->as.arg[1 - a];
    }
    const uint8_t turned = negative && k->coordinate[i] >= 0;
    uint32_t same = 0;
    if (k->coordinate[i] < 0) f = whole, k->constant[i] = 0.0;
    if (k->coordinate[i] >= 0 && times != 1.0) {
        f = dm_mul(g, dm_constant(g, times), f);
        k->constant[i] *= times;
    }
    while (same < k->count && (k->factor[same] != f || k->negative[same] != turned)) same++;
    k->which[i] = same;
    k->factor[same] = f;
    k->negative[same] = turned;
    if (same == k->count) k->count++;
}

/* a factor without a coordinate would be scaled for one and not for the other */
static int is_mixed(const dm_kicks *k, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < i; j++)
            if (k->which[i] == k->which[j] && (k->coordinate[i] < 0) != (k->coordinate[j] < 0))
                return 1;
    return 0;
}

/* Each expression is its own factor, and nothing is scaled. */
static void take_whole(dm_kicks *k, const dm_node *f, uint32_t n) {
    k->count = n;
    for (uint32_t i = 0; i < n; i++) {
        k->factor[i] = f[i];
        k->negative[i] = 0;
        k->which[i] = i;
        k->coordinate[i] = -1;
        k->constant[i] = 0.0;
    }
}

enum { MOST_SCALED = 64 }; /* coordinates that are compared with each other */

/* Factors are looked for where they are to be scaled and there are few coordinates; where that
 * finds none for all, the expressions themselves serve. */
int dm_kicks_read(dm_kicks *k, const dm_model *m, const dm_node *expressions, int scaled) {
    const dm_source *s = &m->source;
    const uint32_t n = m->n;
    if (!s->graph) return 0;
    dm_node *f = dm_arena_take(s->arena, n * sizeof *f);
    *k = (dm_kicks){.factor = dm_arena_take(s->arena, n * sizeof *k->factor),
                    .negative = dm_arena_take(s->arena, n),
                    .which = dm_arena_take(s->arena, n * sizeof *k->which),
                    .coordinate = dm_arena_take(s->arena, n * sizeof *k->coordinate),
                    .constant = dm_arena_take(s->arena, n * sizeof *k->constant)};
    if (!f || !k->constant || !k->factor || !k->negative || !k->which || !k->coordinate) return 0;
    k->graph = dm_compact_graph(s->graph, expressions, n, f); /* as the force has it */
    if (!k->graph || dm_operations(k->graph, f, n) > DM_FUSED_LARGEST) return 0;
    for (uint32_t i = 0; scaled && n <= MOST_SCALED && i < n; i++) take_apart(k, n, f[i], i);
    if (!k->count || is_mixed(k, n)) take_whole(k, f, n);
    return 1;
}

/* In their own graph: the force kernel of the model stays as it was. */
int dm_kicks_contract(dm_kicks *k) {
    k->graph = dm_contract_graph(k->graph, k->factor, k->count, k->factor);
    return k->graph != NULL;
}

/* ---- building a part ---- */

enum { MOST_COEFFICIENTS = 8 };

/* The carried values are the first inputs, coefficients follow; `with` is empty until something
 * asks for q, v or t. */
int dm_fusion_begin(dm_fusion *b, const dm_model *m, const dm_kicks *k, uint32_t size) {
    const dm_source *s = &m->source;
    const uint32_t inputs = dm_graph_inputs(s->graph), n = m->n;
    *b = (dm_fusion){.model = m, .kicks = k, .size = size};
    b->graph = dm_graph_new(s->arena, size + MOST_COEFFICIENTS + m->params);
    b->state = dm_arena_take(s->arena, (size + (size_t)inputs) * sizeof *b->state);
    b->late = dm_arena_take(s->arena, 2 * (size_t)n * sizeof *b->late);
    if (!b->graph || !b->state || !b->late) return 0;
    b->q = b->state;
    b->p = b->q + n;
    b->low_q = b->p + n;
    b->low_p = b->low_q + n;
    b->more = b->low_p + n;
    b->with = b->state + size;
    memset(b->with, 0, inputs * sizeof *b->with);
    for (uint32_t i = 0; i < size; i++) b->state[i] = dm_input(b->graph, i);
    dm_graph_verbatim(b->graph, 1);
    return 1;
}

/* Coefficients are read in the order in which they are asked for. */
dm_node dm_fusion_coefficient(dm_fusion *b) {
    return dm_input(b->graph, b->size + b->coefficients++);
}

/* Behind t in the inputs of L. */
void dm_fusion_params(dm_fusion *b) {
    const uint32_t first = 2 * b->model->n + 1;
    for (uint32_t j = 0; j < b->model->params; j++) b->with[first + j] = dm_fusion_coefficient(b);
}

enum { AFTER_DRIFT = 16 }; /* cycles */

/* About the cycles from the inputs to every node. Coordinates come after a drift, also where a part
 * begins with them, so that all parts scale a factor in one way: bits do not depend on where bursts
 * begin. */
static uint16_t *measure_depth(const dm_fusion *b) {
    static const uint8_t cycles[DM_OP_COUNT] =
        {[DM_OP_NEG] = 1,  [DM_OP_ABS] = 1,   [DM_OP_ADD] = 3,  [DM_OP_SUB] = 3,
         [DM_OP_MUL] = 4,  [DM_OP_FMA] = 4,   [DM_OP_FMS] = 4,  [DM_OP_FNMA] = 4,
         [DM_OP_DIV] = 14, [DM_OP_SQRT] = 14, [DM_OP_WHERE] = 3};
    const uint32_t size = dm_graph_size(b->graph);
    uint16_t *depth = dm_arena_take(b->model->source.arena, size * sizeof *depth);
    if (!depth) return NULL;
    memset(depth, 0, size * sizeof *depth);
    for (uint32_t i = 0; i < b->model->n; i++) depth[b->q[i]] = AFTER_DRIFT;
    for (dm_node i = 0; i < size; i++) {
        const dm_expr *x = dm_graph_at(b->graph, i);
        if (depth[i]) continue; /* a coordinate */
        uint32_t most = 0;
        const int count = dm_op_operands(x->op);
        for (int k = 0; k < count; k++)
            if (depth[x->as.arg[k]] > most) most = depth[x->as.arg[k]];
        if (count) most += cycles[x->op] ? cycles[x->op] : 24;
        depth[i] = (uint16_t)(most < UINT16_MAX ? most : UINT16_MAX);
    }
    return depth;
}

static uint8_t *mark_coordinates(const dm_fusion *b) {
    const uint32_t size = dm_graph_size(b->graph);
    uint8_t *out = dm_arena_take(b->model->source.arena, size);
    if (!out) return NULL;
    memset(out, 0, size);
    for (uint32_t i = 0; i < b->model->n; i++) out[b->q[i]] = 1;
    return out;
}

/* h b and -h b; what no factor goes into: a coordinate is the sum of a drift in some parts only */
typedef struct {
    dm_node plus, minus;
    const uint16_t *depth;
    const uint8_t *whole;
} scaling;

static dm_node scale(dm_fusion *b, const scaling *x, dm_node f);

enum { EARLIER = 8 }; /* cycles that a product off the chain takes */

/* x (p + q) or x (p - q): one of the two is there long before the other, of which it is a single
 * operation then */
static dm_node scale_sum(dm_fusion *b, const scaling *x, const dm_expr *e) {
    const scaling turned = {x->minus, x->plus, x->depth, x->whole};
    const dm_node p = scale(b, x, e->as.arg[0]);
    const dm_node q = scale(b, e->op == DM_OP_SUB ? &turned : x, e->as.arg[1]);
    const int first = x->depth[e->as.arg[0]] > x->depth[e->as.arg[1]];
    const dm_expr late = *dm_graph_at(b->graph, first ? p : q);
    return late.op == DM_OP_MUL
               ? dm_multiply_add(b->graph, late.as.arg[0], late.as.arg[1], first ? q : p)
               : dm_add(b->graph, p, q);
}

/* x times f: into the factor or the numerator that is known first */
static dm_node scale(dm_fusion *b, const scaling *x, dm_node f) {
    const dm_expr e = *dm_graph_at(b->graph, f);
    double value;
    if (dm_is_constant(b->graph, f, &value) && value == 1.0) return x->plus;
    if (x->whole[f]) return dm_mul(b->graph, x->plus, f);
    if (e.op == DM_OP_ADD || e.op == DM_OP_SUB) {
        const int apart = x->depth[e.as.arg[0]] - x->depth[e.as.arg[1]];
        if (apart >= EARLIER || apart <= -EARLIER) return scale_sum(b, x, &e);
    }
    if (e.op != DM_OP_MUL && e.op != DM_OP_DIV) return dm_mul(b->graph, x->plus, f);
    const int first = e.op == DM_OP_DIV || x->depth[e.as.arg[0]] <= x->depth[e.as.arg[1]];
    const dm_node scaled = scale(b, x, e.as.arg[!first]);
    return e.op == DM_OP_DIV ? dm_div(b->graph, scaled, e.as.arg[1])
                             : dm_mul(b->graph, scaled, e.as.arg[first]);
}

/* Those of coordinates are scaled once, whichever expression meets them first. */
void dm_fusion_factors(dm_fusion *b, dm_node *factors, dm_node t, dm_node hb, dm_node minus) {
    const dm_kicks *k = b->kicks;
    const uint32_t n = b->model->n;
    memcpy(b->with, b->q, n * sizeof *b->q);
    b->with[2 * n] = t;
    dm_transplant(b->graph, k->graph, k->factor, k->count, b->with, factors);
    const uint16_t *depth = measure_depth(b);
    const uint8_t *whole = mark_coordinates(b);
    b->failed |= !depth || !whole;
    for (uint32_t i = 0; depth && whole && i < n; i++) {
        const uint32_t j = k->which[i];
        int first = k->coordinate[i] >= 0;
        for (uint32_t before = 0; before < i && first; before++) first = k->which[before] != j;
        const scaling plain = {hb, minus, depth, whole}, turned = {minus, hb, depth, whole};
        if (first) factors[j] = scale(b, k->negative[j] ? &turned : &plain, factors[j]);
    }
}

/* No node where there is no constant. */
dm_node dm_fusion_constant(dm_fusion *b, uint32_t i, dm_node hb, dm_node to) {
    const double c = b->kicks->constant[i];
    if (c == 0.0) return to;
    return dm_multiply_add(b->graph, hb, dm_constant(b->graph, c), to);
}

/* The coordinate times its factor, which h b is in already; or h b times the expression. */
dm_product dm_fusion_kick(dm_fusion *b, const dm_node *factors, uint32_t i, dm_node hb) {
    const int32_t coordinate = b->kicks->coordinate[i];
    const dm_node f = factors[b->kicks->which[i]];
    return coordinate < 0 ? (dm_product){hb, f} : (dm_product){f, b->q[coordinate]};
}

/* *high = sum, made of high, x and perhaps low. Nobody waits for its low part: it is made later, in
 * the time that a force takes. */
void dm_fusion_leave(dm_fusion *b, dm_node *high, dm_node *low, dm_node sum, dm_product x) {
    if (!b->plain)
        b->late[b->late_count++] = (dm_remainder){.high = *high, .sum = sum, .low = low, .x = x};
    *high = sum;
}

/* The sum is rounded from low + high and the product at once: it waits for one operation after the
 * last of x is known. */
void dm_fusion_add_product(dm_fusion *b, dm_node *high, dm_node *low, dm_product x) {
    const dm_node before = b->plain ? *high : dm_add(b->graph, *high, *low);
    dm_fusion_leave(b, high, low, dm_multiply_add(b->graph, x.a, x.b, before), x);
}

/* y has the old low part in it; what the rounding of the sum lost is the new one. */
void dm_fusion_sum(dm_fusion *b, dm_node *high, dm_node *low, dm_node y) {
    const dm_node sum = dm_add(b->graph, *high, y);
    *low = dm_add(b->graph, y, dm_sub(b->graph, *high, sum));
    *high = sum;
}

/* As for numbers: y = low + x first. */
void dm_fusion_add(dm_fusion *b, dm_node *high, dm_node *low, dm_node x) {
    dm_fusion_sum(b, high, low, dm_add(b->graph, *low, x));
}

/* c * x; a factor of 1 is left out */
static dm_node times(dm_fusion *b, double c, dm_node x) {
    if (c == 1.0) return x;
    const dm_node factor = dm_constant(b->graph, c);
    return dm_mul(b->graph, factor, x);
}

/* p - shift */
static dm_node move(dm_fusion *b, dm_node p, double shift) {
    if (shift == 0.0) return p;
    const dm_node constant = dm_constant(b->graph, shift);
    return dm_sub(b->graph, p, constant);
}

/* sum_j row_j moved_j; zeros are left out; shift NULL: none */
static dm_node combine(dm_fusion *b, const double *row, const dm_node *p, const double *shift) {
    dm_node sum = 0;
    for (uint32_t j = 0; j < b->model->n; j++) {
        if (row[j] == 0.0) continue;
        const dm_node moved = shift ? move(b, p[j], shift[j]) : p[j];
        const dm_node term = times(b, row[j], moved);
        sum = sum ? dm_add(b->graph, sum, term) : term;
    }
    return sum;
}

/* With a diagonal mass there is no shift. */
void dm_fusion_velocity(dm_fusion *b, dm_node *v, dm_node *moved, const dm_node *p) {
    const dm_model *m = b->model;
    const uint32_t n = m->n;
    const int diagonal = (m->structure & DM_DIAGONAL_MASS) != 0;
    for (uint32_t i = 0; i < n; i++) {
        if (moved) moved[i] = diagonal ? p[i] : move(b, p[i], m->momentum_shift[i]);
        v[i] = diagonal ? times(b, m->inverse_mass[i], p[i])
                        : combine(b, m->inverse_mass + i * (size_t)n, p, m->momentum_shift);
    }
}

/* what coordinate i drifts by: a v, or where p are low parts, which have no shift, a rest */
static dm_product drift_of(dm_fusion *b, uint32_t i, dm_node ha, const dm_node *p,
                           const double *shift) {
    const dm_model *m = b->model;
    const int diagonal = (m->structure & DM_DIAGONAL_MASS) != 0;
    const double *row = m->inverse_mass + (diagonal ? i : i * (size_t)m->n);
    if (diagonal) return (dm_product){times(b, *row, ha), p[i]};
    return (dm_product){ha, combine(b, row, p, shift)};
}

/* The low part is in what is rounded, so that roundings have no mean: a v alone lies at few places
 * between two doubles where h is a ratio of small numbers. */
void dm_fusion_drift(dm_fusion *b, dm_node ha) {
    for (uint32_t i = 0; i < b->model->n; i++) {
        const dm_product x = drift_of(b, i, ha, b->p, b->model->momentum_shift);
        dm_node *q = b->q + i, *low = b->low_q + i;
        const dm_node y = dm_multiply_add(b->graph, x.a, x.b, b->plain ? *q : *low);
        dm_fusion_leave(b, q, low, b->plain ? y : dm_add(b->graph, *q, y), x);
    }
    b->drifted = b->plain ? 0 : ha;
}

/* low += x + (high - sum), of which the bracket is exact and the product not rounded where the
 * processor rounds a b + c once; those of p first, which a drift did not see. */
void dm_fusion_settle(dm_fusion *b) {
    for (uint32_t k = 0; k < b->late_count; k++) {
        const dm_remainder *r = b->late + k;
        const dm_node lost = dm_sub(b->graph, r->high, r->sum);
        *r->low = dm_add(b->graph, *r->low, dm_multiply_add(b->graph, r->x.a, r->x.b, lost));
    }
    for (uint32_t i = 0; b->drifted && i < b->model->n; i++) {
        const dm_product x = drift_of(b, i, b->drifted, b->low_p, NULL);
        b->low_q[i] = dm_multiply_add(b->graph, x.a, x.b, b->low_q[i]);
    }
    b->late_count = 0;
    b->drifted = 0;
}

/* What is carried out of a part is the state as it is by now. */
int dm_fusion_end(dm_fusion *b, dm_loop_part *out) {
    dm_fusion_settle(b);
    *out = (dm_loop_part){b->graph, b->state, b->coefficients, b->model->params > 0};
    return !b->failed && dm_graph_status(b->graph) == DM_OK;
}

/* Vectors are native or not at all; one member may go by kernels of the model's backend. */
int dm_fused_build(dm_loop *out, const dm_model *m, const dm_loop_part *part, uint32_t size,
                   uint32_t lanes) {
    const dm_source *s = &m->source;
    const int native = lanes > 1 || s->compile == dm_native_build;
    const dm_status status =
        native ? dm_loop_native(out, part, size, lanes, s->arena) : DM_NO_NATIVE;
    if (lanes > 1 || status != DM_NO_NATIVE) return status == DM_OK;
    return dm_loop_by_kernels(out, part, size, s->compile, s->arena) == DM_OK;
}
