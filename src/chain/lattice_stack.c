/* lattice_stack.c - several passes over a chain in one loop. */
#include "code/native/jit_plan.h"
#include "graph/nodes.h"
#include "chain/lattice_inside.h"

#include <string.h>

enum { GROUP = DM_STRIP_GROUP, MOST_BLOCK = 3, MOST_SLOTS = 6, TILE = 512 };

/* one pass at its group, and what the pass before it left for that group */
typedef struct {
    const dm_strip *use;
    dm_node ahead[MOST_BLOCK], slope[MOST_SLOTS], out[DM_STRIP_MOST];
    dm_strand here[MOST_BLOCK], last[MOST_SLOTS];
    dm_strand left[DM_STRIP_MOST]; /* output k of the pass before; base FIXED: none */
} level;

typedef struct {
    const dm_lattice *l;
    dm_strip_draft d;
    dm_lattice_pair at;
    level level[DM_LATTICE_DEEP];
} stack;

static int64_t coordinates(const stack *b) {
    return (int64_t)b->l->block * b->l->pitch;
}

/* from tile to tile through memory; groups before the first valid one may carry anything */
static dm_strand carry(stack *b) {
    const int64_t at = (int64_t)b->d.carried * GROUP;
    return dm_strip_carry(&b->d, (dm_strand){DM_STRAND_SIDE, at}, 1);
}

/* a strand of pass k, which is k groups behind */
static dm_node read(stack *b, uint32_t k, dm_strand from) {
    if (from.base == DM_STRAND_FIXED) from.at += (int64_t)k * DM_LATTICE_NUMBERS;
    if (from.base == DM_STRAND_MAIN) from.at -= (int64_t)k * GROUP;
    return dm_strip_read(&b->d, from);
}

/* position of coordinate c one group on, when pass k begins */
static dm_node position_ahead(stack *b, uint32_t k, uint32_t c) {
    const dm_strip *before = k ? b->level[k - 1].use : NULL;
    for (uint32_t i = 0; before && i < before->one.outputs; i++)
        if (before->out[i].at == (int64_t)c * b->l->pitch) return b->level[k - 1].out[i];
    return before ? 0 : dm_lattice_ahead(b->l, &b->d, b->at, c);
}

/* what input i of the loop of a sum is in pass k */
static dm_node slope_input(stack *b, uint32_t k, dm_strand from) {
    const uint32_t c = (uint32_t)(from.at / b->l->pitch);
    if (from.base != DM_STRAND_MAIN || c >= b->l->block) return read(b, k, from);
    return from.at % b->l->pitch ? b->level[k].ahead[c] : dm_strip_read(&b->d, b->level[k].here[c]);
}

/* no slope where there is no round, whatever the term would say */
static void leave_out(stack *b, uint32_t k, const dm_rounds *r) {
    if (!r->there) return;
    const dm_node there = read(b, k, dm_lattice_entry(b->l, r->there));
    for (uint32_t slot = r->slot; slot < r->slot + r->slots; slot++) {
        dm_node *slope = b->level[k].slope + slot;
        *slope = dm_apply(b->d.g, DM_OP_WHERE, there, *slope, 0);
    }
}

static void take_slopes(stack *b, uint32_t k) {
    dm_node with[DM_STRIP_MOST];
    for (uint32_t n = 0; n < b->l->sums; n++) {
        const dm_rounds *r = b->l->sum + n;
        for (uint32_t i = 0; i < r->strip.one.inputs; i++)
            with[i] = slope_input(b, k, r->strip.in[i]);
        dm_strip_repeat(&b->d, &r->strip, with, b->level[k].slope + r->slot);
        leave_out(b, k, r);
    }
    for (uint32_t slot = 0; slot < b->l->slots; slot++) b->level[k].last[slot] = carry(b);
}

