/* cell_linear.c - reading linear slopes off a graph, and their loops. */
#include "chain/cell_linear.h"

#include "code/tape/tape.h"

#include <math.h>
#include <string.h>

/* ---- reading ---- */

/* what a node is: a number of the data of a cell, a linear function, or neither */
typedef enum { OTHER, DATA, LINEAR } kind;

/* of a linear function: weight is a node, 0: none */
typedef struct {
    kind kind;
    dm_cell_linear l;
    dm_node weight;
    int rounded; /* scale is no power of two: its product has to stay the last one */
} value;

typedef struct {
    const dm_sum *s;
    const uint8_t *column; /* of the inputs */
    const dm_graph *g;
} reader;

static int is_power_of_two(double x) {
    int exponent;
    return isfinite(x) && fabs(frexp(x, &exponent)) == 0.5;
}

static value read_input(const reader *r, uint32_t input) {
    const dm_column *c = r->s->column + r->column[input];
    value v = {.kind = c->data ? DATA : c->step ? LINEAR : OTHER};
    v.l = (dm_cell_linear){.terms = 1, .scale = 1.0};
    v.l.term[0] = (dm_linear_term){c->index, c->first, c->step, 1.0};
    return v;
}

/* a + sign b: one of them is a single term, which is added to the other; -a - b is -(a + b), and
 * a - b is -(b - a), to the last bit */
static value add(value a, value b, double sign) {
    if (a.kind == DATA && b.kind == DATA) return a;
    if (a.kind != LINEAR || b.kind != LINEAR || a.weight || b.weight || a.rounded || b.rounded)
        return (value){.kind = OTHER};
    if (fabs(a.l.scale) != 1.0 || fabs(b.l.scale) != 1.0) return (value){.kind = OTHER};
    b.l.scale *= sign;
    if (b.l.terms > 1) {
        const value other = a;
        a = b;
        b = other;
    }
    if (b.l.terms > 1 || a.l.terms == DM_LINEAR_TERMS) return (value){.kind = OTHER};
    dm_linear_term *t = a.l.term + a.l.terms++;
    *t = b.l.term[0];
    t->sign = a.l.scale * b.l.scale;
    return a;
}

/* a linear function times a node of data, or a constant */
static value times(const reader *r, value a, dm_node by, int divide) {
    double x;
    if (dm_is_constant(r->g, by, &x)) {
        if (!is_power_of_two(x) && (a.weight || a.rounded || divide)) return (value){.kind = OTHER};
        a.rounded |= !is_power_of_two(x);
        a.l.scale = divide ? a.l.scale / x : a.l.scale * x;
        return a;
    }
    if (a.weight || a.rounded || divide) return (value){.kind = OTHER};
    a.weight = by;
    return a;
}

/* what node n is, given its operands */
static value read_node(const reader *r, dm_node n, const value *known) {
    const dm_expr *e = dm_graph_at(r->g, n);
    value v = {.kind = DATA};
    if (e->op == DM_OP_CONSTANT) return v;
    if (e->op == DM_OP_INPUT) return read_input(r, e->as.input);
    const dm_node *arg = e->as.arg;
    for (int k = 0; k < dm_op_operands(e->op); k++)
        if (known[arg[k]].kind != DATA) v.kind = OTHER;
    if (v.kind == DATA) return v;
    const value a = known[arg[0]], b = known[arg[1]];
    if (e->op == DM_OP_ADD || e->op == DM_OP_SUB) return add(a, b, e->op == DM_OP_ADD ? 1.0 : -1.0);
    if (e->op == DM_OP_NEG && a.kind == LINEAR) {
        v = a;
        v.l.scale = -v.l.scale;
    } else if (e->op == DM_OP_MUL && a.kind == LINEAR && b.kind == DATA) {
        v = times(r, a, arg[1], 0);
    } else if (e->op == DM_OP_MUL && b.kind == LINEAR && a.kind == DATA) {
        v = times(r, b, arg[0], 0);
    } else if (e->op == DM_OP_DIV && a.kind == LINEAR && b.kind == DATA) {
        v = times(r, a, arg[1], 1);
    }
    return v;
}

