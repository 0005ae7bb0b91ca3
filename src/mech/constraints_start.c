/* constraints_start.c - is a state on its constraints, are they independent there, and where is
 * the nearest state that is on them? A is G, or G above dphi/dv; c what it has to make zero: g,
 * or (G v + g_t, phi). Nearest is meant in the metric of the mass, W = M^-1: the shift is -W
 * A^T y, as that of an impulse would be. */
#include "linalg/lu.h"
#include "mech/constraints.h"
#include "mech/group.h"

#include <math.h>
#include <string.h>

static const double DEPENDENT = 1e-13; /* what is left of a row's square, relatively */
static const double ROUND_OFF = 1e-15, SETTLED = 1e-12;
static const double ASIDE = 0x1p-20, /* a shift of x, relatively, */
    LOST = 0x1p-28;                  /* of which that by rounding is so much */
enum { TRIES = 500 };

/* everything that one question needs, laid into the caller's scratch */
typedef struct {
    const dm_constraints *t;
    const double *W;
    uint32_t n, m;        /* unknowns; rows of A in use */
    int velocity;         /* v is moved, not q */
    int by_mass;          /* rows are compared in coordinates in which masses are 1 */
    double *A, *c;        /* [m*n], [m] */
    double *S, *y;        /* A W A^T [m*m], scratch [m] */
    double *basis, *part; /* [m*n] orthonormal rows, [m*m] parts of rows along them */
    double *move, *from;  /* [n] */
    double *out;          /* of the kernels */
    double *carried;      /* [6n] of the chart of a group */
    uint32_t *pivot;      /* [m] */
} frame;

/* constraints of both kinds */
static size_t rows(const dm_constraints *t) {
    return (size_t)t->holonomic + t->rolling;
}

/* doubles that both kernels write */
static size_t outputs(const dm_constraints *t) {
    return t->holonomic * ((size_t)t->n + 2) + t->rolling * (3 * (size_t)t->n + 1);
}

size_t dm_constraints_start_work(const dm_constraints *t) {
    const size_t n = t->n, m = rows(t), larger = n > m ? n : m;
    return 2 * m * n + 2 * m + 2 * m * m + 8 * n + outputs(t) + 2 * n * n + 3 * larger + 2;
}

/* the same scratch for questions about positions and velocities */
static frame lay_out(const dm_constraints *t, const double *W, int velocity, double *work) {
    const size_t n = t->n, m = rows(t);
    frame f = {.t = t, .W = W, .n = t->n, .velocity = velocity, .A = work};
    f.m = velocity ? (uint32_t)m : t->holonomic;
    f.c = f.A + m * n;
    f.S = f.c + m;
    f.y = f.S + m * m;
    f.basis = f.y + m;
    f.part = f.basis + m * n;
    f.move = f.part + m * m;
    f.from = f.move + n;
    f.out = f.from + n;
    f.carried = f.out + outputs(t);
    f.pivot = (uint32_t *)(void *)(f.carried + 6 * n);
    return f;
}

