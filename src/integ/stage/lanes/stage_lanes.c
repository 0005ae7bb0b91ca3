/* stage_lanes.c - members of an ensemble side by side: memory, kernels, and steps that a member
 * takes alone. */
#include "integ/stage/lanes/stage_lanes.h"

#include "code/native/jit.h"
#include "integ/method/cache.h"
#include "integ/method/lanes.h"
#include "integ/stage/lanes/one_point.h"
#include "numbers/processor.h"

#include <string.h>

/* ---- choosing ---- */

#ifdef __x86_64__
/* sums over stages are fused where sweep.c has them so for one member */
static int is_fused(const dm_stage *g) {
    const uint32_t width = g->sweeps->row->width;
    if (width == 4) return dm_processor() >= DM_FMA;
    return width == 8 && dm_processor() == DM_AVX512;
}

static dm_stage_lanes_step *choose_step(const dm_stage *g, uint32_t lanes) {
    if (g->one_point) return lanes == 8 ? dm_one_point_avx512 : dm_one_point_avx;
    if (!g->sweeps) return lanes == 8 ? dm_stage_newton_avx512 : dm_stage_newton_avx;
    if (lanes == 8) return is_fused(g) ? dm_stage_sweep_avx512 : dm_stage_sweep_avx512_plain;
    return is_fused(g) ? dm_stage_sweep_fma : dm_stage_sweep_avx;
}
#else
static dm_stage_lanes_step *choose_step(const dm_stage *g, uint32_t lanes) {
    (void)g, (void)lanes;
    return NULL;
}
#endif

/* the stage's own graph, which was compacted, as it stands */
static int build_curves(dm_stage_lanes *w, const dm_stage *g, uint32_t lanes) {
    const dm_source *s = &g->m->source;
    const uint32_t n = g->n, all = 2 * n + 3 * n * n;
    if (!s->stage_graph || g->m->stage.memory || g->m->slope.memory) return 0;
    dm_graph_verbatim(s->stage_graph, 1);
    const int made = dm_jit_build_lanes(&w->matrix.stage, s->stage_graph, s->stage, all, lanes,
                                        s->arena) == DM_OK &&
                     dm_jit_build_lanes(&w->matrix.slope, s->stage_graph, s->stage, 2 * n, lanes,
                                        s->arena) == DM_OK;
    dm_graph_verbatim(s->stage_graph, 0);
    return made;
}

static int build_sweeps(dm_stage_lanes *w, const dm_stage *g, uint32_t lanes) {
    dm_kernel kernels[3];
    if (dm_stage_sweeps_kernels(kernels, g, lanes) != lanes) return 0;
    w->sweeps.force = kernels[0];
    if (g->separable) return 1;
    w->sweeps.factors = kernels[1];
    w->sweeps.velocity = kernels[2];
    return 1;
}

/* ---- memory ---- */

/* arrays of the vectors of one group, one after the other */
typedef struct {
    double **place;
    size_t entries;
} array;

static int lay_out(const dm_stage_lanes *w, const array *arrays, size_t count) {
    size_t all = 0;
    const size_t lanes = w->members.lanes;
    for (size_t i = 0; i < count; i++) all += arrays[i].entries * lanes;
    double *memory = dm_arena_take(w->g->m->source.arena, all * sizeof *memory);
    if (!memory) return 0;
    memset(memory, 0, all * sizeof *memory);
    for (size_t i = 0; i < count; i++) {
        *arrays[i].place = memory;
        memory += arrays[i].entries * lanes;
    }
    return 1;
}

static int lay_out_sweeps(dm_stage_lanes *w) {
    dm_lanes_sweeps *x = &w->sweeps;
    const dm_stage *g = w->g;
    const size_t n = g->n, r = g->table.r;
    const size_t triangle = g->separable ? 0 : n * (n + 1) / 2;
    const size_t taken = 2 * n + 1, given = g->sweeps->force.outputs,
                 factored = g->separable ? 0 : 3 * n + triangle;
    const array arrays[] =
        {{&w->group.next, 4 * n},     {&x->in, r * taken}, {&x->out, r * given}, {&x->u, r * n},
         {&x->base, r * n},           {&x->lift, r * n},   {&x->v0, n},          {&x->drift, n},
         {&x->end_u, r * n},          {&x->end_f, r * n},  {&x->zeros, r * n},   {&x->unit, 2 * n},
         {&x->factored, r * factored}};
    const uint32_t lanes = w->members.lanes;
    if (!lay_out(w, arrays, sizeof arrays / sizeof *arrays)) return 0;
    for (size_t m = 0; m < r; m++) {
        dm_kernel_prepare_lanes(&x->force, lanes, x->out + m * given * lanes);
        if (g->separable) continue;
        dm_kernel_prepare_lanes(&x->factors, lanes, x->factored + m * factored * lanes);
        dm_kernel_prepare_lanes(&x->velocity, lanes, x->in + (m * taken + n) * lanes);
    }
    return 1;
}