/* Constants that are powers of two leave a weight for the scale; returns the node that is left. */
static dm_node without_powers(const dm_graph *g, dm_node n, double *scale) {
    for (;;) {
        const dm_expr *e = dm_graph_at(g, n);
        double x;
        if (e->op == DM_OP_NEG) {
            *scale = -*scale;
            n = e->as.arg[0];
        } else if (e->op == DM_OP_MUL && dm_is_constant(g, e->as.arg[0], &x) &&
                   is_power_of_two(x)) {
            *scale *= x;
            n = e->as.arg[1];
        } else if (e->op == DM_OP_MUL && dm_is_constant(g, e->as.arg[1], &x) &&
                   is_power_of_two(x)) {
            *scale *= x;
            n = e->as.arg[0];
        } else {
            return n;
        }
    }
}

/* weights of all cells: the column itself where it is one, else their values are computed once */
static dm_status make_weights(value *v, const reader *r, dm_graph *g, dm_arena *arena) {
    const dm_node node = without_powers(g, v->weight, &v->l.scale);
    const dm_expr *e = dm_graph_at(g, node);
    const dm_column *c = e->op == DM_OP_INPUT ? r->s->column + r->column[e->as.input] : NULL;
    dm_kernel k;
    if (c && !c->index && c->step == 1) {
        v->l.weight = c->data + c->first;
        return DM_OK;
    }
    const uint32_t inputs = dm_graph_inputs(g), cells = r->s->bodies;
    double *weight = dm_arena_take(arena, ((size_t)cells + 1) * sizeof *weight);
    double *in = dm_arena_take(arena, ((size_t)inputs + 1) * sizeof *in);
    const dm_status status = dm_tape_build_exact(&k, g, &node, 1, arena);
    if (!weight || !in || status != DM_OK) return DM_NO_MEMORY;
    memset(in, 0, ((size_t)inputs + 1) * sizeof *in);
    for (uint32_t i = 0; i < cells; i++) {
        for (uint32_t a = 0; a < inputs; a++) {
            const dm_column *from = r->s->column + r->column[a];
            if (from->data) in[a] = from->data[dm_sum_entry(r->s, from, i, 0)];
        }
        dm_kernel_eval(&k, in, weight + i);
    }
    v->l.weight = weight;
    return DM_OK;
}

dm_status dm_cell_linear_read(dm_cell_linear **out, const dm_sum *s, const uint8_t *column,
                              dm_graph *g, const dm_node *roots, uint32_t outputs,
                              dm_arena *arena) {
    const reader r = {s, column, g};
    const uint32_t size = dm_graph_size(g);
    dm_arena *scratch = dm_arena_scratch(arena); /* until weights are made */
    value *known = scratch ? dm_arena_take(scratch, size * sizeof *known) : NULL;
    value *root = dm_arena_take(arena, (outputs + 1) * sizeof *root);
    dm_cell_linear *l = dm_arena_take(arena, (outputs + 1) * sizeof *l);
    dm_status status = DM_OK;
    *out = NULL;
    if (!known || !root || !l) return DM_NO_MEMORY;
    for (dm_node n = 0; n < size; n++) known[n] = read_node(&r, n, known);
    for (uint32_t k = 0; k < outputs; k++) root[k] = known[roots[k]];
    for (uint32_t k = 0; k < outputs; k++)
        if (root[k].kind != LINEAR) return DM_OK;
    for (uint32_t k = 0; k < outputs && status == DM_OK; k++) {
        if (root[k].weight) status = make_weights(root + k, &r, g, arena);
        l[k] = root[k].l;
    }
    if (status == DM_OK) *out = l;
    return status;
}

/* ---- running ---- */

/* what is done with y: it is added to its entries, or stands in out, or does so with its opposite;
 * signs that are not known beforehand */
enum { ADD = 0, PUT = 1, PUT_BOTH = 2, ANY = 0xff };

/* what is the same for all cells of a run */
typedef struct {
    double *out;
    const double *x, *w; /* w: of the first cell, or NULL */
    uint32_t first, count;
    double scale, factor; /* factor: 1 where it is in scale */
} span;

/* any terms, cell by cell */
static void run_any(const dm_cell_linear *l, const span *s, uint32_t how) {
    for (uint32_t i = s->first; i < s->first + s->count; i++) {
        size_t at[DM_LINEAR_TERMS];
        double sum = 0.0;
        for (uint32_t k = 0; k < l->terms; k++) {
            const dm_linear_term *t = l->term + k;
            at[k] = t->first + (size_t)t->step * (t->index ? t->index[i] : i);
            sum = k ? sum + t->sign * s->x[at[k]] : s->x[at[k]];
        }
        if (s->w) sum *= s->w[i - s->first];
        const double y = (sum * s->scale) * s->factor;
        if (how != ADD) s->out[how * (i - s->first)] = y;
        if (how == PUT_BOTH) s->out[2 * (i - s->first) + 1] = -y;
        for (uint32_t k = 0; how == ADD && k < l->terms; k++) s->out[at[k]] += l->term[k].sign * y;
    }
}

