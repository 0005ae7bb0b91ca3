/* euler.c - rates of the vorticity, and the implicit midpoint rule. */
#include "field/flow/euler.h"

#include "field/flow/anderson.h"
#include "numbers/compensated.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* arrays of vertices that the step works on, beside those of the iteration */
enum { ARRAYS = 3 };

/* One block for what lasts, one for work; area[0] is of vertices whose means nobody asks for. */
dm_status dm_euler_open(dm_euler *e, dm_arena *arena) {
    const size_t n = (size_t)e->vertices + 1, k = (size_t)e->components + 1;
    const size_t all = 4 * n + 2 * k + 2 * (size_t)e->holes.count;
    double *block = dm_arena_take(arena, all * sizeof *block);
    e->work = dm_arena_take(arena, (ARRAYS * n + dm_anderson_work(e->vertices)) * sizeof *block);
    if (!block || !e->work) return DM_NO_MEMORY;
    memset(block, 0, all * sizeof *block);
    e->w = block, e->low = block + n, e->psi = block + 2 * n, e->rate = block + 3 * n;
    e->mean = block + 4 * n, e->area = e->mean + k;
    e->holes.c = e->area + k, e->holes.gap = e->holes.c + e->holes.count;
    for (uint32_t i = 0; i < e->vertices; i++) e->area[e->component[i]] += e->mass[i];
    return DM_OK;
}

/* mean[component] of x; where psi is held nothing is taken away */
static void find_means(dm_euler *e, const double *x) {
    for (uint32_t c = 0; c <= e->components; c++) e->mean[c] = 0.0;
    for (uint32_t i = 0; i < e->vertices; i++)
        if (e->component[i]) e->mean[e->component[i]] += e->mass[i] * x[i];
    for (uint32_t c = 1; c <= e->components; c++) e->mean[c] /= e->area[c];
}

/* psi, 0 on all loops so far, gets what the holes add to it */
static void add_holes(dm_euler *e, const double *x) {
    const dm_euler_holes *at = &e->holes;
    const size_t n = e->vertices;
    for (uint32_t i = 0; i < at->count; i++) {
        at->gap[i] = at->circulation[i];
        for (size_t v = 0; v < n; v++) at->gap[i] -= at->g[i * n + v] * e->mass[v] * x[v];
    }
    for (uint32_t i = 0; i < at->count; i++) {
        at->c[i] = 0.0;
        for (uint32_t j = 0; j < at->count; j++)
            at->c[i] += at->inverse[(size_t)i * at->count + j] * at->gap[j];
        for (size_t v = 0; v < n; v++) e->psi[v] += at->c[i] * at->g[i * n + v];
    }
}

/* div grad psi = x without its means */
static dm_status find_stream(dm_euler *e, const double *x) {
    double *load = e->work, *solution = load + e->vertices;
    find_means(e, x);
    for (uint32_t k = 0; k < e->unknowns; k++) {
        const uint32_t i = e->free[k];
        load[k] = -e->mass[i] * (x[i] - e->mean[e->component[i]]);
    }
    const dm_status status = e->unknowns ? e->poisson.solve(e->poisson.of, solution, load) : DM_OK;
    if (status != DM_OK) return status;
    memset(e->psi, 0, e->vertices * sizeof *e->psi);
    for (uint32_t k = 0; k < e->unknowns; k++) e->psi[e->free[k]] = solution[k];
    add_holes(e, x);
    return DM_OK;
}

/* A third of (d psi ^ d x) of every triangle, [(psi_b - psi_a)(x_c - x_a) - (psi_c - psi_a)
 * (x_b - x_a)] / 2, is taken from its corners. */
dm_status dm_euler_rate(dm_euler *e, const double *x) {
    const double *psi = e->psi;
    const dm_status status = find_stream(e, x);
    if (status != DM_OK) return status;
    memset(e->rate, 0, e->vertices * sizeof *e->rate);
    for (uint32_t t = 0; t < e->triangles; t++) {
        const uint32_t *v = e->corner + 3 * (size_t)t;
        const double wedge = (psi[v[1]] - psi[v[0]]) * (x[v[2]] - x[v[0]]) -
                             (psi[v[2]] - psi[v[0]]) * (x[v[1]] - x[v[0]]);
        const double part = e->sign[t] * wedge / 6.0;
        for (int j = 0; j < 3; j++) e->rate[v[j]] -= part;
    }
    for (uint32_t i = 0; i < e->vertices; i++) e->rate[i] /= e->mass[i];
    return DM_OK;
}

/* sum of *v x^2 */
static double square(const dm_euler *e, const double *x) {
    double sum = 0.0, low = 0.0;
    for (uint32_t i = 0; i < e->vertices; i++) dm_sum_add(&sum, &low, e->mass[i] * x[i] * x[i]);
    return sum + low;
}

/* y = (h / 2) rate at w + x: a solution x = y is half of the step. *change: |y - x| */
static dm_status sweep(dm_euler *e, double h, double *y, const double *x, double *change) {
    double *at = e->work + 2 * (size_t)e->vertices;
    for (uint32_t i = 0; i < e->vertices; i++) at[i] = e->w[i] + x[i];
    const dm_status status = dm_euler_rate(e, at);
    if (status != DM_OK) return status;
    for (uint32_t i = 0; i < e->vertices; i++) {
        y[i] = 0.5 * h * e->rate[i];
        at[i] = y[i] - x[i];
    }
    *change = e->change = sqrt(square(e, at));
    return isfinite(*change) ? DM_OK : DM_NO_CONVERGENCE; /* the iteration ran away */
}

/* To round-off: until the change is as small as rounding of w, or small and no longer less. */
dm_status dm_euler_step(dm_euler *e, double h, uint32_t *sweeps) {
    double *x, *y, change, before = INFINITY;
    const double size = sqrt(square(e, e->w)), rounding = DBL_EPSILON * size;
    dm_anderson a;
    dm_anderson_begin(&a, e->work + ARRAYS * (size_t)e->vertices, e->vertices, e->mass, &x, &y);
    for (*sweeps = 1; *sweeps <= DM_EULER_SWEEPS; ++*sweeps) {
        const dm_status status = sweep(e, h, y, x, &change);
        if (status != DM_OK) return status;
        if (change <= 0.25 * rounding || (change <= 16.0 * rounding && change >= before)) break;
        before = change;
        dm_anderson_next(&a);
    }
    if (*sweeps > DM_EULER_SWEEPS) return DM_NO_CONVERGENCE;
    for (uint32_t i = 0; i < e->vertices; i++) dm_sum_add(e->w + i, e->low + i, 2.0 * y[i]);
    return DM_OK;
}

/* |d psi|^2 = -psi . div grad psi + the sum of c_i circulation_i, by Green's formula */
dm_status dm_euler_integrals(dm_euler *e, double out[3]) {
    double sum[3] = {0.0}, low[3] = {0.0};
    const dm_status status = find_stream(e, e->w);
    if (status != DM_OK) return status;
    for (uint32_t i = 0; i < e->vertices; i++) {
        const double w = e->w[i], mass = e->mass[i];
        dm_sum_add(sum, low, -0.5 * mass * e->psi[i] * (w - e->mean[e->component[i]]));
        dm_sum_add(sum + 1, low + 1, 0.5 * mass * w * w);
        dm_sum_add(sum + 2, low + 2, mass * w);
    }
    for (uint32_t i = 0; i < e->holes.count; i++)
        dm_sum_add(sum, low, 0.5 * e->holes.c[i] * e->holes.circulation[i]);
    for (int k = 0; k < 3; k++) out[k] = sum[k] + low[k];
    return DM_OK;
}
