#include "integ/splitting.h"

#include "base/sum.h"
#include "integ/chain.h"
#include "integ/fused.h"
#include "integ/lanes.h"

#include <string.h>

/* workspace: this, then x = (q, v, t), force[n], kicked[n], the state at the start of a burst, what the loop
** carries, its coefficients */
typedef struct {
    dm_splitting table;
    double c[DM_SPLITTING_STAGES + 1]; /* time of kick k is t + c_k h */
    dm_kicks kicks;
    uint32_t
        size; /* of the carried values: q, p, their low parts, factors of the force; 0: no loop */
    dm_loop one, many;     /* for one member, for lanes */
    double *wide, *spread; /* lanes: carried values [groups][size][lanes], coefficients */
    dm_chain *chain;       /* NULL: no loops along arrays */
} layout;

enum { /* coefficients of the parts */
       OF_START = 3,
       OF_STEP = 5 + 4 * DM_SPLITTING_STAGES,
       COEFFICIENTS = 1024 /* so many have room: of some steps where L depends on t */
};

int dm_splitting_fits(const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    return (m->structure & simple) == simple && m->inverse_mass && !m->ties;
}

void dm_splitting_compose(dm_splitting *out, const double *gamma, int s) {
    out->stages = s;
    for (int k = 0; k <= s; k++) {
        const double before = k > 0 ? gamma[k - 1] : 0.0, after = k < s ? gamma[k] : 0.0;
        out->b[k] = 0.5 * (before + after);
        if (k < s) out->a[k] = gamma[k];
    }
}

static size_t layout_size(void) {
    return (sizeof(layout) + sizeof(double) - 1) / sizeof(double);
}

/* carried values at most, one factor a coordinate */
static size_t most_carried(uint32_t n) {
    return 5 * (size_t)n;
}

size_t dm_splitting_work(uint32_t n) {
    return layout_size() + 4 * (size_t)n + 1 + dm_state_size(n) + most_carried(n) +
           COEFFICIENTS;
}

/* forces a step: one for every kick but the first, which has that of the step before */
static uint32_t evaluations(const dm_splitting *table) {
    return (uint32_t)(table->stages - (table->b[table->stages] == 0.0));
}

/* ---- parts of the loop ---- */

/* coefficients of the parts, in this order: start: t, h b, -h b; head: h b_0, h a, t, h b, -h b; body: h a, t,
** h b, -h b; tail: h a */

/* new factors and with them y[i] = what p_i was + their kick */
static void fuse_force(dm_fusion *b, dm_node *y) {
    const dm_node t = dm_fusion_coefficient(b), hb = dm_fusion_coefficient(b),
                  minus = dm_fusion_coefficient(b);
    dm_fusion_factors(b, b->more, t, hb, minus);
    for (uint32_t i = 0; y && i < b->model->n; i++)
        y[i] = dm_fusion_kicked(b, b->more, i, hb, y[i]);
    for (uint32_t i = 0; y && i < b->model->n; i++)
        dm_fusion_sum(b, b->p + i, b->low_p + i, y[i]);
}

/* The kick that begins a step has the factors of the one that ended the last step: p + kick is what the
** drift sees; p itself gets it with the next kick, by way of y, so that the drift does not wait. */
static void fuse_head(dm_fusion *b, dm_node *y, dm_node *kicked) {
    const uint32_t n = b->model->n;
    const dm_node hb = dm_fusion_coefficient(b), ha = dm_fusion_coefficient(b);
    for (uint32_t i = 0; i < n; i++) {
        kicked[i] = dm_fusion_kicked(b, b->more, i, hb, b->p[i]);
        y[i] = dm_fusion_kicked(b, b->more, i, hb, b->low_p[i]);
    }
    dm_fusion_drift(b, ha, kicked);
    fuse_force(b, y);
}

static void fuse_body(dm_fusion *b, dm_node *y) {
    const dm_node ha = dm_fusion_coefficient(b);
    dm_fusion_drift(b, ha, b->p);
    memcpy(y, b->low_p, b->model->n * sizeof *y);
    fuse_force(b, y);
}

