/* space_group.h - systems whose configuration space is a group: between elements, as a script sees
 * them, and flat coordinates, as a run has them (lua/dm/group/place.lua). */
#ifndef DML_SPACE_GROUP_H
#define DML_SPACE_GROUP_H

#include "bind/model/bind_system.h"
#include "integ/method/method.h"

/* The options of a system at 1: where Q is a group that has no global coordinates, they become
 * those of the system on R^N, and its place is pushed; else nil is pushed. */
void dml_unfold_group(lua_State *L);

/* Where the options of a system at 1 have an L that was found for an H on R^N, the one on elements
 * goes into the options that are given, of the place at `place`. */
void dml_place_lagrangian(lua_State *L, int place);

/* dim of the algebra and N, of the place on top; n and n where it is nil. */
uint32_t dml_place_dimension(lua_State *L, uint32_t n);
uint32_t dml_place_size(lua_State *L, uint32_t n);

/* Is the configuration space of the system at `arg` a group? */
int dml_placed(lua_State *L, int arg);

/* Replace the options at `options` by function `how` ("start", "starts") of them, for a system at
 * `arg` on a group; others stay as they are. */
void dml_place_options(lua_State *L, int arg, int options, const char *how);

/* Replace the function on top by how(function) ("observable"), as above. */
void dml_place_function(lua_State *L, int arg, const char *how);

/* Push the position q[N] of the system at `arg`: an element, or the vector q[n]. */
void dml_pushposition(lua_State *L, int arg, const double *q);

/* Push the column `name` of the path at 1 that is an entry of its elements; 0: it is none. */
int dml_place_column(lua_State *L, int arg, const char *name);

/* The traces of the charts of the group of the system at `arg`, made once and kept by it. */
void dml_place_charts(lua_State *L, int arg, dm_group *out);

/* The same of those taus among `wants` that few ask for. */
void dml_place_taus(lua_State *L, int arg, dm_group *out, unsigned wants);

/* Raise where the rule does not step groups, as that of the system at `arg`; a rule of coordinates
 * gets the lift of the model, where the group has one; complete: with all kernels that it may ask
 * for, since threads cannot make any. */
void dml_refuse_group(lua_State *L, int arg, dml_model *model, const dm_rule *rule,
                      const char *backend, int complete);

/* Make the kernels of the chart that these bits (DM_WANT_ON_GROUP) say; raises where the group has
 * no such map. */
void dml_want_chart(lua_State *L, dml_model *m, unsigned chart, dm_compile *compile);

/* Push the momentum map of the path at 1 of the group at 2 with the options at 3. */
int dml_place_momentum(lua_State *L, int arg);

#endif
