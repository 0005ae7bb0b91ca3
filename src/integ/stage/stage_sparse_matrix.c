/* stage_sparse_matrix.c - S = M - h^2 A L_qq of a sparse step equation, and its factors: one block
 * is symmetric (CHOLMOD), several are not (UMFPACK). Without dm/sparse.so one block goes by
 * conjugate gradients. */
#include "chain/curvature.h"
#include "chain/loops.h"
#include "integ/stage/stage_sparse_inside.h"
#include "linalg/sparse/conjugate_gradient.h"

#include <string.h>

/* that of L_qq in every block */
void dm_stage_sparse_pattern(dm_stage_sparse *l, const dm_sparse *A) {
    const int32_t k = (int32_t)l->solved;
    int32_t next = 0;
    for (int32_t j = 0; j < A->columns; j++)
        for (int32_t b = 0; b < k; b++) {
            l->S.start[j * k + b] = next;
            for (int32_t p = A->start[j]; p < A->start[j + 1]; p++)
                for (int32_t a = 0; a < k; a++) l->S.row[next++] = A->row[p] * k + a;
        }
    l->S.start[A->columns * k] = next;
    l->S.rows = l->S.columns = A->columns * k;
}

/* Columns of solved point b, with L_qq as it stands; rows of entries that are held are rows of 1 */
static void fill(const dm_stepper *s, dm_stage_sparse *l, double h, uint32_t b) {
    const dm_model *m = s->model;
    const dm_sparse *A = &m->curvature->A;
    const uint32_t k = l->solved, r = l->table.r;
    l->diagonal = s->solvers ? l->cg : NULL;
    for (int32_t j = 0; j < A->columns; j++) {
        double *value = l->S.value + l->S.start[(uint32_t)j * k + b];
        for (int32_t p = A->start[j]; p < A->start[j + 1]; p++)
            for (uint32_t a = 0; a < k; a++) {
                const dm_weight w = l->table.A[l->at[a] * r + l->at[b]];
                double x = -h * h * dm_weight_double(w) * A->value[p];
                if (A->row[p] == j && a == b) x += m->held && m->held[j] ? 1.0 : m->mass_matrix[j];
                if (A->row[p] == j && a == b && l->diagonal) l->diagonal[(size_t)j * k + a] = x;
                *value++ = x;
            }
    }
}

/* x = (q0 + Z, t) of the solved point b, or of what stands for all of them */
static void place(dm_stage_sparse *l, const double *q, uint32_t n, double t, double h, uint32_t b,
                  dm_sparse_place at) {
    const int own = at == DM_SPARSE_AT_OWN;
    const uint32_t first = own ? b : 0, last = own ? b + 1 : l->solved;
    for (uint32_t i = 0; i < n; i++) {
        double Z = 0.0;
        for (uint32_t a = first; at != DM_SPARSE_AT_START && a < last; a++)
            Z += l->Z[(size_t)l->at[a] * n + i];
        l->x[i] = q[i] + Z / (double)(last - first);
    }
    l->x[2 * (size_t)n] = own ? t + dm_weight_double(l->table.c[l->at[b]]) * h : t;
}

/* What is made of numbers alone stays as long as h does. */
dm_status dm_stage_sparse_matrix(dm_stepper *s, const double *q, double t, double h,
                                 dm_sparse_place at) {
    dm_stage_sparse *l = dm_stage_sparse_of(s);
    const dm_model *m = s->model;
    if (l->h == h && l->constant && at == DM_SPARSE_AT_START) return DM_OK;
    l->h = 0.0;
    l->kept.is_made = 0;
    for (uint32_t b = 0; b < l->solved; b++) {
        if (b == 0 || at == DM_SPARSE_AT_OWN) {
            place(l, q, m->n, t, h, b, at);
            dm_curvature_at(m->curvature, dm_loops_factors(&m->force, l->x), l->x);
        }
        fill(s, l, h, b);
    }
    l->h = h;
    s->report.matrices++;
    if (!s->solvers) return DM_OK;
    return dm_stage_factor_make(&l->factors, s->solvers, &l->S, l->solved == 1, l->constant);
}

dm_status dm_stage_sparse_solve(dm_stepper *s) {
    dm_stage_sparse *l = dm_stage_sparse_of(s);
    if (l->factors.factor) return s->solvers->solve(l->factors.factor, l->dx, l->R);
    dm_cg how = {.tolerance = 1e-13, .most = 20 * l->S.rows + 100};
    memset(l->dx, 0, (size_t)l->S.rows * sizeof *l->dx);
    return dm_conjugate_gradient(l->dx, &l->S, l->R, l->cg, &how);
}
