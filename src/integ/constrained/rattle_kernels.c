/* rattle_kernels.c - the graphs of a constrained step. */
#include "algebra/compact.h"
#include "algebra/contract.h"
#include "algebra/derive.h"
#include "integ/constrained/rattle_inside.h"
#include "integ/method/cache.h"
#include "mech/constraints.h"

#include <string.h>

/* What a step begins with comes first, in the order in which `end` writes it: so that the end of
 * one step is the beginning of the next without a copy. */
dm_rattle_layout dm_rattle_lay_out(const dm_model *m) {
    const uint32_t n = m->n, k = m->constraints ? m->constraints->holonomic : 0;
    dm_rattle_layout at = {.n = n, .m = k};
    at.drags = m->constraints && m->constraints->structure & DM_CONSTRAINTS_FORCE_SEES_V;
    for (size_t i = 0; i < (size_t)k * n; i++) at.nonzeros += m->constraints->touches[i];
    at.p = n;
    at.low_q = 2 * n;
    at.low_p = 3 * n;
    at.force = 4 * n;
    at.G = 5 * n;
    at.guess = at.G + at.nonzeros;
    at.g = at.guess + k;
    at.h = at.g + k;
    at.half = at.h + 1;
    at.t0 = at.h + 2;
    at.t = at.h + 3;
    at.unit = at.h + 4;
    at.y = at.unit + k;
    at.lambda = at.y + n;
    at.norms = at.lambda + k;
    at.size = at.norms + DM_RATTLE_NORMS;
    return at;
}

typedef dm_rattle_frame frame;

/* One node more than asked for, since a count may be 0. */
dm_node *dm_rattle_take(frame *b, size_t count) {
    dm_node *nodes = dm_arena_take(b->arena, (count + 1) * sizeof *nodes);
    if (nodes)
        memset(nodes, 0, (count + 1) * sizeof *nodes);
    else
        b->no_memory = 1;
    return nodes;
}

/* Node 0 is zero: it adds nothing. */
static dm_node add(const frame *b, dm_node x, dm_node y) {
    if (!x || !y) return x ? x : y;
    return dm_add(b->f.graph, x, y);
}

/* ---- the expressions of the model ---- */

/* Compressed rows of G from the constraints that touch each coordinate. */
static int read_pattern(frame *b) {
    const uint32_t n = b->at.n, m = b->at.m;
    uint32_t next = 0;
    b->row = dm_arena_take(b->arena, (m + (size_t)1) * sizeof *b->row);
    b->column = dm_arena_take(b->arena, (b->at.nonzeros + (size_t)1) * sizeof *b->column);
    if (!b->row || !b->column) return 0;
    for (uint32_t i = 0; i < m; i++) {
        b->row[i] = next;
        for (uint32_t c = 0; c < n; c++)
            if (b->model->constraints->touches[i * (size_t)n + c]) b->column[next++] = c;
    }
    b->row[m] = next;
    return 1;
}

/* F, G, g and g_t in one graph with the inputs q, v, t. The constraints may have been traced in a
 * graph of their own; nonzeros of G follow the pattern. A force that sees v stays apart, with its
 * derivatives. */
static int read_model(frame *b) {
    const dm_model *model = b->model;
    const dm_constraints *constraints = model->constraints;
    const uint32_t n = b->at.n, m = b->at.m, inputs = 2 * n + 1;
    const uint32_t most =
        inputs + (constraints ? constraints->holonomic + constraints->rolling : 0);
    dm_node *with = dm_rattle_take(b, most), *f = dm_rattle_take(b, n);
    b->source = dm_graph_new(b->arena, inputs);
    b->with = dm_rattle_take(b, most), b->force = dm_rattle_take(b, n),
    b->G = dm_rattle_take(b, b->at.nonzeros);
    b->g = dm_rattle_take(b, m), b->g_t = dm_rattle_take(b, m);
    if (!with || !f || !b->source || !b->with || !b->force || !b->G || !b->g || !b->g_t) return 0;
    for (uint32_t i = 0; i < inputs; i++) with[i] = dm_input(b->source, i);
    dm_transplant(b->source, model->source.graph, model->source.gradient, n, with, b->force);
    if (!constraints) return 1;
    if (constraints->f) dm_transplant(b->source, constraints->graph, constraints->f, n, with, f);
    if (b->at.drags) {
        b->drag = f;
        b->drag_v = dm_rattle_take(b, (size_t)n * n);
        if (!b->drag_v) return 0;
        dm_jacobian(b->source, f, n, n, n, b->drag_v);
    }
    for (uint32_t i = 0; i < n && !b->at.drags; i++)
        b->force[i] = dm_add(b->source, b->force[i], f[i]);
    if (!m) return 1;
    dm_transplant(b->source, constraints->graph, constraints->g, m, with, b->g);
    dm_transplant(b->source, constraints->graph, constraints->g_t, m, with, b->g_t);
    for (uint32_t i = 0, e = 0; i < m; i++)
        for (; e < b->row[i + 1]; e++)
            dm_transplant(b->source, constraints->graph,
                          constraints->G + i * (size_t)n + b->column[e], 1, with, b->G + e);
    return dm_graph_status(b->source) == DM_OK;
}