static int lay_out_newton(dm_stage_lanes *w) {
    dm_stage_newton *x = &w->newton;
    dm_lanes_newton *y = &w->matrix;
    const size_t n = w->g->n, s = w->g->table.s, r = w->g->table.r, m = s * n;
    const size_t curve = 2 * n + 3 * n * n;
    const array arrays[] = {{&w->group.next, 4 * n},
                            {&x->x, 2 * n + 1},
                            {&x->curve, r * curve},
                            {&x->slopes, r * 2 * n},
                            {&x->root, m},
                            {&x->missed, m},
                            {&y->r, m},
                            {&y->dx, m},
                            {&y->J, m * m},
                            {&y->J2, m * m},
                            {&y->pivot, m},
                            {&y->pivot2, m},
                            {&y->other, curve + 2 * n},
                            {&y->made, 1}};
    const uint32_t lanes = w->members.lanes;
    if (!lay_out(w, arrays, sizeof arrays / sizeof *arrays)) return 0;
    x->stage = &y->stage;
    x->slope = &y->slope;
    for (size_t i = 0; i < r; i++)
        dm_kernel_prepare_lanes(&y->stage, lanes, x->curve + i * curve * lanes);
    dm_kernel_prepare_lanes(&y->stage, lanes, y->other);
    dm_kernel_prepare_lanes(&y->slope, lanes, y->other + curve * lanes);
    return 1;
}

static int lay_out_one_point(dm_stage_lanes *w) {
    dm_one_point *x = &w->one_point;
    const array arrays[] = {{&x->in, dm_one_point_inputs(w->g->n)},
                            {&x->out, dm_one_point_outputs(w->g->n)}};
    if (!lay_out(w, arrays, sizeof arrays / sizeof *arrays)) return 0;
    dm_kernel_prepare_lanes(&x->kernel, w->members.lanes, x->out);
    return 1;
}

/* ---- steps of their own ---- */

static size_t paces_size(const dm_stage_lanes *w) {
    return (1 + w->entries) * w->members.lanes;
}

/* room for coefficients that are multiplied by h, for every member; steps are unknown yet */
static int lay_out_paces(dm_stage_lanes *w) {
    const dm_stage *g = w->g;
    dm_lanes *x = &w->members;
    w->entries = dm_stage_weights_size(g->table.s, g->table.r);
    if (g->sweeps) w->entries = dm_stage_sweeps_scaled(g->sweeps, &w->group.one);
    const size_t all = x->groups * paces_size(w);
    w->paces = dm_arena_take(g->m->source.arena, all * sizeof *w->paces);
    if (!w->paces) return 0;
    memset(w->paces, 0, all * sizeof *w->paces);
    x->paced = 1;
    return 1;
}

/* those that a method of other coefficients left, and its factors */
static void forget_paces(dm_stage_lanes *w, const dm_stage *g) {
    w->group.one = &g->weights.hA->top;
    if (g->sweeps) dm_stage_sweeps_scaled(g->sweeps, &w->group.one);
    for (uint32_t i = 0; i < w->members.groups; i++)
        memset(w->paces + i * paces_size(w), 0, w->members.lanes * sizeof *w->paces);
    if (w->matrix.made) memset(w->matrix.made, 0, w->members.lanes * sizeof *w->matrix.made);
}

/* what Newton's method needs, which continuation in h leaves undone when it gives up */
static void complete_weights(dm_stage *g) {
    if (!g->sweeps && !g->weights.complete) dm_stage_weights_complete(g);
}

