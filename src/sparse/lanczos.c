/* lanczos.c - eigenpairs by ARPACK's implicitly restarted Lanczos iteration with shift and
 * invert: it looks for the largest eigenvalues nu = 1 / (lambda - shift) of (S - shift M)^-1 M in
 * the product of M.
 *
 * One start vector sees one direction of every eigenspace; the others come by rounding, and a
 * multiple eigenvalue may lack one when the iteration ends: dm_inertia counts what there is.
 *
 * The iteration knows the entries with mass alone: those without are in the kernel of M, where
 * their size is free, and rounding would grow there until it is all of a vector. They follow at the
 * end, x = (lambda - shift) (S - shift M)^-1 M x. */
#include "sparse/factor.h"

#include <arpack/arpack.h>

#include <string.h>

enum { CYCLES = 1000 };
static const double TOLERANCE = 1e-14; /* of nu, relative; values are far better than vectors */

/* one iteration and its arrays */
typedef struct {
    dm_eigen_problem *problem;
    int32_t n, wanted, basis; /* n: entries with mass */
    int32_t *at;              /* [n] which they are */
    double *v, *work, *small, *residual, *nu, *vector;
    double *load, *solution; /* of all entries */
    int *select;
} lanczos;

/* Sizes as dsaupd asks for them; v is the basis of the Krylov space, a column each. */
static int room(lanczos *l, dm_arena *arena) {
    const size_t n = (size_t)l->n, m = (size_t)l->basis, all = (size_t)l->problem->S->columns;
    l->v = dm_arena_take(arena, n * m * sizeof(double));
    l->work = dm_arena_take(arena, 3 * n * sizeof(double));
    l->small = dm_arena_take(arena, m * (m + 8) * sizeof(double));
    l->residual = dm_arena_take(arena, n * sizeof(double));
    l->nu = dm_arena_take(arena, m * sizeof(double));
    l->load = dm_arena_take(arena, all * sizeof(double));
    l->solution = dm_arena_take(arena, all * sizeof(double));
    l->select = dm_arena_take(arena, m * sizeof(int));
    if (l->select) memset(l->select, 0, m * sizeof(int)); /* read even where all are asked for */
    return l->v && l->work && l->small && l->residual && l->nu && l->load && l->solution &&
           l->select;
}

/* l->solution = (S - shift M)^-1 of a load on the entries with mass */
static dm_status solve(lanczos *l, const double *load) {
    memset(l->load, 0, (size_t)l->problem->S->columns * sizeof *l->load);
    for (int32_t i = 0; i < l->n; i++) l->load[l->at[i]] = load[i];
    l->problem->solves++;
    return dm_factor_solve(l->problem->shifted, l->solution, l->load);
}

static void weigh(const lanczos *l, double *y, const double *x) {
    for (int32_t i = 0; i < l->n; i++) y[i] = l->problem->mass[l->at[i]] * x[i];
}

/* what ARPACK asks for: y = (S - shift M)^-1 M x (-1), the same with M x given (1), y = M x (2) */
static dm_status answer(lanczos *l, int ido, const int *at) {
    const double *x = l->work + at[0] - 1, *given = l->work + at[2] - 1;
    double *y = l->work + at[1] - 1;
    if (ido == 2 || ido == -1) weigh(l, y, x);
    if (ido == 2) return DM_OK;
    const dm_status status = solve(l, ido == -1 ? y : given);
    for (int32_t i = 0; i < l->n; i++) y[i] = l->solution[l->at[i]];
    return status;
}

/* lambda, from nu; to l->nu and the vectors to `vector`; how many, or a negative number */
static int extract(lanczos *l, int *iparam, int *ipntr, const char *which) {
    int info = 0;
    const int wanted = l->wanted, all = l->problem->S->columns;
    dseupd_c(1, "A", l->select, l->nu, l->vector, all, l->problem->shift, "G", l->n, which, wanted,
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

/* all entries of vector k from those with mass, which stand at its beginning */
static dm_status complete(lanczos *l, int32_t k) {
    const dm_eigen_problem *p = l->problem;
    const int32_t all = p->S->columns;
    double *x = l->vector + (size_t)k * (size_t)all;
    if (l->n == all) return DM_OK;
    weigh(l, l->work, x);
    const dm_status status = solve(l, l->work);
    if (status != DM_OK) return status;
    memcpy(l->work, x, (size_t)l->n * sizeof *x);
    for (int32_t i = 0; i < all; i++) x[i] = (l->nu[k] - p->shift) * l->solution[i];
    for (int32_t i = 0; i < l->n; i++) x[l->at[i]] = l->work[i];
    return DM_OK;
}

/* the entries with mass; how many */
static int32_t massive(int32_t *at, const dm_eigen_problem *p) {
    int32_t n = 0;
    for (int32_t i = 0; i < p->S->columns; i++)
        if (p->mass[i] > 0.0) at[n++] = i;
    return n;
}

dm_status dm_lanczos(dm_eigen_problem *p, dm_arena *arena) {
    const int32_t basis = 2 * p->count + 1 > 20 ? 2 * p->count + 1 : 20;
    lanczos l = {.problem = p, .wanted = p->count, .vector = p->vector};
    int converged = 0;
    l.at = dm_arena_take(arena, (size_t)p->S->columns * sizeof *l.at);
    if (!l.at) return DM_NO_MEMORY;
    l.n = massive(l.at, p);
    l.basis = basis < l.n ? basis : l.n;
    if (l.wanted >= l.n) return DM_NO_CONVERGENCE;
    p->solves = 0;
    if (!room(&l, arena)) return DM_NO_MEMORY;
    for (int32_t i = 0; i < l.n; i++) l.residual[i] = p->start[l.at[i]];
    dm_status status = iterate(&l, &converged);
    for (int32_t k = 0; status == DM_OK && k < p->count; k++) status = complete(&l, k);
    if (status != DM_OK) return status;
    memcpy(p->value, l.nu, (size_t)p->count * sizeof *p->value);
    return DM_OK;
}
