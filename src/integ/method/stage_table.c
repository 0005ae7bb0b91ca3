/* stage_table.c - coefficients of a stage method from its nodes and its quadrature. */
#include "integ/method/stage_table.h"
#include "integ/method/cache.h"

#include <stddef.h>
#include <string.h>

enum { MOST = DM_QUADRATURE_NODES };

/* As many velocities as points, at the same places: d = 1. */
void dm_galerkin_collocation(dm_galerkin *g, const dm_quadrature *q) {
    g->s = q->r;
    g->sweeps = 0;
    g->tableau = 0;
    g->q = *q;
    memcpy(g->node, q->c, sizeof g->node);
}

/* kept are all but `a`, of rules whose arguments are numbers; the key is these */
void dm_stage_basis(dm_galerkin *out, const dm_rule *rule, const dm_model *m) {
    enum { HEAD = offsetof(dm_galerkin, a) / sizeof(double) };
    double key[DM_RULE_ARGS];
    int plain = rule->data == NULL;
    for (int k = 0; k < rule->count; k++) {
        key[k] = rule->arg[k].number;
        plain &= rule->arg[k].rule == NULL;
    }
    const uint32_t keys = (uint32_t)rule->count;
    const double *kept = plain ? dm_cache_numbers(m, rule->method, key, keys) : NULL;
    if (kept) {
        memcpy(out, kept, HEAD * sizeof *kept);
        return;
    }
    rule->method->basis(out, rule);
    if (plain && !out->tableau)
        dm_cache_leave(m, rule->method, key, keys, (const double *)(const void *)out, HEAD);
}

/* Two doubles a weight. */
size_t dm_stage_table_size(size_t s, size_t r) {
    return 2 * (2 * r * s + 2 * r * r + 4 * r + 2 * s);
}

/* One array after the other, in the order of the struct. */
static void lay_out(dm_stage_table *t, double *memory) {
    const size_t s = t->s, r = t->r;
    t->a = (dm_weight *)(void *)memory;
    t->d = t->a + r * s;
    t->A = t->d + r * s;
    t->b = t->A + r * r;
    t->c = t->b + r;
    t->reach = t->c + r;
    t->mean = t->reach + r;
    t->beta = t->mean + r;
    t->node = t->beta + s;
    t->rate = t->node + s;
}

/* right-hand sides x[s][r] of G x = y by elimination; G is positive definite */
static void eliminate(long double G[MOST][MOST], long double x[MOST][MOST], int s, int r) {
    for (int k = 0; k < s; k++)
        for (int i = 0; i < s; i++) {
            const long double factor = G[i][k] / G[k][k];
            if (i == k || factor == 0.0L) continue;
            for (int j = k; j < s; j++) G[i][j] -= factor * G[k][j];
            for (int m = 0; m < r; m++) x[i][m] -= factor * x[k][m];
        }
    for (int i = 0; i < s; i++)
        for (int m = 0; m < r; m++) x[i][m] /= G[i][i];
}

typedef struct {
    long double a[MOST][MOST], d[MOST][MOST], beta[MOST];
} exact;

/* for p = M v: V_k = v0 + h sum_m x_km M^-1 L_q(m), with G x = b_m (beta_j - a_mj),
 * G_jk = sum_i b_i d_ij d_ik; then A = a x and mean = beta x */
static void separable_part(dm_stage_table *t, const dm_galerkin *g, const exact *e) {
    const int s = g->s, r = g->q.r;
    long double G[MOST][MOST], x[MOST][MOST];
    for (int j = 0; j < s; j++) {
        for (int k = 0; k < s; k++) {
            G[j][k] = 0.0L;
            for (int i = 0; i < r; i++) G[j][k] += g->q.b[i] * e->d[i][j] * e->d[i][k];
        }
        for (int m = 0; m < r; m++) x[j][m] = g->q.b[m] * (e->beta[j] - e->a[m][j]);
    }
    eliminate(G, x, s, r);
    for (int m = 0; m < r; m++) {
        long double mean = 0.0L;
        for (int k = 0; k < s; k++) mean += e->beta[k] * x[k][m];
        t->mean[m] = dm_weight_of(mean);
        for (int i = 0; i < r; i++) {
            long double sum = 0.0L, rate = 0.0L;
            for (int k = 0; k < s; k++) sum += e->a[i][k] * x[k][m];
            for (int k = 0; k < s; k++) rate += e->d[i][k] * x[k][m];
            t->A[i * r + m] = dm_weight_of(sum);
            t->rate[i * r + m] = dm_weight_of(rate);
        }
    }
}