/* a . b */
static double dot(const double *a, const double *b, uint32_t n) {
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

static int all_finite(const double *a, size_t n) {
    for (size_t i = 0; i < n; i++)
        if (!isfinite(a[i])) return 0;
    return 1;
}

/* ---- A and c ---- */

/* A = G; c = g for positions, G v + g_t for velocities */
static void read_holonomic(frame *f, const double *x) {
    const size_t n = f->n, k = f->t->holonomic;
    const double *G = f->out + k, *g_t = G + k * n, *v = x + n;
    dm_kernel_prepare(&f->t->holonomic_kernel, f->out);
    dm_kernel_eval(&f->t->holonomic_kernel, x, f->out);
    memcpy(f->A, G, k * n * sizeof *G);
    for (size_t i = 0; i < k; i++)
        f->c[i] = f->velocity ? dot(G + i * n, v, f->n) + g_t[i] : f->out[i];
}

/* behind them dphi/dv and phi */
static void read_rolling(frame *f, const double *x) {
    const size_t n = f->n, k = f->t->holonomic, l = f->t->rolling;
    double *phi = f->out + k * (n + 2);
    dm_kernel_prepare(&f->t->rolling_kernel, phi);
    dm_kernel_eval(&f->t->rolling_kernel, x, phi);
    memcpy(f->c + k, phi, l * sizeof *phi);
    memcpy(f->A + k * n, phi + l + l * n, l * n * sizeof *phi);
}

/* A and c at x; not finite where a function has no value */
static dm_status read_constraints(frame *f, const double *x) {
    if (f->t->holonomic) read_holonomic(f, x);
    if (f->velocity && f->t->rolling) read_rolling(f, x);
    const int fine = all_finite(f->A, f->m * (size_t)f->n) && all_finite(f->c, f->m);
    return fine ? DM_OK : DM_NOT_FINITE;
}

/* ---- dependent rows ---- */

/* each entry by another part of itself: units do not matter, and common factors change too */
static void shift_aside(double *out, const double *x, size_t count) {
    static const double GOLDEN = 0.6180339887498949;
    for (size_t i = 0; i < count; i++) {
        const double turns = GOLDEN * (double)i;
        out[i] = x[i] * (1.0 + ASIDE * (turns - floor(turns) - 0.5));
    }
}

/* the largest |a_i - factor b_i| */
static double farthest(const double *a, const double *b, double factor, uint32_t n) {
    double most = 0.0;
    for (uint32_t i = 0; i < n; i++) most = fmax(most, fabs(a[i] - factor * b[i]));
    return most;
}

/* rows that rounding x moves by as much as they are long are zero: 1 - a . b of two axes, which
 * are equal but for rounding */
static void drop_lost_rows(frame *f, const double *x) {
    const uint32_t n = f->n;
    double *aside = f->carried, *rows_at_x = f->basis;
    memcpy(rows_at_x, f->A, f->m * (size_t)n * sizeof *f->A);
    memcpy(f->y, f->c, f->m * sizeof *f->c);
    shift_aside(aside, x, 2 * (size_t)n);
    aside[2 * n] = x[2 * n];
    const dm_status status = read_constraints(f, aside);
    for (uint32_t i = 0; i < f->m && status == DM_OK; i++) {
        double *row = rows_at_x + i * (size_t)n;
        const double moved = farthest(row, f->A + i * (size_t)n, 1.0, n);
        if (farthest(row, row, 0.0, n) <= LOST * moved) memset(row, 0, n * sizeof *row);
    }
    memcpy(f->A, rows_at_x, f->m * (size_t)n * sizeof *f->A);
    memcpy(f->c, f->y, f->m * sizeof *f->c);
}

/* of coordinate c, for rows */
static double unit_of(const frame *f, uint32_t c) {
    const double w = f->by_mass ? fabs(f->W[c * ((size_t)f->n + 1)]) : 1.0;
    return w > 0.0 && w < INFINITY ? sqrt(w) : 1.0;
}

/* row i with a largest entry of 1; 0: it is zero */
static int scale(frame *f, uint32_t i) {
    const double *from = f->A + i * (size_t)f->n;
    double *row = f->basis + i * (size_t)f->n, size = 0.0;
    for (uint32_t c = 0; c < f->n; c++) size = fmax(size, fabs(from[c] * unit_of(f, c)));
    for (uint32_t c = 0; c < f->n; c++) row[c] = size > 0.0 ? from[c] * unit_of(f, c) / size : 0.0;
    return size > 0.0;
}

/* what is left of row i after the parts along the rows before it; twice, so that it is
 * orthogonal to round-off */
static double reduce(frame *f, uint32_t i) {
    const uint32_t n = f->n;
    double *row = f->basis + i * (size_t)n, *part = f->part + i * (size_t)f->m;
    memset(part, 0, f->m * sizeof *part);
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t j = 0; j < i; j++) {
            const double *unit = f->basis + j * (size_t)n, along = dot(unit, row, n);
            for (uint32_t c = 0; c < n; c++) row[c] -= along * unit[c];
            part[j] += along;
        }
    return dot(row, row, n);
}