/* Terms with a weight that are first + step * index[cell], first and step the same for all.
 * Constants where this is called: terms, minus (bit k: term k is subtracted), step and how. */
__attribute__((always_inline)) static inline void run_terms(const dm_cell_linear *l, const span *s,
                                                            const uint32_t terms,
                                                            const uint32_t minus, const size_t step,
                                                            const uint32_t how) {
    const double *restrict x = s->x + l->term->first, *restrict w = s->w, scale = s->scale;
    double *restrict out = s->out + (how == ADD ? l->term->first : 0), sign[DM_LINEAR_TERMS];
    const uint32_t *index[DM_LINEAR_TERMS];
    size_t at[DM_LINEAR_TERMS];
    for (uint32_t k = 0; k < terms; k++) {
        index[k] = l->term[k].index + s->first;
        sign[k] = minus == ANY ? l->term[k].sign : minus >> k & 1 ? -1.0 : 1.0;
    }
    for (size_t i = 0, end = s->count; i < end; i++) {
        double sum = x[at[0] = step * index[0][i]];
#pragma GCC unroll 4
        for (uint32_t k = 1; k < terms; k++) sum += sign[k] * x[at[k] = step * index[k][i]];
        const double y = (sum * w[i]) * scale;
        if (how != ADD) out[how * i] = y;
        if (how == PUT_BOTH) out[2 * i + 1] = -y;
#pragma GCC unroll 4
        for (uint32_t k = 0; how == ADD && k < terms; k++) out[at[k]] += sign[k] * y;
    }
}

/* are they what run_terms can do? *minus as it has it */
static int is_regular(const dm_cell_linear *l, const span *s, uint32_t *minus) {
    int regular = s->w && s->factor == 1.0;
    *minus = 0;
    for (uint32_t k = 0; k < l->terms; k++) {
        const dm_linear_term *t = l->term + k;
        *minus |= (uint32_t)(t->sign < 0.0) << k;
        regular &= t->index && t->first == l->term->first && t->step == l->term->step;
    }
    return regular;
}

/* differences along edges, circulations of triangles and fluxes out of tetrahedra are what fields
 * have most often */
__attribute__((always_inline)) static inline void run(const dm_cell_linear *l, const span *s,
                                                      const uint32_t how) {
    uint32_t minus;
    const int regular = is_regular(l, s, &minus), dense = regular && l->term->step == 1;
    const uint32_t terms = regular ? l->terms : 0;
    if (dense && terms == 2 && minus == 2)
        run_terms(l, s, 2, 2, 1, how);
    else if (terms == 2)
        run_terms(l, s, 2, ANY, l->term->step, how);
    else if (dense && terms == 3 && minus == 2)
        run_terms(l, s, 3, 2, 1, how);
    else if (dense && terms == 3 && minus == 4)
        run_terms(l, s, 3, 4, 1, how);
    else if (terms == 3)
        run_terms(l, s, 3, ANY, l->term->step, how);
    else if (terms == 4)
        run_terms(l, s, 4, ANY, l->term->step, how);
    else
        run_any(l, s, how);
}

static span span_of(const dm_cell_linear *l, double *out, const double *x, uint32_t first,
                    uint32_t count, double factor) {
    const int exact = is_power_of_two(l->scale) || is_power_of_two(factor);
    return (span){.out = out,
                  .x = x,
                  .w = l->weight ? l->weight + first : NULL,
                  .first = first,
                  .count = count,
                  .scale = exact ? l->scale * factor : l->scale,
                  .factor = exact ? 1.0 : factor};
}

void dm_cell_linear_run(const dm_cell_linear *l, double *out, uint32_t width, const double *x,
                        uint32_t first, uint32_t count, double factor) {
    const span s = span_of(l, out, x, first, count, factor);
    if (width == 2)
        run(l, &s, PUT_BOTH);
    else
        run(l, &s, PUT);
}

void dm_cell_linear_add(const dm_cell_linear *l, double *out, const double *x, uint32_t first,
                        uint32_t count, double factor) {
    const span s = span_of(l, out, x, first, count, factor);
    run(l, &s, ADD);
}
