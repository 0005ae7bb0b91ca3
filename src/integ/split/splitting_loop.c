/* splitting_loop.c - the loop of kicks and drifts that a table wants: parts by its shape, made
 * once for a model and found again.
 * Speed: steps, leapfrog ensemble of Kepler orbits: 19x, and 1.1x for a single member. */
#include "integ/split/splitting_loop_inside.h"

#include "code/native/jit.h"
#include "integ/method/cache.h"

#include <string.h>

/* for both kinds of sums, since a model keeps them */
size_t dm_splitting_loop_work(const dm_model *m) {
    return m->structure & DM_LOOPS ? 0 : dm_splitting_loop_carried(m->n) + DM_LOOP_COEFFICIENTS;
}

/* By which kicks are zero, and by whether the factors of the last kick serve the first. */
static unsigned shape_of(const dm_splitting *table) {
    const double first = table->b[0], last = table->b[table->stages];
    return (first != 0.0 ? DM_LOOP_KICK_FIRST : 0) | (last != 0.0 ? DM_LOOP_KICK_LAST : 0) |
           (table->stages > 1 ? DM_LOOP_MORE_STAGES : 0) |
           /* the factors of a last kick are those of the first one of the next step */
           (first == last || first == 0.0 || last == 0.0 ? DM_LOOP_SCALED : 0);
}

/* ---- parts ---- */

/* coefficients: force: t, h b, -h b, parameters; drift: h a; the first kick of a head: h b_0; in
 * the order of use */

/* new factors, and where it kicks, the kick by them */
static void fuse_force(dm_fusion *b, int kicks) {
    const dm_node t = dm_fusion_coefficient(b), hb = dm_fusion_coefficient(b),
                  minus = dm_fusion_coefficient(b);
    dm_fusion_params(b);
    dm_fusion_factors(b, b->more, t, hb, minus);
    dm_fusion_settle(b);
    for (uint32_t i = 0; kicks && i < b->model->n; i++) {
        dm_node *to = b->plain ? b->p + i : b->low_p + i;
        *to = dm_fusion_constant(b, i, hb, *to);
        dm_fusion_add_product(b, b->p + i, b->low_p + i, dm_fusion_kick(b, b->more, i, hb));
    }
}

/* The kick that begins a step has the factors of the one that ended the last step. */
static void fuse_head(dm_fusion *b) {
    const dm_node hb = dm_fusion_coefficient(b);
    for (uint32_t i = 0; i < b->model->n; i++) {
        const dm_product x = dm_fusion_kick(b, b->more, i, hb);
        dm_node *p = b->p + i, *low = b->plain ? p : b->low_p + i;
        const dm_node before = dm_fusion_constant(b, i, hb, *p);
        /* not by way of the low part, for which the drift would wait */
        dm_fusion_leave(b, p, low, dm_multiply_add(b->graph, x.a, x.b, before), x);
        *low = b->plain ? *low : dm_fusion_constant(b, i, hb, *low);
    }
    dm_fusion_drift(b, dm_fusion_coefficient(b));
    fuse_force(b, 1);
}

/* A stage: drift and force, or force and drift. */
static void fuse_body(dm_fusion *b, int kick_first) {
    if (!kick_first) dm_fusion_drift(b, dm_fusion_coefficient(b));
    fuse_force(b, 1);
    if (kick_first) dm_fusion_drift(b, dm_fusion_coefficient(b));
}

/* values that nothing carries from part to part */
static int drops_factors(const dm_splitting_loop *l) {
    return (l->shape & DM_LOOP_MERGED) ||
           dm_splitting_loop_ends(l->shape) != DM_LOOP_KICKS_AT_BOTH_ENDS;
}

static int fuse_part(const dm_splitting_loop *l, const dm_model *m, dm_loop_kind kind,
                     dm_loop_part *out) {
    dm_fusion b;
    dm_node *factors = dm_arena_take(m->source.arena, m->n * sizeof *factors);
    if (!factors || !dm_fusion_begin(&b, m, &l->kicks, l->size)) return 0;
    b.plain = (l->shape & DM_LOOP_PLAIN) != 0;
    if (drops_factors(l)) b.more = factors; /* nothing carries them */
    if (kind == DM_LOOP_START)
        fuse_force(&b, (l->shape & DM_LOOP_MERGED) != 0);
    else if (kind == DM_LOOP_HEAD)
        fuse_head(&b);
    else if (kind == DM_LOOP_BODY)
        fuse_body(&b, dm_splitting_loop_ends(l->shape) == DM_LOOP_KICK_FIRST);
    else
        dm_fusion_drift(&b, dm_fusion_coefficient(&b));
    return dm_fusion_end(&b, out);
}

