/* cells.c - the loops of a sum over cells, and what entries of the gradient get of their slopes. */
#include "chain/cells.h"

#include "algebra/compact.h"
#include "algebra/derive.h"
#include "chain/cell_lists.h"
#include "code/native/jit.h"
#include "graph/analyse.h"

#include <string.h>

enum { BLOCK = DM_CELL_BLOCK, WIDEST = 8, RUN = 1024 };

/* ---- kernels ---- */

/* the functions of the columns that they depend on, as a graph of these alone */
static dm_graph *cut_down(dm_cell_loop *l, const dm_node *roots, dm_node *out, dm_arena *arena) {
    dm_graph *term = l->sum->term;
    dm_node with[DM_SUM_COLUMNS] = {0};
    for (uint32_t c = 0; c < l->sum->columns; c++)
        if (dm_depends(term, roots, l->outputs, c, 1)) l->column[l->columns++] = (uint8_t)c;
    dm_graph *own = dm_graph_new(arena, l->columns);
    dm_node *all = own ? dm_arena_take(arena, dm_graph_inputs(term) * sizeof *all) : NULL;
    if (!all) return NULL;
    for (uint32_t k = 0; k < l->columns; k++) with[l->column[k]] = dm_input(own, k);
    memset(all, 0, dm_graph_inputs(term) * sizeof *all);
    memcpy(all, with, l->sum->columns * sizeof *all);
    dm_transplant(own, term, roots, l->outputs, all, out);
    return own;
}

/* as a kernel of them would be compacted */
static dm_status read_linear(dm_cell_loop *l, dm_graph *g, const dm_node *roots, dm_node *compact,
                             dm_arena *arena) {
    dm_graph *small = dm_compact_graph(g, roots, l->outputs, compact);
    if (!small) return DM_NO_MEMORY;
    return dm_cell_linear_read(&l->linear, l->sum, l->column, small, compact, l->outputs, arena);
}

dm_status dm_cell_loop_make(dm_cell_loop *l, const dm_sum *s, const dm_node *roots,
                            uint32_t outputs, dm_compile *compile, dm_arena *arena) {
    const uint32_t lanes = dm_jit_lanes();
    *l = (dm_cell_loop){.sum = s, .outputs = outputs};
    dm_node *own = dm_arena_take(arena, 2 * ((size_t)outputs + 1) * sizeof *own);
    if (!own) return DM_NO_MEMORY;
    dm_graph *g = cut_down(l, roots, own, arena);
    if (!g) return DM_NO_MEMORY;
    dm_status status = dm_graph_status(g);
    if (status == DM_OK) status = read_linear(l, g, own, own + outputs, arena);
    if (status != DM_OK || l->linear) return status;
    status = compile(&l->one, g, own, outputs, arena);
    if (status != DM_OK || lanes < 4 || strcmp(l->one.backend, "jit") != 0) return status;
    status = dm_jit_build_lanes(&l->many, g, own, outputs, lanes, arena);
    if (status == DM_OK) l->lanes = lanes;
    return status == DM_NO_NATIVE ? DM_OK : status;
}

/* ---- running them ---- */

size_t dm_cell_loop_work(const dm_cell_loop *l) {
    return (size_t)(l->columns * BLOCK) + (size_t)(l->outputs + 1) * WIDEST + WIDEST;
}

/* in[group][column][lane] of the cells from `first` on; `lanes` is a constant where this is called:
 * all is gathered before the first call, since a load of all lanes at once has to wait for the
 * stores of their parts */
__attribute__((always_inline)) static inline void gather(const dm_cell_loop *l, double *in,
                                                         const double *x, uint32_t first,
                                                         uint32_t count, const uint32_t lanes) {
    for (uint32_t k = 0; k < l->columns; k++, in += lanes) {
        const dm_column *c = l->sum->column + l->column[k];
        const double *from = (c->data ? c->data : x) + c->first;
        const size_t step = c->step;
        double *to = in;
        for (uint32_t r = 0; r < count; r += lanes, to += (size_t)l->columns * lanes) {
            const uint32_t i = first + r;
            if (c->index && step == 1)
                for (uint32_t lane = 0; lane < lanes; lane++) to[lane] = from[c->index[i + lane]];
            else if (c->index)
                for (uint32_t lane = 0; lane < lanes; lane++)
                    to[lane] = from[step * c->index[i + lane]];
            else if (step == 1)
                memcpy(to, from + i, lanes * sizeof *to);
            else
                for (uint32_t lane = 0; lane < lanes; lane++) to[lane] = from[step * (i + lane)];
        }
    }
}

