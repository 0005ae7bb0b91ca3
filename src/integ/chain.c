#include "integ/chain.h"

#include "integ/kept.h"
#include "mech/lattice.h"

#include <string.h>

enum { TIME, KICK, DRIFT, AGAIN_KICK, AGAIN_DRIFT }; /* numbers of a pass */

/* what a pass does with each body, in this order */
typedef struct {
    int kick, drift, end, again_kick, again_drift;
} pass;

struct dm_chain {
    dm_lattice lattice;
    dm_splitting table;
    double c[DM_SPLITTING_STAGES + 1]; /* time of kick k is t + c_k h */
    int first, last; /* kicks of a step; the first one of all may belong to the turn */
    int plain;
    uint32_t q, q0, p0, dq, dp, weight;
    double same_weight; /* 1/m where it is that of all, else 0 */
    dm_strip lead[2], middle[2], turn[2], stop[2]; /* alone; joined with the slopes */
    dm_strip deep_middle, deep_turn, deep_stop;    /* some passes in one loop */
    int joined;
    int deep;                        /* passes of one loop, 0: one by one */
    dm_layer layer[DM_LATTICE_BAND]; /* what is to be run together */
    uint32_t layers, passes;
    int moved, moves; /* q0 and p0, since their ends were copied; by these layers */
    int rest;         /* middle passes that the last loop of a step begins with */
};

/* ---- passes as nodes ---- */

/* one coordinate on its way through a pass */
typedef struct {
    dm_strip_draft *d;
    dm_node q0, p0, dq, dp, weight, force;
    int plain;
} body;

static dm_node number(body *b, uint32_t slot) {
    return dm_strip_read(b->d, dm_lattice_number(slot));
}

/* *sum += number in the slot times factor */
static void add(body *b, dm_node *sum, uint32_t slot, dm_node factor) {
    *sum = dm_apply(b->d->g, DM_OP_FMA, number(b, slot), factor, *sum);
}

static void add_kick(body *b, uint32_t slot) {
    add(b, b->plain ? &b->p0 : &b->dp, slot, b->force);
}

static void add_drift(body *b, uint32_t slot) {
    const dm_node p = b->plain ? b->p0 : dm_add(b->d->g, b->p0, b->dp);
    const dm_node v = b->weight ? dm_mul(b->d->g, b->weight, p) : p;
    add(b, b->plain ? &b->q0 : &b->dq, slot, v);
}

/* high + low exactly, whichever is larger (Knuth): low is at most half a unit of high then, so that the sum of both
** rounds to high and a burst begins where the last one ended */
static void add_up(dm_graph *g, dm_node *high, dm_node *low) {
    const dm_node sum = dm_add(g, *high, *low), from_low = dm_sub(g, sum, *high);
    const dm_node from_high = dm_sub(g, sum, from_low);
    *low = dm_add(g, dm_sub(g, *high, from_high), dm_sub(g, *low, from_low));
    *high = sum;
}

static void go_through(body *b, pass what) {
    if (what.kick) add_kick(b, KICK);
    if (what.drift) add_drift(b, DRIFT);
    if (what.end && !b->plain) {
        add_up(b->d->g, &b->q0, &b->dq);
        add_up(b->d->g, &b->p0, &b->dp);
    }
    if (what.again_kick) add_kick(b, AGAIN_KICK);
    if (what.again_drift) add_drift(b, AGAIN_DRIFT);
}

static dm_strand entry(const dm_chain *c, uint32_t first, uint32_t k) {
    return dm_lattice_entry(&c->lattice, first + k);
}

static dm_node weight_of(const dm_chain *c, dm_strip_draft *d, uint32_t k) {
    if (c->same_weight == 1.0) return 0;
    if (c->same_weight != 0.0) return dm_constant(d->g, c->same_weight);
    return dm_strip_read(d, entry(c, c->weight, k));
}

static void write_body(const dm_chain *c, body *b, pass what, uint32_t k) {
    const dm_node q = c->plain ? b->q0 : dm_add(b->d->g, b->q0, b->dq);
    dm_strip_write(b->d, entry(c, c->q, k), q);
    if (!c->plain) {
        dm_strip_write(b->d, entry(c, c->dq, k), b->dq);
        dm_strip_write(b->d, entry(c, c->dp, k), b->dp);
    }
    if (!what.end && !c->plain) return;
    dm_strip_write(b->d, entry(c, c->q0, k), b->q0);
    dm_strip_write(b->d, entry(c, c->p0, k), b->p0);
}

