#include "integ/curve_segment.h"

#include "linalg/lu.h"

#include <string.h>

static size_t doubles(size_t bytes) {
    return (bytes + sizeof(double) - 1) / sizeof(double);
}

static double *take(double **memory, size_t count) {
    double *block = *memory;
    *memory += count;
    return block;
}

size_t dm_segment_work(const dm_curve *c, size_t n) {
    const size_t s = (size_t)c->s, N = 2 * n;
    return s * (dm_field_inputs(n) + n + n * n + n * n + doubles(n * sizeof(uint32_t)) +
                N + N * N + n * N) +
           N + 2 * N * N + (N * N + N) + 4 * n + N + N * N + 2 * n * N + 3 * s * s +
           7 * s;
}

static void place_coefficients(dm_segment *g, double *memory) {
    const size_t s = g->points;
    g->to_q = take(&memory, s * s);
    g->to_v = take(&memory, s * s);
    g->lift = take(&memory, s * s);
    if (!g->curve->lifted) g->lift = NULL;
    g->plus_q = take(&memory, s);
    g->minus_q = take(&memory, s);
    g->weight = take(&memory, s);
    g->plus_lift = take(&memory, s);
    g->minus_lift = take(&memory, s);
    g->plus_v = take(&memory, s);
    g->next_v = take(&memory, s);
}

/* a product of h and a coefficient is rounded once, for both sweeps: momentum maps would drift otherwise */
static void scale(dm_segment *g, double h) {
    const dm_curve *c = g->curve;
    const size_t s = g->points;
    if (g->h == h) return;
    for (size_t i = 0; i < s; i++) {
        for (size_t j = 0; j < i; j++) {
            g->to_q[i * s + j] = h * c->a[i][j];
            g->to_v[i * s + j] = h * c->push[i][j];
            if (g->lift) g->lift[i * s + j] = h * h * c->lift[i][j];
        }
        g->plus_q[i] = h * c->plus[i];
        g->minus_q[i] = h * c->minus[i];
        g->weight[i] = h * c->weight[i];
        g->plus_lift[i] = h * h * c->plus_lift[i];
        g->minus_lift[i] = h * h * c->minus_lift[i];
        g->plus_v[i] = h * c->arrival[i];
        g->next_v[i] = h * (c->arrival[i] - c->departure[i]);
    }
    g->h = h;
}

dm_status dm_segment_open(dm_segment *g, const dm_curve *c, const dm_model *m,
                          double *memory) {
    const size_t n = m->n, s = (size_t)c->s, N = 2 * n;
    *g = (dm_segment){.curve = c, .m = m, .n = m->n, .points = s};
    g->inputs = dm_field_inputs(n);
    const dm_status status = dm_field_build(&g->field, m);
    if (status != DM_OK) return status;
    place_coefficients(g, take(&memory, 3 * s * s + 7 * s));
    g->x = take(&memory, s * g->inputs);
    g->force = take(&memory, s * (n + n * n));
    g->factors = take(&memory, s * n * n);
    g->pivot = (uint32_t *)(void *)take(&memory, s * doubles(n * sizeof(uint32_t)));
    g->gradient = take(&memory, s * N);
    g->pull = take(&memory, N);
    g->second = take(&memory, 2 * N * N);
    g->tangent = take(&memory, s * N * N);
    g->push = take(&memory, s * n * N);
    g->some = take(&memory, N * N + N);
    g->plus = take(&memory, n);
    g->minus = take(&memory, n);
    g->arrival = take(&memory, n);
    g->next = take(&memory, n);
    g->slope = take(&memory, N);
    g->hessian = take(&memory, N * N);
    g->plus_tangent = take(&memory, n * N);
    g->minus_tangent = take(&memory, n * N);
    for (size_t i = 0; i < s; i++)
        dm_kernel_prepare(&g->field.force, g->force + i * g->field.force.outputs);
    dm_kernel_prepare(&g->field.gradient, g->pull);
    return DM_OK;
}

/* y[n] += w x[n] */
static void add(double *y, double w, const double *x, size_t n) {
    if (w == 0.0) return;
    for (size_t i = 0; i < n; i++) y[i] += w * x[i];
}

/* ---- forward ---- */

