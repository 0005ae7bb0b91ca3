/* inertia_values.c - d2L/dv2 at a place, scaled, on the velocities that constraints allow; how many
 * of its values are negative, and what is told of their sizes, block by block. */
#include "run/inertia/inertia_values.h"
#include "linalg/lu.h"
#include "linalg/signature.h"
#include "mech/constraints.h"
#include "mech/group.h"
#include "numbers/small_copy.h"

#include <math.h>
#include <string.h>

/* `count` rows of a kernel, scaled, each of size 1, at G */
static void place_rows(const dm_inertia *x, double *G, const double *rows, uint32_t count) {
    const size_t n = x->model->n;
    for (size_t c = 0; c < count; c++) {
        double size = 0.0;
        for (size_t i = 0; i < n; i++) size = fmax(size, fabs(rows[c * n + i] * x->scale[i]));
        for (size_t i = 0; i < n; i++)
            G[c * n + i] = size > 0.0 ? rows[c * n + i] * x->scale[i] / size : 0.0;
    }
}

/* The rows of the constraints, at G. */
static void place_constraints(const dm_inertia *x, double *G, const double *at, double *out) {
    const dm_model *m = x->model;
    const uint32_t k = x->holonomic, l = x->rolling;
    const size_t n = m->n;
    if (k) {
        dm_kernel_prepare(&m->constraints->holonomic_kernel, out);
        dm_kernel_eval(&m->constraints->holonomic_kernel, at, out);
        place_rows(x, G, out + k, k);
    }
    if (l) { /* phi[l], E[l*n], phi_v[l*n] */
        dm_kernel_prepare(&m->constraints->rolling_kernel, out);
        dm_kernel_eval(&m->constraints->rolling_kernel, at, out);
        place_rows(x, G + k * n, out + l + l * n, l);
    }
}

/* M at (q, v, t), which lies in x->room, into the outputs of the kernel behind its n momenta; what
 * is constant there stays from look to look, but where constraints and groups use the place.
 * Speed: steps, double spherical pendulum midpoint: 1.005x. */
static void evaluate(const dm_inertia *x) {
    if (x->holonomic || x->rolling || x->model->group)
        dm_kernel_prepare(&x->model->mass, x->out);
    else
        dm_kernel_remember(&x->model->mass, 0);
    dm_kernel_eval(&x->model->mass, x->room, x->out);
}

int dm_inertia_find_state(const dm_inertia *x, const double *state, double t) {
    const dm_model *m = x->model;
    const size_t n = m->n;
    double *at = x->room;
    dm_small_copy(at, state, n);
    for (size_t i = 0; i < n; i++) at[n + i] = 0.0;
    at[2 * n] = t;
    if (dm_inertia_sees_velocity(m) &&
        dm_legendre_inverse(m, at + n, state, state + n, t, x->work) != DM_OK)
        return 0;
    evaluate(x);
    return 1;
}

/* The mass that was found, scaled, as A. */
static void place_mass(const dm_inertia *x, double *A, const double *M) {
    const uint32_t n = x->model->n;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) A[i * n + j] = x->scale[i] * M[i * n + j] * x->scale[j];
}

void dm_inertia_narrow(double *rows, size_t count, uint32_t n, uint32_t d) {
    for (size_t i = 0; i < count && d < n; i++)
        memmove(rows + i * d, rows + i * n, d * sizeof *rows);
}

/* [M, G^T; G, 0] as A[N*N] */
static void place_border(double *A, size_t N, const double *M, const double *G, size_t n) {
    memset(A, 0, N * N * sizeof *A);
    for (size_t i = 0; i < n; i++) memcpy(A + i * N, M + i * n, n * sizeof *A);
    for (size_t c = n; c < N; c++)
        for (size_t i = 0; i < n; i++) A[c * N + i] = A[i * N + c] = G[(c - n) * n + i];
}

double *dm_inertia_solve(const dm_inertia_form *f, double *u) {
    const size_t N = (size_t)f->n + f->rows;
    uint32_t *pivot = (uint32_t *)(void *)f->copy;
    double *A = f->rows ? f->border : f->A;
    if (f->rows > f->n) return NULL;
    if (f->rows) place_border(A, N, f->A, f->G, f->n);
    memset(u + f->n, 0, f->rows * sizeof *u);
    if (dm_lu_factor(A, pivot, (uint32_t)N) != DM_OK) return NULL;
    dm_lu_solve(u, A, pivot, (uint32_t)N);
    return u;
}

/* the lower triangle of those rows of M[n*n], scaled, as A[size*size] */
static inline void place_lower(double *A, size_t size, const double *M, size_t n,
                               const double *scale, const uint32_t *at) {
#pragma GCC unroll 4
    for (size_t i = 0; i < size; i++)
#pragma GCC unroll 4
        for (size_t j = 0; j <= i; j++)
            A[i * size + j] = scale[at[i]] * M[at[i] * n + at[j]] * scale[at[j]];
}

/* The same of block b of the mass that was found; four rows are written out. */
static void place_block(const dm_inertia *x, double *A, uint32_t b) {
    const size_t n = x->model->n, size = dm_block_size(&x->blocks, b);
    const uint32_t *at = x->blocks.order + x->blocks.first[b];
    if (size == 4)
        place_lower(A, 4, x->out + n, n, x->scale, at);
    else
        place_lower(A, size, x->out + n, n, x->scale, at);
}

