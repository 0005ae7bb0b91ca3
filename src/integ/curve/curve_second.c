/* curve_second.c - the second derivatives of G on a segment: exact, or as the flow of the field
 * would have them. */
#include "integ/curve/curve_segment.h"

#include <string.h>

/* y[n] += w x[n] */
static void add(double *y, double w, const double *x, size_t n) {
    if (w == 0.0) return;
    for (size_t i = 0; i < n; i++) y[i] += w * x[i];
}

/* T_i = dY_i/dy */
static void place_tangent(dm_segment *g, size_t i) {
    const size_t n = g->n, N = 2 * n, row = i * g->points;
    double *T = g->tangent + i * N * N;
    memset(T, 0, N * N * sizeof *T);
    for (size_t j = 0; j < i; j++) {
        add(T, dm_weight_double(g->to_q[row + j]), g->tangent + j * N * N + n * N, n * N);
        add(T + n * N, dm_weight_double(g->to_v[row + j]), g->push + j * n * N, n * N);
        if (g->lift) add(T, dm_weight_double(g->lift[row + j]), g->push + j * n * N, n * N);
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

/* row^T = S^-1 row^T for the columns of R_y[M*2n] at point i */
static void push_columns(dm_segment *g, size_t i, double *R) {
    const size_t M = g->field.N, N = 2 * (size_t)g->n;
    double *column = g->some + N * N;
    for (size_t j = 0; j < N; j++) {
        for (size_t k = 0; k < M; k++) column[k] = R[k * N + j];
        dm_segment_divide(g, i, column);
        for (size_t k = 0; k < M; k++) R[k * N + j] = column[k];
    }
}

/* W += B^T w_y + (B^T w_y)^T for B, w_y[rows*N] */
static void add_mass_terms(double *W, const double *B, const double *w_y, size_t rows, size_t N) {
    for (size_t k = 0; k < rows; k++)
        for (size_t i = 0; i < N; i++)
            for (size_t j = 0; j < N; j++)
                W[i * N + j] += B[k * N + i] * w_y[k * N + j] + B[k * N + j] * w_y[k * N + i];
}

/* W += (l E^T mu_y, 0), as work sees the multipliers of rolling constraints; bend[n*rolling] */
static void add_bend(const dm_segment *g, double *W, const double *bend, const double *w_y) {
    const size_t n = g->n, N = 2 * n, l = g->field.rolling;
    const double *mu_y = w_y + (g->field.N - l) * N;
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < l; c++) add(W + i * N, bend[i * l + c], mu_y + c * N, N);
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
    add(g->plus_tangent, dm_weight_double(g->plus_q[i]), dv, size);
    add(g->minus_tangent, dm_weight_double(g->minus_q[i]), dv, size);
    if (!g->lift) return;
    add(g->plus_tangent, dm_weight_double(g->plus_lift[i]), da, size);
    add(g->minus_tangent, dm_weight_double(g->minus_lift[i]), da, size);
}

/* Forward again, with the tangents of the points: by then all pulls are known, and every point adds
 * its own term. */
void dm_segment_hessian(dm_segment *g, uint32_t first) {
    const size_t n = g->n, N = 2 * n, M = g->field.N;
    if (g->curve->recipe) {
        dm_written_segment_hessian(g);
        return;
    }
    memset(g->hessian, 0, N * N * sizeof *g->hessian);
    memset(g->plus_tangent, 0, n * N * sizeof *g->plus_tangent);
    memset(g->minus_tangent, 0, n * N * sizeof *g->minus_tangent);
    for (size_t i = 0; i < g->points; i++) {
        double *T = g->tangent + i * N * N, *W = g->second, *a_y = W + N * N;
        double *B = a_y + M * N;
        place_tangent(g, i);
        dm_kernel_prepare(&g->field.curve, g->second); /* a_y is changed in place */
        dm_kernel_eval(&g->field.curve, g->x + i * g->inputs, g->second);
        push_columns(g, i, a_y);
        if (!g->field.solved) add_mass_terms(W, B, a_y, M, N);
        add_bend(g, W, B + M * N, a_y);
        multiply(g->push + i * n * N, a_y, T, n, N, 0);
        add_second(g, W, T, first);
        add_ends(g, i, T + n * N, g->push + i * n * N);
    }
}

/* ---- an estimate without second derivatives of the field ---- */

/* tangents of the points, of both ends and of the velocities there */
static void run_tangents(dm_segment *g) {
    const size_t n = g->n, N = 2 * n, size = n * N;
    double *cleared[] = {g->plus_tangent, g->minus_tangent, g->arrival_tangent,
                         g->departure_tangent};
    for (int k = 0; k < 4; k++) memset(cleared[k], 0, size * sizeof *g->plus_tangent);
    for (size_t i = 0; i < g->points; i++) {
        double *T = g->tangent + i * N * N, *da = g->push + i * size;
        place_tangent(g, i);
        dm_kernel_prepare(&g->field.tangent, g->a_y); /* changed in place */
        dm_kernel_eval(&g->field.tangent, g->x + i * g->inputs, g->a_y);
        push_columns(g, i, g->a_y);
        multiply(da, g->a_y, T, n, N, 0);
        add_ends(g, i, T + n * N, da);
        add(g->arrival_tangent, g->plus_v[i], da, size);
        add(g->departure_tangent, g->plus_v[i] - g->next_v[i], da, size);
    }
}

/* hessian += sign D^T P with D = T d and P the tangent of L_v at that end, columns first .. N-1 */
static void add_end(dm_segment *g, double sign, const double *D, const double *V, uint32_t first) {
    const size_t n = g->n, N = 2 * n;
    double *P = g->change;
    const size_t columns = N - first;
    for (size_t i = 0; i < n; i++) {
        const double *row = g->momentum + i * N;
        memcpy(P + i * N + first, row + first, columns * sizeof *P);
        for (size_t k = 0; k < n; k++) {
            add(P + i * N + first, row[k], D + k * N + first, columns);
            add(P + i * N + first, row[n + k], V + k * N + first, columns);
        }
    }
    for (size_t i = 0; i < n; i++) {
        add(g->hessian + i * N + first, sign, P + i * N + first, columns);
        for (size_t l = 0; l < N; l++)
            add(g->hessian + l * N + first, sign * D[i * N + l], P + i * N + first, N - first);
    }
}

/* L_vy where the segment ends; `v` the velocity there */
static void look_at_end(dm_segment *g, const double *shift, const double *v, double after) {
    const size_t n = g->n;
    for (size_t k = 0; k < n; k++) {
        g->end[k] = g->x[k] + shift[k]; /* point 0 is (q, v) itself */
        g->end[n + k] = v[k];
    }
    g->end[2 * n] = g->x[2 * n] + after;
    dm_kernel_eval(&g->field.momentum, g->end, g->momentum);
}

/* G_yy = D+^T P+ - D-^T P-, one end after the other. */
void dm_segment_estimate(dm_segment *g, uint32_t first) {
    const size_t n = g->n, N = 2 * n;
    double *v = g->some;
    if (g->curve->recipe) {
        dm_written_segment_hessian(g);
        return;
    }
    run_tangents(g);
    memset(g->hessian, 0, N * N * sizeof *g->hessian);
    look_at_end(g, g->plus, g->arrival, g->curve->bias * g->h);
    add_end(g, 1.0, g->plus_tangent, g->arrival_tangent, first);
    for (size_t k = 0; k < n; k++) v[k] = g->x[n + k] + (g->arrival[k] - g->next[k]);
    look_at_end(g, g->minus, v, (g->curve->bias - 1.0) * g->h);
    add_end(g, -1.0, g->minus_tangent, g->departure_tangent, first);
}