/* x = M^-1 x at point i */
static void divide_by_mass(const dm_segment *g, size_t i, double *x) {
    const size_t n = g->n;
    const double *inverse = g->m->inverse_mass;
    if (!inverse) {
        dm_lu_solve(x, g->factors + i * n * n, g->pivot + i * n, g->n);
    } else if (g->m->structure & DM_DIAGONAL_MASS) {
        for (size_t k = 0; k < n; k++) x[k] *= inverse[k];
    } else {
        double *y = g->some;
        memset(y, 0, n * sizeof *y);
        for (size_t k = 0; k < n; k++)
            for (size_t l = 0; l < n; l++) y[k] += inverse[k * n + l] * x[l];
        memcpy(x, y, n * sizeof *x);
    }
}

/* acceleration of point i from its q, v, t */
static dm_status accelerate(dm_segment *g, size_t i) {
    const size_t n = g->n;
    double *x = g->x + i * g->inputs, *a = x + 2 * n + 1;
    double *out = g->force + i * g->field.force.outputs;
    dm_kernel_eval(&g->field.force, x, out);
    memcpy(a, out, n * sizeof *a);
    if (g->m->inverse_mass) return DM_OK;
    double *M = g->factors + i * n * n;
    memcpy(M, out + n, n * n * sizeof *M);
    const dm_status status = dm_lu_factor(M, g->pivot + i * n, g->n);
    if (status == DM_OK) divide_by_mass(g, i, a);
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
            dq += g->to_q[row + j] * v[j * width];
            dv += g->to_v[row + j] * a[j * width];
        }
        for (size_t j = 0; g->lift && j < i; j++) dq += g->lift[row + j] * a[j * width];
        x[k] = at->q[k] + dq;
        x[n + k] = at->v[k] + dv;
    }
    x[2 * n] = at->t + at->h * g->curve->c[i];
}

