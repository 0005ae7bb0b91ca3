/* bind_bundle.h - `dm.bundle`: discrete tangent bundles. */
#ifndef DML_BUNDLE_H
#define DML_BUNDLE_H

#include "bind/model/bind_system.h"
#include "bind/rule/bind_curve.h"
#include "integ/curve/curve_bundle.h"

#define DML_BUNDLE "dm.bundle"

typedef struct {
    uint32_t n; /* dim Q */
    double h;
    const dm_curve *curve; /* of the segments */
} dml_bundle;

/* user values of a bundle: the dm.rule of its segments, its system */
enum { DML_BUNDLE_SEGMENTS = 1, DML_BUNDLE_SYSTEM };

/* dm.bundle{system= or Q=, h=, segments=, bias=} and bundle:check{q=, v=, t=}, as C functions. */
int dml_bundle_new(lua_State *L);
int dml_bundle_check(lua_State *L);

/* Push the bundle at stack index 1 with its kernels, for one call. */
dm_bundle *dml_pushbundle(lua_State *L);

/* Raise what a call ended with; DM_OK: nothing. */
void dml_bundle_raise(lua_State *L, dm_status status, const char *what);

#endif
