/* backend.h - how graphs become kernels: one row per backend, in the order of preference.
 */
#ifndef DML_BACKEND_H
#define DML_BACKEND_H

#include "bind/core/bind.h"
#include "mech/model.h"

typedef struct {
    const char *name;
    dm_compile *compile;
    int (*available)(void); /* NULL: always */
} dml_backend;

/* The backend of that name; NULL: the one of DMLUA_BACKEND, else the first that is
 * available.
 * Raises on an unknown name. */
const dml_backend *dml_findbackend(lua_State *L, const char *name);

/* DMLUA_PROCESSOR: elementary functions and fma as on a plain, fma or avx512 processor, at most
 * this one's own level. */
void dml_limitprocessor(lua_State *L);

#endif
