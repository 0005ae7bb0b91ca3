#include "integ/fused.h"

#include "expr/analyse.h"
#include "expr/compact.h"
#include "expr/derive.h"
#include "expr/jit.h"

#include <string.h>

int dm_fusion_begin(dm_fusion *b, const dm_model *m, const dm_node *expressions,
                    uint32_t size) {
    const dm_source *s = &m->source;
    if (!s->graph) return 0;
    const uint32_t inputs = dm_graph_inputs(s->graph);
    *b = (dm_fusion){.model = m, .size = size, .lanes = 1};
    b->with = dm_arena_take(s->arena, (inputs + (size_t)m->n) * sizeof *b->with);
    b->graph = dm_graph_new(s->arena, size + DM_FUSED_COEFFICIENTS);
    if (!b->with || !b->graph) return 0;
    b->force = b->with + inputs;
    memset(b->with, 0, inputs * sizeof *b->with);
    dm_compact(s->graph, expressions, m->n, b->force);
    dm_graph_verbatim(b->graph, 1);
    return dm_graph_status(s->graph) == DM_OK &&
           dm_operations(s->graph, b->force, m->n) <= DM_FUSED_LARGEST;
}

void dm_fusion_state(dm_fusion *b, dm_node *state) {
    for (uint32_t i = 0; i < b->size; i++) state[i] = dm_input(b->graph, i);
}

dm_node dm_fusion_coefficient(dm_fusion *b, uint32_t i) {
    return dm_input(b->graph, b->size + i);
}

void dm_fusion_evaluate(dm_fusion *b, dm_node *out, const dm_node *q, dm_node t) {
    const uint32_t n = b->model->n;
    memcpy(b->with, q, n * sizeof *q);
    b->with[2 * n] = t;
    dm_transplant(b->graph, b->model->source.graph, b->force, n, b->with, out);
}

void dm_fusion_add(dm_fusion *b, dm_node *high, dm_node *low, dm_node x) {
    const dm_node e = dm_add(b->graph, *low, x);
    const dm_node sum = dm_add(b->graph, *high, e);
    const dm_node lost = dm_sub(b->graph, *high, sum);
    *low = dm_add(b->graph, e, lost);
    *high = sum;
}

/* c * x; a factor of 1 is left out */
static dm_node scale(dm_fusion *b, double c, dm_node x) {
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

/* sum_j row_j moved_j; zeros are left out */
static dm_node combine(dm_fusion *b, const double *row, const dm_node *p,
                       const double *shift) {
    dm_node sum = 0;
    for (uint32_t j = 0; j < b->model->n; j++) {
        if (row[j] == 0.0) continue;
        const dm_node moved = move(b, p[j], shift[j]);
        const dm_node term = scale(b, row[j], moved);
        sum = sum ? dm_add(b->graph, sum, term) : term;
    }
    return sum;
}

void dm_fusion_velocity(dm_fusion *b, dm_node *v, dm_node *moved, const dm_node *p) {
    const dm_model *m = b->model;
    const uint32_t n = m->n;
    const int diagonal = (m->structure & DM_DIAGONAL_MASS) != 0;
    for (uint32_t i = 0; i < n; i++) {
        if (moved) moved[i] = diagonal ? p[i] : move(b, p[i], m->momentum_shift[i]);
        v[i] = diagonal
                   ? scale(b, m->inverse_mass[i], p[i])
                   : combine(b, m->inverse_mass + i * (size_t)n, p, m->momentum_shift);
    }
}

int dm_fusion_end(dm_fusion *b, dm_kernel *out, const dm_node *roots, uint32_t m) {
    const dm_source *s = &b->model->source;
    if (dm_graph_status(b->graph) != DM_OK) return 0;
    if (b->lanes > 1)
        return dm_jit_build_lanes(out, b->graph, roots, m, b->lanes, s->arena) == DM_OK;
    return s->compile(out, b->graph, roots, m, s->arena) == DM_OK;
}

int dm_fused_open(dm_fused *f, const dm_model *m, uint32_t size, uint32_t lanes) {
    const size_t length = (size + (size_t)DM_FUSED_COEFFICIENTS) * lanes;
    f->size = 0;
    f->now = dm_arena_take(m->source.arena, 2 * length * sizeof *f->now);
    if (!f->now) return 0;
    memset(f->now, 0, 2 * length * sizeof *f->now);
    f->next = f->now + length;
    f->size = size;
    f->lanes = lanes;
    return 1;
}
