#include "integ/stage/stage_place.h"

#include <string.h>

enum {
    MANY = 8,     /* iterations: a new matrix costs less from here on */
    PATIENCE = 16 /* steps without a kept one, where it did not do */
};

enum { STEP, SERVED, PLACE }; /* in the memory */

size_t dm_stage_place_room(size_t size) {
    return size ? PLACE + 2 * size : 0;
}

void dm_stage_place_open(dm_stage_place *p, double *room, size_t size) {
    *p = (dm_stage_place){.size = size, .memory = room, .made = room + PLACE + size};
    memset(room, 0, dm_stage_place_room(size) * sizeof *room);
}

size_t dm_stage_place_memory(const dm_stage_place *p) {
    return p->size ? PLACE + p->size : 0;
}

void dm_stage_place_clear(dm_stage_place *p, double h) {
    p->is_made = 0;
    if (!p->size) return;
    memset(p->memory, 0, dm_stage_place_memory(p) * sizeof *p->memory);
    p->memory[STEP] = h;
}

static dm_place_use begin_here(dm_stage_place *p, const double *here, double t) {
    p->memory[SERVED] = 1.0;
    memcpy(p->memory + PLACE, here, (p->size - 1) * sizeof *here);
    p->memory[PLACE + p->size - 1] = t;
    return DM_PLACE_NEW;
}

const double *dm_stage_place_of(const dm_stage_place *p) {
    return p->memory + PLACE;
}

dm_place_use dm_stage_place_ask(dm_stage_place *p, const double *here, double t, double h) {
    double *served = p->memory + SERVED;
    if (!p->size || p->memory[STEP] != h) return DM_PLACE_OWN;
    if (*served > 0.0) return DM_PLACE_KEPT;
    if (*served == 0.0) return begin_here(p, here, t);
    *served += 1.0;
    return DM_PLACE_OWN;
}

int dm_stage_place_has(const dm_stage_place *p) {
    return p->is_made && memcmp(p->made, p->memory + PLACE, p->size * sizeof *p->made) == 0;
}

void dm_stage_place_make(dm_stage_place *p) {
    memcpy(p->made, p->memory + PLACE, p->size * sizeof *p->made);
    p->is_made = 1;
}

void dm_stage_place_ended(dm_stage_place *p, int iterations) {
    double *served = p->memory + SERVED;
    *served = iterations > MANY ? 0.0 : *served + 1.0;
}

dm_place_use dm_stage_place_failed(dm_stage_place *p, const double *here, double t) {
    if (p->memory[SERVED] > 1.0) return begin_here(p, here, t);
    dm_stage_place_leave(p);
    return DM_PLACE_OWN;
}

void dm_stage_place_leave(dm_stage_place *p) {
    p->memory[SERVED] = -PATIENCE;
}
