/* named.h - positions, velocities and momenta by the names of coordinates: { x = 1, y = 0 } for
 * { 1, 0 }. */
#ifndef DML_NAMED_H
#define DML_NAMED_H

#include "bind/model/bind_system.h"

/* A table without a list in it, and with a name for a key? */
int dml_is_named(lua_State *L, int at);

/* The value at stack index `at`, called `what` in messages: a plain table with names in place of
 * numbers becomes the list of its entries in the order of the coordinates of the system at
 * `system`. Raises when one is missing or there is no such coordinate. All else stays as it is. */
void dml_unname(lua_State *L, int system, int at, const char *what);

/* Of a field the value at `at`, field `key` of a start: a form or a function of the position
 * becomes the list of its numbers. 0: the system at `system` is no field. */
int dml_unfield(lua_State *L, int system, int at, const char *key);

/* n numbers of a start, field `key` of the options: in a list, by the names of coordinates, or, of
 * a field, as a form or a function. */
void dml_start_numbers(lua_State *L, int system, int options, const char *key, double *out,
                       uint32_t n);

#endif
