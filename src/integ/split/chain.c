/* chain.c - splitting steps along arrays: what is planned for a table, and bursts of steps.
 * Speed: P8-fpu-1024: 12.7x, against forces by loops over rounds. */
#include "base/doubles.h"
#include "integ/split/chain_inside.h"

#include "integ/method/cache.h"

#include <string.h>

/* ---- setting up ---- */

/* kicks at both ends of a step share a force and a pass; a step that begins with a drift has that
 * in the pass before */
static void plan_step(dm_chain *c) {
    const dm_splitting *table = &c->table;
    const int s = table->stages, opens = table->b[0] != 0.0, closes = table->b[s] != 0.0;
    c->first = opens && !closes ? 0 : 1;
    c->last = closes ? s : s - 1;
    for (int k = 0; k < s; k++) c->c[k + 1] = c->c[k] + table->a[k];
    c->c[s] = 1.0;
}

/* tables with the same kicks and drifts missing share their loops, which the model keeps */
static int find(dm_chain *c, const dm_model *m) {
    static const char maker;
    const int s = c->table.stages;
    const uint32_t which = (uint32_t)((c->table.b[0] != 0.0) + 2 * (c->table.b[s] != 0.0) +
                                      4 * (c->plain != 0) + 8 * s);
    dm_kernel kept;
    if (dm_cache_find(&kept, m, &maker, which)) {
        const dm_splitting table = c->table;
        if (!kept.pool) return 0;
        *c = *(const dm_chain *)kept.pool;
        c->table = table;
        c->lattice.source = &m->source;
        return 1;
    }
    dm_chain *copy = dm_arena_take(m->source.arena, sizeof *copy);
    if (!copy) return 0;
    const int there = dm_chain_make(c, m) == DM_OK;
    *copy = *c;
    kept = (dm_kernel){.pool = there ? copy : NULL};
    dm_cache_add(m, &maker, which, &kept, 1);
    return there;
}

/* The struct at the head of the workspace, in doubles. */
static size_t own_size(void) {
    return dm_doubles(sizeof(dm_chain));
}

/* Six arrays at most: q, q0, p0, dq, dp and weights. */
size_t dm_chain_work(const dm_model *m) {
    const size_t lattice = dm_lattice_work(&m->source, m->n, 6);
    return lattice ? own_size() + lattice : 0;
}

/* The plan is made twice: for what is found with the model, and over what was found. */
dm_chain *dm_chain_open(const dm_model *m, const dm_splitting *table, int plain, double *work) {
    if (!dm_chain_work(m)) return NULL;
    dm_chain *c = (dm_chain *)(void *)work;
    *c = (dm_chain){.table = *table, .plain = plain != 0};
    plan_step(c);
    if (c->last < c->first || !find(c, m)) return NULL;
    plan_step(c);
    dm_lattice_place(&c->lattice, work + own_size());
    if (c->same_weight == 0.0) dm_lattice_load(&c->lattice, c->weight, m->inverse_mass);
    return c;
}

/* ---- running ---- */

/* Positions are added up where passes do not do it on their way. */
static void load(dm_chain *c, const double *state) {
    const size_t n = c->lattice.n;
    dm_lattice_load(&c->lattice, c->q0, state);
    dm_lattice_load(&c->lattice, c->p0, state + n);
    if (!c->plain) {
        dm_lattice_load(&c->lattice, c->dq, state + 2 * n);
        dm_lattice_load(&c->lattice, c->dp, state + 3 * n);
    }
    if (!c->fused) dm_lattice_add_up(&c->lattice, dm_chain_positions(c));
}

/* Low parts too, where sums have them. */
static void store(const dm_chain *c, double *state) {
    const size_t n = c->lattice.n;
    dm_lattice_store(&c->lattice, state, c->q0);
    dm_lattice_store(&c->lattice, state + n, c->p0);
    if (c->plain) return;
    dm_lattice_store(&c->lattice, state + 2 * n, c->dq);
    dm_lattice_store(&c->lattice, state + 3 * n, c->dp);
}

/* One pass over all bodies: slopes and what is done with them, in one loop or in two. */
static void run(dm_chain *c, const dm_array_loop *passes, double t) {
    if (c->fused)
        dm_lattice_run_fused(&c->lattice, passes + 1, passes, dm_chain_positions(c), t);
    else
        dm_lattice_run(&c->lattice, passes, t);
}

/* what comes before the first turn of a burst */
static void begin(dm_chain *c, double h, double t) {
    dm_lattice *l = &c->lattice;
    dm_lattice_set(l, KICK, h * c->table.b[0]);
    dm_lattice_set(l, DRIFT, h * c->table.a[0]);
    if (c->table.b[0] != 0.0)
        run(c, c->middle, t);
    else
        dm_lattice_move(l, c->lead);
}

/* The last pass of a step turns into the next one, unless the burst stops there. */
static void step(dm_chain *c, const dm_chain_burst *b, int stops) {
    dm_lattice *l = &c->lattice;
    for (int k = c->first; k <= c->last; k++) {
        const dm_array_loop *rest = stops || !c->first ? c->stop : c->turn;
        dm_lattice_set(l, KICK, b->h * c->table.b[k]);
        if (k < c->table.stages) dm_lattice_set(l, DRIFT, b->h * c->table.a[k]);
        run(c, k < c->last ? c->middle : rest, b->t + c->c[k] * b->h);
    }
}

/* The time of a step comes from its number. */
static void steps(dm_chain *c, const dm_chain_burst *b) {
    dm_chain_burst now = *b;
    for (long k = 0; k < b->count; k++) {
        now.t = b->t + (double)k * b->h;
        step(c, &now, k == b->count - 1);
    }
}

/* A burst that goes on finds its arrays as they were left. */
long dm_chain_run(dm_chain *c, double *state, const dm_chain_burst *b) {
    const int kicks = c->first && c->table.b[0] != 0.0;
    if (b->count <= 0) return 0;
    if (!b->goes_on) load(c, state);
    if (c->first) begin(c, b->h, b->t);
    dm_lattice_set(&c->lattice, AGAIN_KICK, b->h * c->table.b[0]);
    dm_lattice_set(&c->lattice, AGAIN_DRIFT, b->h * c->table.a[0]);
    steps(c, b);
    if (!dm_lattice_is_finite(&c->lattice, c->q0) || !dm_lattice_is_finite(&c->lattice, c->p0))
        return 0; /* what is not finite stays so, and a sum whose low part is not is not either */
    store(c, state);
    return kicks + b->count * (c->last - c->first + 1);
}
