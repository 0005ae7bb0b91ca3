/* wave_split.c - kicks and drifts of a wave. Every flow is a multiplication by phases, at points or
 * in modes; on a ring the factor 1/n of the two transforms stands in the drifts. The kick that ends
 * a step and the one that begins the next are made in one pass, with the bits of two. */
#include "wave/turn.h"
#include "wave/wave_stepper.h"

#include "integ/split/splitting.h"

#include <math.h>
#include <string.h>

typedef struct {
    int stages;
    double b[DM_SPLITTING_STAGES + 1];           /* of kicks */
    const double *kick[DM_SPLITTING_STAGES + 1]; /* phases [2 n], NULL: none, or by |psi|^2 */
    const double *drift[DM_SPLITTING_STAGES];    /* NULL: none */
    dm_modes potential;                          /* Leok's space: where V is diagonal; else n = 0 */
    double *c, *angle;                           /* [2 n] and room for 8 more */
} splitting;

/* the flow of energies over a time: exp(-i time E_k/hbar), times factor */
static double *phases(const double *energy, const dm_wave *w, double time, double factor,
                      dm_arena *arena) {
    const size_t n = w->n;
    double *e = dm_arena_take(arena, 2 * n * sizeof *e);
    for (size_t k = 0; e && k < n; k++) {
        const double angle = -time * energy[k] / w->hbar;
        e[2 * k] = factor * cos(angle), e[2 * k + 1] = factor * sin(angle);
    }
    return e;
}

/* the table that a coefficient which was there before has, or NULL */
static const double *find(const double *const *table, const double *coefficient, int count) {
    for (int j = 0; j < count; j++)
        if (coefficient[j] == coefficient[count]) return table[j];
    return NULL;
}

/* With g the phases depend on psi, and there is no table. */
static dm_status make_kicks(splitting *p, const dm_wave *w, double h, dm_arena *arena) {
    const double *energy = p->potential.n ? p->potential.energy : w->V;
    for (int j = 0; j <= p->stages && w->g == 0.0; j++) {
        if (p->b[j] == 0.0) continue;
        p->kick[j] = find(p->kick, p->b, j);
        if (!p->kick[j]) p->kick[j] = phases(energy, w, h * p->b[j], 1.0, arena);
        if (!p->kick[j]) return DM_NO_MEMORY;
    }
    return DM_OK;
}

/* b and a of palindromes repeat, and so do their tables. */
static dm_status make_drifts(splitting *p, const dm_wave *w, double h, const double *a,
                             dm_arena *arena) {
    const double factor = w->kinetic.Q ? 1.0 : 1.0 / (double)w->n;
    for (int j = 0; j < p->stages; j++) {
        if (a[j] == 0.0) continue;
        p->drift[j] = find(p->drift, a, j);
        if (!p->drift[j]) p->drift[j] = phases(w->kinetic.energy, w, h * a[j], factor, arena);
        if (!p->drift[j]) return DM_NO_MEMORY;
    }
    return DM_OK;
}

/* ---- steps ---- */

/* |a|^2 does not change in a kick, which is exact then */
static void nonlinear_kick(const dm_wave_stepper *s, double *a, double b) {
    const splitting *p = s->data;
    const dm_wave *w = s->wave;
    const double time = s->h * b / w->hbar;
    for (uint32_t j = 0; j < w->n; j++) {
        const double density = (a[2 * j] * a[2 * j] + a[2 * j + 1] * a[2 * j + 1]) / w->weight[j];
        p->angle[j] = -time * (w->V[j] + w->g * density);
    }
    dm_phases(p->c, p->angle, w->n);
    dm_turn(a, p->c, w->n);
}

/* In Leok's space V is a full matrix: its flow is diagonal in its own modes. */
static void kick_in_modes(const splitting *p, double *a, const double *e) {
    dm_to_modes(p->c, &p->potential, a);
    dm_turn(p->c, e, p->potential.n);
    dm_from_modes(a, &p->potential, p->c);
}