__attribute__((always_inline)) static inline void run_block(const dm_cell_loop *l, double *out,
                                                            size_t stride, const double *x,
                                                            uint32_t first, uint32_t count,
                                                            double *work, const uint32_t lanes) {
    const dm_kernel *kernel = lanes == 1 ? &l->one : &l->many;
    double *in = work, *y = work + (size_t)l->columns * BLOCK;
    gather(l, in, x, first, count, lanes);
    if (lanes == 1)
        dm_kernel_prepare(kernel, y);
    else
        dm_kernel_prepare_lanes(kernel, lanes, y);
    if (l->outputs == 1 && !(kernel->fixed && kernel->fixed[0])) { /* no constant: y is not kept */
        for (uint32_t r = 0; r < count; r += lanes, in += (size_t)l->columns * lanes)
            dm_kernel_eval(kernel, in, out + r);
        return;
    }
    for (uint32_t r = 0; r < count; r += lanes, in += (size_t)l->columns * lanes) {
        dm_kernel_eval(kernel, in, y);
        for (uint32_t k = 0; k < l->outputs; k++)
            memcpy(out + k * stride + r, y + (size_t)k * lanes, lanes * sizeof *y);
    }
}

/* whole groups in lanes, the rest one by one */
void dm_cell_loop_run(const dm_cell_loop *l, double *out, size_t stride, const double *x,
                      uint32_t first, uint32_t count, double *work) {
    for (uint32_t k = 0; l->linear && k < l->outputs; k++)
        dm_cell_linear_run(l->linear + k, out + k * stride, 1, x, first, count, 1.0);
    if (l->linear) return;
    const uintptr_t line = WIDEST * sizeof *work;
    work += (line - (uintptr_t)work % line) % line / sizeof *work;
    while (count) {
        uint32_t now = count < BLOCK ? count : BLOCK;
        const uint32_t lanes = l->lanes && now >= l->lanes ? l->lanes : 1;
        now -= now % lanes;
        if (lanes == 8)
            run_block(l, out, stride, x, first, now, work, 8);
        else if (lanes == 4)
            run_block(l, out, stride, x, first, now, work, 4);
        else
            run_block(l, out, stride, x, first, now, work, 1);
        first += now;
        count -= now;
        out += now;
    }
}

/* ---- the gradient ---- */

/* the output that is this root or, *sign = -1, its opposite; a new one where there is none */
static uint32_t find_output(dm_graph *term, dm_node *roots, uint32_t *outputs, dm_node root,
                            double *sign) {
    const dm_node opposite = dm_neg(term, root);
    for (uint32_t k = 0; k < *outputs; k++) {
        *sign = roots[k] == opposite ? -1.0 : 1.0;
        if (roots[k] == root || roots[k] == opposite) return k;
    }
    *sign = 1.0;
    roots[*outputs] = root;
    return (*outputs)++;
}

/* where slopes by the columns of s go; *outputs of the loop */
static dm_status find_shares(dm_cell_slopes *d, const dm_sum *s, uint32_t m, dm_node *roots,
                             uint32_t *outputs, dm_arena *arena) {
    dm_node slope[DM_SUM_COLUMNS];
    d->share = dm_arena_take(arena, s->columns * sizeof *d->share);
    if (!d->share) return DM_NO_MEMORY;
    dm_gradient(s->term, s->value, 0, s->columns, slope);
    for (uint32_t k = 0; k < s->columns; k++) {
        const dm_column *c = s->column + k;
        if (!slope[k] || c->data || c->first >= m) continue;
        dm_cell_share *to = d->share + d->shares++;
        *to = (dm_cell_share){.index = c->index, .first = c->first, .step = c->step};
        to->output = find_output(s->term, roots, outputs, slope[k], &to->sign);
        if (d->shares == 1) d->step = c->step;
        if (!c->index || c->step != d->step) d->step = 0;
    }
    return dm_graph_status(s->term);
}

