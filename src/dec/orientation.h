/* orientation.h - the coherent orientation of the top cells (Leok 3.3): neighbours stand with
 * opposite signs in the boundary of what they share. */
#ifndef DM_ORIENTATION_H
#define DM_ORIENTATION_H

#include "dec/complex.h"

/* Set K->orientation, to NULL where there is none (a Moebius band, or a face of more than two
 * top cells). The first cell of every component has the sign that `wish` says, [count[n]] of +1
 * and -1, or +1 where wish is NULL. DM_OK or DM_NO_MEMORY. */
dm_status dm_complex_orient(dm_complex *K, dm_arena *arena, const int8_t *wish);

/* The first face of degree n - 1 with more than two top cells, or UINT32_MAX. */
uint32_t dm_complex_crowded(const dm_complex *K);

/* How many faces of degree n - 1 have two top cells on the same side, where sign[count[n]] are the
 * signs of volumes in R^n; *first is one. */
uint32_t dm_complex_folds(const dm_complex *K, const int8_t *sign, uint32_t *first);

#endif
