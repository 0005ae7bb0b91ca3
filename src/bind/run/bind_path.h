/* bind_path.h - `dm.path` for the other bindings: rows of t, q[n], p[momenta] in one block. */
#ifndef DML_PATH_H
#define DML_PATH_H

#include "bind/model/bind_system.h"
#include "integ/method/method.h"

typedef struct {
    uint32_t n;       /* entries of q: dim Q, or flat coordinates of an element of a group */
    uint32_t momenta; /* entries of p: n, or the dimension of the group */
    int placed;       /* q[i] are elements of a group (space_group.h) */
    uint32_t width;   /* columns of a row */
    int watched;      /* its rows hold t and what was watched, not q and p */
    long rows;        /* recorded */
    long unfiled;     /* of those, rows that the file of the run did not take */
    long steps;       /* finished */
    double h, t0, t;  /* step, first and last time */
    double until;     /* time that the run was to reach; infinite where steps were asked for */
    long every;       /* a row for so many steps */
    double ns_per_step;
    double constraint, rolling; /* largest |g|, |phi| that the solver saw */
    double condition, defect,
        drift;            /* of curves with a fast phase, as dm_report has them, else 0 */
    dm_energy_report sem; /* of steps that chose h by their energy; no steps: others */
    const char *rule;     /* as the user gave it; kept by the path */
    double *
        /* rows x width: t, q[n], p[momenta] and what was recorded beside, or what was watched */
        data;
} dml_path;

/* user values of dm.path: the system, the rule as written, the traced model, the names of
 * columns of a path that watched or recorded (else nil), the events (else nil), the end from
 * which a run can go on (checkpoint.h), the solver, the name of the file of rows */
enum {
    DML_PATH_SYSTEM = 1,
    DML_PATH_RULE,
    DML_PATH_MODEL,
    DML_PATH_NAMES,
    DML_PATH_EVENTS,
    DML_PATH_END,
    DML_PATH_SOLVER,
    DML_PATH_FILE,
    DML_PATH_VALUES = DML_PATH_FILE
};

#define DML_PATH "dm.path"

/* Push an empty path with room for `rows` rows of `width` columns for the system at stack index
 * `system`. Raises when the block would not fit in half of the machine's memory. */
dml_path *dml_pushpath(lua_State *L, int system, uint32_t n, long rows, uint32_t width);

/* Columns of a row: t, q[n], p[momenta], or t and what was watched. */
static inline uint32_t dml_path_width(const dml_path *p) {
    return p->width;
}

/* The path at stack index 1; raises where its rows hold no q and p, which `what` needs. */
dml_path *dml_path_states(lua_State *L, const char *what);

/* The rest is shared by the files of the class; the path is at stack index 1. */

/* Push the view path.<name> of `count` columns from `first`. */
int dml_path_columns(lua_State *L, const char *name, uint32_t first, uint32_t count);

/* How many columns are called `stem` or stem1, stem2 ..., and the first of them. */
uint32_t dml_path_group(lua_State *L, const char *stem, uint32_t *first);

/* Push the table of column names; number of the column called `name` (raises when there
 * is none). */
int dml_path_names(lua_State *L);
/* Push the names of t, q[n] and p[momenta] of a system at index `system`. */
void dml_state_names(lua_State *L, int system, uint32_t n, uint32_t momenta);
uint32_t dml_path_find(lua_State *L, const char *name);

/* Is there a column of that name? */
int dml_path_has(lua_State *L, const char *name);

/* dm.path{system =, h =, columns =}, as a C function (path_new.c). */
int dml_path_new(lua_State *L);

/* The model that the path was stepped with, with the kernels `want` made now; a path loaded from
 * elsewhere has one, too. */
dml_model *dml_path_kernels(lua_State *L, unsigned want);

/* Push room for x = (q, v, t) and, behind it, for the Legendre transform; v of the first row starts
 * from p. */
double *dml_path_scratch(lua_State *L, const dml_path *p, const dml_model *m);

/* x of row i, v from p by the inverse Legendre transform starting from the v in x. */
dm_status dml_path_row(const dml_path *p, const dml_model *m, long i, double *x, double *work);

/* path:column(name), path:energy() and path:momentum(), as C functions of the path. */
int dml_path_column(lua_State *L);
int dml_path_energy(lua_State *L);
int dml_path_momentum(lua_State *L);
extern const dml_row dml_path_quantities[]; /* the methods that compute along the path */
extern const dml_row dml_path_functions[];  /* functions of dm beside them */

#endif
