#include "integ/method/cache.h"

#include <string.h>

uint32_t dm_kept_find(dm_kernel *out, const dm_model *m, const void *maker, uint32_t which) {
    const dm_kept *k = m->source.kept ? *m->source.kept : NULL;
    while (k && (k->maker != maker || k->which != which)) k = k->next;
    if (!k) return 0;
    *out = k->kernel;
    return k->lanes;
}

void dm_kept_add(const dm_model *m, const void *maker, uint32_t which, const dm_kernel *kernel,
                 uint32_t lanes) {
    if (!m->source.kept) return;
    dm_kept *k = dm_arena_take(m->source.arena, sizeof *k);
    if (!k) return;
    *k = (dm_kept){.next = *m->source.kept,
                   .maker = maker,
                   .which = which,
                   .lanes = lanes,
                   .kernel = *kernel};
    *m->source.kept = k;
}

/* numbers stand where a kernel has what its code needs, behind their key */
const double *dm_kept_numbers(const dm_model *m, const void *maker, const double *key,
                              uint32_t keys) {
    const dm_kept *k = m->source.kept ? *m->source.kept : NULL;
    for (; k; k = k->next)
        if (k->maker == maker && k->which == keys &&
            memcmp(k->kernel.pool, key, keys * sizeof *key) == 0)
            return (const double *)k->kernel.pool + keys;
    return NULL;
}

void dm_kept_leave(const dm_model *m, const void *maker, const double *key, uint32_t keys,
                   const double *numbers, uint32_t count) {
    if (!m->source.kept) return;
    double *place = dm_arena_take(m->source.arena, ((size_t)keys + count) * sizeof *place);
    if (!place) return;
    memcpy(place, key, keys * sizeof *place);
    memcpy(place + keys, numbers, count * sizeof *place);
    dm_kept_add(m, maker, keys, &(dm_kernel){.pool = place}, 1);
}
