/* run_events.h - `events = { name = function(q, v, t, p) ... end }` of a run, and what it found. */
#ifndef DML_RUN_EVENTS_H
#define DML_RUN_EVENTS_H

#include "bind/run/observables.h"
#include "run/events.h"

typedef struct dml_found dml_found;

typedef struct {
    dml_observables g;
    dm_event list[DML_OBSERVABLES];
    dm_events events;
    const dm_stepper *stepper;
    dm_arena *arena;          /* of what was found */
    dml_found *first, **last; /* in the order of time */
    int names;                /* stack index of the list of names */
} dml_run_events;

/* Field 'events' of the options at 2. Leaves things on the stack that must stay. */
void dml_events_read(lua_State *L, dml_run_events *e, const dml_stepping *r);

/* Push what was found: a list of { name =, t =, q =, p = }, of the system at that stack index. */
void dml_pushevents(lua_State *L, const dml_run_events *e, int system);

/* Note for the failure of the run which function was NaN; the text stays on the stack. */
void dml_events_missed(lua_State *L, const dml_run_events *e, dml_stepping *r);

#endif