/* the share of the entries that a term reads, or NULL */
static const dm_cell_share *share_of(const dm_cell_slopes *d, const dm_linear_term *t) {
    const dm_cell_share *found = NULL;
    for (const dm_cell_share *s = d->share; s < d->share + d->shares; s++)
        if (s->index == t->index && s->first == t->first && s->step == t->step) {
            if (found) return NULL;
            found = s;
        }
    return found;
}

/* Outputs that have no entries in common, such as values of a vector side by side, may be added one
 * after the other: the order of the sums of an entry stays that of the cells. */
static int are_apart(const dm_cell_slopes *d) {
    for (uint32_t a = 0; a < d->shares; a++)
        for (uint32_t b = 0; b < a; b++) {
            const dm_cell_share *s = d->share + a, *t = d->share + b;
            if (s->output == t->output) continue;
            if (!s->step || s->step != t->step) return 0;
            if (s->first % s->step == t->first % s->step) return 0;
        }
    return 1;
}

/* do all slopes go where they come from, as those of |da|^2 do? */
static void find_direct(dm_cell_slopes *d) {
    const dm_cell_loop *l = &d->loop;
    uint32_t terms = 0;
    if (!l->linear || !are_apart(d)) return;
    for (uint32_t k = 0; k < l->outputs; k++)
        for (uint32_t j = 0; j < l->linear[k].terms; j++, terms++) {
            const dm_linear_term *t = l->linear[k].term + j;
            const dm_cell_share *s = share_of(d, t);
            if (!s || s->output != k) return;
            if (!terms) d->turned = s->sign * t->sign;
            if (s->sign * t->sign != d->turned) return;
        }
    d->direct = terms == d->shares;
}

/* loop and shares of one sum */
static dm_status open_sum(dm_cells *c, const dm_sum *s, dm_compile *compile, dm_arena *arena) {
    dm_node roots[DM_SUM_COLUMNS];
    uint32_t outputs = 0;
    dm_cell_slopes *d = c->sum + c->sums++;
    *d = (dm_cell_slopes){.loop = {.sum = s}};
    dm_status status = find_shares(d, s, c->m, roots, &outputs, arena);
    if (status != DM_OK || !outputs) return status;
    status = dm_cell_loop_make(&d->loop, s, roots, outputs, compile, arena);
    if (status == DM_OK) find_direct(d);
    const size_t work = dm_cell_loop_work(&d->loop) + (size_t)outputs * BLOCK;
    if (work > c->work) c->work = work;
    c->shared &= d->loop.linear || (d->loop.one.backend && strcmp(d->loop.one.backend, "jit") == 0);
    for (uint32_t i = 0; s->held && i < s->coordinates; i++)
        if (s->held[i] == DM_HELD) c->held = s->held;
    c->coordinates = s->coordinates;
    return status;
}

const dm_sum **dm_cells_sums(dm_graph *g, dm_node root, dm_node *factor, uint32_t *count,
                             dm_arena *arena) {
    uint32_t most = 0;
    for (const dm_sum *s = dm_sums(g); s; s = s->next) most++;
    const dm_sum **sums = dm_arena_take(arena, (most + 1) * sizeof(void *));
    *count = 0;
    for (const dm_sum *s = dm_sums(g); s && sums; s = s->next) {
        if (!s->cells || s->work) continue;
        dm_gradient(g, root, s->input, 1, factor + *count);
        if (factor[*count]) sums[(*count)++] = s;
    }
    return sums;
}

dm_status dm_cells_open(dm_cells *c, const dm_sum *const *sums, uint32_t count, uint32_t m,
                        dm_compile *compile, dm_arena *arena) {
    dm_status status = DM_OK;
    *c = (dm_cells){.m = m, .shared = 1};
    c->sum = dm_arena_take(arena, (count + 1) * sizeof *c->sum);
    c->lists = dm_arena_take(arena, sizeof *c->lists);
    c->ranges = dm_arena_take(arena, sizeof(struct dm_cell_ranges *));
    if (!c->sum || !c->lists || !c->ranges) return DM_NO_MEMORY;
    *c->lists = (dm_cell_lists){0};
    *c->ranges = NULL;
    for (uint32_t k = 0; k < count && status == DM_OK; k++)
        status = open_sum(c, sums[k], compile, arena);
    return status;
}

