#include "integ/curve/curve_field.h"

#include "algebra/derive.h"
#include "integ/method/cache.h"

#include <string.h>

/* inputs of the graph, by what stands there, and what was carried into it */
typedef struct {
    dm_graph *g;
    const dm_model *m;
    const dm_constraints *c; /* NULL: none */
    uint32_t n, N, k, rolling, t, w, U, l, inputs;
    dm_node L, psi;    /* psi = U . R + l L */
    dm_node *gradient; /* [2n+1] of L in (q, v, t) */
    dm_node *push;     /* [n] C; NULL: no work but that of L */
    dm_node *roots;
} builder;

enum { FORCE, GRADIENT, CURVE, TANGENT, MOMENTUM };
static const char maker;

uint32_t dm_field_rows(const dm_model *m) {
    const dm_constraints *c = m->constraints;
    return m->n + (c ? c->holonomic + c->rolling : 0);
}

size_t dm_field_inputs(const dm_model *m) {
    const size_t controls = m->constraints ? m->constraints->controls : 0;
    return 2 * (size_t)m->n + 2 + 2 * (size_t)dm_field_rows(m) + controls;
}

size_t dm_field_curve(const dm_model *m) {
    const size_t n = m->n, N = dm_field_rows(m),
                 rolling = m->constraints ? m->constraints->rolling : 0;
    return 4 * n * n + 4 * N * n + n * rolling;
}

/* Nodes in the arena of the model; NULL without memory. */
static dm_node *take(const builder *b, size_t count) {
    return dm_arena_take(b->m->source.arena, (count + 1) * sizeof(dm_node));
}

/* sum + x y */
static dm_node add_product(dm_graph *g, dm_node sum, dm_node x, dm_node y) {
    const dm_node product = dm_mul(g, x, y);
    return dm_add(g, sum, product);
}

/* sum + input first + i times x[i], count of them */
static dm_node contract(const builder *b, dm_node sum, uint32_t first, const dm_node *x,
                        uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const dm_node factor = dm_input(b->g, first + i);
        sum = add_product(b->g, sum, factor, x[i]);
    }
    return sum;
}

/* L in the builder's own graph, whose inputs go on behind t; and its gradient there. */
static dm_status carry_lagrangian(builder *b) {
    dm_graph *from = b->m->source.graph;
    const uint32_t inputs = dm_graph_inputs(from);
    dm_node *with = take(b, inputs);
    b->gradient = take(b, 2 * (size_t)b->n + 1);
    if (!with || !b->gradient) return DM_NO_MEMORY;
    for (uint32_t i = 0; i < inputs; i++) with[i] = i <= b->t ? dm_input(b->g, i) : 0;
    dm_transplant(b->g, from, &b->m->source.lagrangian, 1, with, &b->L);
    dm_gradient(b->g, b->L, 0, 2 * b->n + 1, b->gradient);
    return dm_graph_status(b->g);
}

/* U . R of L by directional derivatives: w = U . L_v, then U . L_q - w_q . v - w_v . a - w_t, and
 * l L */
static dm_status make_psi(builder *b) {
    const uint32_t n = b->n;
    dm_node *slope = take(b, 2 * (size_t)n + 1);
    if (!slope) return DM_NO_MEMORY;
    const dm_node w = contract(b, 0, b->U, b->gradient + n, n);
    dm_gradient(b->g, w, 0, 2 * n + 1, slope);
    const dm_node moved = contract(b, slope[2 * n], n, slope, n);
    const dm_node all = contract(b, moved, b->w, slope + n, n);
    const dm_node pushed = contract(b, 0, b->U, b->gradient, n);
    const dm_node defect = dm_sub(b->g, pushed, all);
    b->psi = add_product(b->g, defect, dm_input(b->g, b->l), b->L);
    return dm_graph_status(b->g);
}

/* ---- forces and constraints ---- */

/* nodes of the constraints in the builder's graph */
static dm_node *carry(const builder *b, const dm_node *nodes, size_t count) {
    const uint32_t inputs = dm_graph_inputs(b->c->graph), first = inputs - b->c->controls;
    dm_node *with = take(b, inputs), *out = take(b, count);
    if (!with || !out) return NULL;
    for (uint32_t i = 0; i < inputs; i++) {
        with[i] = i <= b->t ? dm_input(b->g, i) : 0;
        if (i >= first) with[i] = dm_input(b->g, b->l + 1 + (i - first));
    }
    dm_transplant(b->g, b->c->graph, nodes, (uint32_t)count, with, out);
    return out;
}

