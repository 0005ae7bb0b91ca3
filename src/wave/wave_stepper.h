/* wave_stepper.h - steps of a wave: an engine, and the stepper that it works on. */
#ifndef DM_WAVE_STEPPER_H
#define DM_WAVE_STEPPER_H

#include "wave/wave.h"

typedef struct dm_wave_stepper dm_wave_stepper;

/* A state and the stepper are all that a step needs. */
typedef struct {
    /* sets the state of amplitudes a[2 n] at the start. DM_NO_START: no second level */
    dm_status (*start)(dm_wave_stepper *s, const double *a);
    /* `count` steps, the bits of as many calls with 1; *done counts those made, also on failure,
     * which leaves the state of the last one */
    dm_status (*advance)(dm_wave_stepper *s, long count, long *done);
    /* amplitudes of the state */
    void (*amplitudes)(const dm_wave_stepper *s, double *a);
    /* the discrete Noether quantity of the phase; NULL: hbar times the norm */
    double (*noether)(const dm_wave_stepper *s);
} dm_wave_engine;

struct dm_wave_stepper {
    const dm_wave_engine *engine;
    const dm_wave *wave;
    double h;
    double *state; /* [size] from which a run goes on bit for bit */
    size_t size;
    long iterations;  /* so far, of steps that are solved for */
    double residual;  /* of the last such step: what the last iteration changed, over the norm */
    double parasitic; /* two-step: norm of the parasitic modes over the whole, at the start */
    void *data;       /* of the engine */
};

/* The rules. Each takes its tables from the arena. DM_NO_MEMORY, DM_STOPPED; dense modes of H,
 * which need n <= DM_DENSE_MODES, DM_NO_CONVERGENCE. */

/* Kicks exp(-i b h (V + g |psi|^2)/hbar) and drifts exp(-i a h T/hbar) in turn: stages drifts,
 * b[stages + 1], a[stages]. */
dm_status dm_wave_split(dm_wave_stepper *s, const dm_wave *w, double h, int stages, const double *b,
                        const double *a, dm_arena *arena, volatile const int *stop);

/* Polynomials of degree `degree` in time, their action by as many Gauss nodes: Gauss collocation.
 * g = 0 and dense modes: any degree; else up to DM_WAVE_STAGES, the rest of H by iteration. */
enum { DM_WAVE_STAGES = 24 };
dm_status dm_wave_gauss(dm_wave_stepper *s, const dm_wave *w, double h, int degree, dm_arena *arena,
                        volatile const int *stop);

/* (i hbar/2)(psi+ - psi-) = (h/6) H (psi- + 4 psi + psi+) [+ lambda psi], lambda such that the norm
 * is that of the start (Leok 5.8); the second level by Crank and Nicolson. The state has both
 * levels. DM_SINGULAR of advance: no lambda. */
dm_status dm_wave_two_step(dm_wave_stepper *s, const dm_wave *w, double h, int keeps_norm,
                           dm_arena *arena, volatile const int *stop);

/* The phase 2 arg P_s(-i theta) by which s Gauss stages turn a mode of h E/hbar = theta. */
double dm_gauss_phase(int s, double theta);

/* Dense modes of H, or the Fourier basis where H is diagonal there. *rest: V less what the modes
 * have, NULL: nothing; only where dense modes are too many. */
dm_status dm_wave_modes(dm_modes *out, const double **rest, const dm_wave *w, dm_arena *arena,
                        volatile const int *stop);

#endif
