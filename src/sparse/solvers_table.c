/* solvers_table.c - what the module gives: the table of linalg/sparse/solvers.h. */
#include "sparse/factor.h"

/* The struct lies in the arena, what the libraries take in blocks of its allocator. */
static dm_status factor(dm_factor **out, dm_factorization kind, const dm_sparse *A, dm_arena *arena,
                        double *condition) {
    dm_factor *f = dm_arena_take(arena, sizeof *f);
    *out = NULL;
    if (!f) return DM_NO_MEMORY;
    *f = (dm_factor){.kind = kind, .A = A, .arena = arena};
    const dm_status status =
        kind == DM_CHOLESKY ? dm_cholesky_factor(f, condition) : dm_umfpack_factor(f, condition);
    if (status != DM_OK) {
        dm_library_release(f);
        return status;
    }
    *out = f;
    return DM_OK;
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
    .solve = dm_factor_solve,
    .release = dm_library_release,
    .eigen = dm_lanczos,
    .inertia = dm_inertia,
};
