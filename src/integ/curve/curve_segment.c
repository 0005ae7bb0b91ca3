#include "integ/curve/curve_segment.h"

#include "base/doubles.h"
#include "linalg/lu.h"

#include <math.h>
#include <string.h>

/* Of two doubles what is added to positions and velocities; the rest one. */
static size_t coefficients(size_t s) {
    return 2 * (3 * s * s + 4 * s) + 3 * s;
}

/* In the order of dm_segment_open: what every point has, then what the segment has once. */
size_t dm_segment_work(const dm_curve *c, const dm_model *m) {
    const size_t s = (size_t)c->s, n = m->n, N = 2 * n, M = dm_field_rows(m);
    if (c->recipe) return dm_written_segment_work(c, m);
    const size_t inputs = dm_field_inputs(m), controls = inputs - N - 2 - 2 * M;
    return s * (inputs + M + 2 * M * M + dm_doubles(M * sizeof(uint32_t)) + N + N * N + n * N) + N +
           dm_field_curve(m) + (N * N + 2 * M) + controls + 4 * n + N + N * N + 2 * n * N +
           coefficients(s) + 4 * n * N + M * N + inputs;
}

/* They are filled when the first step tells its h. */
static void place_coefficients(dm_segment *g, double *memory) {
    const size_t s = g->points;
    dm_weight **const pairs[] = {&g->plus_q, &g->minus_q, &g->plus_lift, &g->minus_lift};
    dm_weight **const squares[] = {&g->to_q, &g->to_v, &g->lift};
    for (size_t i = 0; i < 3; i++) *squares[i] = (dm_weight *)(void *)dm_take(&memory, 2 * s * s);
    for (size_t i = 0; i < 4; i++) *pairs[i] = (dm_weight *)(void *)dm_take(&memory, 2 * s);
    if (!g->curve->lifted) g->lift = NULL;
    g->weight = dm_take(&memory, s);
    g->plus_v = dm_take(&memory, s);
    g->next_v = dm_take(&memory, s);
}

/* A product of h and a coefficient is rounded once, for both sweeps, and kept in two parts, since
 * one product by a decimal number has roundings with a mean: momentum maps would drift. */
static void scale(dm_segment *g, double h) {
    const dm_curve *c = g->curve;
    const size_t s = g->points;
    if (g->h == h) return;
    for (size_t i = 0; i < s; i++) {
        for (size_t j = 0; j < i; j++) {
            g->to_q[i * s + j] = dm_weight_of(h * c->a[i][j]);
            g->to_v[i * s + j] = dm_weight_of(h * c->push[i][j]);
            if (g->lift) g->lift[i * s + j] = dm_weight_of(h * h * c->lift[i][j]);
        }
        g->plus_q[i] = dm_weight_of(h * c->plus[i]);
        g->minus_q[i] = dm_weight_of(h * c->minus[i]);
        g->weight[i] = h * c->weight[i];
        g->plus_lift[i] = dm_weight_of(h * h * c->plus_lift[i]);
        g->minus_lift[i] = dm_weight_of(h * h * c->minus_lift[i]);
        g->plus_v[i] = h * c->arrival[i];
        g->next_v[i] = h * (c->arrival[i] - c->departure[i]);
    }
    g->h = h;
}

/* Kernels, arrays, and the outputs that never vary. */
dm_status dm_segment_open(dm_segment *g, const dm_curve *c, const dm_model *m, double *memory) {
    const size_t n = m->n, s = (size_t)c->s, N = 2 * n, M = dm_field_rows(m);
    *g = (dm_segment){.curve = c, .m = m, .n = m->n, .points = s, .h = NAN};
    dm_field_shape(&g->field, m);
    if (c->recipe) return dm_written_segment_open(g, memory);
    g->inputs = dm_field_inputs(m);
    const dm_status status = dm_field_build(&g->field, m);
    if (status != DM_OK) return status;
    place_coefficients(g, dm_take(&memory, coefficients(s)));
    g->x = dm_take(&memory, s * g->inputs);
    g->force = dm_take(&memory, s * (M + M * M));
    g->factors = dm_take(&memory, s * M * M);
    g->pivot = (uint32_t *)(void *)dm_take(&memory, s * dm_doubles(M * sizeof(uint32_t)));
    g->gradient = dm_take(&memory, s * N);
    g->pull = dm_take(&memory, N);
    g->second = dm_take(&memory, dm_field_curve(m));
    g->tangent = dm_take(&memory, s * N * N);
    g->push = dm_take(&memory, s * n * N);
    g->some = dm_take(&memory, N * N + 2 * M);
    g->held = dm_take(&memory, g->inputs - N - 2 - 2 * M);
    g->plus = dm_take(&memory, n);
    g->minus = dm_take(&memory, n);
    g->arrival = dm_take(&memory, n);
    g->next = dm_take(&memory, n);
    g->slope = dm_take(&memory, N);
    g->hessian = dm_take(&memory, N * N);
    g->plus_tangent = dm_take(&memory, n * N);
    g->minus_tangent = dm_take(&memory, n * N);
    g->arrival_tangent = dm_take(&memory, n * N);
    g->departure_tangent = dm_take(&memory, n * N);
    g->momentum = dm_take(&memory, n * N);
    g->change = dm_take(&memory, n * N);
    g->a_y = dm_take(&memory, M * N);
    g->end = dm_take(&memory, g->inputs);
    for (size_t i = 0; i < s; i++)
        dm_kernel_prepare(&g->field.force, g->force + i * g->field.force.outputs);
    dm_kernel_prepare(&g->field.gradient, g->pull);
    dm_kernel_prepare(&g->field.momentum, g->momentum);
    return DM_OK;
}

