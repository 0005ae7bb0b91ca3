/* bind_space.h - `dm.space` as the other bindings see it. */
#ifndef DML_SPACE_H
#define DML_SPACE_H

#include "bind/core/bind.h"
#include "code/kernel.h"
#include "geom/action/momentum.h"

/* user values: 1, of a product: its factors; 2, of a semidirect product: how the first moves
 * the second, or nil; 3 and 4, of a group of a script: its kit, and what owns its row */
typedef struct {
    const dm_space *row;
    uint32_t n; /* of a product: its dimension */
    int chart;  /* of the row, or of all factors */
} dml_space;
enum { DML_SPACE_PARTS = 1, DML_SPACE_ACTION, DML_SPACE_KIT, DML_SPACE_ROW };

/* The space at stack index arg; raises when it is none. */
const dml_space *dml_checkspace(lua_State *L, int arg);

/* dm.product(G, H, ...) and dm.semidirect(G, V [, action]) */
int dml_product(lua_State *L);
int dml_semidirect(lua_State *L);

/* core.own_group(name, dimension, kit) */
int dml_own_group(lua_State *L);

/* The options of a system at 1: where Q holds spheres, in a copy Q becomes R^N and their
 * equations |q|^2 = 1 join the constraint. */
void dml_unfold_spheres(lua_State *L);

/* Push a space with no parts yet. */
dml_space *dml_pushspace(lua_State *L, const dm_space *row, uint32_t n);

/* The standard action of the group at `arg` on the n coordinates of the system at `system`; the
 * block may be given by field `block` of the options table at `options` (0: none). Raises when
 * there is no such action. */
dm_action dml_standard_action(lua_State *L, int arg, int options, int system, uint32_t n);

/* d2L/dv2 at x = (q, v, t), of a kernel that gives L_v[n] before it: by how much the action turns
 * it, beside its own size. 0: the kinetic energy is the same for all turned states near x.
 * work: 4 n^2 + 5 n + 1 numbers. */
double dml_turned_mass(const dm_action *action, const dm_kernel *mass, uint32_t n, const double *x,
                       double *work);

#endif
