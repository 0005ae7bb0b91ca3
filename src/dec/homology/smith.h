/* smith.h - the Smith normal form of an integer matrix (Leok, appendix A): D = U A V with U, V
 * invertible in integers and D diagonal, each entry dividing the next one. */
#ifndef DM_SMITH_H
#define DM_SMITH_H

#include "base/arena.h"
#include "base/status.h"

#include <stdint.h>

/* Matrices row by row. */
typedef struct {
    uint32_t m, n;  /* A and D are m x n */
    int64_t *D;     /* A on the way in, D on the way out */
    int64_t *U, *W; /* m x m: U and its inverse */
    int64_t *V, *X; /* n x n: V and its inverse */
    uint32_t rank;  /* entries of the diagonal that are not 0; they are > 0 */
} dm_smith;

/* Take the arrays, A to be filled in. */
dm_status dm_smith_open(dm_smith *s, dm_arena *arena, uint32_t m, uint32_t n);

/* No entry of A may be INT64_MIN. Time of order m n min(m, n). DM_OK, DM_TOO_LARGE where an entry
 * on the way leaves 64 bits, DM_STOPPED. */
dm_status dm_smith_form(dm_smith *s, volatile const int *stop);

#endif