/* Compacted by themselves: the graph around them must not change their order of operations. */
void dm_rattle_evaluate(frame *b, dm_node *out, const dm_node *roots, size_t count,
                        const dm_rattle_point *at) {
    const uint32_t n = b->at.n;
    dm_node *compact = dm_rattle_take(b, count);
    if (!compact || !count) return;
    dm_compact(b->source, roots, (uint32_t)count, compact);
    dm_graph *small = dm_contract_graph(b->source, compact, (uint32_t)count, compact);
    if (!small) {
        b->no_memory = 1;
        return;
    }
    memset(b->with, 0, (2 * n + (size_t)1) * sizeof *b->with);
    memcpy(b->with, at->q, n * sizeof *b->with);
    if (at->v) memcpy(b->with + n, at->v, n * sizeof *b->with);
    b->with[2 * n] = at->t;
    dm_transplant(b->f.graph, small, compact, (uint32_t)count, b->with, out);
}

/* ---- linear algebra in the graph ---- */

/* B[n*m] = W G^T, by rows of W, times h where that is a node */
void dm_rattle_spread(const frame *b, dm_node *B, const dm_node *G, dm_node h) {
    const uint32_t n = b->at.n, m = b->at.m;
    const int diagonal = (b->model->structure & DM_DIAGONAL_MASS) != 0;
    const double *W = b->model->inverse_mass;
    memset(B, 0, (size_t)n * m * sizeof *B);
    for (uint32_t j = 0; j < m; j++)
        for (uint32_t e = b->row[j]; e < b->row[j + 1]; e++)
            for (uint32_t c = diagonal ? b->column[e] : 0; c < (diagonal ? b->column[e] + 1 : n);
                 c++) {
                const double w = diagonal ? W[c] : W[c * (size_t)n + b->column[e]];
                const dm_node weight = dm_constant(b->f.graph, w);
                const dm_node term = w == 1.0 ? G[e] : dm_mul(b->f.graph, weight, G[e]);
                dm_node *entry = B + c * (size_t)m + j;
                if (w != 0.0) *entry = add(b, *entry, term);
            }
    for (size_t i = 0; h && i < (size_t)n * m; i++)
        if (B[i]) B[i] = dm_mul(b->f.graph, h, B[i]);
}

/* A[m*m] = G B; symmetric: only its upper half */
void dm_rattle_multiply(const frame *b, dm_node *A, const dm_node *G, const dm_node *B,
                        int symmetric) {
    const uint32_t m = b->at.m;
    for (uint32_t i = 0; i < m; i++)
        for (uint32_t j = symmetric ? i : 0; j < m; j++) {
            dm_node sum = 0;
            for (uint32_t e = b->row[i]; e < b->row[i + 1]; e++)
                sum = dm_rattle_add_product(b, sum, G[e], B[b->column[e] * (size_t)m + j]);
            A[i * (size_t)m + j] = sum;
        }
}

/* ---- kernels ---- */

/* Inputs of every kernel are the numbers of a buffer, by their places. */
int dm_rattle_begin(frame *b) {
    const dm_rattle_layout *at = &b->at;
    dm_graph *g = dm_graph_new(b->arena, at->size);
    b->f = (dm_fusion){.graph = g, .model = b->model, .size = at->size};
    b->q = dm_rattle_take(b, 4 * (size_t)at->n);
    if (!g || !b->q) return 0;
    for (uint32_t i = 0; i < 4 * at->n; i++) b->q[i] = dm_input(g, i);
    b->p = b->q + at->n, b->lq = b->p + at->n, b->lp = b->lq + at->n;
    b->h = dm_input(g, at->h);
    b->half = dm_input(g, at->half);
    b->t0 = dm_input(g, at->t0);
    b->t = dm_input(g, at->t);
    dm_graph_verbatim(g, 1);
    return 1;
}

/* As many as stand there one after the other. */
void dm_rattle_inputs(const frame *b, dm_node *out, uint32_t first, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) out[i] = dm_input(b->f.graph, first + i);
}

/* Node by node as it stands: the order of sums is that of the formulas here. */
dm_status dm_rattle_end(frame *b, dm_kernel *out, const dm_node *roots, size_t count) {
    const dm_status status = dm_graph_status(b->f.graph);
    if (b->no_memory || dm_graph_status(b->source) != DM_OK) return DM_NO_MEMORY;
    if (status != DM_OK) return status;
    return b->model->source.compile(out, b->f.graph, roots, (uint32_t)count, b->arena);
}

