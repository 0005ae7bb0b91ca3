/* fma.h - a * b + c rounded once where the processor does that in one instruction, else twice:
 * one meaning on all roads of one machine. */
#ifndef DM_FMA_H
#define DM_FMA_H

double dm_fma(double a, double b, double c);

/* True where it rounds once. */
int dm_fma_is_fused(void);

/* Round twice from now on as on a processor that has no such instruction (0), or not (1); in the
 * whole process, for tests. Kernels made before do not change. */
void dm_fma_allow(int fused);

#endif
