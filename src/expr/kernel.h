/*
** kernel.h - a compiled function from doubles to doubles: tape, native code or a callback.
** eval is straight-line: no allocation, no Lua inside (a callback kernel is the named
** exception). It writes only the outputs that vary: call dm_kernel_prepare once on every
** output buffer, which fills in the constant ones; they are then never touched.
*/
#ifndef DM_KERNEL_H
#define DM_KERNEL_H

#include <stdint.h>

typedef void dm_eval(const void *pool, const double *in, double *out);

typedef struct {
    dm_eval *eval;
    const void *pool; /* what eval needs: constants, tape, callback context */
    uint32_t inputs, outputs;
    uint32_t operations;  /* per evaluation */
    const char *backend;  /* "tape", "jit", "cc", "hyperdual" */
    const uint8_t *fixed; /* [outputs]: 1 where the output is a constant; NULL: none is */
    const double *constant; /* [outputs]: its value there */
} dm_kernel;

static inline void dm_kernel_eval(const dm_kernel *k, const double *in, double *out) {
    k->eval(k->pool, in, out);
}

static inline void dm_kernel_prepare(const dm_kernel *k, double *out) {
    for (uint32_t i = 0; k->fixed && i < k->outputs; i++)
        if (k->fixed[i]) out[i] = k->constant[i];
}

#endif
