/* euler.c - rates of the vorticity, and the implicit midpoint rule. */
#include "field/flow/euler.h"

#include "field/flow/anderson.h"
#include "numbers/compensated.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* arrays of a state that the step works on, beside those of the iteration */
enum { ARRAYS = 3 };

/* weights of a state, areas of components */
static void find_weights(dm_euler *e) {
    double whole = 0.0;
    for (uint32_t i = 0; i < e->vertices; i++) {
        e->area[e->component[i]] += e->mass[i];
        e->weight[i] = e->mass[i];
        whole += e->mass[i];
    }
    for (uint32_t i = e->vertices; i < e->size; i++) e->weight[i] = 1.0 / whole;
}

/* One block for what lasts, one for work; area[0] is of vertices whose means nobody asks for. */
dm_status dm_euler_open(dm_euler *e, dm_arena *arena) {
    e->size = e->vertices + e->handles.count;
    const size_t n = (size_t)e->size + 1, k = (size_t)e->components + 1;
    const size_t all = 5 * n + 2 * k + 2 * (size_t)e->holes.count;
    double *block = dm_arena_take(arena, all * sizeof *block);
    e->work = dm_arena_take(arena, (ARRAYS * n + dm_anderson_work(e->size)) * sizeof *block);
    if (!block || !e->work) return DM_NO_MEMORY;
    memset(block, 0, all * sizeof *block);
    e->w = block, e->low = block + n, e->psi = block + 2 * n, e->rate = block + 3 * n;
    e->weight = block + 4 * n, e->mean = block + 5 * n, e->area = e->mean + k;
    e->holes.c = e->area + k, e->holes.gap = e->holes.c + e->holes.count;
    find_weights(e);
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

/* eta_k on two edges of triangle t */
static const double *eta_at(const dm_euler *e, uint32_t k, uint32_t t) {
    return e->handles.eta + 2 * ((size_t)k * e->triangles + t);
}

/* beta on the edges (a, b) and (a, c) of triangle t with corners v */
static void find_beta(const dm_euler *e, const double *b, uint32_t t, double beta[2]) {
    const uint32_t *v = e->corner + 3 * (size_t)t;
    beta[0] = e->psi[v[1]] - e->psi[v[0]];
    beta[1] = e->psi[v[2]] - e->psi[v[0]];
    for (uint32_t k = 0; k < e->handles.count; k++) {
        beta[0] += b[k] * eta_at(e, k, t)[0];
        beta[1] += b[k] * eta_at(e, k, t)[1];
    }
}

/* b_k' gets what triangle t, where w has this mean, adds to it */
static void push_handles(dm_euler *e, uint32_t t, double mean, const double beta[2]) {
    const double half = 0.5 * e->sign[t] * mean;
    for (uint32_t k = 0; k < e->handles.count; k++) {
        const double *eta = eta_at(e, k, t);
        e->rate[e->vertices + k] += half * (eta[0] * beta[1] - eta[1] * beta[0]);
    }
}

/* A third of (beta ^ d x) of every triangle, [beta_ab (x_c - x_a) - beta_ac (x_b - x_a)] / 2, is
 * taken from its corners. A mean without psi is no vorticity of the flow, and drives no b. */
dm_status dm_euler_rate(dm_euler *e, const double *x) {
    const dm_status status = find_stream(e, x);
    if (status != DM_OK) return status;
    memset(e->rate, 0, e->size * sizeof *e->rate);
    for (uint32_t t = 0; t < e->triangles; t++) {
        const uint32_t *v = e->corner + 3 * (size_t)t;
        double beta[2];
        find_beta(e, x + e->vertices, t, beta);
        const double wedge = beta[0] * (x[v[2]] - x[v[0]]) - beta[1] * (x[v[1]] - x[v[0]]);
        const double part = e->sign[t] * wedge / 6.0;
        for (int j = 0; j < 3; j++) e->rate[v[j]] -= part;
        const double mean = (x[v[0]] + x[v[1]] + x[v[2]]) / 3.0;
        push_handles(e, t, mean - e->mean[e->component[v[0]]], beta);
    }
    for (uint32_t i = 0; i < e->vertices; i++) e->rate[i] /= e->mass[i];
    return DM_OK;
}

/* sum of *v x^2, and of b^2 / area */
static double square(const dm_euler *e, const double *x) {
    double sum = 0.0, low = 0.0;
    for (uint32_t i = 0; i < e->size; i++) dm_sum_add(&sum, &low, e->weight[i] * x[i] * x[i]);
    return sum + low;
}

/* y = (h / 2) rate at w + x: a solution x = y is half of the step. *change: |y - x| */
static dm_status sweep(dm_euler *e, double h, double *y, const double *x, double *change) {
    double *at = e->work + 2 * (size_t)e->size;
    for (uint32_t i = 0; i < e->size; i++) at[i] = e->w[i] + x[i];
    const dm_status status = dm_euler_rate(e, at);
    if (status != DM_OK) return status;
    for (uint32_t i = 0; i < e->size; i++) {
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
    dm_anderson_begin(&a, e->work + ARRAYS * (size_t)e->size, e->size, e->weight, &x, &y);
    for (*sweeps = 1; *sweeps <= DM_EULER_SWEEPS; ++*sweeps) {
        const dm_status status = sweep(e, h, y, x, &change);
        if (status != DM_OK) return status;
        if (change <= 0.25 * rounding || (change <= 16.0 * rounding && change >= before)) break;
        before = change;
        dm_anderson_next(&a);
    }
    if (*sweeps > DM_EULER_SWEEPS) return DM_NO_CONVERGENCE;
    for (uint32_t i = 0; i < e->size; i++) dm_sum_add(e->w + i, e->low + i, 2.0 * y[i]);
    return DM_OK;
}

/* |beta|^2 = -psi . div grad psi + the sum of c_i circulation_i, by Green's formula, and of b^2 */
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
    for (uint32_t i = e->vertices; i < e->size; i++) dm_sum_add(sum, low, 0.5 * e->w[i] * e->w[i]);
    for (int k = 0; k < 3; k++) out[k] = sum[k] + low[k];
    return DM_OK;
}
