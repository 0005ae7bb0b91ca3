/* system_dual.h - a system that is given by H(q, p, t). */
#ifndef DML_SYSTEM_DUAL_H
#define DML_SYSTEM_DUAL_H

#include "bind/core/bind.h"

/* Of options at 1 with the field H, of n coordinates: they are replaced by a copy with the L that
 * belongs to H, and 0 is returned; 1: no formula gives an L, and H itself is what is stepped.
 * Without H: 0. */
int dml_add_lagrangian(lua_State *L, uint32_t n);

/* Raise, for what needs a Lagrangian, where the system at 1 has only its H. */
void dml_need_lagrangian(lua_State *L, const char *what);

#endif
