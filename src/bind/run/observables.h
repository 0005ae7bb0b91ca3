/* observables.h - functions of the state that a run evaluates as kernels: what it records, what
 * it looks for. */
#ifndef DML_OBSERVABLES_H
#define DML_OBSERVABLES_H

#include "bind/run/stepping.h"
#include "run/run.h"

enum { DML_OBSERVABLES = 64 }; /* of one run, at most */

typedef struct {
    dm_observer observer;
    dm_observable list[DML_OBSERVABLES];
    dm_kernel kernel[DML_OBSERVABLES];
} dml_observables;

/* Nothing is observed yet. */
void dml_observables_start(dml_observables *o, const dml_stepping *r);

/* Add f(q, v, t, p) on top of the stack, traced; it gives one number, or with `any` several.
 * `what` names it in messages. The stack grows by what keeps the kernel alive. Raises what
 * dml_trace raises. */
void dml_observables_add(lua_State *L, dml_observables *o, const dml_stepping *r, const char *what,
                         int any);

/* Add the energy, or an entry of (q, p). */
void dml_observables_energy(lua_State *L, dml_observables *o, const dml_stepping *r);
void dml_observables_entry(lua_State *L, dml_observables *o, uint32_t entry);

/* Add `count` parts of the engine from `first` on (dm_engine.parts). */
void dml_observables_parts(lua_State *L, dml_observables *o, const dml_stepping *r, uint32_t first,
                           uint32_t count);

/* Room for the observer; it stays on the stack. */
void dml_observables_end(lua_State *L, dml_observables *o);

/* Push the list of the keys of a table: 1, 2, ... first, then names in alphabetic order. Raises
 * on other keys, naming the field. */
void dml_pushkeys(lua_State *L, int table, const char *field);

/* The columns that field 'watch' of the options at 2 asks for; the list of their names is left
 * at the old top of the stack + 1, under what keeps the kernels. */
void dml_watch_read(lua_State *L, dml_observables *o, const dml_stepping *r);

/* Note for the failure of the run, whose path is at `at`, which column was NaN (dm_observe_row);
 * the text stays on the stack. */
void dml_watch_missed(lua_State *L, const dml_observables *o, int at, dml_stepping *r);

/* Raise that gaps are given where nothing is watched or recorded that could have them. */
void dml_refuse_gaps(lua_State *L);

/* Does a run have columns beside q and p, by field 'record' of the options at 2 or as parts of its
 * steps? Without, gaps are refused. */
int dml_records(lua_State *L, const dml_stepping *r);

/* The same for parts and for field 'record': names of columns beside t, q and p, to be appended to
 * those. "impulses" and "inner" are noted: their names follow behind all others. */
void dml_record_read(lua_State *L, dml_observables *o, const dml_stepping *r,
                     dm_impulses *impulses);

#endif
