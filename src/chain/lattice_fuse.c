/* lattice_fuse.c - slopes and what they are for in one loop over a chain. Positions and slopes
 * go from group to group in registers: a position is loaded once, as that of the next group, a
 * slope is never stored. That is so for neighbours one body away and 8 lanes; depths whose
 * rounds are not all there (the end of a chain that is not closed) are done apart, by way of
 * the buffer.
 * Speed: P8-fpu-1024: 1.31x with plain sums, 1.17x with compensated ones. */
#include "chain/lattice_inside.h"
#include "graph/nodes.h"

#include <string.h>

enum { GROUP = DM_ARRAY_GROUP, MOST_BLOCK = 3, MOST_SLOTS = 6 };

/* positions and slopes of this group, and what is carried to it */
typedef struct {
    const dm_lattice *l;
    dm_array_loop_draft d;
    dm_node ahead[MOST_BLOCK], slope[MOST_SLOTS];
    dm_array_ref here[MOST_BLOCK], last[MOST_SLOTS];
} fusion;

/* position of coordinate c one group on */
static dm_node position_ahead(const dm_lattice *l, dm_array_loop_draft *d, dm_lattice_pair at,
                              uint32_t c) {
    dm_array_ref q = dm_lattice_entry(l, at.high + c);
    q.at += GROUP;
    const dm_node high = dm_array_loop_read(d, q);
    if (at.low == DM_LATTICE_NONE) return high;
    dm_array_ref dq = dm_lattice_entry(l, at.low + c);
    dq.at += GROUP;
    return dm_add(d->g, high, dm_array_loop_read(d, dq));
}

/* the position of this group is what was that of the next one a group ago */
static void carry_positions(fusion *b, dm_lattice_pair at) {
    for (uint32_t c = 0; c < b->l->block; c++) {
        b->ahead[c] = position_ahead(b->l, &b->d, at, c);
        b->here[c] = dm_array_loop_carry(&b->d, dm_lattice_entry(b->l, c), 0);
    }
}

/* what input k of the loop of a sum is: a position of this group or the next one, or what it was */
static dm_node slope_input(fusion *b, dm_array_ref from) {
    const uint32_t c = (uint32_t)(from.at / b->l->pitch);
    const int64_t rest = from.at - (int64_t)c * b->l->pitch;
    if (from.base != DM_ARRAY_MAIN || c >= b->l->block) return dm_array_loop_read(&b->d, from);
    return rest ? b->ahead[c] : dm_array_loop_read(&b->d, b->here[c]);
}

/* the loop of a sum, its inputs replaced */
static void repeat_slopes(fusion *b, const dm_lattice_sum *r) {
    dm_node with[DM_ARRAY_LOOP_MOST];
    for (uint32_t k = 0; k < r->loop.one.inputs; k++) with[k] = slope_input(b, r->loop.in[k]);
    dm_array_loop_inline(&b->d, &r->loop, with, b->slope + r->slot);
}

/* the slope of the group before, at first the one in the buffer before the first group */
static void carry_slopes(fusion *b) {
    for (uint32_t slot = 0; slot < b->l->slots; slot++) {
        const dm_array_ref start = {DM_ARRAY_BUFFER, (int64_t)slot * b->l->row - GROUP};
        b->last[slot] = dm_array_loop_carry(&b->d, start, 1);
    }
}

/* an input of `use`: slopes of this group or of the one before, or what it was */
static dm_node use_input(fusion *b, dm_array_ref from) {
    if (from.base != DM_ARRAY_BUFFER) return dm_array_loop_read(&b->d, from);
    const uint32_t slot = (uint32_t)((from.at + GROUP) / b->l->row);
    const int64_t rest = from.at - (int64_t)slot * b->l->row;
    return rest ? dm_array_loop_read(&b->d, b->last[slot]) : b->slope[slot];
}

/* what the slopes are for, its inputs replaced; positions themselves are not written */
static void repeat_use(fusion *b, const dm_array_loop *use) {
    dm_node with[DM_ARRAY_LOOP_MOST], out[DM_ARRAY_LOOP_MOST];
    const int64_t coordinates = (int64_t)b->l->block * b->l->pitch;
    for (uint32_t k = 0; k < use->one.inputs; k++) with[k] = use_input(b, use->in[k]);
    dm_array_loop_inline(&b->d, use, with, out);
    for (uint32_t k = 0; k < use->one.outputs; k++)
        if (use->out[k].at >= coordinates) dm_array_loop_write(&b->d, use->out[k], out[k]);
}

/* what this group leaves to the next */
static void write_carried(fusion *b) {
    for (uint32_t c = 0; c < b->l->block; c++) dm_array_loop_write(&b->d, b->here[c], b->ahead[c]);
    for (uint32_t slot = 0; slot < b->l->slots; slot++)
        dm_array_loop_write(&b->d, b->last[slot], b->slope[slot]);
}

