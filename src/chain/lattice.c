/* lattice.c - is a Lagrangian of this kind, and the loops that it is made of then: one a sum,
 * from coordinates to derivatives of its term. Everything about a layout is decided before
 * memory is taken (dm_lattice_layout), so that a stepper can ask for workspace first.
 * Speed: P8-fpu-1024: 12.7x, against loops over rounds (chain/loops.h). */
#include "chain/lattice_inside.h"

#include "algebra/body_sum.h"
#include "algebra/compact.h"
#include "algebra/derive.h"
#include "graph/analyse.h"

#include <string.h>

enum {
    TILE = 128, /* of the depth, between slopes and forces, at least */
    SKEW = 72,  /* doubles: entries of one body do not share the place in a page */
    PAGE = 512,
    GROUP = DM_ARRAY_GROUP,
    COLUMNS = 24
};

static uint32_t larger(uint32_t a, uint32_t b) {
    return a > b ? a : b;
}

/* ---- does it fit? ---- */

/* a column of coordinates that differ from round to round */
static int is_coordinate(const dm_lattice *l, const dm_column *c) {
    return !c->data && c->step && c->first < l->n;
}

/* entries from the body of a round to that of column c */
static uint32_t reach(const dm_lattice *l, const dm_sum *s, const dm_column *c) {
    const uint32_t own = is_coordinate(l, c) ? c->first / l->block : 0;
    return own + (c->partner ? s->from : 0);
}

/* what column c is needs a place: coordinates, numbers, the time; 0: none */
static int has_place(const dm_lattice *l, const dm_sum *s, const dm_column *c) {
    const uint32_t n = l->n;
    if (c->data) return 1;
    if (!c->step) return c->first == 2 * n;
    if (c->first >= n) return 0;
    const uint32_t own = c->first / l->block;
    return c->step == l->block && own + s->bodies <= l->bodies &&
           (!s->periodic || s->bodies == l->bodies);
}

/* the derivatives of the term times the factor of the sum; 0 where there are none */
static uint32_t find_slopes(const dm_lattice *l, const dm_sum *s, dm_node *slope) {
    uint32_t count = 0;
    dm_gradient(s->term, s->value, 0, s->columns, slope);
    for (uint32_t c = 0; c < s->columns; c++) {
        if (s->column[c].data || s->column[c].first >= l->n) slope[c] = 0;
        count += slope[c] != 0;
    }
    return count;
}

/* one sum: everything that its slopes need has a place */
static int sum_fits(const dm_lattice *l, const dm_sum *s) {
    dm_node slope[COLUMNS];
    if (s->from != s->to) return 0;
    if (!find_slopes(l, s, slope)) return 1;
    for (uint32_t c = 0; c < s->columns; c++) {
        const dm_column *column = s->column + c;
        if (slope[c] && !is_coordinate(l, column)) return 0;
        if (!has_place(l, s, column) && dm_depends(s->term, slope, s->columns, c, 1)) return 0;
    }
    return 1;
}

/* all of them */
static int sums_fit(const dm_lattice *l) {
    for (const dm_sum *s = dm_sums(l->source->sums); s; s = s->next)
        if (!sum_fits(l, s)) return 0;
    return 1;
}

/* L is linear in the sums, with numbers as factors, and nothing else depends on q */
static int outside_fits(const dm_lattice *l, double *factor) {
    const dm_source *from = l->source;
    for (uint32_t i = 0; i < l->n; i++)
        if (from->gradient[i]) return 0;
    for (const dm_sum *s = dm_sums(from->sums); s; s = s->next) {
        dm_node node;
        dm_gradient(from->sums, from->lagrangian, s->input, 1, &node);
        if (!dm_is_constant(from->sums, node, factor++)) return 0;
    }
    return dm_graph_status(from->sums) == DM_OK;
}

/* coordinates of a body: the step of the sums that depend on coordinates */
static void find_block(dm_lattice *l) {
    l->block = 1;
    for (const dm_sum *s = dm_sums(l->source->sums); s; s = s->next)
        for (uint32_t c = 0; c < s->columns; c++)
            if (is_coordinate(l, s->column + c)) l->block = s->column[c].step;
    l->bodies = l->n / l->block;
}

