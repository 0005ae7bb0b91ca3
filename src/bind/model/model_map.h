/* model_map.h - is the map of a discrete Lagrangian the step of its Ld? */
#ifndef DML_MODEL_MAP_H
#define DML_MODEL_MAP_H

#include "bind/model/bind_system.h"

/* Raise, with point and defect, where the map that was given beside Ld does not solve p0 = -D1 Ld -
 * F1 - G^T lambda - E^T mu, p1 = D2 Ld + F2, g(q1) = 0, phi(q0, q1) = 0 (Leok 2.3, 2.8) from
 * `count` starts (q0, p0), `stride` doubles apart, or, without any (NULL), from made-up points, the
 * same in every run. Those from which map or Ld have no value are passed over; so is a map that was
 * solved for, not given. */
void dml_checkmap(lua_State *L, int arg, dml_model *m, const double *starts, long count,
                  size_t stride);

#endif