/* Only the parts that steps of this shape have. */
static int build_parts(dm_splitting_loop *l, const dm_model *m) {
    const int merged = (l->shape & DM_LOOP_MERGED) != 0;
    const int both = !merged && dm_splitting_loop_ends(l->shape) == DM_LOOP_KICKS_AT_BOTH_ENDS;
    const int wanted[DM_LOOP_PARTS] = {[DM_LOOP_START] = both,
                                       [DM_LOOP_HEAD] = both,
                                       [DM_LOOP_BODY] = !both || (l->shape & DM_LOOP_MORE_STAGES),
                                       [DM_LOOP_TAIL] = !dm_splitting_loop_ends(l->shape)};
    for (int k = 0; k < DM_LOOP_PARTS; k++)
        if (wanted[k] && !fuse_part(l, m, (dm_loop_kind)k, l->part + k)) return 0;
    return !merged || fuse_part(l, m, DM_LOOP_START, l->kick + DM_LOOP_START);
}

/* Without compensation the kicks between two steps can be one, where the force does not see the
 * time. */
static unsigned whole_shape(const dm_model *m, const dm_splitting *table, int plain) {
    const unsigned shape = shape_of(table);
    if (!plain) return shape;
    if (dm_splitting_loop_ends(shape) != DM_LOOP_KICKS_AT_BOTH_ENDS ||
        !(m->structure & DM_AUTONOMOUS))
        return shape | DM_LOOP_PLAIN;
    /* one body does for any number of stages */
    return DM_LOOP_KICKS_AT_BOTH_ENDS | DM_LOOP_SCALED | DM_LOOP_PLAIN | DM_LOOP_MERGED;
}

/* what a step carries */
static uint32_t size_of(const dm_splitting_loop *l, uint32_t n) {
    if (l->shape & DM_LOOP_MERGED) return 2 * n;
    return 4 * n + (drops_factors(l) ? 0 : l->kicks.count);
}

/* One for every shape, which the model keeps: tables and h are numbers that it reads. */
dm_splitting_loop *dm_splitting_loop_open(const dm_model *m, const dm_splitting *table, int plain) {
    static const char maker;
    const unsigned shape = whole_shape(m, table, plain);
    dm_kernel kept;
    if (dm_cache_find(&kept, m, &maker, shape)) return (dm_splitting_loop *)(uintptr_t)kept.pool;
    if (!m->source.graph || (!dm_splitting_loop_ends(shape) && table->stages < 2)) return NULL;
    dm_splitting_loop *l = dm_arena_take(m->source.arena, sizeof *l);
    if (!l) return NULL;
    *l = (dm_splitting_loop){.shape = shape};
    if (!dm_kicks_read(&l->kicks, m, m->source.gradient, (shape & DM_LOOP_SCALED) != 0) ||
        !dm_kicks_contract(&l->kicks))
        return NULL;
    l->size = size_of(l, m->n);
    if (!build_parts(l, m) || !dm_fused_build(&l->one, m, l->part, l->size, 1)) return NULL;
    if ((shape & DM_LOOP_MERGED) && !dm_fused_build(&l->one_kick, m, l->kick, l->size, 1))
        return NULL;
    dm_cache_add(m, &maker, shape, &(dm_kernel){.pool = l}, 1);
    return l;
}

/* Made once for a number of lanes. Parameters need coefficients for every member. */
int dm_splitting_loop_widen(dm_splitting_loop *l, const dm_model *m, dm_lanes *x) {
    dm_arena *arena = m->source.arena;
    dm_splitting_wide *w = &l->many;
    if (w->spread && w->lanes.lanes == dm_jit_lanes()) return *x = w->lanes, 1;
    *w = (dm_splitting_wide){0};
    if (!l->one.native || !dm_lanes_open(x, m, l->size)) return 0;
    const size_t group = (size_t)l->size * x->lanes;
    const size_t spread = DM_LOOP_COEFFICIENTS * (size_t)x->lanes * (m->params ? x->groups : 1);
    w->wide = dm_arena_take(arena, group * x->groups * sizeof *w->wide);
    if (!w->wide || !dm_fused_build(&w->loop, m, l->part, l->size, x->lanes)) return 0;
    if ((l->shape & DM_LOOP_MERGED) && !dm_fused_build(&w->kick, m, l->kick, l->size, x->lanes))
        return 0;
    x->together = w->loop.together;
    if (x->groups % x->together != 0) return 0;
    w->lanes = *x;
    w->spread = dm_arena_take(arena, spread * sizeof *w->spread);
    return w->spread != NULL;
}