/* an input of pass k: a slope, what the pass before left, or what lies in memory */
static dm_node use_input(stack *b, uint32_t k, dm_strand from) {
    const level *v = b->level + k;
    if (from.base == DM_STRAND_SIDE) {
        const uint32_t slot = (uint32_t)((from.at + GROUP) / b->l->row);
        const int64_t rest = from.at - (int64_t)slot * b->l->row;
        return rest ? dm_strip_read(&b->d, v->last[slot]) : v->slope[slot];
    }
    for (uint32_t i = 0; k && i < v[-1].use->one.outputs; i++)
        if (v[-1].use->out[i].base == from.base && v[-1].use->out[i].at == from.at)
            return dm_strip_read(&b->d, v->left[i]);
    return read(b, k, from);
}

static void take_pass(stack *b, uint32_t k) {
    level *v = b->level + k;
    dm_node with[DM_STRIP_MOST];
    for (uint32_t c = 0; c < b->l->block; c++) {
        v->ahead[c] = position_ahead(b, k, c);
        v->here[c] = carry(b);
    }
    for (uint32_t i = 0; k && i < v[-1].use->one.outputs; i++)
        if (v[-1].use->out[i].at >= coordinates(b)) v->left[i] = carry(b);
    take_slopes(b, k);
    for (uint32_t i = 0; i < v->use->one.inputs; i++) with[i] = use_input(b, k, v->use->in[i]);
    dm_strip_repeat(&b->d, v->use, with, v->out);
}

/* what is handed on to the next group, the last pass first */
static void write_pass(stack *b, uint32_t k, int last) {
    const level *v = b->level + k;
    for (uint32_t i = 0; i < v->use->one.outputs; i++) {
        dm_strand to = v->use->out[i];
        if (to.at < coordinates(b)) continue;
        to.at -= (int64_t)k * GROUP;
        dm_strip_write(&b->d, last ? to : v[1].left[i], v->out[i]);
    }
    for (uint32_t c = 0; c < b->l->block; c++) dm_strip_write(&b->d, v->here[c], v->ahead[c]);
    for (uint32_t slot = 0; slot < b->l->slots; slot++)
        dm_strip_write(&b->d, v->last[slot], v->slope[slot]);
}

/* functions want the registers for themselves, and cost more than memory does */
static int has_functions(const dm_lattice *l) {
    for (uint32_t k = 0; k < l->sums; k++) {
        const dm_strip *s = &l->sum[k].strip;
        for (dm_node n = 0; n < dm_graph_size(s->g); n++)
            if (dm_is_call((uint8_t)dm_at(s->g, n)->op)) return 1;
    }
    return 0;
}

/* neighbours at most one body away, enough bodies for what the ends do twice; a chain that is
 * not closed is a ring some rounds of which are not there */
static int can_stack(const dm_lattice *l) {
    if (l->block > MOST_BLOCK || l->slots > MOST_SLOTS || l->pad != 1) return 0;
    for (uint32_t k = 0; k < l->sums; k++) {
        if (l->sum[k].strip.lanes != GROUP) return 0;
    }
    return dm_lattice_is_deep(l);
}

/* what a pass carries for itself: positions and slopes; from the one before: dq and dp too */
uint32_t dm_lattice_deep(const dm_lattice *l) {
    const uint32_t own = l->block + l->slots, more = own + 2 * l->block;
    if (!can_stack(l) || own > DM_STRIP_CARRIED) return 0;
    if (has_functions(l)) return 1;
    const uint32_t deep = 1 + (DM_STRIP_CARRIED - own) / more;
    return deep < DM_LATTICE_DEEP ? deep : DM_LATTICE_DEEP;
}

dm_status dm_lattice_stack(const dm_lattice *l, dm_strip *out, const dm_strip *const *use,
                           uint32_t count, dm_lattice_pair at) {
    const dm_source *from = &l->model->source;
    stack *b = dm_arena_take(from->arena, sizeof *b);
    if (count > dm_lattice_deep(l)) return DM_NO_NATIVE;
    if (!b || !dm_strip_begin(&b->d, from->arena)) return DM_NO_MEMORY;
    b->l = l;
    b->at = at;
    b->d.stands = 1;
    dm_graph_verbatim(b->d.g, 1);
    for (uint32_t k = 0; k < count; k++) {
        b->level[k].use = use[k];
        take_pass(b, k);
    }
    for (uint32_t k = count; k-- > 0;) write_pass(b, k, k + 1 == count);
    return dm_strip_end(out, &b->d, from->compile, from->arena);
}