/* the row before i with the largest coefficient in sum_j y_j A_j = A_i, from 1 */
static uint32_t largest_part(frame *f, uint32_t i) {
    double *y = f->y;
    uint32_t best = 0;
    memcpy(y, f->part + i * (size_t)f->m, i * sizeof *y);
    for (uint32_t j = i; j-- > 0;) {
        const double *part = f->part + j * (size_t)f->m;
        y[j] /= part[j];
        for (uint32_t c = 0; c < j; c++) y[c] -= y[j] * part[c];
    }
    for (uint32_t j = 0; j < i; j++)
        if (!best || fabs(y[j]) > fabs(y[best - 1])) best = j + 1;
    return best;
}

/* rows are made orthogonal one after the other; the first of which nothing is left depends on
 * others */
static void find_dependent_in(frame *f, dm_constraints_defect *out) {
    out->depends = out->on = 0;
    for (uint32_t i = 0; i < f->m; i++) {
        const double *row = f->basis + i * (size_t)f->n;
        const int some = scale(f, i);
        const double whole = dot(row, row, f->n), left = reduce(f, i);
        if (left <= DEPENDENT * whole) {
            out->depends = i + 1;
            out->on = some ? largest_part(f, i) : 0;
            return;
        }
        for (uint32_t c = 0; c < f->n; c++) f->basis[i * (size_t)f->n + c] /= sqrt(left);
        f->part[i * (size_t)f->m + i] = sqrt(left);
    }
}

/* Rows that are parallel in coordinates of very different units, as those of a wheel with a radius
 * of 1e8, need not be so in its motion. */
static void find_dependent(frame *f, dm_constraints_defect *out) {
    find_dependent_in(f, out);
    if (!out->depends || !f->W) return;
    const dm_constraints_defect plain = *out;
    f->by_mass = 1;
    find_dependent_in(f, out);
    if (out->depends) *out = plain;
}

/* ---- the nearest point ---- */

/* out = W A_i, most of whose entries are zero; W is symmetric */
static void raise_row(const frame *f, double *out, uint32_t i) {
    const double *row = f->A + i * (size_t)f->n;
    memset(out, 0, f->n * sizeof *out);
    for (uint32_t j = 0; j < f->n; j++)
        for (uint32_t c = 0; row[j] != 0.0 && c < f->n; c++)
            out[c] += f->W[j * (size_t)f->n + c] * row[j];
}

/* move = -W A^T (A W A^T)^-1 y */
static dm_status find_move(frame *f) {
    const uint32_t n = f->n, m = f->m;
    for (uint32_t j = 0; j < m; j++) {
        raise_row(f, f->move, j);
        for (uint32_t i = 0; i < m; i++)
            f->S[i * (size_t)m + j] = dot(f->A + i * (size_t)n, f->move, n);
    }
    const dm_status status = dm_lu_factor(f->S, f->pivot, m);
    if (status != DM_OK) return status;
    dm_lu_solve(f->y, f->S, f->pivot, m);
    double *step = f->basis;
    memset(step, 0, n * sizeof *step);
    for (uint32_t j = 0; j < m; j++) {
        raise_row(f, f->move, j);
        for (uint32_t c = 0; c < n; c++) step[c] -= f->y[j] * f->move[c];
    }
    memcpy(f->move, step, n * sizeof *step);
    return all_finite(f->move, n) ? DM_OK : DM_SINGULAR;
}

/* distance and rank first; the shift only where the rows are independent */
static dm_status defect(dm_constraints_defect *out, frame *f, const double *x) {
    *out = (dm_constraints_defect){0};
    if (!f->m) return DM_OK;
    dm_status status = read_constraints(f, x);
    if (status != DM_OK) return status;
    for (uint32_t i = 0; i < f->m; i++)
        if (!out->row || fabs(f->c[i]) > out->distance)
            out->distance = fabs(f->c[i]), out->row = i + 1;
    drop_lost_rows(f, x);
    find_dependent(f, out);
    if (out->depends) return DM_OK;
    memcpy(f->y, f->c, f->m * sizeof *f->y);
    status = find_move(f);
    const double *at = x + (f->velocity ? f->n : 0);
    out->move = sqrt(dot(f->move, f->move, f->n)) / (1.0 + sqrt(dot(at, at, f->n)));
    return status;
}