static void find_ends(dm_segment *g, const dm_segment_place *at) {
    const size_t n = g->n;
    for (size_t k = 0; k < n; k++) {
        const double *v = g->x + n + k;
        double plus = 0.0, minus = 0.0, arrival = 0.0, next = 0.0;
        for (size_t i = 0; i < g->points; i++, v += g->inputs) {
            const double a = v[n + 1];
            plus += g->plus_q[i] * v[0];
            minus += g->minus_q[i] * v[0];
            if (g->lift) {
                plus += g->plus_lift[i] * a;
                minus += g->minus_lift[i] * a;
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

dm_status dm_segment_run(dm_segment *g, const dm_segment_place *at) {
    scale(g, at->h);
    for (size_t i = 0; i < g->points; i++) {
        place_point(g, at, i);
        const dm_status status = accelerate(g, i);
        if (status != DM_OK) return status;
    }
    find_ends(g, at);
    return DM_OK;
}

double dm_segment_action(const dm_segment *g) {
    double sum = 0.0, L = 0.0;
    dm_kernel_prepare(&g->m->value, &L);
    for (size_t i = 0; i < g->points; i++) {
        dm_kernel_eval(&g->m->value, g->x + i * g->inputs, &L);
        sum += g->weight[i] * L;
    }
    return sum;
}

/* ---- back ---- */

/* k_i[2n]: what F_i is pulled back by, from the ends and the points that it moves */
static void pull_back(dm_segment *g, double *k, size_t i, const double *p1,
                      const double *p0) {
    const size_t n = g->n, N = 2 * n, s = g->points;
    for (size_t l = 0; l < n; l++) {
        const double *y = g->gradient + l, back = p0 ? p0[l] : 0.0;
        double kq = g->minus_q[i] * back - g->plus_q[i] * p1[l], kv = 0.0;
        for (size_t j = i + 1; j < s; j++) {
            kq += g->to_q[j * s + i] * y[j * N];
            kv += g->to_v[j * s + i] * y[j * N + n];
        }
        if (g->lift) kv += g->minus_lift[i] * back - g->plus_lift[i] * p1[l];
        for (size_t j = i + 1; g->lift && j < s; j++) kv += g->lift[j * s + i] * y[j * N];
        k[l] = kq;
        k[n + l] = kv;
    }
}

void dm_segment_gradient(dm_segment *g, const double *p1, const double *p0) {
    const size_t n = g->n;
    double *k = g->hessian; /* not yet in use */
    for (size_t l = 0; l < 2 * n; l++) g->slope[l] = 0.0;
    for (size_t i = g->points; i-- > 0;) {
        double *x = g->x + i * g->inputs, *u = x + 3 * n + 1;
        double *y = g->gradient + i * 2 * n;
        pull_back(g, k, i, p1, p0);
        for (size_t l = 0; l < n; l++) u[l] = k[n + l];
        divide_by_mass(g, i, u);
        x[4 * n + 1] = g->weight[i];
        dm_kernel_eval(&g->field.gradient, x, g->pull);
        for (size_t l = 0; l < n; l++) {
            y[l] = g->pull[l];
            y[n + l] = g->pull[n + l] + k[l];
            g->slope[l] += y[l];
            g->slope[n + l] += y[n + l];
        }
    }
}

/* T_i = dY_i/dy */
static void place_tangent(dm_segment *g, size_t i) {
    const size_t n = g->n, N = 2 * n, row = i * g->points;
    double *T = g->tangent + i * N * N;
    memset(T, 0, N * N * sizeof *T);
    for (size_t j = 0; j < i; j++) {
        add(T, g->to_q[row + j], g->tangent + j * N * N + n * N, n * N);
        add(T + n * N, g->to_v[row + j], g->push + j * n * N, n * N);
        if (g->lift) add(T, g->lift[row + j], g->push + j * n * N, n * N);
    }
    for (size_t k = 0; k < N; k++) T[k * N + k] += 1.0;
}

/* columns first .. N-1 of C[rows*N] = A[rows*N] B[N*N] */
static void multiply(double *C, const double *A, const double *B, size_t rows, size_t N,
                     size_t first) {
    for (size_t i = 0; i < rows; i++) {
        double *c = C + i * N;
        for (size_t j = first; j < N; j++) c[j] = 0.0;
        for (size_t k = 0; k < N; k++) {
            const double a = A[i * N + k], *b = B + k * N;
            if (a == 0.0) continue;
            for (size_t j = first; j < N; j++) c[j] += a * b[j];
        }
    }
}

/* row^T = M^-1 row^T for the columns of E_y[n*N] at point i */
static void push_columns(dm_segment *g, size_t i, double *E) {
    const size_t n = g->n, N = 2 * n;
    double *column = g->some + N * N;
    for (size_t j = 0; j < N; j++) {
        for (size_t k = 0; k < n; k++) column[k] = E[k * N + j];
        divide_by_mass(g, i, column);
        for (size_t k = 0; k < n; k++) E[k * N + j] = column[k];
    }
}

/* W += B^T a_y + (B^T a_y)^T */
static void add_mass_terms(double *W, const double *B, const double *a_y, size_t n) {
    const size_t N = 2 * n;
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < N; i++)
            for (size_t j = 0; j < N; j++)
                W[i * N + j] +=
                    B[k * N + i] * a_y[k * N + j] + B[k * N + j] * a_y[k * N + i];
}

/* columns first .. N-1 of hessian += T^T W T */
static void add_second(dm_segment *g, const double *W, const double *T, size_t first) {
    const size_t N = 2 * (size_t)g->n;
    multiply(g->some, W, T, N, N, first);
    for (size_t k = 0; k < N; k++) {
        const double *row = g->some + k * N;
        for (size_t i = 0; i < N; i++) {
            const double t = T[k * N + i];
            if (t == 0.0) continue;
            double *out = g->hessian + i * N;
            for (size_t j = first; j < N; j++) out[j] += t * row[j];
        }
    }
}

/* what point i adds to the tangents of the ends */
static void add_ends(dm_segment *g, size_t i, const double *dv, const double *da) {
    const size_t size = 2 * (size_t)g->n * g->n;
    add(g->plus_tangent, g->plus_q[i], dv, size);
    add(g->minus_tangent, g->minus_q[i], dv, size);
    if (!g->lift) return;
    add(g->plus_tangent, g->plus_lift[i], da, size);
    add(g->minus_tangent, g->minus_lift[i], da, size);
}

void dm_segment_hessian(dm_segment *g, uint32_t first) {
    const size_t n = g->n, N = 2 * n;
    memset(g->hessian, 0, N * N * sizeof *g->hessian);
    memset(g->plus_tangent, 0, n * N * sizeof *g->plus_tangent);
    memset(g->minus_tangent, 0, n * N * sizeof *g->minus_tangent);
    for (size_t i = 0; i < g->points; i++) {
        double *T = g->tangent + i * N * N, *W = g->second, *a_y = W + N * N;
        place_tangent(g, i);
        dm_kernel_prepare(&g->field.curve, g->second); /* a_y is changed in place */
        dm_kernel_eval(&g->field.curve, g->x + i * g->inputs, g->second);
        push_columns(g, i, a_y);
        if (!g->m->inverse_mass) add_mass_terms(W, a_y + n * N, a_y, n);
        multiply(g->push + i * n * N, a_y, T, n, N, 0);
        add_second(g, W, T, first);
        add_ends(g, i, T + n * N, g->push + i * n * N);
    }
}
