/* bind_failure.h - the one way in which a failed computation reaches a script. */
#ifndef DML_FAILURE_H
#define DML_FAILURE_H

#include "bind/core/bind.h"

typedef struct {
    dm_status status;
    long step;   /* the step that failed, from 1 */
    double time; /* its start; NaN: steps have no time */
    double h;
    double residual; /* of its step equation */
    int iterations;
    int fading;              /* d2L/dv2 was about to lose a value */
    int constraint, rolling; /* from 1: the one that depends on the others there, 0: none */
    int crosses;             /* that one does inside of the step, at this time */
    double at;
    int turned;      /* `root` says all */
    int constrained; /* are there constraints, holonomic or rolling? */
    const char *rule;
    const char
        *root; /* why an implicit function had no value, "; ...", what the method knows, or NULL */
} dml_failure;

/* why a step failed where d2L/dv2 was about to lose a value, and did it fail so? */
extern const char dml_failure_fading[];
int dml_failure_fades(int fading, dm_status status);

/* Push why, or what to try. */
void dml_failure_reason(lua_State *L, const dml_failure *f);

/* Raise a dm.failure {code, step, time, residual, iterations, rule, message, path}; the path so far
 * is the value at stack index `path` (0: none). */
void dml_fail(lua_State *L, const dml_failure *f, int path);

/* The same of a stop, which it answers, of `what` at a step; the path so far is on top. */
void dml_stopped(lua_State *L, const char *what, long step);

#endif