/* Kick j of the table. */
static void kick(const dm_wave_stepper *s, double *a, int j) {
    const splitting *p = s->data;
    if (p->b[j] == 0.0) return;
    if (s->wave->g != 0.0)
        nonlinear_kick(s, a, p->b[j]);
    else if (p->potential.n)
        kick_in_modes(p, a, p->kick[j]);
    else
        dm_turn(a, p->kick[j], s->wave->n);
}

/* the last kick of a step and the first of the next */
static void kick_between(const dm_wave_stepper *s, double *a) {
    const splitting *p = s->data;
    const double *last = p->kick[p->stages], *first = p->kick[0];
    if (last && first && !p->potential.n) {
        dm_turn_twice(a, last, first, s->wave->n);
        return;
    }
    kick(s, a, p->stages);
    kick(s, a, 0);
}

/* Drift j: there are always modes of T. */
static void drift(const dm_wave_stepper *s, double *a, int j) {
    const splitting *p = s->data;
    const dm_modes *modes = &s->wave->kinetic;
    if (!p->drift[j]) return;
    if (modes->Q) {
        dm_to_modes(p->c, modes, a);
        dm_turn(p->c, p->drift[j], modes->n);
        dm_from_modes(a, modes, p->c);
        return;
    }
    modes->transforms->run(modes->forward, p->c, a);
    dm_turn(p->c, p->drift[j], modes->n);
    modes->transforms->run(modes->backward, a, p->c);
}

/* Kicks that end a step meet those of the next, so the loop is one of kicks between. */
static dm_status advance(dm_wave_stepper *s, long count, long *done) {
    const splitting *p = s->data;
    double *a = s->state;
    if (count > 0) kick(s, a, 0);
    for (long step = 1; step <= count; step++) {
        for (int j = 0; j < p->stages; j++) {
            drift(s, a, j);
            if (j + 1 < p->stages) kick(s, a, j + 1);
        }
        if (step < count)
            kick_between(s, a);
        else
            kick(s, a, p->stages);
    }
    *done += count;
    return DM_OK;
}

/* The state are the amplitudes themselves. */
static dm_status start(dm_wave_stepper *s, const double *a) {
    memcpy(s->state, a, s->size * sizeof *a);
    return DM_OK;
}

static void amplitudes(const dm_wave_stepper *s, double *a) {
    memcpy(a, s->state, s->size * sizeof *a);
}

static const dm_wave_engine engine = {start, advance, amplitudes, NULL};

/* ---- opening ---- */

dm_status dm_wave_split(dm_wave_stepper *s, const dm_wave *w, double h, int stages, const double *b,
                        const double *a, dm_arena *arena, volatile const int *stop) {
    const size_t n = w->n;
    splitting *p = dm_arena_take(arena, sizeof *p);
    *s = (dm_wave_stepper){.engine = &engine, .wave = w, .h = h, .size = 2 * n, .data = p};
    s->state = dm_arena_take(arena, 2 * n * sizeof(double));
    if (!p || !s->state) return DM_NO_MEMORY;
    *p = (splitting){.stages = stages};
    memcpy(p->b, b, ((size_t)stages + 1) * sizeof *b);
    p->c = dm_arena_take(arena, 2 * n * sizeof(double));
    p->angle = dm_arena_take(arena, (n + 8) * sizeof(double));
    if (!p->c || !p->angle) return DM_NO_MEMORY;
    memset(p->angle, 0, (n + 8) * sizeof(double));
    if (w->P) {
        double *P = dm_arena_take(arena, n * n * sizeof *P);
        if (!P) return DM_NO_MEMORY;
        memcpy(P, w->P, n * n * sizeof *P);
        const dm_status status = dm_modes_dense(&p->potential, P, w->n, arena, stop);
        if (status != DM_OK) return status;
    }
    const dm_status status = make_kicks(p, w, h, arena);
    return status == DM_OK ? make_drifts(p, w, h, a, arena) : status;
}
