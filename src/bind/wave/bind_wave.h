/* bind_wave.h - waves and transforms for the bindings. */
#ifndef DML_WAVE_H
#define DML_WAVE_H

#include "bind/core/bind.h"
#include "wave/wave.h"

#define DML_WAVE "dm.wave_equation"
#define DML_WAVE_STEPPER "dm.wave_stepper"

/* FFTW's table where dm/fft.so is there, else GSL's; the first call that finds no module says so in
 * one line on stderr. */
const dm_transforms *dml_transforms(void);

/* The equation at arg. Its arena is its user value 1. */
const dm_wave *dml_checkwave(lua_State *L, int arg);

/* Raise what a status of opening or stepping says; Ctrl-C too. */
void dml_wavefail(lua_State *L, dm_status status);

/* values re, im at arg and arg + 1 into psi[2 n] */
void dml_wavevalues(lua_State *L, int arg, double *psi, uint32_t n);

/* Push `count` energies and the list of values of their real states, given by amplitudes
 * [count][n]; how many values that are, 2. */
int dml_pushstates(lua_State *L, const dm_wave *w, const double *energy, const double *states,
                   uint32_t count);

/* Push re and im of psi[2 n] as two vectors. */
void dml_pushwave(lua_State *L, const double *psi, uint32_t n);

#endif
