/* rattle_kernels.c - the graphs of a constrained step. */
#include "expr/compact.h"
#include "expr/derive.h"
#include "expr/linear.h"
#include "integ/fused.h"
#include "integ/kept.h"
#include "integ/rattle.h"
#include "mech/ties.h"

#include <string.h>

dm_rattle_layout dm_rattle_lay_out(const dm_model *m) {
    const uint32_t n = m->n, k = m->ties ? m->ties->holonomic : 0;
    dm_rattle_layout at = {.n = n, .m = k};
    for (size_t i = 0; i < (size_t)k * n; i++) at.nonzeros += m->ties->touches[i];
    at.p = n;
    at.low_q = 2 * n;
    at.low_p = 3 * n;
    at.force = 4 * n;
    at.G = 5 * n;
    at.guess = at.G + at.nonzeros;
    at.g = at.guess + k;
    at.h = at.g + k;
    at.half = at.h + 1;
    at.t = at.h + 2;
    at.y = at.h + 3;
    at.lambda = at.y + n;
    at.norms = at.lambda + k;
    at.size = at.norms + 3;
    return at;
}

/* ---- what is under construction ---- */

typedef struct {
    dm_fusion f; /* the graph of the kernel that is being made, and the model */
    const dm_model *model;
    dm_rattle_layout at;
    dm_arena *arena;
    int no_memory;
    dm_graph *source;         /* inputs q, v, t */
    dm_node *force, *G, *g;   /* of source: F[n], the nonzeros of G, g[m] */
    dm_node *g_t;             /* [m] */
    dm_node *with;            /* inputs of source in the kernel's graph */
    uint32_t *row, *column;   /* row i of G has the nonzeros row[i] .. row[i + 1] - 1 */
    dm_node h, half, t;       /* inputs */
    dm_node *q, *p, *lq, *lp; /* the state */
} frame;

/* zeroed; NULL is remembered, so that no kernel comes out without what should be in it */
static dm_node *take(frame *b, size_t count) {
    dm_node *nodes = dm_arena_take(b->arena, (count + 1) * sizeof *nodes);
    if (nodes)
        memset(nodes, 0, (count + 1) * sizeof *nodes);
    else
        b->no_memory = 1;
    return nodes;
}

/* sum + x y */
static dm_node add_product(const frame *b, dm_node sum, dm_node x, dm_node y) {
    return dm_add_product(b->f.graph, sum, x, y);
}

static dm_node add(const frame *b, dm_node x, dm_node y) {
    if (!x || !y) return x ? x : y;
    return dm_add(b->f.graph, x, y);
}

/* ---- the expressions of the model ---- */

static int read_pattern(frame *b) {
    const uint32_t n = b->at.n, m = b->at.m;
    uint32_t next = 0;
    b->row = dm_arena_take(b->arena, (m + (size_t)1) * sizeof *b->row);
    b->column = dm_arena_take(b->arena, (b->at.nonzeros + (size_t)1) * sizeof *b->column);
    if (!b->row || !b->column) return 0;
    for (uint32_t i = 0; i < m; i++) {
        b->row[i] = next;
        for (uint32_t c = 0; c < n; c++)
            if (b->model->ties->touches[i * (size_t)n + c]) b->column[next++] = c;
    }
    b->row[m] = next;
    return 1;
}

/* F, G, g, g_t in one graph with the inputs q, v, t */
static int read_model(frame *b) {
    const dm_model *model = b->model;
    const dm_ties *ties = model->ties;
    const uint32_t n = b->at.n, m = b->at.m, inputs = 2 * n + 1;
    const uint32_t most = inputs + (ties ? ties->holonomic + ties->rolling : 0);
    dm_node *with = take(b, most), *f = take(b, n);
    b->source = dm_graph_new(b->arena, inputs);
    b->with = take(b, most), b->force = take(b, n), b->G = take(b, b->at.nonzeros);
    b->g = take(b, m), b->g_t = take(b, m);
    if (!with || !f || !b->source || !b->with || !b->force || !b->G || !b->g || !b->g_t)
        return 0;
    for (uint32_t i = 0; i < inputs; i++) with[i] = dm_input(b->source, i);
    dm_transplant(b->source, model->source.graph, model->source.gradient, n, with,
                  b->force);
    if (!ties) return 1;
    if (ties->f) dm_transplant(b->source, ties->graph, ties->f, n, with, f);
    for (uint32_t i = 0; i < n; i++) b->force[i] = dm_add(b->source, b->force[i], f[i]);
    if (!m) return 1;
    dm_transplant(b->source, ties->graph, ties->g, m, with, b->g);
    dm_transplant(b->source, ties->graph, ties->g_t, m, with, b->g_t);
    for (uint32_t i = 0, e = 0; i < m; i++)
        for (; e < b->row[i + 1]; e++)
            dm_transplant(b->source, ties->graph, ties->G + i * (size_t)n + b->column[e],
                          1, with, b->G + e);
    return dm_graph_status(b->source) == DM_OK;
}