static int fuse_part(const dm_model *m, const layout *l, uint32_t size, dm_loop_kind kind,
                     dm_loop_part *out) {
    dm_fusion b;
    dm_node *y = dm_arena_take(m->source.arena, 2 * (size_t)m->n * sizeof *y);
    if (!y || !dm_fusion_begin(&b, m, &l->kicks, size)) return 0;
    /* factors that nothing carries: behind the state */
    dm_node *apart = dm_arena_take(m->source.arena, m->n * sizeof *apart);
    if (!apart) return 0;
    if (size == 4 * m->n) b.more = apart;
    if (kind == DM_LOOP_START)
        fuse_force(&b, NULL);
    else if (kind == DM_LOOP_HEAD)
        fuse_head(&b, y, y + m->n);
    else if (kind == DM_LOOP_BODY)
        fuse_body(&b, y);
    else
        dm_fusion_drift(&b, dm_fusion_coefficient(&b), b.p);
    return dm_fusion_end(&b, out);
}

/* a step with a kick first: head, bodies; with a drift first: bodies, tail */
static int fuse(const dm_model *m, const layout *l, uint32_t size, dm_loop *out,
                uint32_t lanes) {
    const int kick_first = l->table.b[0] != 0.0, more = l->table.stages > 1;
    dm_loop_part part[DM_LOOP_PARTS] = {{0}};
    return (!kick_first || fuse_part(m, l, size, DM_LOOP_START, part + DM_LOOP_START)) &&
           (!kick_first || fuse_part(m, l, size, DM_LOOP_HEAD, part + DM_LOOP_HEAD)) &&
           (!more || fuse_part(m, l, size, DM_LOOP_BODY, part + DM_LOOP_BODY)) &&
           (kick_first || fuse_part(m, l, size, DM_LOOP_TAIL, part + DM_LOOP_TAIL)) &&
           dm_fused_build(out, m, part, size, lanes);
}

void dm_splitting_open(dm_stepper *s, const dm_splitting *table) {
    const dm_model *m = s->model;
    layout *l = (layout *)(void *)s->work;
    *l = (layout){.table = *table};
    for (int k = 0; k < table->stages; k++) l->c[k + 1] = l->c[k] + table->a[k];
    l->c[table->stages] = 1.0;
    if (m->structure & DM_LOOPS) l->chain = dm_chain_open(m, table);
    /* the factors of a last kick are those of the first one of the next step */
    const int again = table->b[0] == table->b[table->stages];
    /* without a loop the one below serves */
    if ((table->b[0] == 0.0) != (table->b[table->stages] == 0.0) ||
        !dm_kicks_read(&l->kicks, m, m->source.gradient, again))
        return;
    const uint32_t size = 4 * m->n + (table->b[0] != 0.0 ? l->kicks.count : 0);
    if (fuse(m, l, size, &l->one, 1)) l->size = size;
}

int dm_splitting_widen(dm_stepper *s, dm_lanes *x) {
    layout *l = (layout *)(void *)s->work;
    dm_arena *arena = s->model->source.arena;
    if (!l->size || !l->one.native || !dm_lanes_open(x, s->model, l->size)) return 0;
    const size_t group = (size_t)l->size * x->lanes;
    l->wide = dm_arena_take(arena, group * x->groups * sizeof *l->wide);
    l->spread = dm_arena_take(arena, COEFFICIENTS * (size_t)x->lanes * sizeof *l->spread);
    return l->wide && l->spread && fuse(s->model, l, l->size, &l->many, x->lanes);
}

static inline void kick(uint32_t n, double *p, double *low, double hb,
                        const double *force) {
    for (uint32_t i = 0; i < n; i++) dm_sum_add(p + i, low + i, hb * force[i]);
}

