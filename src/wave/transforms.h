/* transforms.h - the table of functions by which discrete Fourier transforms are made: GSL's here,
 * FFTW's in src/fft, a module that the core opens at the first transform. */
#ifndef DM_TRANSFORMS_H
#define DM_TRANSFORMS_H

#include "base/arena.h"
#include "base/status.h"

#include <stdint.h>

/* A transform of one length and direction; it may be run as often as wanted, by one thread. */
typedef struct dm_transform dm_transform;

enum { DM_FORWARD = -1, DM_BACKWARD = 1 }; /* the sign of i in exp(+-2 pi i j k/n) */

typedef struct {
    const char *name; /* "FFTW 3.3.10" */
    /* The sum out[k] = sum_j in[j] exp(sign 2 pi i j k/n), no factor, of n >= 1 complex numbers,
     * re and im in turn. in[2 n] and out[2 n] are other arrays, aligned to 64, as those of every
     * run. measure: the plan is chosen by timing instead of by rule. What the library holds is
     * given back with the arena. DM_NO_MEMORY. */
    dm_status (*open)(dm_transform **made, uint32_t n, int sign, int measure, double *in,
                      double *out, dm_arena *arena);
    /* Leaves `in` as it is. */
    void (*run)(const dm_transform *t, double *out, const double *in);
    /* What timing has chosen so far, read from and added to a file; 0: it cannot be read or
     * written. NULL: nothing is ever timed. */
    int (*recall)(const char *file);
    int (*keep)(const char *file);
} dm_transforms;

/* The symbol of the module: const dm_transforms dm_transforms_table. */
#define DM_TRANSFORMS_SYMBOL "dm_transforms_table"

/* Always there: mixed radices 2 to 7, O(n^2) in larger prime factors. */
extern const dm_transforms dm_transforms_gsl;

#endif
