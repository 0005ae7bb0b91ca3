/* cache.c - kernels and numbers of a model for its next stepper, as a list, newest first.
 * Speed: setup, again: 25x with what bind/model/model_cache.c holds, against making them. */
#include "integ/method/cache.h"

#include <string.h>

/* The model has a list, the newest first; there are few. */
uint32_t dm_cache_find(dm_kernel *out, const dm_model *m, const void *maker, uint32_t which) {
    const dm_cache_entry *k = m->source.cache ? *m->source.cache : NULL;
    while (k && (k->maker != maker || k->which != which)) k = k->next;
    if (!k) return 0;
    *out = k->kernel;
    return k->lanes;
}

/* A refused allocation only means that it is made again. */
void dm_cache_add(const dm_model *m, const void *maker, uint32_t which, const dm_kernel *kernel,
                  uint32_t lanes) {
    if (!m->source.cache) return;
    dm_cache_entry *k = dm_arena_take(m->source.arena, sizeof *k);
    if (!k) return;
    *k = (dm_cache_entry){.next = *m->source.cache,
                          .maker = maker,
                          .which = which,
                          .lanes = lanes,
                          .kernel = *kernel};
    *m->source.cache = k;
}

/* numbers stand where a kernel has what its code needs, behind their key */
const double *dm_cache_numbers(const dm_model *m, const void *maker, const double *key,
                               uint32_t keys) {
    const dm_cache_entry *k = m->source.cache ? *m->source.cache : NULL;
    for (; k; k = k->next)
        if (k->maker == maker && k->which == keys &&
            memcmp(k->kernel.pool, key, keys * sizeof *key) == 0)
            return (const double *)k->kernel.pool + keys;
    return NULL;
}

/* Copied, behind their key: the caller's may go. */
void dm_cache_leave(const dm_model *m, const void *maker, const double *key, uint32_t keys,
                    const double *numbers, uint32_t count) {
    if (!m->source.cache) return;
    double *place = dm_arena_take(m->source.arena, ((size_t)keys + count) * sizeof *place);
    if (!place) return;
    memcpy(place, key, keys * sizeof *place);
    memcpy(place + keys, numbers, count * sizeof *place);
    dm_cache_add(m, maker, keys, &(dm_kernel){.pool = place}, 1);
}
