/* cache.h - kernels and numbers that methods make for a model and that its next stepper finds
 * again (code/source.h). */
#ifndef DM_CACHE_H
#define DM_CACHE_H

#include "mech/model.h"

/* The kernel `which` that `maker` left to the model, into *out, and how many members it takes;
 * 0: none. */
uint32_t dm_cache_find(dm_kernel *out, const dm_model *m, const void *maker, uint32_t which);

/* Leave it one; nothing happens where the model has no cache. */
void dm_cache_add(const dm_model *m, const void *maker, uint32_t which, const dm_kernel *kernel,
                  uint32_t lanes);

/* The numbers that `maker` left to the model under a key[keys]; NULL: none. */
const double *dm_cache_numbers(const dm_model *m, const void *maker, const double *key,
                               uint32_t keys);

/* Leave it such numbers[count]. */
void dm_cache_leave(const dm_model *m, const void *maker, const double *key, uint32_t keys,
                    const double *numbers, uint32_t count);

#endif
