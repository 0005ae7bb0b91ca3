#include "integ/curve/curve_defect.h"

#include "algebra/derive.h"
#include "integ/curve/curve_field.h"

#include <string.h>

dm_node *dm_defect_take(const dm_defect *b, size_t count) {
    return dm_arena_take(b->m->source.arena, (count + 1) * sizeof(dm_node));
}

dm_node dm_defect_add(dm_graph *g, dm_node sum, dm_node x, dm_node y) {
    const dm_node product = dm_mul(g, x, y);
    return dm_add(g, sum, product);
}

/* sum + input first + i times x[i], count of them */
static dm_node contract(const dm_defect *b, dm_node sum, uint32_t first, const dm_node *x,
                        uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const dm_node factor = dm_input(b->g, first + i);
        sum = dm_defect_add(b->g, sum, factor, x[i]);
    }
    return sum;
}

/* L in the defect's own graph, whose inputs go on behind t; and its gradient there. */
static dm_status carry_lagrangian(dm_defect *b) {
    dm_graph *from = b->m->source.graph;
    const uint32_t inputs = dm_graph_inputs(from);
    dm_node *with = dm_defect_take(b, inputs);
    b->gradient = dm_defect_take(b, 2 * (size_t)b->n + 1);
    if (!with || !b->gradient) return DM_NO_MEMORY;
    for (uint32_t i = 0; i < inputs; i++) with[i] = i <= b->t ? dm_input(b->g, i) : 0;
    dm_transplant(b->g, from, &b->m->source.lagrangian, 1, with, &b->L);
    dm_gradient(b->g, b->L, 0, 2 * b->n + 1, b->gradient);
    return dm_graph_status(b->g);
}

/* U . R of L by directional derivatives: w = U . L_v, then U . L_q - w_q . v - w_v . a - w_t, and
 * l L */
static dm_status make_psi(dm_defect *b) {
    const uint32_t n = b->n;
    dm_node *slope = dm_defect_take(b, 2 * (size_t)n + 1);
    if (!slope) return DM_NO_MEMORY;
    const dm_node w = contract(b, 0, b->U, b->gradient + n, n);
    dm_gradient(b->g, w, 0, 2 * n + 1, slope);
    const dm_node moved = contract(b, slope[2 * n], n, slope, n);
    const dm_node all = contract(b, moved, b->w, slope + n, n);
    const dm_node pushed = contract(b, 0, b->U, b->gradient, n);
    const dm_node defect = dm_sub(b->g, pushed, all);
    b->psi = dm_defect_add(b->g, defect, dm_input(b->g, b->l), b->L);
    return dm_graph_status(b->g);
}

/* ---- forces and constraints ---- */

/* nodes of the constraints in the graph */
static dm_node *carry(const dm_defect *b, const dm_node *nodes, size_t count) {
    const uint32_t inputs = dm_graph_inputs(b->c->graph), first = inputs - b->c->controls;
    dm_node *with = dm_defect_take(b, inputs), *out = dm_defect_take(b, count);
    if (!with || !out) return NULL;
    for (uint32_t i = 0; i < inputs; i++) {
        with[i] = i <= b->t ? dm_input(b->g, i) : 0;
        if (i >= first) with[i] = dm_input(b->g, b->l + 1 + (i - first));
    }
    dm_transplant(b->g, b->c->graph, nodes, (uint32_t)count, with, out);
    return out;
}

/* psi += U . f, and f into the work */
static dm_status add_force(dm_defect *b) {
    if (!b->c->forced) return DM_OK;
    const dm_node *f = carry(b, b->c->f, b->n);
    if (!f) return DM_NO_MEMORY;
    memcpy(b->push, f, b->n * sizeof *f);
    b->psi = contract(b, b->psi, b->U, f, b->n);
    return DM_OK;
}

/* psi += U . rows^T w for the multipliers from input `first` on; rows[count*n], which do work or
 * none */
static void add_reactions(dm_defect *b, const dm_node *rows, uint32_t first, uint32_t count,
                          int works) {
    for (uint32_t c = 0; c < count; c++) {
        const dm_node along = contract(b, 0, b->U, rows + c * (size_t)b->n, b->n);
        b->psi = dm_defect_add(b->g, b->psi, along, dm_input(b->g, first + c));
        for (uint32_t i = 0; i < b->n && works; i++) {
            const dm_node row = rows[c * (size_t)b->n + i];
            b->push[i] = dm_defect_add(b->g, b->push[i], row, dm_input(b->g, first + c));
        }
    }
}