/* neighbours at most one body away, rounds over all of them */
static int can_fuse(const dm_lattice *l) {
    if (l->block > MOST_BLOCK || l->slots > MOST_SLOTS || l->pad > 1) return 0;
    for (uint32_t k = 0; k < l->sums; k++) {
        const dm_lattice_sum *r = l->sum + k;
        if (r->loop.lanes != GROUP || (!r->periodic && r->rounds + l->pad < l->bodies)) return 0;
    }
    return l->depth > 4 * GROUP;
}

dm_status dm_lattice_fuse(const dm_lattice *l, dm_array_loop *out, const dm_array_loop *use,
                          dm_lattice_pair at) {
    const dm_source *from = l->source;
    fusion *b = dm_arena_take(from->arena, sizeof *b);
    if (!can_fuse(l) || use->lanes != GROUP) return DM_NO_NATIVE;
    if (!b || !dm_array_loop_begin(&b->d, from->arena)) return DM_NO_MEMORY;
    b->l = l;
    b->d.verbatim = 1;
    dm_graph_verbatim(b->d.g, 1);
    carry_positions(b, at);
    for (uint32_t k = 0; k < l->sums; k++) repeat_slopes(b, l->sum + k);
    carry_slopes(b);
    repeat_use(b, use);
    write_carried(b);
    return dm_array_loop_end(out, &b->d, from->compile, from->arena);
}

/* ---- running ---- */

/* q = q0 + dq, or q = q0, of some depths: for ends, which loops read from memory */
static void add_up(const dm_lattice *l, dm_lattice_pair at, uint32_t first, uint32_t end) {
    const size_t from = (size_t)first * GROUP, to = (size_t)end * GROUP;
    for (uint32_t c = 0; c < l->block; c++) {
        double *q = l->space + (size_t)c * l->pitch;
        const double *q0 = q + (size_t)at.high * l->pitch;
        const double *dq = q + (at.low == DM_LATTICE_NONE ? 0 : at.low) * (size_t)l->pitch;
        for (size_t i = from; at.low == DM_LATTICE_NONE && i < to; i++) q[i] = q0[i];
        for (size_t i = from; at.low != DM_LATTICE_NONE && i < to; i++) q[i] = q0[i] + dq[i];
    }
}

void dm_lattice_add_up(dm_lattice *l, dm_lattice_pair at) {
    add_up(l, at, 0, l->depth);
}

/* positions that the loop reads beyond the bodies that are there; to[] = from[], 0 where from is
 * NULL */
static void give_array(const dm_lattice *l, double *to, const double *from) {
    const size_t behind = (size_t)l->depth * GROUP, count = (size_t)l->pad * GROUP;
    for (size_t k = behind; k < behind + count; k++) to[k] = from ? from[k] : 0.0;
    for (uint32_t i = l->bodies; i < l->depth * GROUP; i++) {
        const size_t k = dm_lattice_at(l, i);
        to[k] = from ? from[k] : 0.0;
    }
}

/* what lies there has to be a sum of two arrays again */
static void give_ends(const dm_lattice *l, dm_lattice_pair at) {
    for (uint32_t c = 0; c < l->block; c++) {
        double *q = l->space + (size_t)c * l->pitch;
        give_array(l, q + (size_t)at.high * l->pitch, q);
        if (at.low != DM_LATTICE_NONE) give_array(l, q + (size_t)at.low * l->pitch, NULL);
    }
}

/* depths that have all their rounds */
static uint32_t whole_depths(const dm_lattice *l) {
    int64_t least = l->depth;
    for (uint32_t k = 0; k < l->sums; k++) {
        const dm_lattice_sum *r = l->sum + k;
        const int64_t own = r->rounds - (int64_t)(GROUP - 1) * l->depth;
        if (!r->periodic && own < least) least = own;
    }
    return least > 0 ? (uint32_t)least : 0;
}

void dm_lattice_run_fused(dm_lattice *l, const dm_array_loop *fused, const dm_array_loop *use,
                          dm_lattice_pair at, double t) {
    const uint32_t margin = l->pad + (l->bodies % GROUP ? GROUP : 0) + 1;
    const uint32_t end = whole_depths(l), left = l->depth - end;
    dm_lattice_set(l, 0, t);
    add_up(l, at, 0, margin);
    add_up(l, at, (end < l->depth - margin ? end : l->depth - margin), l->depth);
    dm_lattice_fill_ends(l);
    give_ends(l, at);
    for (uint32_t k = 0; k < l->sums; k++) dm_lattice_fill(l, l->sum + k, 0, -(int64_t)l->pad, 0);
    dm_array_loop_run(fused, dm_lattice_bases(l, 0, 0), end * GROUP);
    if (!left) return;
    for (uint32_t k = 0; k < l->sums; k++) dm_lattice_fill(l, l->sum + k, end, 0, left);
    dm_array_loop_run(use, dm_lattice_bases(l, end, 0), left * GROUP);
}
