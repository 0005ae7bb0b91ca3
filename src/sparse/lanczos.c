/* lanczos.c - eigenpairs by ARPACK's implicitly restarted Lanczos iteration with shift and
 * invert: it looks for the largest eigenvalues nu = 1 / (lambda - shift) of (S - shift M)^-1 M in
 * the product of M.
 *
 * One start vector sees one direction of every eigenspace; the others come by rounding, and a
 * multiple eigenvalue may lack one when the iteration ends: dm_inertia counts what there is. */
#include "sparse/factor.h"

#include <arpack/arpack.h>

#include <string.h>

enum { CYCLES = 1000 };
static const double TOLERANCE = 1e-14; /* of nu, relative; values are far better than vectors */

/* one iteration and its arrays */
typedef struct {
    dm_eigen_problem *problem;
    int32_t n, wanted, basis;
    double *v, *work, *small, *residual, *nu, *vector, *rhs;
    int *select;
} lanczos;

/* Sizes as dsaupd asks for them; v is the basis of the Krylov space, a column each. */
static int room(lanczos *l, dm_arena *arena) {
    const size_t n = (size_t)l->n, m = (size_t)l->basis;
    l->v = dm_arena_take(arena, n * m * sizeof(double));
    l->work = dm_arena_take(arena, 3 * n * sizeof(double));
    l->small = dm_arena_take(arena, m * (m + 8) * sizeof(double));
    l->residual = dm_arena_take(arena, n * sizeof(double));
    l->nu = dm_arena_take(arena, m * sizeof(double));
    l->rhs = dm_arena_take(arena, n * sizeof(double));
    l->select = dm_arena_take(arena, m * sizeof(int));
    if (l->select) memset(l->select, 0, m * sizeof(int)); /* read even where all are asked for */
    return l->v && l->work && l->small && l->residual && l->nu && l->rhs && l->select;
}

/* what ARPACK asks for: y = (S - shift M)^-1 M x (-1), the same with M x given (1), y = M x (2) */
static dm_status answer(lanczos *l, int ido, const int *at) {
    dm_eigen_problem *p = l->problem;
    const double *x = l->work + at[0] - 1, *given = l->work + at[2] - 1;
    double *y = l->work + at[1] - 1;
    if (ido == 2 || ido == -1) {
        double *to = ido == 2 ? y : l->rhs;
        for (int32_t i = 0; i < l->n; i++) to[i] = p->mass[i] * x[i];
        if (ido == 2) return DM_OK;
        given = l->rhs;
    }
    p->solves++;
    return dm_factor_solve(p->shifted, y, given);
}

/* lambda, from nu; to l->nu and the vectors to `vector`; how many, or a negative number */
static int extract(lanczos *l, int *iparam, int *ipntr, const char *which) {
    int info = 0;
    const int wanted = l->wanted;
    dseupd_c(1, "A", l->select, l->nu, l->vector, l->n, l->problem->shift, "G", l->n, which, wanted,
             TOLERANCE, l->residual, l->basis, l->v, l->n, iparam, ipntr, l->work, l->small,
             l->basis * (l->basis + 8), &info);
    return info == 0 ? iparam[4] : -1;
}

/* one iteration to its end; *converged vectors stand in l->vector */
static dm_status iterate(lanczos *l, int *converged) {
    const char *which = l->problem->above ? "LA" : "LM";
    int ido = 0, info = 1, ipntr[14] = {0}, iparam[11] = {1, 0, CYCLES, 1, 0, 0, 3};
    for (;;) {
        dsaupd_c(&ido, "G", l->n, which, l->wanted, TOLERANCE, l->residual, l->basis, l->v, l->n,
                 iparam, ipntr, l->work, l->small, l->basis * (l->basis + 8), &info);
        if (ido == 99) break;
        if (l->problem->stop && *l->problem->stop) return DM_STOPPED;
        const dm_status status = answer(l, ido, ipntr);
        if (status != DM_OK) return status;
    }
    /* 1: cycles are used up; what has converged is counted below */
    if (info < 0) return DM_NO_CONVERGENCE;
    *converged = extract(l, iparam, ipntr, which);
    return *converged >= l->wanted ? DM_OK : DM_NO_CONVERGENCE;
}

dm_status dm_lanczos(dm_eigen_problem *p, dm_arena *arena) {
    const int32_t n = p->S->columns, basis = 2 * p->count + 1 > 20 ? 2 * p->count + 1 : 20;
    lanczos l = {.problem = p, .n = n, .wanted = p->count, .basis = basis < n ? basis : n};
    int converged = 0;
    l.vector = p->vector;
    p->solves = 0;
    if (!room(&l, arena)) return DM_NO_MEMORY;
    memcpy(l.residual, p->start, (size_t)n * sizeof *l.residual);
    const dm_status status = iterate(&l, &converged);
    if (status != DM_OK) return status;
    memcpy(p->value, l.nu, (size_t)p->count * sizeof *p->value);
    return DM_OK;
}
