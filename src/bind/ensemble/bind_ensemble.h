/* bind_ensemble.h - `dm.ensemble` as the files that make it see it. */
#ifndef DML_ENSEMBLE_H
#define DML_ENSEMBLE_H

#include "bind/run/stepping.h"
#include "run/departure.h"
#include "run/ensemble/ensemble.h"

typedef struct {
    long members;
    uint32_t n;
    uint32_t lanes; /* members that went side by side */
    long systems;   /* parts that were a system of their own; 1: all members */
    double t, h;
    const dm_pace *pace;   /* members with steps of their own, or NULL */
    double *state;         /* members x dm_state_size(n) */
    dm_member *member;     /* members */
    dm_trouble *trouble;   /* members; of those that have one */
    dm_ensemble_rows rows; /* room 0: none are kept */
    double t0;
} dml_ensemble;

/* user values of dm.ensemble: fields made so far, the solver, the values that vary and their
 * names (or nil), the names of columns that were watched (or nil), the paces of members (or
 * nil), why members failed (or nil), what was found beside flows and the names of its columns (or
 * nil), the model that members without values of their own were stepped with, the params of the
 * system where others varied some (or nil) */
enum {
    DML_ENSEMBLE_FIELDS = 1,
    DML_ENSEMBLE_SOLVER,
    DML_ENSEMBLE_VARIED,
    DML_ENSEMBLE_NAMES,
    DML_ENSEMBLE_COLUMNS,
    DML_ENSEMBLE_STEPS,
    DML_ENSEMBLE_MESSAGES,
    DML_ENSEMBLE_FOLLOWED,
    DML_ENSEMBLE_ASIDE,
    DML_ENSEMBLE_MODEL,
    DML_ENSEMBLE_PARAMS,
    DML_ENSEMBLE_VALUES = DML_ENSEMBLE_PARAMS
};

#define DML_ENSEMBLE "dm.ensemble"

/* Push one with all states zero and room for rows as `rows` says (its data and count are set);
 * raises when it would not fit into memory. */
dml_ensemble *dml_pushensemble(lua_State *L, long members, uint32_t n,
                               const dm_ensemble_rows *rows);

/* ensemble:path(i) */
int dml_ensemble_path(lua_State *L);

/* Push what is known of why member i of the ensemble at `at` failed, beyond its status; 0: nothing
 * is, and nothing was pushed. */
int dml_ensemblereason(lua_State *L, int at, long i);

/* Push the table of these texts by member, an empty one where there was none. */
void dml_ensemblemessages(lua_State *L, int at);

/* Sources of numbers for members: field `key` of the table at `arg`, a function of the member's
 * number or a table, matrix or vector with an entry for each. check: raises unless it is one.
 * push: what it has for member i (from 0). */
void dml_check_source(lua_State *L, int arg, const char *key, long members);
void dml_push_source(lua_State *L, int arg, const char *key, long i);

/* Members first .. first + count - 1, whose parameters are the same. */
typedef struct {
    dml_ensemble *e;
    long first, count, steps;
    int at;       /* stack index of the ensemble */
    int velocity; /* starts are q and v, not q and p; or DML_PLACES_ALONE, then v is 0 */
    int varied;   /* these are not the parameters of the system */
    int names;    /* stack index of parameters that are inputs of the kernels; 0: none are */
    const double *values; /* of these */
    const double *energy; /* that all steps are to have; NULL: that of the first one */
    dm_follow *follow;    /* [members] of the ensemble beside their flows; NULL: they have none */
} dml_part;

/* What is done to the start of every member of a part: body does it to member `next`, and
 * leaves the stack as it was. */
typedef struct dml_starting {
    const dml_part *these;
    dml_stepping *r;
    void (*body)(lua_State *L, struct dml_starting *s);
    long next;
    int theirs;       /* a function of the user runs: what it raises is no member's alone */
    const char *key;  /* of the options, for all members */
    int source;       /* its stack index */
    int field;        /* of a field, which may move its starts */
    double *v, *room; /* of one member */
    long inside;      /* members that start in the domain of L */
} dml_starting;

/* Over all members; raises with the first reason and the numbers of those that cannot start. */
void dml_each_start(lua_State *L, dml_starting *s);