/* psi += (sum of U_c x_c)' along the curve, for x[count] functions of (q, v, t) with the rows from
 * `first` on */
static dm_status add_rate(dm_defect *b, const dm_node *x, uint32_t first, uint32_t count) {
    const uint32_t n = b->n;
    dm_node *slope = dm_defect_take(b, 2 * (size_t)n + 1);
    if (!slope) return DM_NO_MEMORY;
    const dm_node sum = contract(b, 0, b->U + first, x, count);
    dm_gradient(b->g, sum, 0, 2 * n + 1, slope);
    const dm_node moved = contract(b, slope[2 * n], n, slope, n);
    b->psi = dm_add(b->g, b->psi, contract(b, moved, b->w, slope + n, n));
    return DM_OK;
}

/* reactions G^T lambda, and (G v + g_t)' = 0 */
static dm_status add_holonomic(dm_defect *b) {
    const uint32_t n = b->n, k = b->k;
    const dm_node *G = carry(b, b->c->G, k * (size_t)n), *g_t = carry(b, b->c->g_t, k);
    dm_node *hidden = dm_defect_take(b, k);
    if (!G || !g_t || !hidden) return DM_NO_MEMORY;
    add_reactions(b, G, b->w + n, k, 0);
    for (uint32_t c = 0; c < k; c++) hidden[c] = contract(b, g_t[c], n, G + c * (size_t)n, n);
    return add_rate(b, hidden, n, k);
}

/* reactions E^T mu, which work on variations of the curve, and phi' = 0 */
static dm_status add_rolling(dm_defect *b) {
    const uint32_t n = b->n, l = b->rolling;
    const dm_node *E = carry(b, b->c->E, l * (size_t)n), *phi = carry(b, b->c->phi, l);
    if (!E || !phi) return DM_NO_MEMORY;
    add_reactions(b, E, b->w + n + b->k, l, 1);
    return add_rate(b, phi, n + b->k, l);
}

static dm_status add_constraints(dm_defect *b) {
    if (!b->c) return DM_OK;
    dm_node *none = dm_defect_take(b, b->n);
    if (!none) return DM_NO_MEMORY;
    memset(none, 0, b->n * sizeof *none);
    b->push = b->c->forced || b->rolling ? none : NULL;
    dm_status status = add_force(b);
    if (status == DM_OK && b->k) status = add_holonomic(b);
    if (status == DM_OK && b->rolling) status = add_rolling(b);
    return status == DM_OK ? dm_graph_status(b->g) : status;
}

/* ---- rows ---- */

/* What is left of R without the part of the acceleration. */
void dm_defect_push(const dm_defect *b, dm_node *out, dm_node *mixed) {
    const uint32_t n = b->n;
    dm_node *rate = mixed + (size_t)n * n; /* [n]; mixed: row v, column q */
    dm_jacobian(b->g, b->gradient + n, n, 0, n, mixed);
    dm_jacobian(b->g, b->gradient + n, n, b->t, 1, rate);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node moved = contract(b, rate[i], n, mixed + i * (size_t)n, n);
        out[i] = dm_sub(b->g, b->gradient[i], moved);
        if (b->push) out[i] = dm_add(b->g, out[i], b->push[i]);
    }
}

void dm_defect_divide(const dm_defect *b, dm_node *x, dm_node *y) {
    const uint32_t n = b->n;
    const int diagonal = (b->m->structure & DM_DIAGONAL_MASS) != 0;
    memcpy(y, x, n * sizeof *y);
    for (uint32_t i = 0; i < n; i++) {
        const double *row = b->m->inverse_mass + (diagonal ? 0 : i * (size_t)n);
        x[i] = 0;
        for (uint32_t j = 0; j < n; j++) {
            if (diagonal && j != i) continue;
            x[i] = dm_defect_add(b->g, x[i], dm_constant(b->g, row[j]), y[j]);
        }
    }
}