/* ---- forward ---- */

/* x = M^-1 x with the numbers of a constant mass */
static void divide_by_mass(const dm_segment *g, double *x) {
    const size_t n = g->n;
    const double *inverse = g->m->inverse_mass;
    if (g->m->structure & DM_DIAGONAL_MASS) {
        for (size_t k = 0; k < n; k++) x[k] *= inverse[k];
    } else {
        double *y = g->some;
        memset(y, 0, n * sizeof *y);
        for (size_t k = 0; k < n; k++)
            for (size_t l = 0; l < n; l++) y[k] += inverse[k * n + l] * x[l];
        memcpy(x, y, n * sizeof *x);
    }
}

void dm_segment_divide(const dm_segment *g, size_t i, double *x) {
    const size_t N = g->field.N;
    if (g->field.solved)
        divide_by_mass(g, x);
    else
        dm_lu_solve(x, g->factors + i * N * N, g->pivot + i * N, g->field.N);
}

/* Given reactions make S another matrix than its transpose. */
void dm_segment_divide_transposed(const dm_segment *g, size_t i, double *x) {
    const size_t N = g->field.N;
    if (N == g->n)
        dm_segment_divide(g, i, x);
    else
        dm_lu_solve_transposed(x, g->factors + i * N * N, g->pivot + i * N, g->field.N);
}

/* acceleration and multipliers of point i from its q, v, t */
static dm_status accelerate(dm_segment *g, size_t i) {
    const size_t N = g->field.N;
    double *x = g->x + i * g->inputs, *w = x + 2 * g->n + 1;
    double *out = g->force + i * g->field.force.outputs;
    dm_kernel_eval(&g->field.force, x, out);
    memcpy(w, out, N * sizeof *w);
    if (g->field.solved) return DM_OK;
    double *S = g->factors + i * N * N;
    memcpy(S, out + N, N * N * sizeof *S);
    const dm_status status = dm_lu_factor(S, g->pivot + i * N, g->field.N);
    if (status == DM_OK) dm_segment_divide(g, i, w);
    return status;
}

/* Q_i = q + sum_j (h a_ij V_j + h^2 lift_ij A_j), V_i = v + sum_j h push_ij A_j */
static void place_point(dm_segment *g, const dm_segment_place *at, size_t i) {
    const size_t n = g->n, width = g->inputs, row = i * g->points;
    double *x = g->x + i * width;
    for (size_t k = 0; k < n; k++) {
        const double *v = g->x + n + k, *a = v + n + 1;
        double dq = at->shift ? at->shift[k] : 0.0, dv = 0.0;
        for (size_t j = 0; j < i; j++) {
            dq += dm_weighted(g->to_q[row + j], v[j * width]);
            dv += dm_weighted(g->to_v[row + j], a[j * width]);
        }
        for (size_t j = 0; g->lift && j < i; j++) dq += dm_weighted(g->lift[row + j], a[j * width]);
        x[k] = at->q[k] + dq;
        x[n + k] = at->v[k] + dv;
    }
    x[2 * n] = at->t + at->h * g->curve->c[i];
    const size_t known = 2 * n + 2 + 2 * (size_t)g->field.N;
    if (width > known) memcpy(x + known, g->held, (width - known) * sizeof *x);
}