/* The kick that begins a step, with the force that ended the last one: p + hb force is what the
** first drift sees; p itself gets it with the next kick, by way of the low part, so that the drift
** does not wait for two sums. */
static inline void begin(uint32_t n, double *kicked, double *p, double hb,
                         const double *force) {
    double *low = p + 2 * n; /* behind p in the state */
    for (uint32_t i = 0; i < n; i++) {
        kicked[i] = p[i] + hb * force[i];
        low[i] += hb * force[i];
    }
}

/* q += h a M^-1 (p - shift) */
static inline void drift(const dm_model *m, double *q, double *low, double ha,
                         const double *p) {
    const uint32_t n = m->n;
    const double *w = m->inverse_mass, *shift = m->momentum_shift;
    if (m->structure & DM_DIAGONAL_MASS) {
        for (uint32_t i = 0; i < n; i++) dm_sum_add(q + i, low + i, (ha * w[i]) * p[i]);
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        double v = 0.0;
        for (uint32_t j = 0; j < n; j++) v += w[i * n + j] * (p[j] - shift[j]);
        dm_sum_add(q + i, low + i, ha * v);
    }
}

/* coefficients of a force at time `at` and of the kick by it */
static double *put_force(double *c, double at, double hb) {
    c[0] = at, c[1] = hb, c[2] = -hb;
    return c + 3;
}

/* of a step that begins at t */
static double *put_step(double *c, const dm_splitting *table, const double *times,
                        double h, double t) {
    const int s = table->stages, kick_first = table->b[0] != 0.0;
    if (kick_first) *c++ = h * table->b[0];
    for (int k = 0; k < s; k++) {
        *c++ = h * table->a[k];
        if (kick_first || k + 1 < s)
            c = put_force(c, t + times[k + 1] * h, h * table->b[k + 1]);
    }
    return c;
}

/* steps from t on with coefficients of their own, as many as have room; where the force does not see the time
** one is enough */
typedef struct {
    long steps;
    int64_t stride; /* doubles from one to the next */
    size_t count;
} coefficients;

static coefficients put_steps(double *c, const dm_stepper *s, const layout *l, double t,
                              long count) {
    const int timeless = (s->model->structure & DM_AUTONOMOUS) != 0;
    const dm_splitting *table = &l->table;
    double *to = c;
    coefficients x = {.steps = count};
    if (table->b[0] != 0.0) to = put_force(to, t, s->h * table->b[table->stages]);
    for (long k = 0; k < (timeless ? 1 : count); k++) {
        if (to - c > COEFFICIENTS - OF_STEP) {
            x.steps = k;
            break;
        }
        double *end =
            put_step(to, table, l->c, s->h, timeless ? 0.0 : t + (double)k * s->h);
        x.stride = timeless ? 0 : end - to;
        to = end;
    }
    x.count = (size_t)(to - c);
    return x;
}

static void run_loop(dm_stepper *s, const layout *l, double *state, double t,
                     long count) {
    const uint32_t n = s->model->n;
    double *x = s->work + layout_size() + 4 * (size_t)n + 1 + dm_state_size(n);
    double *c = x + most_carried(n);
    memcpy(x, state, 4 * (size_t)n * sizeof *x);
    memset(x + 4 * (size_t)n, 0, n * sizeof *x);
    for (long done = 0; done < count;) {
        const double now = t + (double)done * s->h;
        const coefficients put = put_steps(c, s, l, now, count - done);
        dm_loop_call call = {.state = x,
                             .coefficients = c,
                             .groups = 1,
                             .repeats = l->table.stages - 1,
                             .steps = put.steps,
                             .stride = put.stride * (int64_t)sizeof *c};
        dm_loop_run(&l->one, &call);
        done += put.steps;
    }
    memcpy(state, x, 4 * (size_t)n * sizeof *x);
    s->report.evaluations += 1 + count * evaluations(&l->table);
}

