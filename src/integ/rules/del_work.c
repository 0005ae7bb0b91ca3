/* del_work.c - the workspace of a step of a discrete Lagrangian and the memory from step to
 * step. */
#include "base/doubles.h"
#include "integ/rules/del.h"

#include <string.h>

/* g, G, g_t */
static size_t constraint_outputs(const dm_model *m) {
    return dm_del_constraints(m) * ((size_t)m->n + 2);
}

/* phi, E and derivatives; E^T mu and derivatives; F1, F2 and derivatives */
static size_t roll_outputs(const dm_model *m) {
    return dm_del_rolling(m) * (1 + 3 * (size_t)m->n);
}

static size_t turn_outputs(const dm_model *m) {
    return dm_del_rolling(m) ? m->n + 2 * (size_t)m->n * m->n : 0;
}

static size_t push_outputs(const dm_model *m) {
    return dm_del_is_forced(m) ? 2 * (size_t)m->n * (1 + 2 * (size_t)m->n) : 0;
}

/* with what the kernel remembers */
size_t dm_del_memory(const dm_model *m) {
    const size_t N = (size_t)m->n + dm_del_rows(m);
    return DM_DEL_END + 4 * (size_t)m->n + DM_DEL_KEPT * N + m->pair.memory_size;
}

/* of Newton's method, and of places where constraints cross */
static size_t scratch_size(const dm_model *m) {
    const size_t newton = dm_newton_work(m->n + dm_del_rows(m));
    const size_t crossing = dm_del_constraints(m) ? m->n + dm_crossing_work(m->constraints) : 0;
    return newton > crossing ? newton : crossing;
}

size_t dm_del_work(const dm_model *m) {
    const size_t n = m->n, r = dm_del_rows(m);
    return dm_doubles(sizeof(dm_del)) + 2 * n + (2 * n + n * n) + n + (n + r) + 4 * n +
           dm_del_memory(m) + 2 * n + 1 + r + 2 * constraint_outputs(m) + 2 * r + roll_outputs(m) +
           turn_outputs(m) + push_outputs(m) + scratch_size(m);
}

/* Not in every step. Speed: instructions, Kepler by del. */
dm_del *dm_del_lay_out(const dm_stepper *s) {
    const size_t n = s->model->n, outputs = constraint_outputs(s->model);
    dm_del e = {.m = s->model, .x = s->work + dm_doubles(sizeof e), .n = s->model->n};
    e.k = dm_del_constraints(s->model);
    e.l = dm_del_rolling(s->model);
    e.N = e.n + e.k + e.l;
    e.out = e.x + 2 * n;
    e.sum = e.out + 2 * n + n * n;
    e.z = e.sum + n;
    e.next = e.z + e.N;
    e.memory = e.next + 4 * n;
    e.roots = e.memory + DM_DEL_END + 4 * n + DM_DEL_KEPT * (size_t)e.N;
    e.constraint_x = e.memory + dm_del_memory(s->model);
    e.here = e.constraint_x + 2 * n + 1 + e.k + e.l;
    e.there = e.here + outputs;
    e.unit = e.there + outputs;
    e.pull = e.unit + e.k + e.l;
    e.roll = e.pull + e.k + e.l;
    e.turn = e.roll + roll_outputs(s->model);
    e.push = e.turn + turn_outputs(s->model);
    e.scratch = e.push + push_outputs(s->model);
    *dm_del_of(s) = e;
    return dm_del_of(s);
}

/* what the kernel remembers is that of the last step, whatever it was asked for since */
void dm_del_take_roots(const dm_del *e) {
    const dm_kernel *k = &e->m->pair;
    if (k->memory) memcpy(k->memory, e->roots, k->memory_size * sizeof *k->memory);
}

void dm_del_leave_roots(const dm_del *e) {
    const dm_kernel *k = &e->m->pair;
    if (k->memory) memcpy(e->roots, k->memory, k->memory_size * sizeof *k->memory);
}
