#include "integ/splitting_loop.h"

#include "integ/fused.h"
#include "integ/kept.h"

#include <string.h>

/*
** A step by where its kicks are:
**   kicks at both ends       head: kick, drift, force, kick; bodies: drift, force, kick; the factors of the
**                            force are carried, those of the start are a part of their own
**   kick at the beginning    bodies: force, kick, drift
**   kick at the end          bodies: drift, force, kick
**   at neither               bodies: drift, force, kick; tail: drift
*/
enum {
    KICK_FIRST = 1,
    KICK_LAST = 2,
    KICKS_AT_BOTH_ENDS = 3,
    MORE_STAGES = 4,
    SCALED = 8,
    PLAIN = 16 /* sums without low parts */
};

struct dm_splitting_loop {
    unsigned shape;
    dm_kicks kicks;
    uint32_t size; /* of the carried values: q, p, their low parts, factors */
    dm_loop_part part[DM_LOOP_PARTS];
    dm_loop one, many;     /* for one member, for lanes */
    double *wide, *spread; /* lanes: carried values [groups][size][lanes], coefficients */
};

enum { /* doubles */
       OF_STEP = 5 + 4 * DM_SPLITTING_STAGES,
       COEFFICIENTS = 1024 /* have room: of some steps where L depends on t */
};

/* carried values at most, one factor a coordinate */
static size_t most_carried(uint32_t n) {
    return 5 * (size_t)n;
}

size_t dm_splitting_loop_work(const dm_model *m) {
    return m->structure & DM_LOOPS ? 0 : most_carried(m->n) + COEFFICIENTS;
}

static unsigned shape_of(const dm_splitting *table) {
    const double first = table->b[0], last = table->b[table->stages];
    return (first != 0.0 ? KICK_FIRST : 0) | (last != 0.0 ? KICK_LAST : 0) |
           (table->stages > 1 ? MORE_STAGES : 0) |
           /* the factors of a last kick are those of the first one of the next step */
           (first == last || first == 0.0 || last == 0.0 ? SCALED : 0);
}

static int ends(unsigned shape) {
    return (int)(shape & KICKS_AT_BOTH_ENDS);
}

/* ---- parts ---- */

/* coefficients: force: t, h b, -h b; drift: h a; the first kick of a head: h b_0; in the order of use */

/* new factors, and where there is a low[n], p with other increments in its low parts, the kick by them */
static void fuse_force(dm_fusion *b, dm_node *low) {
    const dm_node t = dm_fusion_coefficient(b), hb = dm_fusion_coefficient(b),
                  minus = dm_fusion_coefficient(b);
    dm_fusion_factors(b, b->more, t, hb, minus);
    for (uint32_t i = 0; low && i < b->model->n; i++) {
        dm_node *to = b->plain ? b->p : b->low_p;
        to[i] = dm_fusion_constant(b, i, hb, b->plain ? b->p[i] : low[i]);
        dm_fusion_push(b, b->p + i, b->low_p + i, dm_fusion_kick(b, b->more, i, hb));
    }
}

/* The kick that begins a step has the factors of the one that ended the last step: p + kick is what the
** drift sees; p itself gets it with the next kick, by way of the low part, so that the drift does not wait. */
static void fuse_head(dm_fusion *b, dm_node *low, dm_node *kicked) {
    const uint32_t n = b->model->n;
    dm_product *first = dm_arena_take(b->model->source.arena, n * sizeof *first);
    b->failed |= !first;
    if (!first) return;
    const dm_node hb = dm_fusion_coefficient(b);
    for (uint32_t i = 0; i < n; i++) {
        const dm_product x = dm_fusion_kick(b, b->more, i, hb);
        const dm_node p = dm_fusion_constant(b, i, hb, b->p[i]);
        kicked[i] = dm_multiply_add(b->graph, x.a, x.b, p);
        first[i] = x;
    }
    dm_fusion_drift(b, dm_fusion_coefficient(b), kicked);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node more = dm_fusion_constant(b, i, hb, b->low_p[i]);
        low[i] = dm_multiply_add(b->graph, first[i].a, first[i].b, more);
    }
    fuse_force(b, low);
}

/* the same without low parts: p gets the kick at once */
static void fuse_plain_head(dm_fusion *b) {
    const dm_node hb = dm_fusion_coefficient(b);
    for (uint32_t i = 0; i < b->model->n; i++) {
        b->p[i] = dm_fusion_constant(b, i, hb, b->p[i]);
        dm_fusion_push(b, b->p + i, b->low_p + i, dm_fusion_kick(b, b->more, i, hb));
    }
    dm_fusion_drift(b, dm_fusion_coefficient(b), b->p);
    fuse_force(b, b->low_p);
}