/* psi += U . f, and f into the work */
static dm_status add_force(builder *b) {
    if (!b->c->forced) return DM_OK;
    const dm_node *f = carry(b, b->c->f, b->n);
    if (!f) return DM_NO_MEMORY;
    memcpy(b->push, f, b->n * sizeof *f);
    b->psi = contract(b, b->psi, b->U, f, b->n);
    return DM_OK;
}

/* psi += U . rows^T w for the multipliers from input `first` on; rows[count*n], which do work or
 * none */
static void add_reactions(builder *b, const dm_node *rows, uint32_t first, uint32_t count,
                          int works) {
    for (uint32_t c = 0; c < count; c++) {
        const dm_node along = contract(b, 0, b->U, rows + c * (size_t)b->n, b->n);
        b->psi = add_product(b->g, b->psi, along, dm_input(b->g, first + c));
        for (uint32_t i = 0; i < b->n && works; i++) {
            const dm_node row = rows[c * (size_t)b->n + i];
            b->push[i] = add_product(b->g, b->push[i], row, dm_input(b->g, first + c));
        }
    }
}

/* psi += (sum of U_c x_c)' along the curve, for x[count] functions of (q, v, t) with the rows from
 * `first` on */
static dm_status add_rate(builder *b, const dm_node *x, uint32_t first, uint32_t count) {
    const uint32_t n = b->n;
    dm_node *slope = take(b, 2 * (size_t)n + 1);
    if (!slope) return DM_NO_MEMORY;
    const dm_node sum = contract(b, 0, b->U + first, x, count);
    dm_gradient(b->g, sum, 0, 2 * n + 1, slope);
    const dm_node moved = contract(b, slope[2 * n], n, slope, n);
    b->psi = dm_add(b->g, b->psi, contract(b, moved, b->w, slope + n, n));
    return DM_OK;
}

/* reactions G^T lambda, and (G v + g_t)' = 0 */
static dm_status add_holonomic(builder *b) {
    const uint32_t n = b->n, k = b->k;
    const dm_node *G = carry(b, b->c->G, k * (size_t)n), *g_t = carry(b, b->c->g_t, k);
    dm_node *hidden = take(b, k);
    if (!G || !g_t || !hidden) return DM_NO_MEMORY;
    add_reactions(b, G, b->w + n, k, 0);
    for (uint32_t c = 0; c < k; c++) hidden[c] = contract(b, g_t[c], n, G + c * (size_t)n, n);
    return add_rate(b, hidden, n, k);
}

/* reactions E^T mu, which work on variations of the curve, and phi' = 0 */
static dm_status add_rolling(builder *b) {
    const uint32_t n = b->n, l = b->rolling;
    const dm_node *E = carry(b, b->c->E, l * (size_t)n), *phi = carry(b, b->c->phi, l);
    if (!E || !phi) return DM_NO_MEMORY;
    add_reactions(b, E, b->w + n + b->k, l, 1);
    return add_rate(b, phi, n + b->k, l);
}

static dm_status add_constraints(builder *b) {
    if (!b->c) return DM_OK;
    dm_node *none = take(b, b->n);
    if (!none) return DM_NO_MEMORY;
    memset(none, 0, b->n * sizeof *none);
    b->push = b->c->forced || b->rolling ? none : NULL;
    dm_status status = add_force(b);
    if (status == DM_OK && b->k) status = add_holonomic(b);
    if (status == DM_OK && b->rolling) status = add_rolling(b);
    return status == DM_OK ? dm_graph_status(b->g) : status;
}

/* ---- kernels ---- */