static void read_body(const dm_chain *c, body *b, uint32_t k) {
    b->q0 = dm_strip_read(b->d, entry(c, c->q0, k));
    if (!c->plain) b->dq = dm_strip_read(b->d, entry(c, c->dq, k));
    b->p0 = dm_strip_read(b->d, entry(c, c->p0, k));
    if (!c->plain) b->dp = dm_strip_read(b->d, entry(c, c->dp, k));
}

static dm_status make_pass(dm_chain *c, dm_strip *out, pass what) {
    const dm_source *from = &c->lattice.model->source;
    dm_node F[DM_STRIP_MOST];
    dm_strip_draft d;
    if (c->lattice.block > DM_STRIP_MOST) return DM_TOO_LARGE;
    if (!dm_strip_begin(&d, from->arena)) return DM_NO_MEMORY;
    dm_graph_verbatim(d.g, 1);
    if (what.kick || what.again_kick) dm_lattice_force(&c->lattice, &d, F);
    for (uint32_t k = 0; k < c->lattice.block; k++) {
        body b = {
            .d = &d, .force = F[k], .weight = weight_of(c, &d, k), .plain = c->plain};
        read_body(c, &b, k);
        go_through(&b, what);
        write_body(c, &b, what, k);
    }
    return dm_strip_end(out, &d, from->compile, from->arena);
}

/* ---- setting up ---- */

/* kicks at both ends of a step share a force and a pass; a step that begins with a drift has that
** in the pass before */
static void plan_step(dm_chain *c) {
    const dm_splitting *table = &c->table;
    const int s = table->stages, opens = table->b[0] != 0.0, closes = table->b[s] != 0.0;
    c->first = opens && !closes ? 0 : 1;
    c->last = closes ? s : s - 1;
    for (int k = 0; k < s; k++) c->c[k + 1] = c->c[k] + table->a[k];
    c->c[s] = 1.0;
}

static dm_lattice_pair positions(const dm_chain *c) {
    return (dm_lattice_pair){c->q0, c->plain ? DM_LATTICE_NONE : c->dq};
}

/* all passes or none: they differ in where positions are */
static int join(dm_chain *c) {
    dm_strip *const all[] = {c->middle, c->turn, c->stop};
    for (int k = 0; k < 3; k++)
        if (all[k]->one.outputs &&
            dm_lattice_join(&c->lattice, all[k] + 1, all[k], positions(c)) != DM_OK)
            return 0;
    return 1;
}

/* `count` passes, all but the last of them in the middle of a step */
static int stack_up(dm_chain *c, dm_strip *out, int count, const dm_strip *last) {
    const dm_strip *use[DM_LATTICE_DEEP];
    for (int k = 0; k < count; k++) use[k] = k + 1 < count ? c->middle : last;
    return dm_lattice_stack(&c->lattice, out, use, (uint32_t)count, positions(c)) ==
           DM_OK;
}

/* all stacks of a step, or none */
static int stack_all(dm_chain *c) {
    const int middle = c->last - c->first;
    c->deep = (int)dm_lattice_deep(&c->lattice);
    if (!c->deep) return 0;
    c->rest = middle % c->deep;
    if (middle >= c->deep && !stack_up(c, &c->deep_middle, c->deep, c->middle)) return 0;
    if (c->first && !stack_up(c, &c->deep_turn, c->rest + 1, c->turn)) return 0;
    return stack_up(c, &c->deep_stop, c->rest + 1, c->stop);
}

static dm_status make_passes(dm_chain *c) {
    const dm_splitting *table = &c->table;
    const int kicks = c->first && table->b[0] != 0.0, drifts = c->last < table->stages;
    const pass lead = {.drift = 1}, middle = {.kick = 1, .drift = 1};
    const pass stop = {.kick = 1, .drift = drifts, .end = 1};
    pass turn = stop;
    turn.again_kick = kicks;
    turn.again_drift = c->first;
    dm_status status = make_pass(c, c->stop, stop);
    if (status == DM_OK && (kicks || c->last > c->first))
        status = make_pass(c, c->middle, middle);
    if (status == DM_OK && c->first) status = make_pass(c, c->turn, turn);
    if (status == DM_OK && c->first && !kicks) status = make_pass(c, c->lead, lead);
    c->joined = status == DM_OK && join(c);
    if (!c->joined || !stack_all(c)) c->deep = 0;
    return status;
}