/* In the order in which kernels write what they keep: F, G; then g_t and g. */
static dm_node *all_roots(frame *b) {
    const size_t n = b->at.n, m = b->at.m, z = b->at.nonzeros;
    dm_node *roots = dm_rattle_take(b, n + z + 2 * m);
    if (!roots) return NULL;
    memcpy(roots, b->force, n * sizeof *roots);
    memcpy(roots + n, b->G, z * sizeof *roots);
    memcpy(roots + n + z, b->g_t, m * sizeof *roots);
    memcpy(roots + n + z + m, b->g, m * sizeof *roots);
    return roots;
}

/* F and G where a run starts; g and g_t only share their operations. */
static dm_status make_begin(frame *b, dm_kernel *out) {
    const size_t count = b->at.n + (size_t)b->at.nonzeros + 2 * (size_t)b->at.m;
    if (!dm_rattle_begin(b)) return DM_NO_MEMORY;
    const dm_node *roots = all_roots(b);
    dm_node *values = dm_rattle_take(b, count);
    if (!roots || !values) return DM_NO_MEMORY;
    dm_rattle_evaluate(b, values, roots, count, &(dm_rattle_point){b->q, NULL, b->t});
    return dm_rattle_end(b, out, values, b->at.n + (size_t)b->at.nonzeros);
}

/* p += G^T lambda + half F, summed with compensation; half 0: without F */
static void kick(frame *b, const dm_node *G, const dm_node *lambda, const dm_node *F) {
    const uint32_t n = b->at.n;
    dm_node *push = dm_rattle_take(b, n);
    for (uint32_t c = 0; push && F && c < n; c++)
        push[c] = dm_rattle_add_product(b, 0, b->half, F[c]);
    for (uint32_t j = 0; push && G && j < b->at.m; j++)
        for (uint32_t e = b->row[j]; e < b->row[j + 1]; e++)
            push[b->column[e]] = dm_rattle_add_product(b, push[b->column[e]], G[e], lambda[j]);
    for (uint32_t c = 0; push && c < n; c++)
        if (push[c]) dm_fusion_add(&b->f, b->p + c, b->lp + c, push[c]);
}

/* F += f(q, v, t) where f sees v, which is that of the step */
static int add_drag(frame *b, dm_node *F, dm_node t) {
    const uint32_t n = b->at.n;
    dm_node *v = dm_rattle_take(b, n), *f = dm_rattle_take(b, n);
    if (!v || !f) return 0;
    if (!b->drag) return 1;
    dm_rattle_inputs(b, v, b->at.y, n);
    dm_rattle_evaluate(b, f, b->drag, n, &(dm_rattle_point){b->q, v, t});
    for (uint32_t c = 0; c < n; c++) F[c] = add(b, F[c], f[c]);
    return 1;
}

/* The kicked momentum is not summed with compensation: only its drift is wanted here. */
int dm_rattle_displace(frame *b, dm_node *out, const dm_node *F, const dm_node *B,
                       const dm_node *lambda) {
    const uint32_t n = b->at.n, m = b->at.m;
    dm_node *kicked = dm_rattle_take(b, n), *v = dm_rattle_take(b, n);
    if (!kicked || !v) return 0;
    for (uint32_t c = 0; c < n; c++) kicked[c] = dm_rattle_add_product(b, b->p[c], b->half, F[c]);
    dm_fusion_velocity(&b->f, v, NULL, kicked);
    for (uint32_t c = 0; c < n; c++) {
        out[c] = dm_rattle_add_product(b, b->lq[c], b->h, v[c]);
        for (uint32_t j = 0; j < m; j++)
            out[c] = dm_rattle_add_product(b, out[c], B[c * (size_t)m + j], lambda[j]);
    }
    return 1;
}

/* q moves straight away: it does not wait for the compensated sums of p. The low part is exact,
 * since the move is small. */
static int drift(frame *b, const dm_node *F0, const dm_node *G0, const dm_node *lambda) {
    const uint32_t n = b->at.n;
    dm_node *B = dm_rattle_take(b, (size_t)n * b->at.m), *move = dm_rattle_take(b, n);
    if (!B || !move) return 0;
    dm_rattle_spread(b, B, G0, b->h);
    if (!dm_rattle_displace(b, move, F0, B, lambda)) return 0;
    for (uint32_t c = 0; c < n; c++) {
        const dm_node before = b->q[c];
        b->q[c] = dm_add(b->f.graph, before, move[c]);
        const dm_node lost = dm_sub(b->f.graph, before, b->q[c]);
        b->lq[c] = dm_add(b->f.graph, move[c], lost);
    }
    return 1;
}