/* E + M a = L_q - L_vq v - L_vt + f, without constraints */
static void write_push(const builder *b, dm_node *out) {
    const uint32_t n = b->n;
    dm_node *mixed = b->roots + n + (size_t)n * n; /* [n][n] row v, column q */
    dm_node *rate = mixed + (size_t)n * n;
    dm_jacobian(b->g, b->gradient + n, n, 0, n, mixed);
    dm_jacobian(b->g, b->gradient + n, n, b->t, 1, rate);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node moved = contract(b, rate[i], n, mixed + i * (size_t)n, n);
        out[i] = dm_sub(b->g, b->gradient[i], moved);
        if (b->push) out[i] = dm_add(b->g, out[i], b->push[i]);
    }
}

/* x = M^-1 x with the numbers of a constant mass; y[n] is scratch */
static void divide_by_mass(const builder *b, dm_node *x, dm_node *y) {
    const uint32_t n = b->n;
    const int diagonal = (b->m->structure & DM_DIAGONAL_MASS) != 0;
    memcpy(y, x, n * sizeof *y);
    for (uint32_t i = 0; i < n; i++) {
        const double *row = b->m->inverse_mass + (diagonal ? 0 : i * (size_t)n);
        x[i] = 0;
        for (uint32_t j = 0; j < n; j++) {
            if (diagonal && j != i) continue;
            x[i] = add_product(b->g, x[i], dm_constant(b->g, row[j]), y[j]);
        }
    }
}

/* The roots so far as a kernel, which the model keeps. */
static dm_status make(const builder *b, dm_kernel *out, size_t count, uint32_t which) {
    dm_status status = dm_graph_status(b->g);
    if (status == DM_OK)
        status = b->m->source.compile(out, b->g, b->roots, (uint32_t)count, b->m->source.arena);
    if (status == DM_OK) dm_cache_add(b->m, &maker, which, out, 1);
    return status;
}

/* R at w = 0, and S = -R_w */
static dm_status write_rows(const builder *b) {
    const uint32_t N = b->N;
    dm_node *with = take(b, b->inputs), *R = take(b, N), *S = b->roots + N;
    if (!with || !R) return DM_NO_MEMORY;
    for (uint32_t i = 0; i < b->inputs; i++)
        with[i] = i >= b->w && i < b->w + N ? 0 : dm_input(b->g, i);
    dm_gradient(b->g, b->psi, b->U, N, R);
    dm_jacobian(b->g, R, N, b->w, N, S);
    for (size_t i = 0; i < N * (size_t)N; i++) S[i] = dm_neg(b->g, S[i]);
    dm_substitute(b->g, R, N, with, b->roots);
    return DM_OK;
}

/* The acceleration itself where M is constant; else M a and M, to be solved at every point; with
 * constraints R and S. */
static dm_status make_force(const builder *b, dm_field *out) {
    const size_t n = b->n, N = b->N;
    if (N > n) {
        const dm_status status = write_rows(b);
        return status == DM_OK ? make(b, &out->force, N + N * N, FORCE) : status;
    }
    write_push(b, b->roots);
    if (out->solved) {
        divide_by_mass(b, b->roots, b->roots + n);
        return make(b, &out->force, n, FORCE);
    }
    dm_jacobian(b->g, b->gradient + n, b->n, b->n, b->n, b->roots + n);
    return make(b, &out->force, n + n * n, FORCE);
}

/* l C_i */
static dm_node work_of(const builder *b, uint32_t i) {
    const dm_node l = dm_input(b->g, b->l);
    return dm_mul(b->g, l, b->push[i]);
}

/* psi_y + l C */
static dm_status make_gradient(const builder *b, dm_kernel *out) {
    const uint32_t n = b->n;
    dm_gradient(b->g, b->psi, 0, 2 * n, b->roots);
    for (uint32_t i = 0; i < n && b->push; i++)
        b->roots[i] = dm_add(b->g, b->roots[i], work_of(b, i));
    return make(b, out, 2 * (size_t)n, GRADIENT);
}

/* psi_yy += l C_y, and l E^T, by which C sees mu, into bend[n*rolling] */
static void add_work_curve(const builder *b, dm_node *second, dm_node *bend) {
    const uint32_t n = b->n, N = 2 * n, l = b->rolling;
    dm_node *row = bend + n * (size_t)l; /* [2n] scratch */
    for (uint32_t i = 0; i < n && b->push; i++) {
        const dm_node work = work_of(b, i);
        dm_gradient(b->g, work, 0, N, row);
        for (uint32_t j = 0; j < N; j++) {
            dm_node *entry = second + i * (size_t)N + j;
            *entry = dm_add(b->g, *entry, row[j]);
        }
        if (l) dm_gradient(b->g, work, b->w + n + b->k, l, bend + i * (size_t)l);
    }
}

