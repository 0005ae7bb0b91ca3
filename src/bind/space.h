/* space.h - `dm.space` as the other bindings see it. */
#ifndef DML_SPACE_H
#define DML_SPACE_H

#include "action/momentum.h"
#include "bind/bind.h"

typedef struct {
    const dm_space *row;
    uint32_t n;
} dml_space;

/* The space at stack index arg; raises when it is none. */
const dml_space *dml_checkspace(lua_State *L, int arg);

/* The standard action of the group at `arg` on n coordinates; the block may be given by
 *field
 ** `block` of the options table at `options` (0: none). Raises when there is no such
 *action. */
dm_action dml_standard_action(lua_State *L, int arg, int options, uint32_t n);

#endif
