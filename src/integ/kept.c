#include "integ/kept.h"

uint32_t dm_kept_find(dm_kernel *out, const dm_model *m, const void *maker,
                      uint32_t which) {
    const dm_kept *k = m->source.kept ? *m->source.kept : NULL;
    while (k && (k->maker != maker || k->which != which)) k = k->next;
    if (!k) return 0;
    *out = k->kernel;
    return k->lanes;
}

void dm_kept_add(const dm_model *m, const void *maker, uint32_t which,
                 const dm_kernel *kernel, uint32_t lanes) {
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
