/* implicit_bracket.h - roots of one equation for one unknown by its changes of sign. */
#ifndef DM_IMPLICIT_BRACKET_H
#define DM_IMPLICIT_BRACKET_H

#include "code/implicit/implicit_solve.h"

/* *y beside a root of F at the x in s->in, from the first change of sign behind interval *next of
 * those that go outward from the first start (an angle: half a turn to both sides): halved until
 * |F| is a small part of what it was. *next is then the interval behind it; 0: there are no more.
 */
int dm_root_bracket(dm_root_solver *s, int *next, double *y);

#endif
