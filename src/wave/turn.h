/* turn.h - arrays of complex numbers, re and im in turn, multiplied by others: the phases of a
 * splitting. The bits do not depend on the width of the registers. */
#ifndef DM_TURN_H
#define DM_TURN_H

#include <stddef.h>

/* z[n] = z e, entry by entry. Arrays are aligned to 64. */
void dm_turn(double *z, const double *e, size_t n);

/* z = (z e) f: two kicks in one pass, the bits of two. */
void dm_turn_twice(double *z, const double *e, const double *f, size_t n);

/* e[n] = exp(i angle[n]), by the functions of the processor's level (numbers/functions.h); angle
 * and e have room for the next multiple of 8, work[16] too. */
void dm_phases(double *e, const double *angle, size_t n);

#endif