/* ---- adding slopes up ---- */

/* out += factor times the slopes y[output][BLOCK] of cells [first, first + count), cell by cell.
 * Constants where this is called: shares, which have an index, and step, which is that of all. */
__attribute__((always_inline)) static inline void scatter(const dm_cell_slopes *d, double *out,
                                                          double factor, const double *y,
                                                          uint32_t first, uint32_t count,
                                                          const uint32_t shares,
                                                          const uint32_t step) {
    const uint32_t *index[DM_SUM_COLUMNS];
    const double *slope[DM_SUM_COLUMNS];
    double *to[DM_SUM_COLUMNS], by[DM_SUM_COLUMNS];
    for (uint32_t k = 0; k < shares; k++) {
        const dm_cell_share *s = d->share + k;
        index[k] = s->index + first;
        slope[k] = y + s->output * BLOCK;
        to[k] = out + s->first;
        by[k] = s->sign * factor;
    }
    for (uint32_t i = 0; i < count; i++)
#pragma GCC unroll 4
        for (uint32_t k = 0; k < shares; k++)
            to[k][(size_t)step * index[k][i]] += by[k] * slope[k][i];
}

/* the same of any shares */
static void scatter_any(const dm_cell_slopes *d, double *out, double factor, const double *y,
                        uint32_t first, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        for (const dm_cell_share *s = d->share; s < d->share + d->shares; s++)
            out[dm_cell_share_entry(s, first + i)] += s->sign * factor * y[s->output * BLOCK + i];
}

/* cells with an entry of their own, one behind the other */
static void add_run(double *restrict to, double factor, const double *restrict y, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) to[i] += factor * y[i];
}

/* of vertices, edges and triangles, which fields have most often, and of any cells */
static void add_slopes(const dm_cell_slopes *d, double *out, double factor, const double *y,
                       uint32_t first, uint32_t count) {
    const dm_cell_share *s = d->share;
    if (d->shares == 1 && !s->index && s->step == 1)
        add_run(out + s->first + first, s->sign * factor, y, count);
    else if (d->step == 1 && d->shares == 2)
        scatter(d, out, factor, y, first, count, 2, 1);
    else if (d->step == 1 && d->shares == 3)
        scatter(d, out, factor, y, first, count, 3, 1);
    else if (d->step)
        scatter(d, out, factor, y, first, count, d->shares, d->step);
    else
        scatter_any(d, out, factor, y, first, count);
}

/* linear slopes in runs, as far as x is in the caches for all outputs; others block by block */
void dm_cells_add(const dm_cell_slopes *d, double *out, double factor, const double *x,
                  uint32_t first, uint32_t cells, double *work) {
    const dm_cell_loop *l = &d->loop;
    const uint32_t end = first + cells, most = d->direct ? RUN : BLOCK;
    for (; first < end; first += most) {
        const uint32_t count = end - first < most ? end - first : most;
        for (uint32_t k = 0; d->direct && k < l->outputs; k++)
            dm_cell_linear_add(l->linear + k, out, x, first, count, d->turned * factor);
        if (d->direct) continue;
        dm_cell_loop_run(l, work, BLOCK, x, first, count, work + (size_t)l->outputs * BLOCK);
        add_slopes(d, out, factor, work, first, count);
    }
}

void dm_cells_hold(const dm_cells *c, double *out, uint32_t from, uint32_t to) {
    for (uint32_t i = from; c->held && i < to; i++)
        if (c->held[i % c->coordinates] == DM_HELD) out[i] = 0.0;
}

void dm_cells_gradient(const dm_cells *c, double *out, const double *factor, const double *x,
                       double *work) {
    memset(out, 0, c->m * sizeof *out);
    for (uint32_t k = 0; k < c->sums; k++) {
        const dm_cell_slopes *d = c->sum + k;
        const uint32_t cells = d->loop.outputs ? d->loop.sum->bodies : 0;
        dm_cells_add(d, out, factor[k], x, 0, cells, work);
    }
    dm_cells_hold(c, out, 0, c->m);
}
