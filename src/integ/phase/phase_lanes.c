/* phase_lanes.c - members of an ensemble of H side by side: memory and kernels. */
#include "integ/phase/phase_lanes.h"

#include "code/native/jit.h"
#include "integ/method/cache.h"
#include "integ/method/hamilton.h"
#include "numbers/processor.h"

#include <string.h>

#ifdef __x86_64__
/* sums over stages are fused where sweep.c has them so for one member */
static int is_fused(const dm_phase *g) {
    if (g->width == 4) return dm_processor() >= DM_FMA;
    return g->width == 8 && dm_processor() == DM_AVX512;
}

static dm_phase_lanes_step *choose_step(const dm_phase *g, uint32_t lanes) {
    if (lanes == 8) return is_fused(g) ? dm_phase_step_avx512 : dm_phase_step_avx512_plain;
    return is_fused(g) ? dm_phase_step_fma : dm_phase_step_avx;
}
#else
static dm_phase_lanes_step *choose_step(const dm_phase *g, uint32_t lanes) {
    (void)g, (void)lanes;
    return NULL;
}
#endif

/* arrays of the group in hand; 0: no memory */
static int lay_out(dm_phase_lanes *w, uint32_t lanes) {
    const dm_phase *g = w->g;
    const size_t n2 = 2 * (size_t)g->n, r = g->r, all = r * (n2 + 1) + 3 * r * n2 + 3 * n2;
    double *memory = dm_arena_take(g->m->source.arena, all * lanes * sizeof *memory);
    if (!memory) return 0;
    memset(memory, 0, all * lanes * sizeof *memory);
    w->x = memory;
    w->u = w->x + r * (n2 + 1) * lanes;
    w->base = w->u + r * n2 * lanes;
    w->end = w->base + r * n2 * lanes;
    w->unit = w->end + r * n2 * lanes;
    w->next = w->unit + n2 * lanes;
    for (size_t m = 0; m < r; m++) dm_kernel_prepare_lanes(&w->field, lanes, w->u + m * n2 * lanes);
    return 1;
}

/* ---- steps of their own ---- */

static size_t paces_size(const dm_phase_lanes *w) {
    return (1 + w->entries) * w->members.lanes;
}

/* room for the coefficients of every member; steps are unknown yet */
static int lay_out_paces(dm_phase_lanes *w) {
    const dm_phase *g = w->g;
    w->entries = dm_phase_scaled(g, &w->one);
    const size_t all = w->members.groups * paces_size(w);
    w->paces = dm_arena_take(g->m->source.arena, all * sizeof *w->paces);
    w->members.paced = 1;
    return w->paces != NULL;
}

/* those that a method of other coefficients left */
static void forget_paces(dm_phase_lanes *w) {
    dm_phase_scaled(w->g, &w->one);
    for (uint32_t i = 0; i < w->members.groups; i++)
        memset(w->paces + i * paces_size(w), 0, w->members.lanes * sizeof *w->paces);
}

/* the coefficients of the lanes of a group whose step is another one than it was; groups with the
 * steps of the first one have its own */
static void scale_group(dm_phase_lanes *w, dm_phase *g, uint32_t group, const double *h) {
    const uint32_t lanes = w->members.lanes;
    const int first = memcmp(h, w->paces, lanes * sizeof *h) == 0;
    double *paces = w->paces + (first ? 0 : group * paces_size(w));
    for (uint32_t l = 0; l < lanes; l++) {
        if (paces[l] == h[l]) continue;
        if (g->h != h[l]) dm_phase_scale(g, h[l]);
        paces[l] = h[l];
        for (size_t k = 0; k < w->entries; k++) paces[(k + 1) * lanes + l] = w->one[k];
    }
    w->h = paces;
    w->scaled = paces + lanes;
}

/* ---- opening ---- */

static dm_phase_lanes *make(dm_phase *g, uint32_t lanes) {
    const dm_model *m = g->m;
    const size_t kept = dm_phase_memory_size(g);
    dm_phase_lanes *w = dm_arena_take(m->source.arena, sizeof *w);
    if (!w) return NULL;
    *w = (dm_phase_lanes){.g = g};
    if (dm_lanes_build(&w->field, m, m->source.graph, m->source.field, 2 * g->n, lanes) != lanes)
        return NULL;
    const uint32_t size = (uint32_t)(dm_state_size(m->n) + kept);
    if (!dm_lanes_open_told(&w->members, m, size, kept)) return NULL;
    return lay_out_paces(w) && lay_out(w, lanes) ? w : NULL;
}

/* those of the model's last ensemble with as many stages, or new ones */
int dm_phase_widen(dm_stepper *s, dm_lanes *x) {
    static const char maker;
    dm_phase *g = dm_phase_of(s);
    const uint32_t lanes = dm_jit_lanes(), which = g->r * 16 + lanes;
    dm_kernel kept;
    if (lanes < 4 || !g->field.lanes || g->m->params) return 0;
    if (g->r >= lanes) return 0; /* the stages of one member fill the registers */
    if (dm_cache_find(&kept, g->m, &maker, which)) {
        g->lanes = (dm_phase_lanes *)(uintptr_t)kept.pool;
    } else {
        g->lanes = make(g, lanes);
        if (!g->lanes) return 0;
        dm_cache_add(g->m, &maker, which, &(dm_kernel){.pool = g->lanes}, lanes);
    }
    g->lanes->g = g;
    forget_paces(g->lanes);
    g->lanes->step = choose_step(g, lanes);
    *x = g->lanes->members;
    return g->lanes->step != NULL;
}

static uint32_t step(void *phase_lanes, uint32_t asked, double t) {
    dm_phase_lanes *w = phase_lanes;
    w->t = t;
    return w->step(w, asked);
}

void dm_phase_advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count) {
    dm_phase *g = dm_phase_of(s);
    dm_phase_lanes *w = g->lanes;
    w->tolerance = s->tolerance;
    for (uint32_t i = 0; i < x->groups; i++, h += x->lanes) {
        scale_group(w, g, i, h);
        w->state = x->state + i * x->lanes * dm_state_size(g->n);
        w->memory = x->memory + i * x->lanes * x->memory_size;
        dm_lanes_advance_group(s, x, i, t, h, count, step, w);
    }
}