/* ---- running ---- */

typedef double lanes __attribute__((vector_size(64), aligned(8), may_alias));

static inline __attribute__((always_inline)) void ends_of(const dm_lattice *l, double *x,
                                                          uint32_t count) {
    for (uint32_t k = 0; k < count; k++) {
        double *behind = x + (size_t)(l->depth + k) * GROUP;
        double *before = x - (size_t)(k + 1) * GROUP;
        const lanes first = *(const lanes *)(const void *)(x + (size_t)k * GROUP);
        const lanes last = *(const lanes *)(const void *)(behind - (size_t)(2 * k + 1) * GROUP);
        *(lanes *)(void *)behind = __builtin_shufflevector(first, first, 1, 2, 3, 4, 5, 6, 7, 0);
        *(lanes *)(void *)before = __builtin_shufflevector(last, last, 7, 0, 1, 2, 3, 4, 5, 6);
    }
}

/* the last part lacks some bodies: the first ones follow before its end, and what is before the
 * first part is there */
static void ends_of_last(const dm_lattice *l, double *x, uint32_t count) {
    const uint32_t lacks = l->depth * GROUP - l->bodies, own = l->depth - lacks;
    double *last = x + (size_t)own * GROUP + GROUP - 1, *before = x - GROUP;
    for (uint32_t k = 0; k < lacks + count; k++) last[(size_t)k * GROUP] = x[(size_t)k * GROUP];
    for (uint32_t k = 0; k < count; k++)
        *(before - (size_t)k * GROUP) = *(last - (size_t)(k + 1) * GROUP);
}

/* a number that the compiler knows saves two thirds of the time */
void dm_lattice_ends_of(const dm_lattice *l, double *x, uint32_t count) {
    ends_of(l, x, DM_LATTICE_DEEP);
    if (count > DM_LATTICE_DEEP) ends_of(l, x, count);
    if (l->bodies < l->depth * GROUP) ends_of_last(l, x, count);
}

void dm_lattice_copy_ends(const dm_lattice *l, uint32_t first, uint32_t count) {
    for (uint32_t c = 0; c < l->block; c++)
        dm_lattice_ends_of(l, l->space + (size_t)(first + c) * l->pitch, count);
}

/* where a layer is: groups [done, stop) are left for its first pass */
typedef struct {
    int64_t done, stop;
} front;

static void run_to(const dm_lattice *l, const dm_layer *layer, uint32_t k, front *f, int64_t to) {
    dm_strip_bases at = dm_lattice_bases(l, f->done, 0);
    if (to > f->stop) to = f->stop;
    if (to <= f->done) return;
    at.fixed = l->numbers + (size_t)k * DM_LATTICE_FIXED * GROUP;
    at.side = l->carried + (size_t)(2 * k + l->turn) * DM_STRIP_CARRIED * GROUP;
    dm_strip_run(layer[k].loop, at, (uint32_t)(to - f->done) * GROUP);
    f->done = to;
}

/* The first pass of a layer begins a group before the first one from which its last pass gets
 * what it needs; of the groups beyond both ends each pass loses one, those of the layers behind
 * it included. The last pass of a layer writes count - 1 groups behind the first, and the next
 * layer reads a group ahead: it may come as near as `count`. */
void dm_lattice_run_band(dm_lattice *l, const dm_layer *layer, uint32_t layers) {
    front f[DM_LATTICE_BAND];
    int64_t more = 0;
    if (layers == 0) return;
    l->turn = !l->turn; /* a loop does not wait for the end of the one before */
    for (uint32_t k = layers; k-- > 0;) {
        more += layer[k].count;
        f[k] = (front){-more - 1, l->depth + more - 1};
    }
    const int64_t tile = l->band > 1 ? TILE : f[0].stop - f[0].done;
    for (int64_t to = f[0].done; f[layers - 1].done < f[layers - 1].stop;) {
        int64_t least = to += tile;
        for (uint32_t k = 0; k < layers; k++) {
            run_to(l, layer, k, f + k, least);
            least = f[k].done - layer[k].count;
        }
    }
}
