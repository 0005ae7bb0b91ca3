#include "run/inertia/mass_lanes.h"

#include "algebra/implicit.h"
#include "code/native/jit.h"
#include "integ/method/cache.h"
#include "mech/group.h"

#include <string.h>

#ifdef __x86_64__
static void choose(dm_mass_lanes *w) {
    w->pivots = w->lanes == 8 ? dm_mass_pivots_avx512 : dm_mass_pivots_avx;
    w->quiet = w->lanes == 8 ? dm_mass_quiet_avx512 : dm_mass_quiet_avx;
}
#else
static void choose(dm_mass_lanes *w) {
    w->pivots = NULL;
}
#endif

/* What lanes tell of: the mass of a model with a stage kernel is made of the graph of that
 * (mech/model.c). */
static int fits(const dm_model *m, uint32_t lanes) {
    const dm_source *s = &m->source;
    const uint32_t n = m->n, momenta = n, mass = 2 * n + 2 * n * n;
    return (lanes == 4 || lanes == 8) && dm_inertia_may_change(m) && !dm_inertia_sees_velocity(m) &&
           m->mass_blocks.count && !m->constraints && !m->params && dm_momenta(m) == n &&
           s->stage_graph && s->compile == dm_native_build && !m->mass.memory &&
           !dm_has_roots(s->stage_graph, s->stage + momenta, n) &&
           !dm_has_roots(s->stage_graph, s->stage + mass, n * n);
}

/* entries of the lower triangles of all blocks */
static uint32_t entries(const dm_blocks *blocks) {
    uint32_t out = 0;
    for (uint32_t b = 0; b < blocks->count; b++)
        out += dm_block_size(blocks, b) * (dm_block_size(blocks, b) + 1) / 2;
    return out;
}

/* those of L_vv, from the graph as it stands */
static int build(dm_mass_lanes *w, const dm_model *m) {
    const dm_source *s = &m->source;
    const uint32_t n = m->n, count = entries(&w->blocks);
    const uint32_t *order = w->blocks.order, *first = w->blocks.first;
    const dm_node *mass = s->stage + 2 * n + 2 * n * n;
    dm_node *roots = dm_arena_take(s->arena, count * sizeof *roots), *next = roots;
    if (!roots) return 0;
    for (uint32_t b = 0; b < w->blocks.count; b++)
        for (uint32_t i = first[b]; i < first[b + 1]; i++)
            for (uint32_t j = first[b]; j <= i; j++) *next++ = mass[order[i] * n + order[j]];
    dm_graph_verbatim(s->stage_graph, 1);
    const dm_status status =
        dm_jit_build_lanes(&w->mass, s->stage_graph, roots, count, w->lanes, s->arena);
    dm_graph_verbatim(s->stage_graph, 0);
    return status == DM_OK;
}

static int lay_out(dm_mass_lanes *w, const dm_model *m) {
    enum { COURSE = sizeof(dm_inertia_course) / sizeof(double), FOUND = 4 };
    const size_t n = m->n, in = 2 * n + 1, lanes = w->lanes, blocks = w->blocks.count;
    const size_t triangles = entries(&w->blocks), scales = (DM_LANES_GROUPS + 1) * n;
    const size_t told = 2 * DM_LANES_GROUPS * blocks;
    const size_t all = in + triangles + n * n + scales + (FOUND + COURSE) * blocks + told;
    w->in = dm_arena_take(m->source.arena, all * lanes * sizeof *w->in);
    if (!w->in) return 0;
    memset(w->in, 0, all * lanes * sizeof *w->in);
    w->t = w->in + 2 * n * lanes;
    w->M = w->in + in * lanes;
    w->A = w->M + triangles * lanes;
    w->scale = w->A + n * n * lanes;
    w->least = w->scale + scales * lanes;
    w->all = w->least + blocks * lanes;
    w->kept = w->all + blocks * lanes;
    w->noted = w->kept + 2 * blocks * lanes;
    w->told = (dm_inertia_value *)(void *)(w->noted + COURSE * blocks * lanes);
    dm_kernel_prepare_lanes(&w->mass, w->lanes, w->M);
    return 1;
}

static dm_mass_lanes *make(const dm_model *m, uint32_t lanes) {
    dm_mass_lanes *w = dm_arena_take(m->source.arena, sizeof *w);
    if (!w) return NULL;
    *w = (dm_mass_lanes){.n = m->n, .lanes = lanes, .blocks = m->mass_blocks};
    choose(w);
    return w->pivots && build(w, m) && lay_out(w, m) ? w : NULL;
}

/* A model that has none is not asked again. */
dm_mass_lanes *dm_mass_lanes_open(const dm_model *m, const dm_lanes *x) {
    static const char maker;
    dm_kernel kept;
    if (!fits(m, x->lanes)) return NULL;
    if (dm_cache_find(&kept, m, &maker, x->lanes)) return (dm_mass_lanes *)(uintptr_t)kept.pool;
    dm_mass_lanes *w = make(m, x->lanes);
    dm_cache_add(m, &maker, x->lanes, &(dm_kernel){.pool = w}, x->lanes);
    return w;
}

void dm_mass_lanes_put_scale(dm_mass_lanes *w, uint32_t i, const double *scale) {
    double *to = w->scale + (size_t)(i / w->lanes) * w->n * w->lanes + i % w->lanes;
    for (uint32_t k = 0; k < w->n; k++) to[k * w->lanes] = scale[w->blocks.order[k]];
}

void dm_mass_lanes_put_place(dm_mass_lanes *w, uint32_t lane, const double *q, double t) {
    for (uint32_t k = 0; k < w->n; k++) w->in[k * w->lanes + lane] = q[k];
    w->t[lane] = t;
}

uint32_t dm_mass_lanes_look(dm_mass_lanes *w, uint32_t group, uint32_t asked) {
    dm_kernel_eval(&w->mass, w->in, w->M);
    return w->pivots(w, w->scale + (size_t)group * w->n * w->lanes, DM_INERTIA_FAR, asked);
}