/* the coefficients of one lane for a step h */
static void scale_lane(dm_stage_lanes *w, dm_stage *g, double *place, double h) {
    const uint32_t lanes = w->members.lanes;
    if (g->weights.h != h) {
        dm_stage_weights_scale(g, h);
        if (g->sweeps) dm_stage_sweeps_scale(g->sweeps, g);
    }
    complete_weights(g);
    *place = h;
    for (size_t k = 0; k < w->entries; k++) place[(k + 1) * lanes] = w->group.one[k];
}

/* of the lanes of a group whose step is another one than it was */
static void scale_group(dm_stage_lanes *w, dm_stage *g, uint32_t group, const double *h) {
    const uint32_t lanes = w->members.lanes;
    double *paces = w->paces + group * paces_size(w);
    for (uint32_t l = 0; l < lanes; l++)
        if (paces[l] != h[l]) scale_lane(w, g, paces + l, h[l]);
    w->group.h = paces;
    w->group.scaled = paces + lanes;
}

/* ---- opening ---- */

static dm_stage_lanes *make(dm_stage *g, dm_stepper *s, uint32_t lanes) {
    double *place;
    dm_stage_lanes *w = dm_arena_take(g->m->source.arena, sizeof *w);
    if (!w) return NULL;
    *w = (dm_stage_lanes){.g = g};
    const size_t kept = dm_stepper_memory(s, &place);
    const uint32_t size = (uint32_t)(dm_state_size(g->m->n) + kept);
    if (!dm_lanes_open_told(&w->members, g->m, size, kept) || !lay_out_paces(w)) return NULL;
    if (g->one_point)
        return dm_one_point_kernel(&w->one_point.kernel, g->m, lanes) && lay_out_one_point(w)
                   ? w
                   : NULL;
    if (g->sweeps) return build_sweeps(w, g, lanes) && lay_out_sweeps(w) ? w : NULL;
    return build_curves(w, g, lanes) && lay_out_newton(w) ? w : NULL;
}

/* what there are vectors for */
static int is_usual(const dm_stage *g) {
    const uint32_t unknowns = g->table.s * g->n;
    if (!g->m->source.graph || g->m->source.compile != dm_native_build) return 0;
    return g->sweeps || g->one_point || (g->ahead && unknowns <= DM_STAGE_LANES_UNKNOWNS);
}

/* those of the model's last ensemble, or new ones */
int dm_stage_widen(dm_stepper *s, dm_lanes *x) {
    static const char maker;
    dm_stage *g = dm_stage_of(s);
    const uint32_t lanes = dm_jit_lanes();
    dm_kernel kept;
    if (s->model->constraints || lanes < 4 || !is_usual(g)) return 0;
    const uint32_t form = (g->sweeps != NULL) * 2u + (uint32_t)g->separable;
    const uint32_t which = ((g->table.s * 64 + g->table.r) * 16 + lanes) * 4 + form;
    if (dm_cache_find(&kept, g->m, &maker, which)) {
        g->lanes = (dm_stage_lanes *)(uintptr_t)kept.pool;
    } else {
        g->lanes = make(g, s, lanes);
        if (!g->lanes) return 0;
        dm_cache_add(g->m, &maker, which, &(dm_kernel){.pool = g->lanes}, lanes);
    }
    g->lanes->g = g;
    forget_paces(g->lanes, g);
    g->lanes->step = choose_step(g, lanes);
    *x = g->lanes->members;
    return g->lanes->step != NULL;
}

/* ---- stepping ---- */

static uint32_t step(void *stage_lanes, uint32_t asked, double t) {
    dm_stage_lanes *w = stage_lanes;
    w->group.t = t;
    return w->step(w, asked);
}

void dm_stage_advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count) {
    dm_stage *g = dm_stage_of(s);
    dm_stage_lanes *w = g->lanes;
    w->group.tolerance = s->tolerance;
    w->group.max_iterations = s->max_iterations;
    for (uint32_t i = 0; i < x->groups; i++, h += x->lanes) {
        scale_group(w, g, i, h);
        w->group.state = x->state + i * x->lanes * dm_state_size(s->model->n);
        w->group.memory = x->memory + i * x->lanes * x->memory_size;
        dm_lanes_advance_group(s, x, i, t, h, count, step, w);
    }
}
