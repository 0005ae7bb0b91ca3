/* lie_lanes.c - members of an ensemble in the natural chart side by side: memory and kernels. */
#include "integ/lie/lie_lanes.h"

#include "code/native/jit.h"
#include "integ/method/cache.h"

#include <string.h>

enum { MOST_UNKNOWNS = 64 };

#ifdef __x86_64__
static dm_lie_lanes_step *choose_step(uint32_t lanes) {
    return lanes == 8 ? dm_lie_step_avx512 : dm_lie_step_avx;
}
#else
static dm_lie_lanes_step *choose_step(uint32_t lanes) {
    (void)lanes;
    return NULL;
}
#endif

/* a dm_compile */
static dm_status build(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                       dm_arena *arena) {
    return dm_jit_build_lanes(out, g, roots, m, dm_jit_lanes(), arena);
}

/* the same graphs as for one member, made anew */
static int build_kernels(dm_lie_lanes *w, const dm_lie *one, dm_tau tau) {
    w->wide = (dm_group){.momenta = one->d};
    memcpy(w->wide.trace, one->group->trace, sizeof w->wide.trace);
    return dm_group_want(&w->wide, one->model, tau, one->s == 1, build) == DM_OK;
}

typedef struct {
    double **place;
    size_t entries;
} array;

/* What Newton's method takes; NULL: no memory. */
static double *lay_out_newton(dm_lie_lanes *w, uint32_t lanes, dm_arena *arena) {
    const size_t m = w->group.m, d = w->group.d;
    const array arrays[] = {{&w->r, m},      {&w->dx, m},       {&w->r2, m},     {&w->J, m * m},
                            {&w->J2, m * m}, {&w->pivot, m},    {&w->pivot2, m}, {&w->gain, d},
                            {&w->mu, d},     {&w->mu_V, d * m}, {&w->ones, 1}};
    size_t all = 0;
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) all += arrays[i].entries * lanes;
    double *memory = dm_arena_take(arena, all * sizeof *memory);
    if (!memory) return NULL;
    memset(memory, 0, all * sizeof *memory);
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        *arrays[i].place = memory;
        memory += arrays[i].entries * lanes;
    }
    for (uint32_t l = 0; l < lanes; l++) w->ones[l] = 1.0;
    return w->ones;
}

/* Arrays of the group in hand; its memory is that of the members. */
static int lay_out(dm_lie_lanes *w, const dm_lie *one, uint32_t lanes) {
    dm_arena *arena = one->model->source.arena;
    w->group = *one;
    w->group.group = &w->wide;
    const size_t all = dm_lie_lay_out(&w->group, lanes, NULL);
    double *memory = dm_arena_take(arena, all * sizeof *memory);
    if (!memory) return 0;
    memset(memory, 0, all * sizeof *memory);
    dm_lie_lay_out(&w->group, lanes, memory);
    dm_lie_choose(&w->group, &w->wide, lanes);
    return lay_out_newton(w, lanes, arena) != NULL;
}

static dm_lie_lanes *make(const dm_lie *one, dm_tau tau, uint32_t lanes) {
    dm_lie_lanes *w = dm_arena_take(one->model->source.arena, sizeof *w);
    const size_t kept = 2 + DM_LIE_KEPT * (size_t)one->m;
    if (!w) return NULL;
    *w = (dm_lie_lanes){.step = NULL};
    const uint32_t size = (uint32_t)(dm_state_size(one->n) + kept);
    if (!build_kernels(w, one, tau) || !dm_lanes_open_told(&w->members, one->model, size, kept))
        return NULL;
    w->members.paced = 1;
    return lay_out(w, one, lanes) ? w : NULL;
}

/* those of the rule in hand, which may be another one than the last */
static void take_coefficients(dm_lie *to, const dm_lie *from) {
    const size_t all = (size_t)from->r * from->s;
    memcpy(to->a, from->a, all * sizeof *to->a);
    memcpy(to->D, from->D, all * sizeof *to->D);
    memcpy(to->b, from->b, from->r * sizeof *to->b);
    memcpy(to->c, from->c, from->r * sizeof *to->c);
    memcpy(to->beta, from->beta, from->s * sizeof *to->beta);
}

/* what there are vectors for */
static int is_usual(const dm_lie *e) {
    return e->m <= MOST_UNKNOWNS && !e->model->params &&
           e->model->source.compile == dm_native_build;
}

/* those of the model's last ensemble with as many velocities and points, or new ones */
int dm_lie_widen(dm_stepper *s, dm_lanes *x) {
    static const char maker;
    dm_lie *e = dm_lie_of(s);
    const uint32_t lanes = dm_jit_lanes();
    const dm_tau tau = dm_lie_tau(s->rule);
    dm_kernel kept;
    if (lanes < 4 || !is_usual(e)) return 0;
    const uint32_t which = ((e->s * 64 + e->r) * 16 + lanes) * 8 + (uint32_t)tau;
    if (dm_cache_find(&kept, e->model, &maker, which)) {
        e->lanes = (dm_lie_lanes *)(uintptr_t)kept.pool;
    } else {
        e->lanes = make(e, tau, lanes);
        if (!e->lanes) return 0;
        dm_cache_add(e->model, &maker, which, &(dm_kernel){.pool = e->lanes}, lanes);
    }
    take_coefficients(&e->lanes->group, e);
    e->lanes->step = choose_step(lanes);
    *x = e->lanes->members;
    return e->lanes->step != NULL;
}

static uint32_t step(void *lie_lanes, uint32_t asked, double t) {
    dm_lie_lanes *w = lie_lanes;
    w->group.t = t;
    return w->step(w, asked);
}

void dm_lie_advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count) {
    dm_lie_lanes *w = dm_lie_of(s)->lanes;
    dm_lie *e = &w->group;
    w->tolerance = s->tolerance;
    w->max_iterations = s->max_iterations;
    for (uint32_t i = 0; i < x->groups; i++, h += x->lanes) {
        memcpy(e->h, h, x->lanes * sizeof *h);
        e->state = x->state + i * x->lanes * dm_state_size(e->n);
        e->memory = x->memory + i * x->lanes * x->memory_size;
        dm_lanes_advance_group(s, x, i, t, h, count, step, w);
    }
}
