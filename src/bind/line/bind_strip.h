/* bind_strip.h - `dm.strip`, shared by its files. */
#ifndef DML_STRIP_H
#define DML_STRIP_H

#include "bind/core/bind.h"
#include "bind/trace/trace.h"
#include "field/line/strip_run.h"

#define DML_STRIP "dm.strip"

/* A strip, its room, and what its maps are made of. */
typedef struct {
    dm_strip strip;
    dm_strip_room room;
    dm_arena *arena, *large; /* of kernels, of levels; kept by user values 1 and 2 */
    dm_compile *compile;
    dml_traced trace; /* with a log */
    dm_graph *graph;
    const dm_node *out; /* S of a cell, or the equations of a box */
    dm_node *slopes;    /* [4 values] dS, lower then upper; of boxes: the equations */
    uint32_t largest;   /* outputs of a map that the buffer has room for */
    dm_cell_map value;  /* -> S, or the equations */
} dml_strip;

dml_strip *dml_checkstrip(lua_State *L);

/* The map of roots[m], made now where it is not there. */
dm_cell_map *dml_stripmap(lua_State *L, dml_strip *d, dm_cell_map *map, const dm_node *roots,
                          uint32_t m);

/* What a step, momenta, energies, free heights and second derivatives need, made when first
 * needed. */
void dml_strip_wantstep(lua_State *L, dml_strip *d);
void dml_strip_wantafter(lua_State *L, dml_strip *d);
void dml_strip_wantenergy(lua_State *L, dml_strip *d);
void dml_strip_wantclock(lua_State *L, dml_strip *d);
void dml_strip_wanthessian(lua_State *L, dml_strip *d);

/* Does the function at stack index 2 what was traced? Raises what it raises. */
int dml_strip_follows(lua_State *L, const dml_strip *d);

/* core.strip, as a C function (strip_new.c). */
int dml_strip_new(lua_State *L);

#endif