/* p += G^T mu with G W (p - shift) + g_t = 0; mu[m] */
static int tangent(frame *b, dm_node *mu, const dm_node *G, const dm_node *g_t) {
    const uint32_t n = b->at.n, m = b->at.m;
    dm_node *v = dm_rattle_take(b, n), *B = dm_rattle_take(b, (size_t)n * m),
            *A = dm_rattle_take(b, (size_t)m * m);
    if (!v || !B || !A) return 0;
    dm_fusion_velocity(&b->f, v, NULL, b->p);
    for (uint32_t i = 0; i < m; i++) {
        dm_node sum = g_t[i];
        for (uint32_t e = b->row[i]; e < b->row[i + 1]; e++)
            sum = dm_rattle_add_product(b, sum, G[e], v[b->column[e]]);
        mu[i] = sum ? dm_neg(b->f.graph, sum) : 0;
    }
    dm_rattle_spread(b, B, G, 0);
    dm_rattle_multiply(b, A, G, B, 1);
    dm_graph_solve(b->f.graph, A, mu, m, 1, NULL);
    kick(b, G, mu, NULL);
    return 1;
}

/* From the root to the next step: drift, second half of the kick, momentum onto the hidden
 * constraint, and F, G, g of the new position for the step behind it. */
static dm_status make_end(frame *b, dm_kernel *out, int shake) {
    const size_t n = b->at.n, m = b->at.m, z = b->at.nonzeros, count = n + z + 2 * m;
    if (!dm_rattle_begin(b)) return DM_NO_MEMORY;
    dm_node *G0 = dm_rattle_take(b, z), *lambda = dm_rattle_take(b, m), *F0 = dm_rattle_take(b, n);
    const dm_node *roots = all_roots(b);
    dm_node *values = dm_rattle_take(b, count), *all = dm_rattle_take(b, 5 * n + z + 2 * m);
    if (!G0 || !lambda || !F0 || !roots || !values || !all) return DM_NO_MEMORY;
    dm_rattle_inputs(b, G0, b->at.G, b->at.nonzeros);
    dm_rattle_inputs(b, lambda, b->at.lambda, b->at.m);
    dm_rattle_inputs(b, F0, b->at.force, b->at.n);
    if (!add_drag(b, F0, b->t0)) return DM_NO_MEMORY;
    if (!drift(b, F0, G0, lambda)) return DM_NO_MEMORY;
    kick(b, G0, lambda, F0);
    dm_rattle_evaluate(b, values, roots, count, &(dm_rattle_point){b->q, NULL, b->t});
    dm_node *G = values + n, *g_t = G + z, *g = g_t + m;
    memcpy(all + b->at.force, values, (n + z) * sizeof *all);
    if (!add_drag(b, values, b->t)) return DM_NO_MEMORY;
    kick(b, NULL, NULL, values);
    if (!shake && m && !tangent(b, lambda, G, g_t)) return DM_NO_MEMORY;
    memcpy(all, b->q, 4 * n * sizeof *all);
    memcpy(all + b->at.guess, lambda, m * sizeof *all);
    memcpy(all + b->at.g, g, m * sizeof *all);
    return dm_rattle_end(b, out, all, 5 * n + z + 2 * m);
}

/* Its address says whose kernels these are. */
static const char maker;
/* One number for each kernel. */
enum { BEGIN, FIRST, NEWTON, END, SHAKE_END };

/* In one source graph, so that what they share is compacted alike. */
static dm_status make_all(frame *b, dm_rattle_kernels *out, int shake) {
    if ((b->at.m && !read_pattern(b)) || !read_model(b)) return DM_NO_MEMORY;
    dm_status status = make_begin(b, &out->begin);
    if (status == DM_OK) status = dm_rattle_make_iterate(b, &out->first, 1);
    if (status == DM_OK) status = dm_rattle_make_iterate(b, &out->newton, 0);
    if (status == DM_OK) status = make_end(b, &out->end, shake);
    return status;
}

/* Both rules share all but the end. */
dm_status dm_rattle_build(dm_rattle_kernels *out, const dm_model *m, int shake) {
    frame b = {.model = m, .at = dm_rattle_lay_out(m), .arena = m->source.arena};
    const uint32_t last = shake ? SHAKE_END : END;
    if (dm_cache_find(&out->begin, m, &maker, BEGIN) &&
        dm_cache_find(&out->first, m, &maker, FIRST) &&
        dm_cache_find(&out->newton, m, &maker, NEWTON) && dm_cache_find(&out->end, m, &maker, last))
        return DM_OK;
    const dm_status status = make_all(&b, out, shake);
    if (status != DM_OK) return status;
    dm_cache_add(m, &maker, BEGIN, &out->begin, 1);
    dm_cache_add(m, &maker, FIRST, &out->first, 1);
    dm_cache_add(m, &maker, NEWTON, &out->newton, 1);
    dm_cache_add(m, &maker, last, &out->end, 1);
    return DM_OK;
}
