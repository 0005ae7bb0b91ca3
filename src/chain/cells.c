/* cells.c - the loops of a sum over cells, and what entries of the gradient get of their slopes. */
#include "chain/cells.h"

#include "algebra/compact.h"
#include "algebra/derive.h"
#include "code/native/jit.h"
#include "graph/analyse.h"

#include <string.h>

enum { BLOCK = DM_CELL_BLOCK, WIDEST = 8, RUN = 16 };

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
        dm_cell_linear_run(l->linear + k, out + k * stride, x, first, count, 1.0);
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

/* the entry that cell i has in a share */
static inline size_t entry_of(const dm_cell_share *s, uint32_t i) {
    return s->first + (size_t)s->step * (s->index ? s->index[i] : i);
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
            if (s->step != t->step || s->first % s->step == t->first % s->step) return 0;
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

/* least and largest entries, block by block */
static dm_status find_reach(dm_cell_slopes *d, uint32_t cells, dm_arena *arena) {
    const uint32_t blocks = (cells + BLOCK - 1) / BLOCK;
    d->reach = dm_arena_take(arena, ((size_t)blocks + 1) * sizeof *d->reach);
    if (!d->reach) return DM_NO_MEMORY;
    for (uint32_t b = 0; b < blocks; b++) d->reach[b][0] = UINT32_MAX, d->reach[b][1] = 0;
    for (uint32_t k = 0; k < d->shares; k++)
        for (uint32_t i = 0; i < cells; i++) {
            const uint32_t entry = (uint32_t)entry_of(d->share + k, i);
            uint32_t *reach = d->reach[i / BLOCK];
            if (entry < reach[0]) reach[0] = entry;
            if (entry > reach[1]) reach[1] = entry;
        }
    return DM_OK;
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
    if (status == DM_OK) status = find_reach(d, s->bodies, arena);
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
    if (!c->sum) return DM_NO_MEMORY;
    for (uint32_t k = 0; k < count && status == DM_OK; k++)
        status = open_sum(c, sums[k], compile, arena);
    return status;
}

/* ---- adding slopes up ---- */

/* Slopes y[output][BLOCK] of the cells [first, first + count), times the factor, to the entries
 * that they belong to, cell by cell; all shares have an index. Constants where this is called:
 * shares, and step, which is that of all. */
__attribute__((always_inline)) static inline void scatter(const dm_cell_slopes *d,
                                                          const dm_cell_target *t, const double *y,
                                                          uint32_t first, uint32_t count,
                                                          const uint32_t shares,
                                                          const uint32_t step) {
    const uint32_t *index[DM_SUM_COLUMNS];
    const double *slope[DM_SUM_COLUMNS];
    double *to[DM_SUM_COLUMNS], sign[DM_SUM_COLUMNS];
    for (uint32_t k = 0; k < shares; k++) {
        const dm_cell_share *s = d->share + k;
        index[k] = s->index + first;
        slope[k] = y + s->output * BLOCK;
        to[k] = t->out + s->first;
        sign[k] = s->sign * t->factor;
    }
    for (uint32_t i = 0; i < count; i++)
#pragma GCC unroll 4
        for (uint32_t k = 0; k < shares; k++)
            to[k][(size_t)step * index[k][i]] += sign[k] * slope[k][i];
}

/* the same of any shares, where entries are asked for */
static void scatter_some(const dm_cell_slopes *d, const dm_cell_target *t, const double *y,
                         uint32_t first, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        for (const dm_cell_share *s = d->share; s < d->share + d->shares; s++) {
            const size_t entry = entry_of(s, first + i);
            if (entry >= t->from && entry < t->to)
                t->out[entry] += s->sign * t->factor * y[s->output * BLOCK + i];
        }
}

/* cells with a share of their own, one behind the other */
static void add_run(const dm_cell_share *s, const dm_cell_target *t, const double *restrict y,
                    uint32_t first, uint32_t count) {
    double *restrict to = t->out + s->first + first;
    const double sign = s->sign * t->factor;
    for (uint32_t i = 0; i < count; i++) to[i] += sign * y[i];
}

/* of single cells, edges and triangles, which fields have most often, and of any */
static void add_slopes(const dm_cell_slopes *d, const dm_cell_target *t, const double *y,
                       uint32_t first, uint32_t count, int whole) {
    if (whole && d->shares == 1 && !d->share->index && d->share->step == 1)
        add_run(d->share, t, y, first, count);
    else if (whole && d->step == 1 && d->shares == 2)
        scatter(d, t, y, first, count, 2, 1);
    else if (whole && d->step == 1 && d->shares == 3)
        scatter(d, t, y, first, count, 3, 1);
    else if (whole && d->step)
        scatter(d, t, y, first, count, d->shares, d->step);
    else
        scatter_some(d, t, y, first, count);
}

/* the end of a run of at most RUN blocks that are alike: they have an entry that is asked for, or
 * none, and others, too, or none; *some, *whole: what they are */
static uint32_t end_of_run(const dm_cell_slopes *d, const dm_cell_target *t, uint32_t first,
                           uint32_t cells, int *some, int *whole) {
    const uint32_t blocks = (cells + BLOCK - 1) / BLOCK, from = first / BLOCK;
    const uint32_t most = blocks - from < RUN ? blocks : from + RUN;
    uint32_t b = from;
    for (; b < most; b++) {
        const uint32_t *reach = d->reach[b];
        const int has = reach[0] < t->to && reach[1] >= t->from;
        const int all = reach[0] >= t->from && reach[1] < t->to;
        if (b > from && (has != *some || all != *whole)) break;
        *some = has;
        *whole = all;
    }
    return b < blocks ? b * BLOCK : cells;
}

/* run by run; by kernels block by block */
static void add_sum(const dm_cell_slopes *d, const dm_cell_target *t, double *work) {
    const dm_cell_loop *l = &d->loop;
    const uint32_t cells = l->outputs ? l->sum->bodies : 0;
    double *scratch = work + (size_t)l->outputs * BLOCK;
    int some = 0, whole = 0;
    for (uint32_t first = 0, end; first < cells; first = end) {
        end = end_of_run(d, t, first, cells, &some, &whole);
        for (uint32_t k = 0; some && d->direct && k < l->outputs; k++)
            dm_cell_linear_add(l->linear + k, t, first, end - first, whole);
        for (uint32_t i = first; some && !d->direct && i < end; i += BLOCK) {
            const uint32_t count = end - i < BLOCK ? end - i : BLOCK;
            dm_cell_loop_run(l, work, BLOCK, t->x, i, count, scratch);
            add_slopes(d, t, work, i, count, whole);
        }
    }
}

void dm_cells_gradient(const dm_cells *c, double *out, const double *factor, const double *x,
                       double *work, uint32_t from, uint32_t to) {
    memset(out + from, 0, (to - from) * sizeof *out);
    for (uint32_t k = 0; k < c->sums; k++) {
        const dm_cell_slopes *d = c->sum + k;
        const double turned = d->direct ? d->turned : 1.0;
        const dm_cell_target t = {out, x, turned * factor[k], from, to};
        add_sum(d, &t, work);
    }
    for (uint32_t i = from; c->held && i < to; i++)
        if (c->held[i % c->coordinates] == DM_HELD) out[i] = 0.0;
}
