/* bind_wave_spectrum.c - the least energies of more points than dense eigenvectors are for: Lanczos
 * iterations by the library behind dm/sparse.so, with H as a full matrix. */
#include "bind/dec/bind_sparse.h"
#include "bind/value/value.h"
#include "bind/wave/bind_wave.h"

#include <math.h>

enum { MOST_FULL = 4096 }; /* unknowns: a matrix of 200 MB and its factor */

/* H - shift as columns of all their rows: it is symmetric, so rows will do for columns. */
static dm_status fill(dm_sparse *A, const dm_wave *w, double shift, dm_arena *arena) {
    const int32_t n = (int32_t)w->n;
    const dm_status status = dm_sparse_room(A, arena, n, n, (int64_t)n * n);
    if (status != DM_OK) return status;
    dm_wave_matrix(A->value, w, 1, 1);
    for (int32_t j = 0; j < n; j++) {
        A->start[j + 1] = (j + 1) * n;
        for (int32_t i = 0; i < n; i++) A->row[(size_t)j * w->n + (size_t)i] = i;
        A->value[(size_t)j * w->n + (size_t)j] -= shift;
    }
    return DM_OK;
}

/* T is not negative, so nothing of H lies below the least V; a little less is positive definite */
static double shift_of(const dm_wave *w) {
    double least = w->V[0], most = w->V[0];
    for (uint32_t j = 1; j < w->n; j++) {
        least = fmin(least, w->V[j]);
        most = fmax(most, w->V[j]);
    }
    return least - 1e-3 * (most - least) - 1e-3;
}

/* room for what the iteration is given and gives: masses 1, a start without order */
static dm_status take(dm_eigen_problem *p, double **ones, double **start, dm_arena *arena) {
    const size_t n = (size_t)p->S->columns, count = (size_t)p->count;
    *ones = dm_arena_take(arena, n * sizeof(double));
    *start = dm_arena_take(arena, n * sizeof(double));
    p->value = dm_arena_take(arena, count * sizeof(double));
    p->vector = dm_arena_take(arena, count * n * sizeof(double));
    if (!*ones || !*start || !p->value || !p->vector) return DM_NO_MEMORY;
    for (size_t j = 0; j < n; j++) {
        (*ones)[j] = 1.0;
        (*start)[j] = sin(1.0 + 0.7 * (double)j * (double)j);
    }
    p->mass = *ones, p->start = *start;
    return DM_OK;
}

/* by choice of the least: there are few */
static void sort(const dm_eigen_problem *p) {
    const size_t n = (size_t)p->S->columns;
    for (int32_t i = 0; i < p->count; i++)
        for (int32_t j = i + 1; j < p->count; j++) {
            if (p->value[j] >= p->value[i]) continue;
            const double value = p->value[i];
            p->value[i] = p->value[j], p->value[j] = value;
            for (size_t k = 0; k < n; k++) {
                double *a = p->vector + (size_t)i * n + k, *b = p->vector + (size_t)j * n + k;
                const double x = *a;
                *a = *b, *b = x;
            }
        }
}

/* w:lanczos(k) */
static int lanczos(lua_State *L) {
    const char *why;
    const dm_wave *w = dml_checkwave(L, 1);
    const lua_Integer count = dml_checkinteger(L, 2);
    const dm_solvers *solvers = dml_solvers(&why);
    luaL_argcheck(L, count >= 1 && count < w->n / 2, 2, "fewer states than half of the points");
    if (!solvers) return luaL_error(L, "%s", why);
    if (w->n > MOST_FULL)
        return luaL_error(L, "wave:eigen: spectra are for up to %d points", MOST_FULL);
    dm_arena *arena = dml_pusharena(L);
    const double shift = shift_of(w);
    dm_sparse A;
    dm_factor *factor = NULL;
    double condition, *ones, *start;
    dml_wavefail(L, fill(&A, w, shift, arena));
    dm_status status = solvers->factor(&factor, DM_CHOLESKY, &A, arena, &condition);
    dml_wavefail(L, status);
    /* of H - shift itself: its eigenvalues are those of H, less the shift */
    dm_eigen_problem p = {.S = &A,
                          .shifted = factor,
                          .shift = 0.0,
                          .count = (int32_t)count,
                          .stop = &dml_stop};
    status = take(&p, &ones, &start, arena);
    if (status == DM_OK) status = solvers->eigen(&p, arena);
    dml_wavefail(L, status);
    sort(&p);
    for (int32_t i = 0; i < p.count; i++) p.value[i] += shift;
    return dml_pushstates(L, w, p.value, p.vector, (uint32_t)p.count);
}

static const dml_row methods[] =
    {{"lanczos", lanczos,
      "w:lanczos(k) -> values, list of dm.vector\n"
      "As w:eigen(k), for up to 4096 unknowns, by the library behind dm/sparse.so; raises without "
      "it."},
     {NULL, NULL, NULL}};

static const dml_extension more[] = {{DML_WAVE, methods}, {NULL, NULL}};

const dml_class dml_class_wave_spectrum = {.more = more};
