/* solvers_table.c - what the module gives: the table of linalg/sparse/solvers.h. */
#include "sparse/factor.h"

/* The struct lies in the arena, what the libraries take in blocks of its allocator. */
static dm_status factor_by(dm_factor **out, dm_factorization kind, const dm_sparse *A,
                           const dm_analysis *known, dm_arena *arena, double *condition) {
    dm_factor *f = dm_arena_take(arena, sizeof *f);
    *out = NULL;
    if (!f) return DM_NO_MEMORY;
    *f = (dm_factor){.kind = kind, .A = A, .arena = arena};
    const dm_status status = kind == DM_CHOLESKY ? dm_cholesky_factor(f, known, condition)
                                                 : dm_umfpack_factor(f, known, condition);
    if (status != DM_OK) {
        dm_library_release(f);
        return status;
    }
    *out = f;
    return DM_OK;
}

static dm_status factor(dm_factor **out, dm_factorization kind, const dm_sparse *A, dm_arena *arena,
                        double *condition) {
    return factor_by(out, kind, A, NULL, arena, condition);
}

static dm_status analyse(dm_analysis **out, dm_factorization kind, const dm_sparse *A,
                         dm_arena *arena) {
    dm_analysis *a = dm_arena_take(arena, sizeof *a);
    *out = NULL;
    if (!a) return DM_NO_MEMORY;
    a->f = (dm_factor){.kind = kind, .A = A, .arena = arena};
    const dm_status status =
        kind == DM_CHOLESKY ? dm_cholesky_analyse(&a->f) : dm_umfpack_analyse(&a->f);
    if (status == DM_OK)
        *out = a;
    else
        dm_library_release(&a->f);
    return status;
}

static double operations(const dm_analysis *known) {
    return known->f.operations;
}

static dm_status refactor(dm_factor *f, const dm_analysis *known) {
    return f->kind == DM_CHOLESKY ? dm_cholesky_refactor(f) : dm_umfpack_refactor(f, known);
}

static void release_analysis(dm_analysis *a) {
    dm_library_release(&a->f);
}

/* A solve keeps workspace in the factorization. */
dm_status dm_factor_solve(const dm_factor *given, double *x, const double *b) {
    dm_factor *f = (dm_factor *)(uintptr_t)given;
    return f->kind == DM_CHOLESKY ? dm_cholesky_solve(f, x, b) : dm_umfpack_solve(f, x, b);
}

extern const dm_solvers dm_solvers_table;
const dm_solvers dm_solvers_table = {
    .name = "CHOLMOD, UMFPACK, ARPACK",
    .factor = factor,
    .analyse = analyse,
    .factor_by = factor_by,
    .operations = operations,
    .refactor = refactor,
    .solve = dm_factor_solve,
    .release = dm_library_release,
    .release_analysis = release_analysis,
    .eigen = dm_lanczos,
    .inertia = dm_inertia,
};
