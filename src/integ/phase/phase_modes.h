/* phase_modes.h - the eigenvalues and eigenvectors of the coefficients a_ij of Gauss' rules, in
 * which the linear equations of all stages fall apart into one of 2n complex numbers for each pair
 * (Butcher 1976; Bickart 1977). With W_ij the normalized Legendre polynomial of degree j at c_i and
 * B = diag(b), W^T B A W is tridiagonal, 1/2, 0, 0 ... beside -x_k above and x_k below (Hairer and
 * Wanner 1996, IV.5), and so are its eigenvectors short recurrences, with left ones that differ in
 * signs alone. */
#ifndef DM_PHASE_MODES_H
#define DM_PHASE_MODES_H

#include "integ/method/stage_table.h"

/* of each eigenvalue that is real or above the real axis; [re, im] side by side */
typedef struct {
    uint32_t count;    /* 0: the coefficients are not those of Gauss */
    double *value;     /* [count][2] */
    double *down, *up; /* [count][r][2] Z = sum of 2 Re up_i y (Re of a real one), y = sum
                               down_i Z_i */
} dm_phase_modes;

/* Doubles of the arrays for r stages; laid into `memory` and filled. */
size_t dm_phase_modes_size(uint32_t r);
void dm_phase_modes_find(dm_phase_modes *out, const dm_stage_table *t, double *memory);

#endif
