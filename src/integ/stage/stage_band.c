/* stage_band.c - the matrix of Newton's method in the separable form: where few coordinates meet,
 * as in a chain, a band, and where V is quadratic one of h alone, whose factors serve every step.
 * Speed: steps, chain of 30 beyond sweeps by gauss(8): 200x, against LU of the full matrix. */
#include "integ/stage/stage_inside.h"

#include "linalg/lu.h"
#include "linalg/solve/newton.h"

#include <math.h>
#include <string.h>

/* Entries k of its rows of L_qq among the outputs of the kernel: [n][n]. */
static size_t curve_of(const dm_stage *g) {
    return 2 * (size_t)g->n;
}

static int is_zero(const dm_kernel *stage, size_t output) {
    return stage->fixed && stage->fixed[output] && stage->constant[output] == 0.0;
}

/* numbers of the points that are solved for; how many */
static uint32_t solved_points(const dm_stage *g, uint32_t *list) {
    uint32_t count = 0;
    for (uint32_t m = 0; m < g->table.r; m++)
        if (g->points.kind[m] == DM_POINT_SOLVED) list[count++] = m;
    return count;
}

/* J = 1 where coordinates meet in L_qq: [n][n] */
static void mark(const dm_stage *g, double *J) {
    const size_t n = g->n;
    for (size_t k = 0; k < n; k++)
        for (size_t l = 0; l < n; l++)
            J[k * n + l] = k == l || !is_zero(g->newton.stage, curve_of(g) + l * n + k);
}

/* V is quadratic, but for what is linear in q */
static int is_linear(const dm_stage *g) {
    const dm_kernel *stage = g->newton.stage;
    const size_t first = curve_of(g), n = g->n;
    for (size_t k = 0; k < n * n; k++)
        if (!stage->fixed || !stage->fixed[first + k]) return 0;
    return 1;
}

/* factors and pivots behind what the Legendre transform and the iteration work on */
static int has_room(dm_stage *g, size_t room) {
    dm_stage_newton *w = &g->newton;
    const size_t m = w->matrix.band.n, n = g->n;
    const size_t before = dm_legendre_work(g->m) + n * n + n + 4 * m;
    const size_t size = w->matrix.banded ? dm_band_size(&w->matrix.band) : m * m;
    w->factors = g->scratch + before;
    w->pivot = (uint32_t *)(void *)(w->factors + size);
    return before + size + dm_doubles(m * sizeof(uint32_t)) <= room;
}

void dm_stage_band_open(dm_stage *g, size_t room) {
    dm_stage_newton *w = &g->newton;
    const uint32_t points = solved_points(g, w->solved), m = points * g->n;
    w->points = points;
    w->linear = w->keeps = 0;
    w->factored = NAN;
    dm_step_matrix_open(&w->matrix, m, w->lists);
    if (m >= DM_STAGE_BAND_LEAST && g->m->structure & DM_DIAGONAL_MASS) {
        mark(g, g->scratch);
        dm_step_matrix_narrow_blocks(&w->matrix, g->scratch, g->n,
                                     (uint32_t *)(void *)(g->scratch + (size_t)g->n * g->n));
    }
    if (!has_room(g, room)) return;
    w->linear = is_linear(g);
    w->keeps = !w->linear && dm_stage_kept_size(g) > 0;
}

/* entry (i, m) of the blocks: delta_im - h^2 A_im M^-1 L_qq(m) */
void dm_stage_band_fill(const dm_stage *g, double *J) {
    const dm_stage_newton *w = &g->newton;
    const size_t n = g->n, width = 2 * n + 3 * n * n, r = g->table.r;
    const size_t *row = w->matrix.row, *column = w->matrix.column;
    dm_step_matrix_zero(J, &w->matrix);
    for (size_t i = 0; i < w->points * n; i++) J[row[i] + column[i]] = 1.0;
    for (size_t j = 0; j < w->points; j++) {
        const double *qq = w->curve + w->solved[j] * width + curve_of(g);
        for (size_t l = 0; l < n; l++)
            for (size_t k = 0; k < n; k++) {
                const double x = qq[l * n + k] * g->m->inverse_mass[k];
                for (size_t i = 0; x != 0.0 && i < w->points; i++) {
                    const dm_weight A = g->weights.hA[w->solved[i] * r + w->solved[j]];
                    J[row[i * n + k] + column[j * n + l]] -= dm_weight_double(A) * x;
                }
            }
    }
}

dm_status dm_stage_band_factor(dm_stage *g) {
    dm_stage_newton *w = &g->newton;
    if (w->factored == g->weights.h) return DM_OK;
    dm_stage_matrix(g, w->factors);
    const dm_status status = w->matrix.banded
                                 ? dm_band_factor(w->factors, w->pivot, &w->matrix.band)
                                 : dm_lu_factor(w->factors, w->pivot, w->matrix.band.n);
    w->factored = status == DM_OK ? g->weights.h : NAN;
    return status;
}