static double common_weight(const dm_model *m) {
    for (uint32_t i = 1; i < m->n; i++)
        if (m->inverse_mass[i] != m->inverse_mass[0]) return 0.0;
    return m->inverse_mass[0];
}

/* the loops of all steps with such a table; they take its coefficients as they run */
static dm_status make(dm_chain *c, const dm_model *m) {
    const dm_status status = dm_lattice_open(&c->lattice, m);
    if (status != DM_OK) return status;
    c->same_weight = common_weight(m);
    c->q0 = dm_lattice_arrays(&c->lattice);
    c->p0 = dm_lattice_arrays(&c->lattice);
    c->dq = dm_lattice_arrays(&c->lattice);
    c->dp = dm_lattice_arrays(&c->lattice);
    if (c->same_weight == 0.0) c->weight = dm_lattice_arrays(&c->lattice);
    return make_passes(c);
}

/* tables with the same kicks and drifts missing share their loops, which the model keeps */
static int find(dm_chain *c, const dm_model *m) {
    static const char maker;
    const int s = c->table.stages;
    const uint32_t which =
        (uint32_t)((c->table.b[0] != 0.0) + 2 * (c->table.b[s] != 0.0) +
                   4 * (c->plain != 0) + 8 * s);
    dm_kernel kept;
    if (dm_kept_find(&kept, m, &maker, which)) {
        const dm_splitting table = c->table;
        if (!kept.pool) return 0;
        *c = *(const dm_chain *)kept.pool;
        c->table = table;
        c->lattice.model = m;
        return 1;
    }
    dm_chain *copy = dm_arena_take(m->source.arena, sizeof *copy);
    if (!copy) return 0;
    const int there = make(c, m) == DM_OK;
    *copy = *c;
    kept = (dm_kernel){.pool = there ? copy : NULL};
    dm_kept_add(m, &maker, which, &kept, 1);
    return there;
}

static size_t own_size(void) {
    return (sizeof(dm_chain) + sizeof(double) - 1) / sizeof(double);
}

size_t dm_chain_work(const dm_model *m) {
    const size_t lattice = dm_lattice_work(m, 6);
    return lattice ? own_size() + lattice : 0;
}

dm_chain *dm_chain_open(const dm_model *m, const dm_splitting *table, int plain,
                        double *work) {
    if (!dm_chain_work(m)) return NULL;
    dm_chain *c = (dm_chain *)(void *)work;
    *c = (dm_chain){.table = *table, .plain = plain != 0};
    plan_step(c);
    if (c->last < c->first || !find(c, m)) return NULL;
    plan_step(c);
    dm_lattice_place(&c->lattice, work + own_size());
    if (c->same_weight == 0.0) {
        dm_lattice_load(&c->lattice, c->weight, m->inverse_mass);
        if (c->deep) dm_lattice_copy_ends(&c->lattice, c->weight, c->lattice.room);
    }
    return c;
}

/* ---- running ---- */

static void load(dm_chain *c, const double *state) {
    const size_t n = c->lattice.model->n;
    dm_lattice_load(&c->lattice, c->q0, state);
    dm_lattice_load(&c->lattice, c->p0, state + n);
    if (!c->plain) {
        dm_lattice_load(&c->lattice, c->dq, state + 2 * n);
        dm_lattice_load(&c->lattice, c->dp, state + 3 * n);
    }
    if (!c->joined) dm_lattice_add_up(&c->lattice, positions(c));
}

static void store(const dm_chain *c, double *state) {
    const size_t n = c->lattice.model->n;
    dm_lattice_store(&c->lattice, state, c->q0);
    dm_lattice_store(&c->lattice, state + n, c->p0);
    if (c->plain) return;
    dm_lattice_store(&c->lattice, state + 2 * n, c->dq);
    dm_lattice_store(&c->lattice, state + 3 * n, c->dp);
}

