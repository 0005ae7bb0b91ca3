/* rk8.h - the coefficients of rk8.c, for other uses of the method. */
#ifndef DM_RK8_H
#define DM_RK8_H

enum { DM_RK8_STAGES = 12 };

/* row i: a_ij; the last row: b */
extern const double dm_rk8_tableau[DM_RK8_STAGES + 1][DM_RK8_STAGES];

#endif
