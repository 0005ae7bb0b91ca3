/* constrained_sparsity.c - which entries of the kernels' matrices can differ from zero. */
#include "base/doubles.h"
#include "integ/constrained/constrained_inside.h"

#include <math.h>
#include <string.h>

/* Eight blocks of n x n, k rows of G, 3 l of E, phi_v and phi_q, each with three lists. */
size_t dm_constrained_entries_size(uint32_t n, uint32_t k, uint32_t l) {
    const size_t entries = 8 * (size_t)n * n + (k + 3 * (size_t)l) * n;
    return dm_doubles(3 * entries * sizeof(uint32_t));
}

/* Fixed to be zero when the kernel was compiled: no argument changes it. */
static int is_zero(const dm_kernel *k, size_t i) {
    return k->fixed && k->fixed[i] && k->constant[i] == 0.0;
}

/* outputs first .. first + rows * n - 1 of a kernel, which may be absent; returns what is left
 * of the memory */
static uint32_t *find(dm_constrained_entries *out, const dm_kernel *k, size_t first, uint32_t rows,
                      uint32_t n, uint32_t *memory) {
    const size_t most = (size_t)rows * n;
    *out = (dm_constrained_entries){0, memory, memory + most, memory + 2 * most};
    for (uint32_t i = 0; i < rows && k->eval; i++)
        for (uint32_t j = 0; j < n; j++) {
            if (is_zero(k, first + i * (size_t)n + j)) continue;
            out->entry[out->count] = i * n + j;
            out->row[out->count] = i;
            out->column[out->count++] = j;
        }
    return memory + 3 * most;
}

/* In the order of the kernels' outputs, as mech/model.h and mech/constraints.h give them. */
void dm_constrained_entries_find(dm_constrained *g, double *memory) {
    const dm_constraints *constraints = g->constraints;
    const uint32_t n = g->n, k = g->k, l = g->l;
    const size_t nn = (size_t)n * n;
    uint32_t *at = (uint32_t *)(void *)memory;
    at = find(&g->qq, &g->m->stage, 2 * n, n, n, at);
    at = find(&g->qv, &g->m->stage, 2 * n + nn, n, n, at);
    at = find(&g->vv, &g->m->stage, 2 * n + 2 * nn, n, n, at);
    at = find(&g->mass_vv, &g->m->mass, n, n, n, at);
    at = find(&g->f_q, &constraints->force_curve, n, n, n, at);
    at = find(&g->f_v, &constraints->force_curve, n + nn, n, n, at);
    at = find(&g->r_q, &constraints->reaction, n, n, n, at);
    at = find(&g->r_v, &constraints->reaction, n + nn, n, n, at);
    at = find(&g->G, &constraints->holonomic_kernel, k, k, n, at);
    at = find(&g->E, &constraints->rolling_kernel, l, l, n, at);
    at = find(&g->phi_v, &constraints->rolling_kernel, l + l * (size_t)n, l, n, at);
    find(&g->phi_q, &constraints->rolling_kernel, l + 2 * l * (size_t)n, l, n, at);
}

/* Numbers without meaning, different from each other and from zero, so that no sum of them
 * vanishes. */
static void scatter(const dm_kernel *k, double *out) {
    for (uint32_t i = 0; k->eval && i < k->outputs; i++)
        out[i] = k->fixed && k->fixed[i] ? k->constant[i] : 1.5 + sin(1.0 + i);
}

void dm_constrained_scatter(dm_constrained *g) {
    const dm_constraints *constraints = g->constraints;
    const size_t n = g->n, nn = n * n;
    for (uint32_t i = 0; i < g->table.r; i++) {
        scatter(&g->m->stage, g->curve + i * (2 * n + 3 * nn));
        if (constraints->forced) scatter(&constraints->force_curve, g->drag + i * (n + 2 * nn));
    }
    for (uint32_t k = 0; k <= g->K && g->k + g->l; k++) {
        if (g->k) scatter(&constraints->holonomic_kernel, dm_constrained_holonomic(g, k));
        if (g->l) scatter(&constraints->rolling_kernel, dm_constrained_rolling(g, k));
        if (g->l && k < g->K)
            scatter(&constraints->rolling_kernel, g->roll + k * g->l * (1 + 3 * n));
        scatter(&constraints->reaction, dm_constrained_curved(g, k));
    }
    scatter(&g->m->mass, g->mass);
    for (uint32_t c = 0; c < g->k + g->l; c++) g->row_unit[c] = g->impulse_unit[c] = 1.0;
}

/* The block at (row, column) in the numbering of the unknowns, wherever the matrix keeps it. */
void dm_constrained_add(double *J, const dm_step_matrix *m, uint32_t row, uint32_t column, double w,
                        const double *B, const dm_constrained_entries *e) {
    const size_t *r = m->row + row, *c = m->column + column;
    if (w == 0.0) return;
    for (uint32_t i = 0; i < e->count; i++) J[r[e->row[i]] + c[e->column[i]]] += w * B[e->entry[i]];
}

void dm_constrained_add_transposed(double *J, const dm_step_matrix *m, uint32_t row,
                                   uint32_t column, double w, const double *B,
                                   const dm_constrained_entries *e) {
    const size_t *r = m->row + row, *c = m->column + column;
    if (w == 0.0) return;
    for (uint32_t i = 0; i < e->count; i++) J[r[e->column[i]] + c[e->row[i]]] += w * B[e->entry[i]];
}

void dm_constrained_product(double *y, const double *B, const double *x,
                            const dm_constrained_entries *e) {
    for (uint32_t i = 0; i < e->count; i++) y[e->row[i]] += B[e->entry[i]] * x[e->column[i]];
}