static void run(dm_chain *c, const dm_strip *passes, double t) {
    if (c->joined)
        dm_lattice_run_joined(&c->lattice, passes + 1, passes, positions(c), t);
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

/* numbers of kick k for pass `at` of a loop */
static void set_numbers(dm_chain *c, int k, int at, double h, double t) {
    dm_lattice *l = &c->lattice;
    const uint32_t slot = (uint32_t)at * DM_LATTICE_NUMBERS;
    dm_lattice_set(l, slot + TIME, t + c->c[k] * h);
    dm_lattice_set(l, slot + KICK, h * c->table.b[k]);
    if (k < c->table.stages) dm_lattice_set(l, slot + DRIFT, h * c->table.a[k]);
}

static void copy_ends(dm_chain *c) {
    const dm_lattice *l = &c->lattice;
    if (c->plain || c->moved) {
        dm_lattice_copy_ends(l, c->q0, c->passes);
        dm_lattice_copy_ends(l, c->p0, c->passes);
    }
    if (c->plain) return;
    dm_lattice_copy_ends(l, c->dq, c->passes);
    dm_lattice_copy_ends(l, c->dp, c->passes);
}

/* what has come together */
static void run_layers(dm_chain *c) {
    if (!c->layers) return;
    copy_ends(c);
    dm_lattice_run_band(&c->lattice, c->layer, c->layers);
    /* copies at the ends are for so many passes only */
    c->moved = c->moves || c->lattice.band > 1;
    c->layers = c->passes = 0;
    c->moves = 0;
    dm_lattice_choose(&c->lattice, 0);
}

/* kicks k .. k + count - 1 in one loop */
static void add_layer(dm_chain *c, const dm_strip *stack, int k, int count,
                      const dm_chain_burst *b) {
    dm_lattice *l = &c->lattice;
    if (c->layers == l->band || c->passes + (uint32_t)count > dm_lattice_reach(l))
        run_layers(c);
    dm_lattice_choose(l, c->layers);
    for (int i = 0; i < count; i++) set_numbers(c, k + i, i, b->h, b->t);
    c->layer[c->layers++] = (dm_layer){stack, (uint32_t)count};
    c->passes += (uint32_t)count;
}

static void step_stacked(dm_chain *c, const dm_chain_burst *b, int stops) {
    const dm_strip *rest = stops || !c->first ? &c->deep_stop : &c->deep_turn;
    const uint32_t slot = (uint32_t)c->rest * DM_LATTICE_NUMBERS;
    int k = c->first;
    for (; c->last - k >= c->deep; k += c->deep)
        add_layer(c, &c->deep_middle, k, c->deep, b);
    add_layer(c, rest, k, c->rest + 1, b);
    dm_lattice_set(&c->lattice, slot + AGAIN_KICK, b->h * c->table.b[0]);
    dm_lattice_set(&c->lattice, slot + AGAIN_DRIFT, b->h * c->table.a[0]);
    c->moves = 1;
    if (stops) run_layers(c);
}

static void step(dm_chain *c, const dm_chain_burst *b, int stops) {
    dm_lattice *l = &c->lattice;
    for (int k = c->first; k <= c->last; k++) {
        const dm_strip *rest = stops || !c->first ? c->stop : c->turn;
        dm_lattice_set(l, KICK, b->h * c->table.b[k]);
        if (k < c->table.stages) dm_lattice_set(l, DRIFT, b->h * c->table.a[k]);
        run(c, k < c->last ? c->middle : rest, b->t + c->c[k] * b->h);
    }
}

static void steps(dm_chain *c, const dm_chain_burst *b) {
    dm_chain_burst now = *b;
    c->moved = 1;
    for (long k = 0; k < b->count; k++) {
        now.t = b->t + (double)k * b->h;
        (c->deep ? step_stacked : step)(c, &now, k == b->count - 1);
    }
}

long dm_chain_run(dm_chain *c, double *state, const dm_chain_burst *b) {
    const int kicks = c->first && c->table.b[0] != 0.0;
    if (b->count <= 0) return 0;
    if (!b->goes_on) load(c, state);
    if (c->first) begin(c, b->h, b->t);
    dm_lattice_set(&c->lattice, AGAIN_KICK, b->h * c->table.b[0]);
    dm_lattice_set(&c->lattice, AGAIN_DRIFT, b->h * c->table.a[0]);
    steps(c, b);
    if (!dm_lattice_is_finite(&c->lattice, c->q0) ||
        !dm_lattice_is_finite(&c->lattice, c->p0))
        return 0; /* what is not finite stays so, and a sum whose low part is not is not either */
    store(c, state);
    return kicks + b->count * (c->last - c->first + 1);
}