int dm_lattice_layout(dm_lattice *l) {
    uint32_t far = 0;
    find_block(l);
    if (l->n % l->block) return 0;
    for (const dm_sum *s = dm_sums(l->source->sums); s; s = s->next, l->sums++)
        for (uint32_t c = 0; c < s->columns; c++) far = larger(far, reach(l, s, s->column + c));
    l->depth = (l->bodies + GROUP - 1) / GROUP;
    l->pad = far;
    l->tile = larger(TILE, 4 * far);
    if (l->tile > l->depth) l->tile = l->depth;
    l->row = (far + l->tile) * GROUP;
    l->pitch = (((l->depth + 2 * l->pad) * GROUP + PAGE - 1) & ~(uint32_t)(PAGE - 1)) + SKEW;
    return far <= l->depth && l->bodies < INT32_MAX / 4096;
}

/* ---- the loops ---- */

/* column c of the term in a draft */
static dm_node read_column(dm_lattice *l, dm_array_loop_draft *d, const dm_sum *s,
                           const dm_column *c) {
    if (!c->data && !c->step) return dm_array_loop_read(d, dm_lattice_scalar(0));
    if (c->data && !c->step) return dm_constant(d->g, c->data[c->first]);
    const uint32_t array = c->data ? l->arrays++ : c->first % l->block;
    if (c->data) l->data[l->columns++] = (struct dm_lattice_data){s, c, array};
    dm_array_ref from = dm_lattice_entry(l, array);
    from.at += GROUP * (int64_t)reach(l, s, c);
    return dm_array_loop_read(d, from);
}

/* a share of its own, or the negative of one that is there */
static void add_share(dm_lattice *l, dm_array_loop_draft *d, const dm_lattice_sum *r,
                      dm_lattice_share to, dm_node value) {
    dm_compact(d->g, &value, 1, &value);
    const int turned = dm_graph_at(d->g, value)->op == DM_OP_NEG;
    uint32_t k = 0;
    if (turned) value = dm_graph_at(d->g, value)->as.arg[0];
    for (; k < d->outputs; k++) {
        dm_node sum = dm_add(d->g, d->root[k], value);
        dm_node difference = dm_sub(d->g, d->root[k], value);
        dm_compact(d->g, &sum, 1, &sum);
        dm_compact(d->g, &difference, 1, &difference);
        if (sum && difference) continue;
        to.minus = !sum;
        break;
    }
    to.slot = r->slot + k;
    to.minus ^= turned;
    if (k == d->outputs)
        dm_array_loop_write(d, (dm_array_ref){DM_ARRAY_BUFFER, (int64_t)l->slots++ * l->row},
                            value);
    l->share[l->shares++] = to;
}

/* the loop of one sum: columns are read, slopes times the factor of the sum written */
static dm_status make_sum(dm_lattice *l, const dm_sum *s, double factor) {
    dm_node term[COLUMNS], slope[COLUMNS], with[COLUMNS] = {0};
    dm_array_loop_draft d;
    dm_lattice_sum *r = l->sum + l->sums;
    const dm_source *from = l->source;
    if (factor == 0.0 || !find_slopes(l, s, term)) return DM_OK;
    if (!dm_array_loop_begin(&d, from->arena)) return DM_NO_MEMORY;
    for (uint32_t c = 0; c < s->columns; c++)
        if (dm_depends(s->term, term, s->columns, c, 1))
            with[c] = read_column(l, &d, s, s->column + c);
    dm_transplant(d.g, s->term, term, s->columns, with, slope);
    *r = (dm_lattice_sum){.rounds = dm_sum_rounds(s, s->from),
                          .periodic = s->periodic,
                          .slot = l->slots};
    for (uint32_t c = 0; c < s->columns; c++) {
        if (!slope[c]) continue;
        const dm_lattice_share to = {.coordinate = s->column[c].first % l->block,
                                     .shift = reach(l, s, s->column + c)};
        r->shift = larger(r->shift, to.shift);
        const dm_node scaled = dm_mul(d.g, dm_constant(d.g, factor), slope[c]);
        add_share(l, &d, r, to, scaled);
    }
    r->slots = l->slots - r->slot;
    l->sums++;
    return dm_array_loop_end(&r->loop, &d, from->compile, from->arena);
}

/* those that differ from zero, in their order */
static dm_status make_sums(dm_lattice *l, const double *factor) {
    dm_status status = DM_OK;
    l->sums = 0;
    for (const dm_sum *s = dm_sums(l->source->sums); s && status == DM_OK; s = s->next)
        status = make_sum(l, s, *factor++);
    return status;
}