static void fuse_body(dm_fusion *b, int kick_first) {
    if (!kick_first) dm_fusion_drift(b, dm_fusion_coefficient(b), b->p);
    fuse_force(b, b->low_p);
    if (kick_first) dm_fusion_drift(b, dm_fusion_coefficient(b), b->p);
}

static int fuse_part(const dm_splitting_loop *l, const dm_model *m, dm_loop_kind kind,
                     dm_loop_part *out) {
    const uint32_t n = m->n;
    dm_fusion b;
    dm_node *y = dm_arena_take(m->source.arena, 3 * (size_t)n * sizeof *y);
    if (!y || !dm_fusion_begin(&b, m, &l->kicks, l->size)) return 0;
    b.plain = (l->shape & PLAIN) != 0;
    if (l->size == 4 * n) b.more = y + 2 * (size_t)n; /* factors that nothing carries */
    if (kind == DM_LOOP_START)
        fuse_force(&b, NULL);
    else if (kind == DM_LOOP_HEAD && b.plain)
        fuse_plain_head(&b);
    else if (kind == DM_LOOP_HEAD)
        fuse_head(&b, y, y + n);
    else if (kind == DM_LOOP_BODY)
        fuse_body(&b, ends(l->shape) == KICK_FIRST);
    else
        dm_fusion_drift(&b, dm_fusion_coefficient(&b), b.p);
    return dm_fusion_end(&b, out);
}

static int build_parts(dm_splitting_loop *l, const dm_model *m) {
    const int both = ends(l->shape) == KICKS_AT_BOTH_ENDS;
    const int wanted[DM_LOOP_PARTS] = {
        [DM_LOOP_START] = both,
        [DM_LOOP_HEAD] = both,
        [DM_LOOP_BODY] =
            (l->shape & (MORE_STAGES | KICKS_AT_BOTH_ENDS)) != KICKS_AT_BOTH_ENDS,
        [DM_LOOP_TAIL] = !ends(l->shape)};
    for (int k = 0; k < DM_LOOP_PARTS; k++)
        if (wanted[k] && !fuse_part(l, m, (dm_loop_kind)k, l->part + k)) return 0;
    return 1;
}

dm_splitting_loop *dm_splitting_loop_open(const dm_model *m, const dm_splitting *table,
                                          int plain) {
    static const char maker;
    const unsigned shape = shape_of(table) | (plain ? PLAIN : 0);
    dm_kernel kept;
    if (dm_kept_find(&kept, m, &maker, shape))
        return (dm_splitting_loop *)(uintptr_t)kept.pool;
    if (!m->source.graph || (!ends(shape) && table->stages < 2)) return NULL;
    dm_splitting_loop *l = dm_arena_take(m->source.arena, sizeof *l);
    if (!l) return NULL;
    *l = (dm_splitting_loop){.shape = shape};
    if (!dm_kicks_read(&l->kicks, m, m->source.gradient, (shape & SCALED) != 0))
        return NULL;
    l->size = 4 * m->n + (ends(shape) == KICKS_AT_BOTH_ENDS ? l->kicks.count : 0);
    if (!build_parts(l, m) || !dm_fused_build(&l->one, m, l->part, l->size, 1))
        return NULL;
    dm_kept_add(m, &maker, shape, &(dm_kernel){.pool = l}, 1);
    return l;
}

int dm_splitting_loop_widen(dm_splitting_loop *l, const dm_model *m, dm_lanes *x) {
    dm_arena *arena = m->source.arena;
    if (!l->one.native || !dm_lanes_open(x, m, l->size)) return 0;
    const size_t group = (size_t)l->size * x->lanes;
    l->wide = dm_arena_take(arena, group * x->groups * sizeof *l->wide);
    l->spread = dm_arena_take(arena, COEFFICIENTS * (size_t)x->lanes * sizeof *l->spread);
    if (!l->wide || !l->spread ||
        !dm_fused_build(&l->many, m, l->part, l->size, x->lanes))
        return 0;
    x->together = l->many.together;
    return x->groups % x->together == 0;
}

/* ---- coefficients ---- */

/* of a force at time `at` and of the kick by it */
static double *put_force(double *c, double at, double hb) {
    c[0] = at, c[1] = hb, c[2] = -hb;
    return c + 3;
}