dm_status dm_constraints_position_defect(dm_constraints_defect *out, const dm_constraints *t,
                                         const double *x, const double *W, double *work) {
    frame f = lay_out(t, W, 0, work);
    return defect(out, &f, x);
}

dm_status dm_constraints_velocity_defect(dm_constraints_defect *out, const dm_constraints *t,
                                         const double *x, const double *W, double *work) {
    frame f = lay_out(t, W, 1, work);
    return defect(out, &f, x);
}

/* are positions elements of a group? */
static int on_group(const frame *f) {
    return f->t->group && !f->velocity;
}

/* at = from + move, on a group the element that the chart about `from` leads to; the largest change
 * of an entry */
static double move_to(frame *f, double *at) {
    const uint32_t n = f->n;
    double change = 0.0;
    for (uint32_t c = 0; c < n; c++) f->carried[c] = f->from[c] + f->move[c];
    if (on_group(f)) {
        double *in = f->carried + 3 * n;
        memset(in, 0, 3 * n * sizeof *in);
        memcpy(in, f->from, n * sizeof *in);
        memcpy(in + n, f->move, f->t->group->momenta * sizeof *in);
        dm_kernel_prepare(&f->t->group->joints.finish, f->carried);
        dm_kernel_eval(&f->t->group->joints.finish, in, f->carried);
    }
    for (uint32_t c = 0; c < n; c++) {
        change = fmax(change, fabs(f->carried[c] - at[c]));
        at[c] = f->carried[c];
    }
    return change;
}

/* the nearest point to `from` of c + A (x' - x) = 0, again and again: x' = from + move, move = -W
 * A^T (A W A^T)^-1 (c - A last), last the move before */
static dm_status project(frame *f, double *x) {
    const uint32_t n = f->n;
    double *at = x + (f->velocity ? n : 0), last = INFINITY;
    memcpy(f->from, at, n * sizeof *at);
    memset(f->move, 0, n * sizeof *f->move);
    for (int k = 0; k < TRIES && f->m; k++) {
        double size = 1.0;
        dm_status status = read_constraints(f, x);
        if (status != DM_OK) return status;
        for (uint32_t i = 0; i < f->m; i++) {
            const double *row = f->A + i * (size_t)n;
            f->y[i] = on_group(f) ? f->c[i] - dot(row, f->move, n)
                                  : f->c[i] - dot(row, at, n) + dot(row, f->from, n);
        }
        status = find_move(f);
        if (status != DM_OK) return status;
        const double change = move_to(f, at);
        for (uint32_t c = 0; c < n; c++) size = fmax(size, fabs(at[c]));
        if (change <= ROUND_OFF * size || (change < SETTLED * size && change >= last)) return DM_OK;
        last = change;
    }
    return f->m ? DM_NO_CONVERGENCE : DM_OK;
}

dm_status dm_constraints_project_position(const dm_constraints *t, double *x, const double *W,
                                          double *work) {
    frame f = lay_out(t, W, 0, work);
    return project(&f, x);
}

dm_status dm_constraints_project_velocity(const dm_constraints *t, double *x, const double *W,
                                          double *work) {
    frame f = lay_out(t, W, 1, work);
    return project(&f, x);
}

/* ---- the metric ---- */

/* a constant mass brings its inverse along */
dm_status dm_constraints_inverse_mass(double *W, const dm_model *m, const double *x, double *work) {
    const size_t n = m->n;
    double *mass = work, *column = mass + n + n * n;
    uint32_t *pivot = (uint32_t *)(void *)(column + n);
    const int diagonal = (m->structure & DM_DIAGONAL_MASS) != 0;
    if (m->inverse_mass && !diagonal) {
        memcpy(W, m->inverse_mass, n * n * sizeof *W);
        return DM_OK;
    }
    if (m->inverse_mass) {
        memset(W, 0, n * n * sizeof *W);
        for (size_t i = 0; i < n; i++) W[i * (n + 1)] = m->inverse_mass[i];
        return DM_OK;
    }
    dm_kernel_prepare(&m->mass, mass);
    dm_kernel_eval(&m->mass, x, mass);
    if (!all_finite(mass, n + n * n)) return DM_NOT_FINITE;
    return dm_lu_inverse(W, mass + n, pivot, column, m->n);
}