/* What does not fit is found out before a loop is made. */
dm_status dm_lattice_open(dm_lattice *l, const dm_source *from, uint32_t n) {
    *l = (dm_lattice){.source = from, .n = n};
    if (!from->sums || dm_sum_over_cells(from->sums) || dm_sum_over_near(from->sums))
        return DM_TOO_LARGE;
    if (!dm_lattice_layout(l) || !sums_fit(l)) return DM_TOO_LARGE;
    double *factor = dm_arena_take(from->arena, (l->sums + 1) * sizeof *factor);
    l->sum = dm_arena_take(from->arena, (l->sums + 1) * sizeof *l->sum);
    l->share = dm_arena_take(from->arena, (l->sums + 1) * COLUMNS * sizeof *l->share);
    l->data = dm_arena_take(from->arena, (l->sums + 1) * COLUMNS * sizeof *l->data);
    if (!factor || !l->sum || !l->share || !l->data) return DM_NO_MEMORY;
    if (!outside_fits(l, factor)) return DM_TOO_LARGE;
    l->arrays = l->block;
    return make_sums(l, factor);
}

/* ---- running ---- */

/* those to be added come before those to be taken away */
void dm_lattice_force(const dm_lattice *l, dm_array_loop_draft *d, dm_node *F) {
    uint8_t some[COLUMNS] = {0};
    memset(F, 0, l->block * sizeof *F);
    for (uint32_t k = 0; k < 2 * l->shares; k++) {
        const dm_lattice_share *s = l->share + k % l->shares;
        const int64_t at = (int64_t)s->slot * l->row - GROUP * (int64_t)s->shift;
        dm_node *to = F + s->coordinate;
        if (s->minus != (k >= l->shares)) continue;
        const dm_node x = dm_array_loop_read(d, (dm_array_ref){DM_ARRAY_BUFFER, at});
        if (!some[s->coordinate])
            *to = s->minus ? dm_neg(d->g, x) : x;
        else
            *to = s->minus ? dm_sub(d->g, *to, x) : dm_add(d->g, *to, x);
        some[s->coordinate] = 1;
    }
}

/* where depth j and its entries in the buffer are, that of the tile before at its beginning */
dm_array_bases dm_lattice_bases(const dm_lattice *l, int64_t j, int64_t in_tile) {
    return (dm_array_bases){.main = l->space + j * GROUP,
                            .buffer = l->buffer + (l->pad + in_tile) * GROUP,
                            .scalars = l->scalars};
}

/* no rounds are before the first one and behind the last one: depths [first, end) of a tile at j */
static void clear_outside(const dm_lattice *l, const dm_lattice_sum *r, int64_t j, int64_t first,
                          int64_t end) {
    for (uint32_t slot = r->slot; slot < r->slot + r->slots; slot++) {
        double *row = l->buffer + (size_t)slot * l->row + (size_t)l->pad * GROUP;
        for (int64_t k = first; k < 0; k++) row[k * GROUP] = 0.0;
        for (int64_t lane = 0; lane < GROUP; lane++) {
            const int64_t last = r->rounds - lane * l->depth - j;
            for (int64_t k = last > first ? last : first; k < end; k++) row[k * GROUP + lane] = 0.0;
        }
    }
}

/* slopes at depths j + first .. j + end - 1 */
void dm_lattice_fill(const dm_lattice *l, const dm_lattice_sum *r, int64_t j, int64_t first,
                     int64_t end) {
    dm_array_loop_run(&r->loop, dm_lattice_bases(l, j + first, first),
                      (uint32_t)(end - first) * GROUP);
    if (!r->periodic) clear_outside(l, r, j, first, end);
}

/* the last entries of a tile are what the next one looks back to */
static void keep_end(const dm_lattice *l) {
    for (uint32_t slot = 0; slot < l->slots; slot++) {
        double *row = l->buffer + (size_t)slot * l->row;
        memcpy(row, row + (size_t)l->tile * GROUP, (size_t)l->pad * GROUP * sizeof *row);
    }
}

/* Scalar 0 is the time; ends are renewed, then slopes and their use go tile by tile. */
void dm_lattice_run(dm_lattice *l, const dm_array_loop *use, double t) {
    dm_lattice_set(l, 0, t);
    dm_lattice_fill_ends(l);
    for (uint32_t j = 0; j < l->depth; j += l->tile) {
        const uint32_t left = l->depth - j, count = left < l->tile ? left : l->tile;
        for (uint32_t k = 0; k < l->sums; k++)
            dm_lattice_fill(l, l->sum + k, j, j ? 0 : -(int64_t)l->sum[k].shift, count);
        dm_array_loop_run(use, dm_lattice_bases(l, j, 0), count * GROUP);
        if (count < left) keep_end(l);
    }
}

/* all depths at once: nothing is looked back to */
void dm_lattice_move(const dm_lattice *l, const dm_array_loop *loop) {
    dm_array_loop_run(loop, dm_lattice_bases(l, 0, 0), l->depth * GROUP);
}
