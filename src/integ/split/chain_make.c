/* chain_make.c - kicks and drifts of a chain as nodes, and the loops made of them. */
#include "integ/split/chain_inside.h"

/* what a pass does with each body, in this order */
typedef struct {
    int kick, drift, end, again_kick, again_drift;
} pass;

/* ---- passes as nodes ---- */

/* one coordinate on its way through a pass */
typedef struct {
    dm_array_loop_draft *d;
    dm_node q0, p0, dq, dp, weight, force;
    int plain;
} body;

/* The number in a slot, which the run sets before the pass. */
static dm_node number(body *b, uint32_t slot) {
    return dm_array_loop_read(b->d, dm_lattice_scalar(slot));
}

/* *sum += number in the slot times factor */
static void add(body *b, dm_node *sum, uint32_t slot, dm_node factor) {
    *sum = dm_apply(b->d->g, DM_OP_FMA, number(b, slot), factor, *sum);
}

/* Onto the increment of p, or p itself. */
static void add_kick(body *b, uint32_t slot) {
    add(b, b->plain ? &b->p0 : &b->dp, slot, b->force);
}

/* The momentum is p0 + dp at this place of the step. */
static void add_drift(body *b, uint32_t slot) {
    const dm_node p = b->plain ? b->p0 : dm_add(b->d->g, b->p0, b->dp);
    const dm_node v = b->weight ? dm_mul(b->d->g, b->weight, p) : p;
    add(b, b->plain ? &b->q0 : &b->dq, slot, v);
}

/* high + low exactly, whichever is larger (Knuth): low is at most half a unit of high then, so
 * that the sum of both rounds to high and a burst begins where the last one ended */
static void add_up(dm_graph *g, dm_node *high, dm_node *low) {
    const dm_node sum = dm_add(g, *high, *low), from_low = dm_sub(g, sum, *high);
    const dm_node from_high = dm_sub(g, sum, from_low);
    *low = dm_add(g, dm_sub(g, *high, from_high), dm_sub(g, *low, from_low));
    *high = sum;
}

/* The parts of a pass that are wanted, in the order of the struct. */
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

static dm_array_ref entry(const dm_chain *c, uint32_t first, uint32_t k) {
    return dm_lattice_entry(&c->lattice, first + k);
}

/* 1/m of coordinate k of a body; 0: it is 1. */
static dm_node weight_of(const dm_chain *c, dm_array_loop_draft *d, uint32_t k) {
    if (c->same_weight == 1.0) return 0;
    if (c->same_weight != 0.0) return dm_constant(d->g, c->same_weight);
    return dm_array_loop_read(d, entry(c, c->weight, k));
}

/* q is what the next force sees; q0 and p0 move at the end of a step alone. */
static void write_body(const dm_chain *c, body *b, pass what, uint32_t k) {
    const dm_node q = c->plain ? b->q0 : dm_add(b->d->g, b->q0, b->dq);
    dm_array_loop_write(b->d, entry(c, c->q, k), q);
    if (!c->plain) {
        dm_array_loop_write(b->d, entry(c, c->dq, k), b->dq);
        dm_array_loop_write(b->d, entry(c, c->dp, k), b->dp);
    }
    if (!what.end && !c->plain) return;
    dm_array_loop_write(b->d, entry(c, c->q0, k), b->q0);
    dm_array_loop_write(b->d, entry(c, c->p0, k), b->p0);
}

/* Increments only where there are any. */
static void read_body(const dm_chain *c, body *b, uint32_t k) {
    b->q0 = dm_array_loop_read(b->d, entry(c, c->q0, k));
    if (!c->plain) b->dq = dm_array_loop_read(b->d, entry(c, c->dq, k));
    b->p0 = dm_array_loop_read(b->d, entry(c, c->p0, k));
    if (!c->plain) b->dp = dm_array_loop_read(b->d, entry(c, c->dp, k));
}

/* Every coordinate of a body, behind one force of all. */
static dm_status make_pass(dm_chain *c, dm_array_loop *out, pass what) {
    const dm_source *from = c->lattice.source;
    dm_node F[DM_ARRAY_LOOP_MOST];
    dm_array_loop_draft d;
    if (c->lattice.block > DM_ARRAY_LOOP_MOST) return DM_TOO_LARGE;
    if (!dm_array_loop_begin(&d, from->arena)) return DM_NO_MEMORY;
    dm_graph_verbatim(d.g, 1);
    if (what.kick || what.again_kick) dm_lattice_force(&c->lattice, &d, F);
    for (uint32_t k = 0; k < c->lattice.block; k++) {
        body b = {.d = &d, .force = F[k], .weight = weight_of(c, &d, k), .plain = c->plain};
        read_body(c, &b, k);
        go_through(&b, what);
        write_body(c, &b, what, k);
    }
    return dm_array_loop_end(out, &d, from->compile, from->arena);
}

/* ---- loops ---- */

/* all passes or none: they differ in where positions are */
static int fuse(dm_chain *c) {
    dm_array_loop *const all[] = {c->middle, c->turn, c->stop};
    for (int k = 0; k < 3; k++)
        if (all[k]->one.outputs &&
            dm_lattice_fuse(&c->lattice, all[k] + 1, all[k], dm_chain_positions(c)) != DM_OK)
            return 0;
    return 1;
}

/* Those that steps of this shape have; the last one of all bursts always. */
static dm_status make_passes(dm_chain *c) {
    const dm_splitting *table = &c->table;
    const int kicks = c->first && table->b[0] != 0.0, drifts = c->last < table->stages;
    const pass lead = {.drift = 1}, middle = {.kick = 1, .drift = 1};
    const pass stop = {.kick = 1, .drift = drifts, .end = 1};
    pass turn = stop;
    turn.again_kick = kicks;
    turn.again_drift = c->first;
    dm_status status = make_pass(c, c->stop, stop);
    if (status == DM_OK && (kicks || c->last > c->first)) status = make_pass(c, c->middle, middle);
    if (status == DM_OK && c->first) status = make_pass(c, c->turn, turn);
    if (status == DM_OK && c->first && !kicks) status = make_pass(c, c->lead, lead);
    c->fused = status == DM_OK && fuse(c);
    return status;
}

static double common_weight(const dm_model *m) {
    for (uint32_t i = 1; i < m->n; i++)
        if (m->inverse_mass[i] != m->inverse_mass[0]) return 0.0;
    return m->inverse_mass[0];
}

/* Arrays are numbered here; the workspace that holds them comes later. */
dm_status dm_chain_make(dm_chain *c, const dm_model *m) {
    const dm_status status = dm_lattice_open(&c->lattice, &m->source, m->n);
    if (status != DM_OK) return status;
    c->same_weight = common_weight(m);
    c->q0 = dm_lattice_arrays(&c->lattice);
    c->p0 = dm_lattice_arrays(&c->lattice);
    c->dq = dm_lattice_arrays(&c->lattice);
    c->dp = dm_lattice_arrays(&c->lattice);
    if (c->same_weight == 0.0) c->weight = dm_lattice_arrays(&c->lattice);
    return make_passes(c);
}
