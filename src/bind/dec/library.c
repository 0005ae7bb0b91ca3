/* library.c - dm/sparse.so, opened when the first solver is asked for. What takes long, large
 * orderings and factors, works in a process of its own, which Ctrl-C ends: they ask nobody. */
#include "bind/core/bind.h"
#include "bind/core/child_process.h"
#include "bind/core/module.h"
#include "bind/dec/bind_sparse.h"

/* entries of a matrix: fewer are factorized in less time than a process takes to make */
enum { FEW = 20000 };
static const double MANY = 2e8; /* operations: a tenth of a second, which Ctrl-C can wait for */

static const dm_solvers *loaded;

typedef struct {
    dm_factorization kind;
    const dm_sparse *A;
    const dm_analysis *known; /* or NULL */
    /* set */
    dm_analysis *analysis;
    dm_factor *factor;
    double condition;
    int64_t negatives;
} job;

static dm_status factorize(void *given, dm_arena *arena) {
    job *j = given;
    return loaded->factor_by(&j->factor, j->kind, j->A, j->known, arena, &j->condition);
}

static dm_status find_analysis(void *given, dm_arena *arena) {
    job *j = given;
    return loaded->analyse(&j->analysis, j->kind, j->A, arena);
}

static dm_status count_negatives(void *given, dm_arena *arena) {
    job *j = given;
    return loaded->inertia(&j->negatives, j->A, arena);
}

/* Short ones come many in a row, in one step, so that stop is looked at before each. */
static dm_status run(dml_work *work, job *j, dm_arena *arena) {
    const int is_short = j->known && loaded->operations(j->known) <= MANY;
    if (is_short && dml_stop) return DM_STOPPED;
    if (is_short || j->A->start[j->A->columns] <= FEW) return work(j, arena);
    return dml_child(work, j, sizeof *j, arena, &dml_stop);
}

static dm_status factor_by(dm_factor **out, dm_factorization kind, const dm_sparse *A,
                           const dm_analysis *known, dm_arena *arena, double *condition) {
    job j = {.kind = kind, .A = A, .known = known};
    const dm_status status = run(factorize, &j, arena);
    *out = status == DM_OK ? j.factor : NULL;
    *condition = j.condition;
    return status;
}

static dm_status factor(dm_factor **out, dm_factorization kind, const dm_sparse *A, dm_arena *arena,
                        double *condition) {
    return factor_by(out, kind, A, NULL, arena, condition);
}

static dm_status analyse(dm_analysis **out, dm_factorization kind, const dm_sparse *A,
                         dm_arena *arena) {
    job j = {.kind = kind, .A = A};
    const dm_status status = run(find_analysis, &j, arena);
    *out = status == DM_OK ? j.analysis : NULL;
    return status;
}

static dm_status refactor(dm_factor *f, const dm_analysis *known) {
    if (dml_stop) return DM_STOPPED;
    return loaded->operations(known) <= MANY ? loaded->refactor(f, known) : DM_TOO_LARGE;
}

static dm_status inertia(int64_t *negatives, const dm_sparse *A, dm_arena *arena) {
    job j = {.A = A};
    const dm_status status = run(count_negatives, &j, arena);
    *negatives = j.negatives;
    return status;
}

/* asked for once: the answer stays, also where it is no */
const dm_solvers *dml_solvers(const char **why) {
    static dm_solvers solvers;
    static char reason[DML_WHY];
    if (!loaded && !reason[0]) {
        loaded =
            dml_module("sparse", DM_SOLVERS_SYMBOL, "libsuitesparse-dev, libarpack2-dev", reason);
        if (loaded) solvers = *loaded;
        solvers.factor = factor;
        solvers.factor_by = factor_by;
        solvers.analyse = analyse;
        solvers.refactor = refactor;
        solvers.inertia = inertia;
    }
    *why = loaded ? NULL : reason;
    return loaded ? &solvers : NULL;
}
