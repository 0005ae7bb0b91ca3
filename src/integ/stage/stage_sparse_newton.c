/* stage_sparse_newton.c - Newton's method for the points of a sparse step equation. The matrix is
 * that of the start of the step; where that converges slowly it is made anew at the mean of the
 * points and then, since the mean may say little about any of them, with the second derivatives of
 * every point, which is Newton's method itself. */
#include "integ/method/hamilton.h"
#include "integ/stage/stage_sparse_inside.h"
#include "linalg/solve/newton_limits.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST = 40 /* iterations */ };
static const double NOISE = 4.0; /* of the rounding of a residual: so large may one be */
static const double SLOW = 0.3;  /* rate that calls for a new matrix */

void dm_stage_sparse_force(dm_stepper *s, const double *q, uint32_t m, double t, double h) {
    dm_stage_sparse *l = dm_stage_sparse_of(s);
    const uint32_t n = s->model->n;
    const double *Z = l->Z + (size_t)m * n;
    for (uint32_t i = 0; i < n; i++) l->x[i] = q[i] + Z[i];
    l->x[2 * (size_t)n] = t + dm_weight_double(l->table.c[m]) * h;
    dm_kernel_eval(&s->model->force, l->x, l->F + (size_t)m * n);
    s->report.evaluations++;
}

void dm_stage_sparse_add(const dm_stepper *s, double *out, uint32_t i, int kind, double h) {
    const dm_stage_sparse *l = dm_stage_sparse_of(s);
    const uint32_t n = s->model->n;
    const double *inverse = s->model->inverse_mass;
    for (uint32_t m = 0; m < l->table.r; m++) {
        if (l->kind[m] != kind) continue;
        const double w = h * h * dm_weight_double(l->table.A[i * l->table.r + m]);
        const double *F = l->F + (size_t)m * n;
        for (uint32_t k = 0; k < n; k++) out[k] += w * (inverse[k] * F[k]);
    }
}

/* M (Z - base - h^2 A M^-1 F) with another sign, of all k points; w[k][k]: h^2 A */
__attribute__((always_inline)) static inline void add_rows(const dm_model *m, dm_stage_sparse *l,
                                                           const double *w, const uint32_t k) {
    const size_t n = m->n;
    const double *inverse = m->inverse_mass;
    for (uint32_t a = 0; a < k; a++) {
        const double *Z = l->Z + l->at[a] * n, *base = l->base + l->at[a] * n;
        double *R = l->R + a;
        for (size_t j = 0; j < n; j++) {
            const double mass = m->held && m->held[j] ? 1.0 : m->mass_matrix[j];
            double sum = base[j];
            for (uint32_t b = 0; b < k; b++)
                sum += w[a * k + b] * (inverse[j] * l->F[l->at[b] * n + j]);
            R[j * k] = mass * (sum - Z[j]);
        }
    }
}

/* One point has a loop of its own. */
static void residual(dm_stepper *s, double h) {
    dm_stage_sparse *l = dm_stage_sparse_of(s);
    const uint32_t k = l->solved;
    double w[DM_QUADRATURE_NODES * DM_QUADRATURE_NODES];
    for (uint32_t a = 0; a < k; a++)
        for (uint32_t b = 0; b < k; b++)
            w[a * k + b] = h * h * dm_weight_double(l->table.A[l->at[a] * l->table.r + l->at[b]]);
    if (k == 1)
        add_rows(s->model, l, w, 1);
    else
        add_rows(s->model, l, w, k);
}

/* the largest |x|, NaN passed over; four of them at once, since each waits for the one before */
static double largest(const double *x, uint32_t n) {
    double most[4] = {0.0};
    for (uint32_t i = 0; i < n; i++) {
        const double size = fabs(x[i]), before = most[i % 4];
        most[i % 4] = size > before ? size : before;
    }
    return fmax(fmax(most[0], most[1]), fmax(most[2], most[3]));
}

/* of all |A_ab| of the solved points of row a, how many of |A_cc| that is, c the point whose is
 * largest: share[solved]; c */
static uint32_t shares(const dm_stage_sparse *l, double *share) {
    const uint32_t k = l->solved, r = l->table.r;
    const dm_weight *A = l->table.A;
    uint32_t c = 0;
    double most = 0.0;
    for (uint32_t a = 0; a < k; a++) {
        const double own = fabs(A[l->at[a] * r + l->at[a]].top);
        if (own > most) most = own, c = a;
        share[a] = 0.0;
        for (uint32_t b = 0; b < k; b++) share[a] += fabs(A[l->at[a] * r + l->at[b]].top);
    }
    for (uint32_t a = 0; a < k; a++) share[a] /= most;
    return c;
}

/* Is every row of the residual round-off of the positions and Z that it sees? Values of a cell may
 * have unlike units. */
static int is_rounding(const dm_stepper *s, double part) {
    const dm_stage_sparse *l = dm_stage_sparse_of(s);
    const size_t n = s->model->n, k = l->solved;
    double *size = l->cg + n * k;
    for (size_t a = 0; a < k; a++)
        for (size_t j = 0; j < n; j++)
            size[j * k + a] = fabs(l->x[j]) + fabs(l->Z[l->at[a] * n + j]);
    return dm_sparse_is_within(&l->S, l->R, size, part, size + n * k);
}

/* Is the residual no more than its own rounding? Forces of all points are rounded by |S - M| |x|,
 * the rest by |S| |Z|, of which the diagonal stands for a row; another solve would only bring other
 * noise. size: the largest |Z|. A residual that is noise says that forces are numbers. */
