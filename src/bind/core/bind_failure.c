/* bind_failure.c - `dm.failure`: what a solver raises, with the path computed so far. */
#include "bind/core/bind_failure.h"

#include <math.h>
#include <string.h>

#define TNAME "dm.failure"

static int failure_tostring(lua_State *L) {
    lua_getfield(L, 1, "message");
    return 1;
}

/* holonomic constraints that lose rank inside of a step; one alone by its own row */
static void push_crossing(lua_State *L, const dml_failure *f) {
    lua_pushfstring(L,
                    f->constraint > 1 ? "constraint %d depends on those before it"
                                      : "the derivative of constraint %d vanishes",
                    f->constraint);
    lua_pushfstring(L,
                    " inside of this step, at t = %f: the constraints cross there, more than one "
                    "way leads on, and a step may take any of them; start where it is not met, "
                    "write the way that is meant as constraints of its own, or let steps go over "
                    "such places by crossings = true of the system, or of Ld",
                    f->at);
    lua_concat(L, 2);
}

/* constraints that lost rank */
static void push_constraint(lua_State *L, const dml_failure *f) {
    if (f->crosses) {
        push_crossing(L, f);
        return;
    }
    lua_pushfstring(L,
                    "%s %d depends on those before it there, or its reactions cannot hold it: a "
                    "singular configuration of the constraints; start where it is not met, or "
                    "leave one out",
                    f->rolling ? "rolling constraint" : "constraint",
                    f->rolling ? f->rolling : f->constraint);
}

/* what to try; a sentence per status, with the step of the run where it helps */
static void push_advice(lua_State *L, const dml_failure *f) {
    switch (f->status) {
    case DM_NO_CONVERGENCE:
        lua_pushfstring(L, "try a smaller step (h = %f), or look at failure.path for a singularity",
                        f->h / 2);
        break;
    case DM_SINGULAR:
        if (f->constraint || f->rolling) {
            push_constraint(L, f);
            break;
        }
        lua_pushstring(L, f->constrained
                              ? "constraints come near to depend on each other there, or d2L/dv2 "
                                "loses rank on what they leave: is it a singular configuration?"
                              : "d2L/dv2 or the discrete d2Ld/dq0dq1 loses rank there: is L "
                                "regular, are the coordinates good at this point?");
        break;
    case DM_NOT_FINITE:
        lua_pushfstring(L, "%s: try a smaller step (h = %f), or another start",
                        f->step > 1
                            ? "the state left the domain of L or grew without bound"
                            : "the first step leaves the domain of L, or a derivative of L is "
                              "infinite at the start",
                        f->h / 2);
        break;
    case DM_INERTIA:
        lua_pushstring(L, "a value of d2L/dv2 passes through zero there, so that the momentum no "
                          "longer determines the velocity, or grows without bound: the motion "
                          "ends; solver:singularities shows how it comes near");
        break;
    case DM_STOPPED:
        lua_pushstring(L, "the path so far is in failure.path");
        break;
    case DM_NO_VALUE:
        lua_pushstring(L, "is the function that is watched inside its domain there? gaps = true "
                          "keeps NaN");
        break;
    case DM_NOT_WRITTEN:
        lua_pushstring(L, "is the folder there, is the disk full? The path so far is in "
                          "failure.path");
        break;
    default:
        lua_pushstring(L, "see failure.path for what was computed");
    }
}

const char dml_failure_fading[] =
    "a value of d2L/dv2 goes to zero there, behind which the momentum determines no velocity near "
    "this one: a fold of the momentum, where motions end, or a pole of the coordinates; "
    "solver:singularities shows it";

int dml_failure_fades(int fading, dm_status status) {
    return fading &&
           (status == DM_NO_CONVERGENCE || status == DM_SINGULAR || status == DM_TOO_SHORT);
}

static void set_number(lua_State *L, const char *key, double x) {
    lua_pushnumber(L, x);
    lua_setfield(L, -2, key);
}

void dml_failure_reason(lua_State *L, const dml_failure *f) {
    if (f->root && *f->root)
        lua_pushstring(L, f->root + strspn(f->root, "; "));
    else
        push_advice(L, f);
}

static void push_time(lua_State *L, const dml_failure *f) {
    if (isnan(f->time))
        lua_pushstring(L, "; ");
    else if (f->status == DM_NO_CONVERGENCE)
        lua_pushfstring(L, " (t = %f, residual %f after %d iterations); ", f->time, f->residual,
                        f->iterations);
    else
        lua_pushfstring(L, " (t = %f); ", f->time);
}

/* rule, what happened, when, and why or what to try */
static void push_message(lua_State *L, const dml_failure *f) {
    const LUAI_UACINT step = (LUAI_UACINT)f->step;
    luaL_where(L, 1);
    if (f->turned) {
        lua_pushfstring(L, "%s: %s (step %I, t = %f)", f->rule, f->root, step, f->time);
        lua_concat(L, 2);
        return;
    }
    lua_pushfstring(L, "%s: %s at step %I", f->rule, dm_status_text(f->status), step);
    push_time(L, f);
    dml_failure_reason(L, f);
    lua_concat(L, 4);
}

void dml_fail(lua_State *L, const dml_failure *f, int path) {
    if (path) path = lua_absindex(L, path);
    lua_createtable(L, 0, 8);
    lua_pushstring(L, dm_status_code(f->status));
    lua_setfield(L, -2, "code");
    lua_pushinteger(L, f->step);
    lua_setfield(L, -2, "step");
    lua_pushinteger(L, f->iterations);
    lua_setfield(L, -2, "iterations");
    lua_pushstring(L, f->rule);
    lua_setfield(L, -2, "rule");
    if (!isnan(f->time)) set_number(L, "time", f->time);
    set_number(L, "residual", f->residual);
    if (f->fading) lua_pushboolean(L, 1), lua_setfield(L, -2, "fading");
    if (f->constraint) set_number(L, "constraint", f->constraint);
    if (f->rolling) set_number(L, "rolling", f->rolling);
    if (path) lua_pushvalue(L, path), lua_setfield(L, -2, "path");
    push_message(L, f);
    lua_setfield(L, -2, "message");
    luaL_setmetatable(L, TNAME);
    lua_error(L);
}

void dml_stopped(lua_State *L, const char *what, long step) {
    const dml_failure f = {.status = DM_STOPPED, .step = step, .time = NAN, .rule = what};
    dml_stop = 0;
    dml_fail(L, &f, -1);
}

static const dml_row meta[] = {{"__tostring", failure_tostring, NULL}, {NULL, NULL, NULL}};

const dml_class dml_class_failure = {
    .name = TNAME,
    .doc =
        "dm.failure: raised when a computation fails; pcall returns it\n"
        "fields: code (\"no_convergence\", \"singular\", \"not_finite\", \"inertia\", "
        "\"too_short\", \"no_value\", \"stopped\"), step, time, "
        "residual, iterations, rule, message, path (what was computed before); constraint or "
        "rolling: the number of the one that lost rank; fading: d2L/dv2 was about to lose a value",
    .meta = meta,
};
