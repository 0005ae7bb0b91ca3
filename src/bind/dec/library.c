/* library.c - dm/sparse.so, opened when the first solver is asked for. */
#include "bind/core/module.h"
#include "bind/dec/bind_sparse.h"

/* asked for once: the answer stays, also where it is no */
const dm_solvers *dml_solvers(const char **why) {
    static const dm_solvers *solvers;
    static char reason[DML_WHY];
    if (!solvers && !reason[0])
        solvers =
            dml_module("sparse", DM_SOLVERS_SYMBOL, "libsuitesparse-dev, libarpack2-dev", reason);
    *why = solvers ? NULL : reason;
    return solvers;
}
