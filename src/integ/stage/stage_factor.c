/* stage_factor.c - factors come and go, analyses stay until the end. */
#include "integ/stage/stage_factor.h"

void dm_stage_factor_open(dm_stage_factor *f, const dm_arena *from) {
    *f = (dm_stage_factor){.factor = NULL};
    dm_arena_init(&f->arena, from->allocate, from->ud);
    dm_arena_init(&f->plans, from->allocate, from->ud);
}

/* by the analysis of its kind; factors of that kind get new numbers in their place */
static dm_status make(dm_stage_factor *f, const dm_solvers *solvers, const dm_sparse *S,
                      dm_factorization kind, int once) {
    double condition;
    dm_analysis **known = f->known + (kind == DM_LU);
    dm_status status = DM_OK;
    if (f->factor && !once && f->kind == kind && solvers->refactor(f->factor, *known) == DM_OK)
        return DM_OK;
    dm_stage_factor_drop(f, solvers);
    f->kind = kind;
    if (once) return solvers->factor(&f->factor, kind, S, &f->arena, &condition);
    if (!*known) status = solvers->analyse(known, kind, S, &f->plans);
    if (status != DM_OK) return status;
    return solvers->factor_by(&f->factor, kind, S, *known, &f->arena, &condition);
}

dm_status dm_stage_factor_make(dm_stage_factor *f, const dm_solvers *solvers, const dm_sparse *S,
                               int symmetric, int once) {
    dm_status status = DM_SINGULAR;
    if (symmetric) status = make(f, solvers, S, DM_CHOLESKY, once);
    return status == DM_SINGULAR ? make(f, solvers, S, DM_LU, once) : status;
}

void dm_stage_factor_drop(dm_stage_factor *f, const dm_solvers *solvers) {
    if (f->factor) solvers->release(f->factor);
    f->factor = NULL;
    dm_arena_release(&f->arena);
}

void dm_stage_factor_close(dm_stage_factor *f, const dm_solvers *solvers) {
    dm_stage_factor_drop(f, solvers);
    for (int k = 0; k < 2; k++) {
        if (f->known[k]) solvers->release_analysis(f->known[k]);
        f->known[k] = NULL;
    }
    dm_arena_release(&f->plans);
}