/* count steps with no look at what comes out */
static void run(dm_stepper *s, double *state, double t, long count) {
    const dm_model *m = s->model;
    const uint32_t n = m->n;
    layout *l = (layout *)(void *)s->work;
    if (l->chain) {
        s->report.evaluations += dm_chain_run(l->chain, state, s->h, t, count);
        return;
    }
    if (l->size) {
        run_loop(s, l, state, t, count);
        return;
    }
    const dm_splitting *table = &l->table;
    double *x = s->work + layout_size(), *force = x + 2 * n + 1, *kicked = force + n;
    double *p = state + n, *low_q = state + 2 * n, *low_p = state + 3 * n;
    memcpy(x, state, n * sizeof *x);
    x[2 * n] = t;
    dm_kernel_prepare(&m->force, force);
    if (table->b[0] != 0.0) dm_kernel_eval(&m->force, x, force);
    for (long step = 0; step < count; step++) {
        const double now = t + (double)step * s->h;
        const int kicks = table->b[0] != 0.0;
        if (kicks) begin(n, kicked, p, s->h * table->b[0], force);
        for (int k = 0; k < table->stages; k++) {
            drift(m, x, low_q, s->h * table->a[k], kicks && k == 0 ? kicked : p);
            x[2 * n] = now + l->c[k + 1] * s->h;
            if (table->b[k + 1] == 0.0) continue; /* ends with a drift */
            dm_kernel_eval(&m->force, x, force);
            kick(n, p, low_p, s->h * table->b[k + 1], force);
        }
    }
    memcpy(state, x, n * sizeof *x);
    s->report.evaluations += (table->b[0] != 0.0) + count * evaluations(table);
}

/* what is not finite stays so, hence one look at the end; then the burst is done again to find
** the step */
dm_status dm_splitting_advance(dm_stepper *s, double *state, double t, long count,
                               long *done) {
    const uint32_t n = s->model->n;
    const size_t bytes = dm_state_size(n) * sizeof *state;
    double *start = s->work + layout_size() + 4 * (size_t)n + 1;
    memcpy(start, state, bytes);
    run(s, state, t, count);
    *done = count;
    if (dm_state_is_finite(state, n)) return DM_OK;
    memcpy(state, start, bytes);
    *done = 0;
    return count > 1 ? dm_advance_by_step(s, state, t, count, done) : DM_NOT_FINITE;
}

/* ---- members in lanes ---- */

/* every coefficient once for each lane */
static void spread(const layout *l, const double *c, size_t count, uint32_t lanes) {
    for (size_t i = 0; i < count; i++)
        for (uint32_t lane = 0; lane < lanes; lane++) l->spread[i * lanes + lane] = c[i];
}

void dm_splitting_advance_lanes(dm_stepper *s, dm_lanes *x, double t, long count) {
    const layout *l = (const layout *)(const void *)s->work;
    const uint32_t n = s->model->n;
    const size_t size = dm_state_size(n) * x->lanes, group = (size_t)l->size * x->lanes;
    const size_t bytes = 4 * (size_t)n * x->lanes * sizeof(double);
    double *c = s->work + dm_splitting_work(n) - COEFFICIENTS;
    for (uint32_t g = 0; g < x->groups; g++)
        memcpy(l->wide + g * group, x->state + g * size, bytes);
    for (long done = 0; done < count;) {
        const double now = t + (double)done * s->h;
        const coefficients put = put_steps(c, s, l, now, count - done);
        spread(l, c, put.count, x->lanes);
        dm_loop_call call = {.state = l->wide,
                             .coefficients = l->spread,
                             .groups = x->groups,
                             .repeats = l->table.stages - 1,
                             .steps = put.steps,
                             .stride = put.stride * (int64_t)(x->lanes * sizeof *c)};
        dm_loop_run(&l->many, &call);
        done += put.steps;
    }
    for (uint32_t g = 0; g < x->groups; g++)
        memcpy(x->state + g * size, l->wide + g * group, bytes);
}

dm_status dm_splitting_step(dm_stepper *s, double *state, double t) {
    long done;
    return dm_splitting_advance(s, state, t, 1, &done);
}
