/* phase_lanes.h - the usual step of stages of H, sweeps from the step before, for 4 or 8 members
 * side by side. Every lane does what phase_sweep.c does for its member alone, operation by
 * operation; a member whose step goes another way takes it alone.
 * Speed: bodies, heavy tops by gauss(2): 3x, against a member after the other. */
#ifndef DM_PHASE_LANES_H
#define DM_PHASE_LANES_H

#include "integ/method/lanes.h"
#include "integ/phase/phase_inside.h"

typedef struct dm_phase_lanes dm_phase_lanes;
typedef uint32_t dm_phase_lanes_step(const dm_phase_lanes *w, uint32_t asked);

/* Those of the model's last ensemble stay with the model. Of the group in hand, [..][lanes]: */
struct dm_phase_lanes {
    const dm_phase *g; /* of the stepper */
    dm_phase_lanes_step *step;
    dm_lanes members;
    dm_kernel field;
    /* [groups][1 + entries][lanes] the step h of every member, 0 before its first, and behind it
     * its coefficients times h, as the stepper's own from `one` on */
    double *paces;
    size_t entries;
    const double *one, *h, *scaled; /* h, scaled: [lanes], [entries][lanes] of the group in hand */
    double t, tolerance;
    double *state, *memory;
    double *x, *u; /* [r][2n + 1], [r][2n] arguments and results of the field */
    double *base;  /* [r][2n] low-order parts of the start, then what coefficients lack */
    double *end;   /* [r][2n] u of the lanes that have ended */
    double *unit;  /* [2n] by which squares of moves count */
    double *next;  /* [4n] */
};

/* One for every kind of processor; products are fused into sums as a member alone has it. */
dm_phase_lanes_step dm_phase_step_avx, dm_phase_step_fma, dm_phase_step_avx512,
    dm_phase_step_avx512_plain;

/* For the engine: see stepper.h. */
int dm_phase_widen(dm_stepper *s, dm_lanes *x);
void dm_phase_advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count);

#endif