dm_inertia_form dm_inertia_place(const dm_inertia *x, uint32_t b) {
    const dm_model *m = x->model;
    const size_t n = m->n;
    dm_inertia_form f = {.A = x->A, .n = dm_momenta(m), .rows = x->holonomic + x->rolling};
    f.order = x->blocks.order + x->blocks.first[b];
    f.copy = f.A + n * n, f.G = f.copy + n * n, f.border = f.G + (f.rows + 1) * n;
    if (x->blocks.count > 1 && b < x->blocks.count) {
        f.n = dm_block_size(&x->blocks, b);
        place_block(x, f.A, b);
        for (size_t i = 0; i < f.n; i++)
            for (size_t j = 0; j < i; j++) f.A[j * f.n + i] = f.A[i * f.n + j];
    } else {
        place_mass(x, f.A, x->out + n);
        if (f.rows) place_constraints(x, f.G, x->room, x->out); /* where the mass was */
        dm_inertia_narrow(f.A, f.n, m->n, f.n);
        dm_inertia_narrow(f.G, f.rows, m->n, f.n);
    }
    f.n = dm_inertia_halve(f.A, f.G, &f.rows, f.n, f.border);
    return f;
}

/* Without constraints. */
int dm_inertia_is_far(const dm_inertia *x, uint32_t b, dm_inertia_value *out) {
    const dm_model *m = x->model;
    const uint32_t size = dm_block_size(&x->blocks, b);
    if (x->holonomic || x->rolling || dm_momenta(m) != m->n) return 0;
    place_block(x, x->A, b);
    return dm_all_positive(x->A, size, DM_INERTIA_FAR, &out->least, &out->all);
}

uint32_t dm_inertia_negative_in(const dm_inertia_form *f, uint32_t n, dm_inertia_value *out) {
    const size_t size = (size_t)n * n * sizeof *f->A;
    memcpy(f->copy, f->A, size);
    const int positive = dm_all_positive(f->copy, n, DM_INERTIA_FAR, &out->least, &out->all);
    memcpy(f->copy, f->A, size);
    if (positive) return 0;
    return dm_negative_values(f->A, n, &out->least, &out->all);
}

/* How many are negative in block b of the mass that was found, and the size of the value next to
 * zero. With all values far above zero, as they mostly are, less work tells so. Under constraints
 * the size is that on the velocities they allow; the number is that of the bordered matrix, which
 * has as many more as there are independent constraints. */
static uint32_t count_block(const dm_inertia *x, uint32_t b, dm_inertia_value *out) {
    if (dm_inertia_is_far(x, b, out)) return 0;
    const dm_inertia_form f = dm_inertia_place(x, b);
    uint32_t N = f.n, negative = 0;
    if (f.rows) {
        double unused[2];
        place_border(f.border, (size_t)f.n + f.rows, f.A, f.G, f.n);
        negative = dm_negative_values(f.border, f.n + f.rows, unused, unused + 1);
        N = dm_restrict(f.A, f.n, f.G, f.rows, f.border);
    }
    const uint32_t own = dm_inertia_negative_in(&f, N, out);
    return f.rows ? negative : own;
}

dm_inertia_there dm_inertia_count(const dm_inertia *x) {
    dm_inertia_there out = {.least = INFINITY, .of = x->values};
    for (uint32_t b = 0; b < x->blocks.count; b++) {
        out.negative += count_block(x, b, x->values + b);
        out.least = fmin(out.least, x->values[b].least);
    }
    return out;
}

int dm_inertia_values(const dm_inertia *x, const double *state, double t, dm_inertia_there *out) {
    if (!dm_inertia_find_state(x, state, t)) return 0;
    *out = dm_inertia_count(x);
    return 1;
}

int dm_inertia_at(const dm_inertia *x, const double *state, double t, uint32_t *negative,
                  double *least) {
    dm_inertia_there there;
    if (!dm_inertia_values(x, state, t, &there)) return 0;
    *negative = there.negative, *least = there.least;
    return 1;
}

void dm_inertia_find(const dm_inertia *x, const double *q, const double *v, double t) {
    const size_t n = x->model->n;
    memcpy(x->room, q, n * sizeof *q);
    memcpy(x->room + n, v, n * sizeof *v);
    x->room[2 * n] = t;
    evaluate(x);
}

double *dm_inertia_mass(const dm_inertia *x, const double *q, const double *v, double t) {
    dm_inertia_find(x, q, v, t);
    place_mass(x, x->A, x->out + x->model->n);
    return x->A;
}

uint32_t dm_inertia_negative(const dm_inertia *x, const double *q, const double *v, double t) {
    dm_inertia_find(x, q, v, t);
    return dm_inertia_count(x).negative;
}

const double *dm_inertia_velocity(const dm_inertia *x, const double *state, double t) {
    const dm_model *m = x->model;
    const size_t n = m->n;
    double *v = x->A;
    memset(v, 0, n * sizeof *v);
    return dm_legendre_inverse(m, v, state, state + n, t, x->work) == DM_OK ? v : NULL;
}