/* roots[count] of the source, compacted together, at q[n] and t */
static void evaluate(frame *b, dm_node *out, const dm_node *roots, size_t count,
                     const dm_node *q, dm_node t) {
    dm_node *compact = take(b, count);
    if (!compact || !count) return;
    dm_compact(b->source, roots, (uint32_t)count, compact);
    memset(b->with, 0, (2 * b->at.n + (size_t)1) * sizeof *b->with);
    memcpy(b->with, q, b->at.n * sizeof *q);
    b->with[2 * b->at.n] = t;
    dm_transplant(b->f.graph, b->source, compact, (uint32_t)count, b->with, out);
}

/* ---- linear algebra in the graph ---- */

/* B[n*m] = W G^T, by rows of W, times h where that is a node */
static void spread(const frame *b, dm_node *B, const dm_node *G, dm_node h) {
    const uint32_t n = b->at.n, m = b->at.m;
    const int diagonal = (b->model->structure & DM_DIAGONAL_MASS) != 0;
    const double *W = b->model->inverse_mass;
    memset(B, 0, (size_t)n * m * sizeof *B);
    for (uint32_t j = 0; j < m; j++)
        for (uint32_t e = b->row[j]; e < b->row[j + 1]; e++)
            for (uint32_t c = diagonal ? b->column[e] : 0;
                 c < (diagonal ? b->column[e] + 1 : n); c++) {
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
static void multiply(const frame *b, dm_node *A, const dm_node *G, const dm_node *B,
                     int symmetric) {
    const uint32_t m = b->at.m;
    for (uint32_t i = 0; i < m; i++)
        for (uint32_t j = symmetric ? i : 0; j < m; j++) {
            dm_node sum = 0;
            for (uint32_t e = b->row[i]; e < b->row[i + 1]; e++)
                sum = add_product(b, sum, G[e], B[b->column[e] * (size_t)m + j]);
            A[i * (size_t)m + j] = sum;
        }
}

/* sum_c x_c^2 */
static dm_node square(const frame *b, const dm_node *x) {
    dm_node sum = 0;
    for (uint32_t c = 0; c < b->at.n; c++) sum = add_product(b, sum, x[c], x[c]);
    return sum;
}

/* ---- kernels ---- */

static int begin(frame *b) {
    const dm_rattle_layout *at = &b->at;
    dm_graph *g = dm_graph_new(b->arena, at->size);
    b->f = (dm_fusion){.graph = g, .model = b->model, .size = at->size};
    b->q = take(b, 4 * (size_t)at->n);
    if (!g || !b->q) return 0;
    for (uint32_t i = 0; i < 4 * at->n; i++) b->q[i] = dm_input(g, i);
    b->p = b->q + at->n, b->lq = b->p + at->n, b->lp = b->lq + at->n;
    b->h = dm_input(g, at->h);
    b->half = dm_input(g, at->half);
    b->t = dm_input(g, at->t);
    dm_graph_verbatim(g, 1);
    return 1;
}

static void inputs(const frame *b, dm_node *out, uint32_t first, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) out[i] = dm_input(b->f.graph, first + i);
}

static dm_status end(frame *b, dm_kernel *out, const dm_node *roots, size_t count) {
    const dm_status status = dm_graph_status(b->f.graph);
    if (b->no_memory || dm_graph_status(b->source) != DM_OK) return DM_NO_MEMORY;
    if (status != DM_OK) return status;
    return b->model->source.compile(out, b->f.graph, roots, (uint32_t)count, b->arena);
}

/* F, G, g_t, g as roots of the source, in that order */
static dm_node *all_roots(frame *b) {
    const size_t n = b->at.n, m = b->at.m, z = b->at.nonzeros;
    dm_node *roots = take(b, n + z + 2 * m);
    if (!roots) return NULL;
    memcpy(roots, b->force, n * sizeof *roots);
    memcpy(roots + n, b->G, z * sizeof *roots);
    memcpy(roots + n + z, b->g_t, m * sizeof *roots);
    memcpy(roots + n + z + m, b->g, m * sizeof *roots);
    return roots;
}

static dm_status make_begin(frame *b, dm_kernel *out) {
    const size_t count = b->at.n + (size_t)b->at.nonzeros + 2 * (size_t)b->at.m;
    if (!begin(b)) return DM_NO_MEMORY;
    const dm_node *roots = all_roots(b);
    dm_node *values = take(b, count);
    if (!roots || !values) return DM_NO_MEMORY;
    evaluate(b, values, roots, count, b->q, b->t);
    return end(b, out, values, b->at.n + (size_t)b->at.nonzeros);
}

/* what an iteration works on: y[n], lambda[m], norms[3] are its outputs; B = h W G0^T */
typedef struct {
    dm_node *y, *lambda, *norms, *B;
} iterate;

static int begin_iterate(frame *b, iterate *x) {
    const size_t n = b->at.n, m = b->at.m;
    dm_node *G0 = take(b, b->at.nonzeros);
    x->y = take(b, n + m + 3);
    x->B = take(b, n * m);
    if (!G0 || !x->y || !x->B) return 0;
    x->lambda = x->y + n;
    x->norms = x->lambda + m;
    inputs(b, G0, b->at.G, b->at.nonzeros);
    spread(b, x->B, G0, b->h);
    return 1;
}

/* y += B dlambda, where J dlambda = -g(y) */
static int iteration(frame *b, iterate *x) {
    const uint32_t n = b->at.n, m = b->at.m;
    const size_t count = m + (size_t)b->at.nonzeros;
    dm_node *roots = take(b, count), *values = take(b, count);
    dm_node *J = take(b, (size_t)m * m), *change = take(b, n);
    if (!roots || !values || !J || !change) return 0;
    memcpy(roots, b->g, m * sizeof *roots);
    memcpy(roots + m, b->G, b->at.nonzeros * sizeof *roots);
    evaluate(b, values, roots, count, x->y, b->t);
    multiply(b, J, values + m, x->B, 0);
    dm_node *minus = values; /* -dlambda */
    dm_graph_solve(b->f.graph, J, minus, m, 0);
    for (uint32_t j = 0; j < m; j++)
        x->lambda[j] = dm_sub(b->f.graph, x->lambda[j], minus[j]);
    for (uint32_t c = 0; c < n; c++) {
        for (uint32_t j = 0; j < m; j++)
            change[c] = add_product(b, change[c], x->B[c * (size_t)m + j], minus[j]);
        if (change[c]) x->y[c] = dm_sub(b->f.graph, x->y[c], change[c]);
    }
    x->norms[0] = x->norms[1];
    x->norms[1] = square(b, change);
    x->norms[2] = square(b, x->y);
    return 1;
}

/* q + h W (p + h/2 F - shift) + B lambda, lambda as guessed */
static int predict(frame *b, iterate *x) {
    const uint32_t n = b->at.n, m = b->at.m;
    dm_graph *g = b->f.graph;
    dm_node *kicked = take(b, 2 * (size_t)n);
    if (!kicked) return 0;
    dm_node *v = kicked + n;
    for (uint32_t c = 0; c < n; c++)
        kicked[c] = dm_multiply_add(g, b->half, dm_input(g, b->at.force + c), b->p[c]);
    dm_fusion_velocity(&b->f, v, NULL, kicked);
    inputs(b, x->lambda, b->at.guess, m);
    for (uint32_t c = 0; c < n; c++) {
        dm_node shift = v[c] ? dm_multiply_add(g, b->h, v[c], b->lq[c]) : b->lq[c];
        for (uint32_t j = 0; j < m; j++)
            shift = add_product(b, shift, x->B[c * (size_t)m + j], x->lambda[j]);
        x->y[c] = dm_add(g, b->q[c], shift);
    }
    return 1;
}

static dm_status make_iterate(frame *b, dm_kernel *out, int first) {
    const size_t n = b->at.n, m = b->at.m;
    iterate x;
    if (!begin(b) || !begin_iterate(b, &x)) return DM_NO_MEMORY;
    if (first && !predict(b, &x)) return DM_NO_MEMORY;
    if (!first) inputs(b, x.y, b->at.y, (uint32_t)(n + m + 2));
    for (int i = 0; i < (first ? 2 : 1) && m; i++)
        if (!iteration(b, &x)) return DM_NO_MEMORY;
    return end(b, out, x.y, n + m + 3);
}

/* p += G^T lambda + half F, summed with compensation; half 0: without F */
static void kick(frame *b, const dm_node *G, const dm_node *lambda, const dm_node *F) {
    const uint32_t n = b->at.n;
    dm_node *push = take(b, n);
    for (uint32_t c = 0; push && F && c < n; c++)
        push[c] = add_product(b, 0, b->half, F[c]);
    for (uint32_t j = 0; push && G && j < b->at.m; j++)
        for (uint32_t e = b->row[j]; e < b->row[j + 1]; e++)
            push[b->column[e]] = add_product(b, push[b->column[e]], G[e], lambda[j]);
    for (uint32_t c = 0; push && c < n; c++)
        if (push[c]) dm_fusion_add(&b->f, b->p + c, b->lp + c, push[c]);
}

static int drift(frame *b) {
    dm_node *v = take(b, b->at.n);
    if (!v) return 0;
    dm_fusion_velocity(&b->f, v, NULL, b->p);
    for (uint32_t c = 0; c < b->at.n; c++) {
        const dm_node dq = add_product(b, 0, b->h, v[c]);
        if (dq) dm_fusion_add(&b->f, b->q + c, b->lq + c, dq);
    }
    return 1;
}

/* p += G^T mu with G W (p - shift) + g_t = 0; mu[m] */
static int tangent(frame *b, dm_node *mu, const dm_node *G, const dm_node *g_t) {
    const uint32_t n = b->at.n, m = b->at.m;
    dm_node *v = take(b, n), *B = take(b, (size_t)n * m), *A = take(b, (size_t)m * m);
    if (!v || !B || !A) return 0;
    dm_fusion_velocity(&b->f, v, NULL, b->p);
    for (uint32_t i = 0; i < m; i++) {
        dm_node sum = g_t[i];
        for (uint32_t e = b->row[i]; e < b->row[i + 1]; e++)
            sum = add_product(b, sum, G[e], v[b->column[e]]);
        mu[i] = sum ? dm_neg(b->f.graph, sum) : 0;
    }
    spread(b, B, G, 0);
    multiply(b, A, G, B, 1);
    dm_graph_solve(b->f.graph, A, mu, m, 1);
    kick(b, G, mu, NULL);
    return 1;
}

static dm_status make_end(frame *b, dm_kernel *out, int shake) {
    const size_t n = b->at.n, m = b->at.m, z = b->at.nonzeros, count = n + z + 2 * m;
    if (!begin(b)) return DM_NO_MEMORY;
    dm_node *G0 = take(b, z), *lambda = take(b, m), *F0 = take(b, n);
    const dm_node *roots = all_roots(b);
    dm_node *values = take(b, count), *all = take(b, 5 * n + z + 2 * m);
    if (!G0 || !lambda || !F0 || !roots || !values || !all) return DM_NO_MEMORY;
    inputs(b, G0, b->at.G, b->at.nonzeros);
    inputs(b, lambda, b->at.lambda, b->at.m);
    inputs(b, F0, b->at.force, b->at.n);
    kick(b, G0, lambda, F0);
    if (!drift(b)) return DM_NO_MEMORY;
    evaluate(b, values, roots, count, b->q, b->t);
    dm_node *G = values + n, *g_t = G + z, *g = g_t + m;
    kick(b, NULL, NULL, values);
    if (!shake && m && !tangent(b, lambda, G, g_t)) return DM_NO_MEMORY;
    memcpy(all, b->q, 4 * n * sizeof *all);
    memcpy(all + b->at.force, values, (n + z) * sizeof *all);
    memcpy(all + b->at.guess, lambda, m * sizeof *all);
    memcpy(all + b->at.g, g, m * sizeof *all);
    return end(b, out, all, 5 * n + z + 2 * m);
}

static const char maker;
enum { BEGIN, FIRST, NEWTON, END, SHAKE_END };

static dm_status make_all(frame *b, dm_rattle_kernels *out, int shake) {
    if ((b->at.m && !read_pattern(b)) || !read_model(b)) return DM_NO_MEMORY;
    dm_status status = make_begin(b, &out->begin);
    if (status == DM_OK) status = make_iterate(b, &out->first, 1);
    if (status == DM_OK) status = make_iterate(b, &out->newton, 0);
    if (status == DM_OK) status = make_end(b, &out->end, shake);
    return status;
}

dm_status dm_rattle_build(dm_rattle_kernels *out, const dm_model *m, int shake) {
    frame b = {.model = m, .at = dm_rattle_lay_out(m), .arena = m->source.arena};
    const uint32_t last = shake ? SHAKE_END : END;
    if (dm_kept_find(&out->begin, m, &maker, BEGIN) &&
        dm_kept_find(&out->first, m, &maker, FIRST) &&
        dm_kept_find(&out->newton, m, &maker, NEWTON) &&
        dm_kept_find(&out->end, m, &maker, last))
        return DM_OK;
    const dm_status status = make_all(&b, out, shake);
    if (status != DM_OK) return status;
    dm_kept_add(m, &maker, BEGIN, &out->begin, 1);
    dm_kept_add(m, &maker, FIRST, &out->first, 1);
    dm_kept_add(m, &maker, NEWTON, &out->newton, 1);
    dm_kept_add(m, &maker, last, &out->end, 1);
    return DM_OK;
}