/* of the step that begins at t */
static double *put_step(double *c, unsigned shape, const dm_splitting_burst *x,
                        double t) {
    const dm_splitting *table = x->table;
    const int kick_only_first = ends(shape) == KICK_FIRST;
    const int forces = table->stages - !ends(shape);
    if (ends(shape) == KICKS_AT_BOTH_ENDS) *c++ = x->h * table->b[0];
    for (int k = 0; k < table->stages; k++) {
        const int kick = kick_only_first ? k : k + 1;
        const double at = t + x->c[kick] * x->h, hb = x->h * table->b[kick];
        if (kick_only_first) c = put_force(c, at, hb);
        *c++ = x->h * table->a[k];
        if (!kick_only_first && k < forces) c = put_force(c, at, hb);
    }
    return c;
}

/* what a call has coefficients for */
typedef struct {
    long steps;
    int64_t stride; /* doubles from one step to the next */
    size_t count;
} coefficients;

/* of the steps from `done` on, as many as have room; where the force does not see the time one is enough */
static coefficients put_steps(double *c, const dm_splitting_loop *l, const dm_model *m,
                              const dm_splitting_burst *x, long done) {
    const int timeless = (m->structure & DM_AUTONOMOUS) != 0;
    const long left = x->count - done, different = timeless ? 1 : left;
    double *to = c;
    coefficients put = {.steps = left};
    if (ends(l->shape) == KICKS_AT_BOTH_ENDS)
        to = put_force(to, x->t + (double)done * x->h,
                       x->h * x->table->b[x->table->stages]);
    for (long k = 0; k < different; k++) {
        if (to - c > COEFFICIENTS - OF_STEP) {
            put.steps = k;
            break;
        }
        double *end =
            put_step(to, l->shape, x, timeless ? 0.0 : x->t + (double)(done + k) * x->h);
        put.stride = timeless ? 0 : end - to;
        to = end;
    }
    put.count = (size_t)(to - c);
    return put;
}

/* how often a step does its body */
static int64_t repeats(const dm_splitting_loop *l, const dm_splitting *table) {
    const int e = ends(l->shape);
    return table->stages - (e == KICKS_AT_BOTH_ENDS || e == 0);
}

/* ---- running ---- */

void dm_splitting_loop_run(const dm_splitting_loop *l, const dm_model *m, double *state,
                           const dm_splitting_burst *burst, double *work) {
    const size_t main = 4 * (size_t)m->n;
    double *c = work + most_carried(m->n);
    memcpy(work, state, main * sizeof *work);
    for (long done = 0; done < burst->count;) {
        const coefficients put = put_steps(c, l, m, burst, done);
        dm_loop_call call = {.state = work,
                             .coefficients = c,
                             .groups = 1,
                             .repeats = repeats(l, burst->table),
                             .steps = put.steps,
                             .stride = put.stride * (int64_t)sizeof *c};
        dm_loop_run(&l->one, &call);
        done += put.steps;
    }
    memcpy(state, work, main * sizeof *work);
}

/* every coefficient once for each lane */
static void spread(double *to, const double *c, size_t count, uint32_t lanes) {
    for (size_t i = 0; i < count; i++)
        for (uint32_t lane = 0; lane < lanes; lane++) *to++ = c[i];
}

void dm_splitting_loop_run_lanes(const dm_splitting_loop *l, const dm_model *m,
                                 dm_lanes *x, const dm_splitting_burst *burst,
                                 double *work) {
    const size_t each = dm_state_size(m->n) * x->lanes,
                 group = (size_t)l->size * x->lanes;
    const size_t bytes = 4 * (size_t)m->n * x->lanes * sizeof(double);
    for (uint32_t g = 0; g < x->groups; g++)
        memcpy(l->wide + g * group, x->state + g * each, bytes);
    for (long done = 0; done < burst->count;) {
        const coefficients put = put_steps(work, l, m, burst, done);
        spread(l->spread, work, put.count, x->lanes);
        dm_loop_call call = {.state = l->wide,
                             .coefficients = l->spread,
                             .groups = x->groups,
                             .repeats = repeats(l, burst->table),
                             .steps = put.steps,
                             .stride = put.stride * (int64_t)(x->lanes * sizeof *work)};
        dm_loop_run(&l->many, &call);
        done += put.steps;
    }
    for (uint32_t g = 0; g < x->groups; g++)
        memcpy(x->state + g * each, l->wide + g * group, bytes);
}