static int is_noise(const dm_stepper *s, double size) {
    const dm_stage_sparse *l = dm_stage_sparse_of(s);
    const dm_model *m = s->model;
    const uint32_t n = m->n, k = l->solved;
    if (!l->diagonal) return 0;
    double share[DM_QUADRATURE_NODES];
    const uint32_t c = shares(l, share);
    const double position = largest(l->x, n);
    const double *S = l->diagonal, *R = l->R;
    for (uint32_t j = 0; j < n; j++, S += k, R += k) {
        const double mass = m->held && m->held[j] ? 1.0 : m->mass_matrix[j];
        const double force = fabs(S[c] - mass) * position;
        for (uint32_t a = 0; a < k; a++) {
            const double noise = share[a] * force + fabs(S[a]) * size;
            if (!(fabs(R[a]) <= NOISE * DBL_EPSILON * noise)) return 0;
        }
    }
    return l->constant || is_rounding(s, NOISE * DBL_EPSILON);
}

/* Z += dx; the largest change, and the largest Z. DM_NOT_FINITE: one of them is not */
static dm_status advance(dm_stage_sparse *l, uint32_t n, double *step, double *size) {
    const uint32_t k = l->solved;
    double most = 0.0, far = 0.0;
    int numbers = 1;
    for (uint32_t a = 0; a < k; a++) {
        double *Z = l->Z + (size_t)l->at[a] * n;
        for (uint32_t j = 0; j < n; j++) {
            const double d = l->dx[(size_t)j * k + a], x = Z[j] + d;
            Z[j] = x;
            most = fabs(d) > most ? fabs(d) : most;
            far = fabs(x) > far ? fabs(x) : far;
            numbers &= d == d;
        }
    }
    *step = most, *size = far;
    return numbers && isfinite(most) ? DM_OK : DM_NOT_FINITE;
}

/* iterations with the matrix that stands, which is made anew where they are slow; one that is kept
 * is not */
static dm_status iterate(dm_stepper *s, const double *q, double t, double h, int kept) {
    dm_stage_sparse *l = dm_stage_sparse_of(s);
    dm_sparse_place at = DM_SPARSE_AT_START;
    double step, size = 0.0, last = INFINITY;
    dm_status status = DM_OK;
    for (int pass = 1; status == DM_OK; pass++) {
        for (uint32_t a = 0; a < l->solved; a++) dm_stage_sparse_force(s, q, l->at[a], t, h);
        residual(s, h);
        l->fresh = pass > 1 && is_noise(s, size);
        if (l->fresh) break;
        status = dm_stage_sparse_solve(s);
        if (status == DM_OK) status = advance(l, s->model->n, &step, &size);
        if (status != DM_OK) return status;
        s->report.iterations = pass;
        s->report.newton++;
        s->report.residual = step;
        if (step <= s->tolerance * size || (step >= 0.5 * last && step <= 1e-12 * size)) break;
        if (pass >= DM_NEWTON_STALLED && step > SLOW * last &&
            step <= DM_NEWTON_UNSEEN * largest(l->x, s->model->n) &&
            (l->constant || is_rounding(s, DM_NEWTON_UNSEEN)))
            break; /* what no position shows */
        if (pass >= s->max_iterations || pass >= MOST) return DM_NO_CONVERGENCE;
        if (kept && step > DM_PLACE_SLOW * last) return DM_NO_CONVERGENCE;
        if (step > SLOW * last) {
            at = at == DM_SPARSE_AT_START ? DM_SPARSE_AT_MEAN : DM_SPARSE_AT_OWN;
            status = dm_stage_sparse_matrix(s, q, t, h, at);
        }
        last = step;
    }
    s->report.solves++;
    return status;
}

/* with the matrix of an earlier step; where that does not serve Z is `base` again */
static dm_status iterate_kept(dm_stepper *s, const double *q, double t, double h) {
    dm_stage_sparse *l = dm_stage_sparse_of(s);
    const double *place = dm_stage_place_of(&l->kept);
    const size_t n = s->model->n;
    dm_status status = DM_OK;
    if (l->h != h || !dm_stage_place_has(&l->kept)) {
        status = dm_stage_sparse_matrix(s, place, place[n], h, DM_SPARSE_AT_START);
        if (status == DM_OK) dm_stage_place_make(&l->kept);
    }
    if (status == DM_OK) status = iterate(s, q, t, h, 1);
    for (uint32_t a = 0; a < l->solved && status != DM_OK; a++)
        memcpy(l->Z + l->at[a] * n, l->base + l->at[a] * n, n * sizeof *l->Z);
    return status;
}

/* with the matrix of its own start, which is kept where it serves */
static dm_status iterate_own(dm_stepper *s, const double *q, double t, double h, int first) {
    dm_stage_sparse *l = dm_stage_sparse_of(s);
    dm_status status = dm_stage_sparse_matrix(s, q, t, h, DM_SPARSE_AT_START);
    if (status == DM_OK && first) dm_stage_place_make(&l->kept);
    if (status == DM_OK) status = iterate(s, q, t, h, 0);
    if (first && (status != DM_OK || !l->kept.is_made)) dm_stage_place_leave(&l->kept);
    return status;
}

dm_status dm_stage_sparse_newton(dm_stepper *s, const double *q, double t, double h,
                                 int from_base) {
    dm_stage_sparse *l = dm_stage_sparse_of(s);
    dm_place_use use = DM_PLACE_OWN;
    if (!l->constant && from_base) use = dm_stage_place_ask(&l->kept, q, t, h);
    if (use == DM_PLACE_KEPT) {
        const dm_status status = iterate_kept(s, q, t, h);
        if (status == DM_OK) dm_stage_place_ended(&l->kept, s->report.iterations);
        if (status == DM_OK || status == DM_STOPPED) return status;
        use = dm_stage_place_failed(&l->kept, q, t);
    }
    return iterate_own(s, q, t, h, use == DM_PLACE_NEW);
}