/* psi_yy, then R_y and B = psi_wy. */
static dm_status make_curve(const builder *b, dm_kernel *out) {
    const uint32_t n = b->n, N = 2 * n, M = b->N;
    dm_node *rows = b->roots + (size_t)N * N, *mixed = rows + (size_t)M * N;
    dm_node *bend = mixed + (size_t)M * N, *slope = bend + n * (size_t)b->rolling;
    dm_hessian(b->g, b->psi, 0, N, slope, b->roots);
    dm_gradient(b->g, b->psi, b->U, M, slope);
    dm_jacobian(b->g, slope, M, 0, N, rows);
    dm_gradient(b->g, b->psi, b->w, M, slope);
    dm_jacobian(b->g, slope, M, 0, N, mixed);
    add_work_curve(b, b->roots, bend);
    return make(b, out, dm_field_curve(b->m), CURVE);
}

/* R_y alone. */
static dm_status make_tangent(const builder *b, dm_kernel *out) {
    const uint32_t n = b->n, N = 2 * n, M = b->N;
    dm_node *defect = b->roots + (size_t)M * N; /* [M] scratch */
    dm_gradient(b->g, b->psi, b->U, M, defect);
    dm_jacobian(b->g, defect, M, 0, N, b->roots);
    return make(b, out, (size_t)M * N, TANGENT);
}

/* L_vy. */
static dm_status make_momentum(const builder *b, dm_kernel *out) {
    const uint32_t n = b->n, N = 2 * n;
    dm_jacobian(b->g, b->gradient + n, n, 0, N, b->roots);
    return make(b, out, (size_t)n * N, MOMENTUM);
}

/* The roots are overwritten from kernel to kernel; the largest are those of `curve`. */
static dm_status build(dm_field *out, builder *b) {
    const size_t n = b->n, N = b->N;
    dm_status status = carry_lagrangian(b);
    if (status == DM_OK) status = make_psi(b);
    if (status == DM_OK) status = add_constraints(b);
    b->roots = take(b, dm_field_curve(b->m) + N * N + 4 * n + N);
    if (status == DM_OK && !b->roots) status = DM_NO_MEMORY;
    if (status == DM_OK) status = make_force(b, out);
    if (status == DM_OK) status = make_gradient(b, &out->gradient);
    if (status == DM_OK) status = make_curve(b, &out->curve);
    if (status == DM_OK) status = make_tangent(b, &out->tangent);
    return status == DM_OK ? make_momentum(b, &out->momentum) : status;
}

/* All five or none are found with the model. */
static int find(dm_field *out, const dm_model *m) {
    return dm_cache_find(&out->force, m, &maker, FORCE) &&
           dm_cache_find(&out->gradient, m, &maker, GRADIENT) &&
           dm_cache_find(&out->curve, m, &maker, CURVE) &&
           dm_cache_find(&out->tangent, m, &maker, TANGENT) &&
           dm_cache_find(&out->momentum, m, &maker, MOMENTUM);
}

dm_status dm_field_build(dm_field *out, const dm_model *m) {
    const uint32_t n = m->n, N = dm_field_rows(m), w = 2 * n + 1;
    builder b = {.m = m, .c = m->constraints, .n = n, .N = N, .t = 2 * n};
    b.w = w;
    b.U = w + N;
    b.l = b.U + N;
    b.inputs = (uint32_t)dm_field_inputs(m);
    if (b.c) b.k = b.c->holonomic;
    if (b.c) b.rolling = b.c->rolling;
    out->n = n;
    out->N = N;
    out->rolling = b.rolling;
    out->solved = m->inverse_mass && N == n;
    if (!m->source.graph || !m->source.compile) return DM_TOO_LARGE;
    if (find(out, m)) return DM_OK;
    b.g = dm_graph_new(m->source.arena, b.inputs);
    return b.g ? build(out, &b) : DM_NO_MEMORY;
}
