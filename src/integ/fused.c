#include "integ/fused.h"

#include "expr/analyse.h"
#include "expr/compact.h"
#include "expr/derive.h"

#include <string.h>

int dm_fusion_begin(dm_fusion *b, const dm_model *m, const dm_node *expressions,
                    uint32_t count, uint32_t times, uint32_t inputs) {
    const dm_source *s = &m->source;
    if (!s->graph || !(m->structure & DM_AUTONOMOUS)) return 0;
    const uint32_t x = dm_graph_inputs(s->graph);
    *b = (dm_fusion){.model = m, .count = count};
    b->with = dm_arena_take(s->arena, (x + (size_t)count) * sizeof *b->with);
    b->graph = dm_graph_new(s->arena, inputs);
    if (!b->with || !b->graph) return 0;
    b->force = b->with + x;
    memset(b->with, 0, x * sizeof *b->with);
    dm_compact(s->graph, expressions, count, b->force);
    dm_graph_verbatim(b->graph, 1);
    return dm_graph_status(s->graph) == DM_OK &&
           dm_operations(s->graph, b->force, count) * (size_t)times <= DM_FUSED_LARGEST;
}

void dm_fusion_evaluate(dm_fusion *b, const dm_node *q, dm_node *out) {
    memcpy(b->with, q, b->model->n * sizeof *q);
    dm_transplant(b->graph, b->model->source.graph, b->force, b->count, b->with, out);
}

void dm_fusion_add(dm_fusion *b, dm_node *high, dm_node *low, dm_node x) {
    const dm_node e = dm_add(b->graph, *low, x);
    const dm_node sum = dm_add(b->graph, *high, e);
    const dm_node lost = dm_sub(b->graph, *high, sum);
    *low = dm_add(b->graph, e, lost);
    *high = sum;
}

dm_node dm_fusion_scale(dm_fusion *b, double c, dm_node x) {
    if (c == 1.0) return x;
    const dm_node factor = dm_constant(b->graph, c);
    return dm_mul(b->graph, factor, x);
}

void dm_fusion_velocity(dm_fusion *b, dm_node *v, const dm_node *p, double scale) {
    const dm_model *m = b->model;
    const uint32_t n = m->n;
    if (m->structure & DM_DIAGONAL_MASS) {
        for (uint32_t i = 0; i < n; i++)
            v[i] = dm_fusion_scale(b, scale * m->inverse_mass[i], p[i]);
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        v[i] = 0;
        for (uint32_t j = 0; j < n; j++) {
            const double w = scale * m->inverse_mass[i * (size_t)n + j];
            if (w == 0.0) continue;
            const dm_node shift = dm_constant(b->graph, m->momentum_shift[j]);
            const dm_node moved =
                m->momentum_shift[j] == 0.0 ? p[j] : dm_sub(b->graph, p[j], shift);
            const dm_node term = dm_fusion_scale(b, w, moved);
            v[i] = v[i] ? dm_add(b->graph, v[i], term) : term;
        }
    }
}

void dm_fusion_end(dm_fusion *b, dm_fused *out, const dm_node *roots, uint32_t size,
                   const dm_node *first, uint32_t extra) {
    const dm_source *s = &b->model->source;
    *out = (dm_fused){.size = 0};
    out->now = dm_arena_take(s->arena, 2 * (size_t)size * sizeof *out->now);
    if (!out->now || dm_graph_status(b->graph) != DM_OK) return;
    if (dm_operations(b->graph, roots, size) > DM_FUSED_LARGEST) return;
    if (s->compile(&out->kernel, b->graph, roots, size, s->arena) != DM_OK) return;
    if (extra && s->compile(&out->first, b->graph, first, extra, s->arena) != DM_OK)
        return;
    out->next = out->now + size;
    out->size = size;
    dm_kernel_prepare(&out->kernel, out->now);
    dm_kernel_prepare(&out->kernel, out->next);
}

void dm_fused_run(dm_fused *f, long count) {
    double *now = f->now, *next = f->next;
    for (long k = 0; k < count; k++) {
        dm_kernel_eval(&f->kernel, now, next);
        double *swap = now;
        now = next;
        next = swap;
    }
    f->now = now;
    f->next = next;
}