/* Sums over the points, from the first one on: the order is that of every backend. */
static void find_ends(dm_segment *g, const dm_segment_place *at) {
    const size_t n = g->n;
    for (size_t k = 0; k < n; k++) {
        const double *v = g->x + n + k;
        double plus = 0.0, minus = 0.0, arrival = 0.0, next = 0.0;
        for (size_t i = 0; i < g->points; i++, v += g->inputs) {
            const double a = v[n + 1];
            plus += dm_weighted(g->plus_q[i], v[0]);
            minus += dm_weighted(g->minus_q[i], v[0]);
            if (g->lift) {
                plus += dm_weighted(g->plus_lift[i], a);
                minus += dm_weighted(g->minus_lift[i], a);
            }
            arrival += g->plus_v[i] * a;
            next += g->next_v[i] * a;
        }
        g->plus[k] = plus;
        g->minus[k] = minus;
        g->arrival[k] = at->v[k] + arrival;
        g->next[k] = at->v[k] + next;
    }
}

/* Point by point, as an explicit method goes. */
dm_status dm_segment_run(dm_segment *g, const dm_segment_place *at) {
    if (g->curve->recipe) return dm_written_segment_run(g, at);
    scale(g, at->h);
    for (size_t i = 0; i < g->points; i++) {
        place_point(g, at, i);
        const dm_status status = accelerate(g, i);
        if (status != DM_OK) return status;
    }
    find_ends(g, at);
    return DM_OK;
}

/* Ld = h sum weight_i L(Y_i), at the points where they are. */
double dm_segment_action(const dm_segment *g) {
    if (g->curve->recipe) return dm_written_segment_action(g);
    double sum = 0.0, L = 0.0;
    dm_kernel_prepare(&g->m->value, &L);
    for (size_t i = 0; i < g->points; i++) {
        dm_kernel_eval(&g->m->value, g->x + i * g->inputs, &L);
        sum += g->weight[i] * L;
    }
    return sum;
}

/* h weight mu of every point, shared by both ends as its time tells. */
void dm_segment_impulses(const dm_segment *g, double *out) {
    const size_t l = g->field.rolling, first = 2 * (size_t)g->n + 1 + g->field.N - l;
    if (g->curve->recipe) {
        dm_written_segment_impulses(g, out);
        return;
    }
    for (size_t c = 0; c < 2 * l; c++) out[c] = 0.0;
    for (size_t i = 0; i < g->points; i++) {
        const double part = 1.0 - g->curve->bias + g->curve->c[i];
        for (size_t c = 0; c < l; c++) {
            const double impulse = g->weight[i] * g->x[i * g->inputs + first + c];
            out[c] += (1.0 - part) * impulse;
            out[l + c] += part * impulse;
        }
    }
}

/* ---- back ---- */

/* k_i[2n]: what F_i is pulled back by, from the ends and the points that it moves */
static void pull_back(dm_segment *g, double *k, size_t i, const double *p1, const double *p0) {
    const size_t n = g->n, N = 2 * n, s = g->points;
    for (size_t l = 0; l < n; l++) {
        const double *y = g->gradient + l, back = p0 ? p0[l] : 0.0;
        double kq = dm_weighted(g->minus_q[i], back) - dm_weighted(g->plus_q[i], p1[l]), kv = 0.0;
        for (size_t j = i + 1; j < s; j++) {
            kq += dm_weighted(g->to_q[j * s + i], y[j * N]);
            kv += dm_weighted(g->to_v[j * s + i], y[j * N + n]);
        }
        if (g->lift)
            kv += dm_weighted(g->minus_lift[i], back) - dm_weighted(g->plus_lift[i], p1[l]);
        for (size_t j = i + 1; g->lift && j < s; j++)
            kv += dm_weighted(g->lift[j * s + i], y[j * N]);
        k[l] = kq;
        k[n + l] = kv;
    }
}

/* From the last point to the first: what a point is pulled back by is known when those behind it
 * are done. U = S^-T of the part that meets the acceleration. */
void dm_segment_gradient(dm_segment *g, const double *p1, const double *p0) {
    const size_t n = g->n, N = g->field.N;
    double *k = g->hessian; /* not yet in use */
    if (g->curve->recipe) {
        dm_written_segment_gradient(g, p1, p0);
        return;
    }
    for (size_t l = 0; l < 2 * n; l++) g->slope[l] = 0.0;
    for (size_t i = g->points; i-- > 0;) {
        double *x = g->x + i * g->inputs, *u = x + 2 * n + 1 + N;
        double *y = g->gradient + i * 2 * n;
        pull_back(g, k, i, p1, p0);
        for (size_t l = 0; l < N; l++) u[l] = l < n ? k[n + l] : 0.0;
        dm_segment_divide_transposed(g, i, u);
        u[N] = g->weight[i];
        dm_kernel_eval(&g->field.gradient, x, g->pull);
        for (size_t l = 0; l < n; l++) {
            y[l] = g->pull[l];
            y[n + l] = g->pull[n + l] + k[l];
            g->slope[l] += y[l];
            g->slope[n + l] += y[n + l];
        }
    }
}