/* R is affine in w: its value at zero and its derivative are all of it. */
dm_status dm_defect_rows(const dm_defect *b, dm_node *R, dm_node *S) {
    const uint32_t N = b->N, inputs = dm_graph_inputs(b->g);
    dm_node *with = dm_defect_take(b, inputs), *all = dm_defect_take(b, N);
    if (!with || !all) return DM_NO_MEMORY;
    for (uint32_t i = 0; i < inputs; i++)
        with[i] = i >= b->w && i < b->w + N ? 0 : dm_input(b->g, i);
    dm_gradient(b->g, b->psi, b->U, N, all);
    dm_jacobian(b->g, all, N, b->w, N, S);
    for (size_t i = 0; i < N * (size_t)N; i++) S[i] = dm_neg(b->g, S[i]);
    dm_substitute(b->g, all, N, with, R);
    return dm_graph_status(b->g);
}

/* ---- w, solved ---- */

/* the first row from k on with an entry in column k; N: none */
static uint32_t pivot_row(const dm_node *S, uint32_t N, uint32_t k) {
    for (uint32_t i = k; i < N; i++)
        if (S[i * (size_t)N + k]) return i; /* node 0 is zero */
    return N;
}

/* rows k and i of S and R */
static void exchange(dm_node *S, dm_node *R, uint32_t N, uint32_t k, uint32_t i) {
    const dm_node last = R[k];
    R[k] = R[i];
    R[i] = last;
    for (uint32_t j = 0; j < N; j++) {
        const dm_node entry = S[k * (size_t)N + j];
        S[k * (size_t)N + j] = S[i * (size_t)N + j];
        S[i * (size_t)N + j] = entry;
    }
}

/* a - x y */
static dm_node less_product(dm_graph *g, dm_node a, dm_node x, dm_node y) {
    const dm_node product = dm_mul(g, x, y);
    return dm_sub(g, a, product);
}

/* rows below k without their part along row k */
static void eliminate(dm_graph *g, dm_node *S, dm_node *R, uint32_t N, uint32_t k) {
    for (uint32_t i = k + 1; i < N; i++) {
        dm_node *row = S + i * (size_t)N, *pivot = S + k * (size_t)N;
        if (!row[k]) continue;
        const dm_node factor = dm_div(g, row[k], pivot[k]);
        for (uint32_t j = k + 1; j < N; j++) row[j] = less_product(g, row[j], factor, pivot[j]);
        R[i] = less_product(g, R[i], factor, R[k]);
    }
}

/* The mass comes first, so that pivots are those of a definite matrix, then of minus another. */
static dm_status solve_rows(const dm_defect *b, dm_node *S, dm_node *w) {
    const uint32_t N = b->N;
    for (uint32_t k = 0; k < N; k++) {
        const uint32_t row = pivot_row(S, N, k);
        if (row == N) return DM_SINGULAR;
        if (row != k) exchange(S, w, N, k, row);
        eliminate(b->g, S, w, N, k);
    }
    for (uint32_t k = N; k-- > 0;) {
        for (uint32_t j = k + 1; j < N; j++)
            w[k] = less_product(b->g, w[k], S[k * (size_t)N + j], w[j]);
        w[k] = dm_div(b->g, w[k], S[k * (size_t)N + k]);
    }
    return dm_graph_status(b->g);
}

/* A constant mass has been inverted in numbers already. */
dm_status dm_defect_solve(const dm_defect *b, dm_node *w) {
    const size_t n = b->n, N = b->N;
    dm_node *S = dm_defect_take(b, N * N + n);
    if (!S) return DM_NO_MEMORY;
    if (b->m->inverse_mass && N == n) {
        dm_defect_push(b, w, S);
        dm_defect_divide(b, w, S);
        return dm_graph_status(b->g);
    }
    const dm_status status = dm_defect_rows(b, w, S);
    return status == DM_OK ? solve_rows(b, S, w) : status;
}

/* ---- all of it ---- */

/* L first, then what forces and constraints add to psi. */
dm_status dm_defect_build(dm_defect *out, const dm_model *m, uint32_t more) {
    const uint32_t n = m->n, N = dm_field_rows(m), known = (uint32_t)dm_field_inputs(m);
    dm_defect b = {.m = m, .c = m->constraints, .n = n, .N = N, .t = 2 * n, .w = 2 * n + 1};
    b.U = b.w + N;
    b.l = b.U + N;
    b.more = known;
    if (b.c) b.k = b.c->holonomic;
    if (b.c) b.rolling = b.c->rolling;
    b.g = dm_graph_new(m->source.arena, known + more);
    if (!b.g) return DM_NO_MEMORY;
    dm_status status = carry_lagrangian(&b);
    if (status == DM_OK) status = make_psi(&b);
    if (status == DM_OK) status = add_constraints(&b);
    *out = b;
    return status;
}