/* The options q, and v or p: raises unless they are sources; 1 for v, DML_PLACES_ALONE where
 * neither is there, which is a start where L is linear in v. */
enum { DML_PLACES_ALONE = 2 };
int dml_check_starts(lua_State *L, const dml_solver *solver, long members);

/* Their numbers into the states of a part, with momenta; the trace is checked at its first
 * member. Returns how many are inside of the domain of L; raises where none is and parameters
 * are the system's own numbers. */
long dml_read_starts(lua_State *L, const dml_part *these, dml_stepping *r);

/* q, and v or p as they are given, into the states of a part. */
void dml_read_places(lua_State *L, const dml_part *these);

/* vary = { name = source } of the options at 2: pushes a userdata of values[members][*count],
 * the names as a table above it. NULL and nothing pushed without that field. */
const double *dml_read_vary(lua_State *L, long members, uint32_t *count);

/* Members from `first` on that have the same values. */
long dml_vary_alike(const double *values, uint32_t count, long first, long members);

/* What vary = {} asks for: values[members][count], names in a list on the stack; values NULL:
 * nothing. */
typedef struct {
    const double *values;
    uint32_t count;
    int names;
} dml_varied;

/* Values of all parameters that kernels of the solver at 1 have as inputs, for every member:
 * pushes a userdata. NULL and another value pushed where it has none, or where something varies
 * that is no input. */
const double *dml_vary_inputs(lua_State *L, long members, const dml_varied *v);

/* True when the trace with these inputs is the function where the members of a part start. */
int dml_vary_is_traced(lua_State *L, const dml_part *p, dml_stepping *r);

/* Replace the solver at 1 by one of the same rule for a system with these values; names at
 * `names`; the other params are those at `base`, 0: those of the system. */
dml_solver *dml_vary_solver(lua_State *L, const double *values, int names, int base);

/* Fill that in for a part that was stepped by *of, whose stepper is still open; what looked at the
 * inertia, or NULL. */
void dml_note_reasons(lua_State *L, const dml_part *p, const dml_stepping *of, dm_inertia *x);

/* Run one part with the solver at 1 and the options at 2. */
typedef dm_status dml_part_run(lua_State *L, const dml_part *p, void *ud);

/* All members by parts of the same parameters, each a system of its own. What a part raises
 * fails its members alone; raises only where no part could be run. */
dm_status dml_run_parts(lua_State *L, dml_part *p, const dml_varied *v, dml_part_run *run,
                        void *ud);

/* h = source of the options at 2: a step of its own for every member; with t = duration as many
 * as cover it, else `steps`. Pushes a userdata and returns it, the largest number of steps in
 * *most; NULL and nil pushed without that field. */
const dm_pace *dml_read_steps(lua_State *L, const dml_solver *solver, long members, long *most);

/* every = k, or rows = n: about n rows of `steps` steps; 1 without either */
long dml_read_every(lua_State *L, long steps);

/* ensemble:summary(name), :departure(i, flow, j, names), :range(i, name),
 * :stride(i, names, share); core.summary(t, y) of rows that no ensemble made */
int dml_core_summary(lua_State *L);
int dml_ensemble_summary(lua_State *L);
int dml_ensemble_departure(lua_State *L);
int dml_ensemble_range(lua_State *L);
int dml_ensemble_stride(lua_State *L);

/* The rows of the member whose ensemble is at `arg` and whose number is behind it, and the place of
 * a watched column in them. */
dm_run_table dml_ensemble_table(lua_State *L, int arg);
uint32_t dml_ensemble_column(lua_State *L, int arg, const char *name);

/* The options at 2 become those of their field `beside`, and they themselves are pushed; 0 and
 * nothing without that field. */
int dml_follow_options(lua_State *L);

/* Members beside their flows, as that field says: pushes a userdata and the names of its columns,
 * or two nils. */
dm_follow *dml_read_follow(lua_State *L, const dml_part *p, double t0);

/* ensemble:followed(i) */
int dml_ensemble_followed(lua_State *L);

/* solver:ensemble{} */
int dml_solver_ensemble(lua_State *L);

#endif