/* of the Lagrange polynomials of the nodes, or as the tableau says */
static void find_exact(exact *e, const dm_galerkin *g) {
    const int s = g->s, r = g->q.r;
    long double value[MOST];
    if (!g->tableau) {
        dm_lagrange(value, e->beta, g->node, s, 1.0L);
        for (int i = 0; i < r; i++) dm_lagrange(e->d[i], e->a[i], g->node, s, g->q.c[i]);
        return;
    }
    for (int i = 0; i < r; i++) {
        e->beta[i] = g->q.b[i];
        for (int j = 0; j < s; j++) {
            e->a[i][j] = g->a[i][j];
            e->d[i][j] = i == j;
        }
    }
}

/* All is found in long double and rounded once, to two doubles a weight. */
void dm_stage_table_fill(dm_stage_table *out, const dm_galerkin *g, double *memory) {
    const int s = g->s, r = g->q.r;
    exact e;
    out->s = (uint32_t)s;
    out->r = (uint32_t)r;
    lay_out(out, memory);
    find_exact(&e, g);
    for (int j = 0; j < s; j++) {
        out->beta[j] = dm_weight_of(e.beta[j]);
        out->node[j] = dm_weight_of(g->node[j]);
    }
    for (int i = 0; i < r; i++) {
        out->b[i] = dm_weight_of(g->q.b[i]);
        out->c[i] = dm_weight_of(g->q.c[i]);
        long double reach = g->tableau ? 0.0L : g->q.c[i];
        for (int j = 0; j < s && g->tableau; j++) reach += g->a[i][j];
        out->reach[i] = dm_weight_of(reach);
        for (int j = 0; j < s; j++) {
            out->a[i * s + j] = dm_weight_of(e.a[i][j]);
            out->d[i * s + j] = dm_weight_of(e.d[i][j]);
        }
    }
    separable_part(out, g, &e);
}

/* both halves of numbers[size]: tables have them, too */
static uint32_t add_numbers(double *key, uint32_t count, const long double *numbers, int size) {
    for (int i = 0; i < size; i++) {
        const double top = (double)numbers[i];
        key[count++] = top;
        key[count++] = (double)(numbers[i] - top);
    }
    return count;
}

/* Sizes, nodes, points and weights. */
uint32_t dm_stage_key(double *key, const dm_galerkin *g) {
    const int s = g->s, r = g->q.r;
    key[0] = s;
    key[1] = r;
    uint32_t count = add_numbers(key, 2, g->node, s);
    count = add_numbers(key, count, g->q.c, r);
    return add_numbers(key, count, g->q.b, r);
}

/* A tableau is no function of the key, so it is filled anew. */
void dm_stage_table_find(dm_stage_table *out, const dm_galerkin *g, const dm_model *m,
                         double *memory) {
    static const char maker;
    double key[DM_STAGE_KEY];
    const uint32_t keys = dm_stage_key(key, g),
                   count = (uint32_t)dm_stage_table_size((size_t)g->s, (size_t)g->q.r);
    const double *kept = g->tableau ? NULL : dm_cache_numbers(m, &maker, key, keys);
    if (!kept) {
        dm_stage_table_fill(out, g, memory);
        if (!g->tableau) dm_cache_leave(m, &maker, key, keys, memory, count);
        return;
    }
    out->s = (uint32_t)g->s;
    out->r = (uint32_t)g->q.r;
    lay_out(out, memory);
    memcpy(memory, kept, count * sizeof *memory);
}
