/* cells.c - the loops of a sum over cells, and which slopes an entry of the gradient adds up. */
#include "chain/cells.h"

#include "algebra/compact.h"
#include "algebra/derive.h"
#include "code/native/jit.h"
#include "graph/analyse.h"

#include <string.h>

enum { BLOCK = DM_CELL_BLOCK, WIDEST = 8 };

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

/* a column of entries of x that is differentiated for, and where its slopes are */
typedef struct {
    const dm_sum *of;
    const dm_column *column;
    uint32_t output, cells;
    int minus;
    size_t slot; /* of cell 0, and from cell to cell */
    uint8_t width;
    const uint8_t *held;
    uint32_t coordinates;
} share;

/* the output that is this root or, *minus, its opposite; a new one where there is none */
static uint32_t find_output(dm_graph *term, dm_node *roots, uint32_t *outputs, dm_node root,
                            int *minus) {
    const dm_node opposite = dm_neg(term, root);
    for (uint32_t k = 0; k < *outputs; k++) {
        *minus = roots[k] == opposite;
        if (roots[k] == root || *minus) return k;
    }
    *minus = 0;
    roots[*outputs] = root;
    return (*outputs)++;
}

/* where the slopes of the next loop stand */
static void place_slopes(dm_cells *c, share *shares, uint32_t count, uint32_t outputs) {
    const size_t cells = count ? shares->cells : 0;
    uint8_t width = 1;
    for (uint32_t k = 0; k < count; k++)
        if (shares[k].minus) width = 2;
    for (uint32_t k = 0; k < count; k++) {
        shares[k].width = width;
        shares[k].slot = c->slots + width * (shares[k].output * cells) + (size_t)shares[k].minus;
    }
    c->slot[c->loops] = c->slots;
    c->width[c->loops] = width;
    c->slots += width * outputs * cells;
}

/* loop and shares of one sum; share: room for its columns */
static dm_status open_sum(dm_cells *c, const dm_sum *s, share *shares, uint32_t *count,
                          dm_compile *compile, dm_arena *arena) {
    dm_node slope[DM_SUM_COLUMNS], roots[DM_SUM_COLUMNS];
    const uint32_t first = *count;
    uint32_t outputs = 0;
    dm_gradient(s->term, s->value, 0, s->columns, slope);
    for (uint32_t k = 0; k < s->columns; k++) {
        const dm_column *column = s->column + k;
        if (!slope[k] || column->data || column->first >= c->m) continue;
        share *to = shares + (*count)++;
        to->output = find_output(s->term, roots, &outputs, slope[k], &to->minus);
        to->of = s;
        to->column = column;
        to->cells = s->bodies;
        to->held = s->held;
        to->coordinates = s->coordinates;
    }
    if (dm_graph_status(s->term) != DM_OK) return dm_graph_status(s->term);
    place_slopes(c, shares + first, *count - first, outputs);
    if (!outputs) c->loop[c->loops++] = (dm_cell_loop){.sum = s};
    if (!outputs) return DM_OK;
    dm_cell_loop *l = c->loop + c->loops++;
    const dm_status status = dm_cell_loop_make(l, s, roots, outputs, compile, arena);
    const size_t work = dm_cell_loop_work(l) + (size_t)outputs * BLOCK;
    if (work > c->work) c->work = work;
    c->shared &= l->linear || (l->one.backend && strcmp(l->one.backend, "jit") == 0);
    return status;
}

/* the entry that cell i has in a share; UINT32_MAX: it is held */
static uint32_t entry_of(const share *s, uint32_t i) {
    const dm_column *c = s->column;
    const size_t body = c->index ? c->index[i] : i, entry = c->first + c->step * body;
    if (s->held && s->held[entry % s->coordinates] == DM_HELD) return UINT32_MAX;
    return (uint32_t)entry;
}

/* the shares of the sum of share k end here */
static uint32_t end_of_sum(const share *shares, uint32_t count, uint32_t k) {
    uint32_t end = k + 1;
    while (end < count && shares[end].of == shares[k].of) end++;
    return end;
}

/* one pass over all shares, sum by sum, cell by cell: counts (list NULL), or lists */
static void pass(dm_cells *c, const share *shares, uint32_t count, uint32_t *list) {
    for (uint32_t k = 0, end; k < count; k = end) {
        end = end_of_sum(shares, count, k);
        for (uint32_t i = 0; i < shares[k].cells; i++)
            for (uint32_t j = k; j < end; j++) {
                const uint32_t entry = entry_of(shares + j, i);
                if (entry == UINT32_MAX) continue;
                if (list)
                    list[c->start[entry + 1]++] =
                        (uint32_t)(shares[j].slot + (size_t)shares[j].width * i);
                else
                    c->start[entry + 2]++;
            }
    }
}

/* in nearly all blocks edges of a surface have two terms each, vertices six */
static dm_status find_alike(dm_cells *c, dm_arena *arena) {
    c->alike = dm_arena_take(arena, c->m / BLOCK + 1);
    if (!c->alike) return DM_NO_MEMORY;
    for (uint32_t i = 0; i <= c->m / BLOCK; i++) c->alike[i] = 0;
    for (uint32_t first = 0; first < c->m; first += BLOCK) {
        const uint32_t *start = c->start + first, terms = start[1] - start[0];
        const uint32_t count = c->m - first < BLOCK ? c->m - first : BLOCK;
        uint32_t i = 1;
        while (i < count && start[i + 1] - start[i] == terms) i++;
        if (i == count && terms < UINT8_MAX) c->alike[first / BLOCK] = (uint8_t)terms;
    }
    return DM_OK;
}

/* lists by counting: while they are filled start[i + 1] is the next place of entry i */
static dm_status make_lists(dm_cells *c, const share *shares, uint32_t count, dm_arena *arena) {
    size_t all = 0;
    for (uint32_t k = 0; k < count; k++) all += shares[k].cells;
    if (all > UINT32_MAX || c->slots > UINT32_MAX) return DM_TOO_LARGE;
    c->start = dm_arena_take(arena, ((size_t)c->m + 2) * sizeof *c->start);
    c->list = dm_arena_take(arena, (all + 1) * sizeof *c->list);
    if (!c->start || !c->list) return DM_NO_MEMORY;
    memset(c->start, 0, ((size_t)c->m + 2) * sizeof *c->start);
    pass(c, shares, count, NULL);
    for (uint32_t i = 1; i <= c->m; i++) c->start[i + 1] += c->start[i];
    pass(c, shares, count, c->list);
    return find_alike(c, arena);
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
    uint32_t columns = 0, shares = 0;
    *c = (dm_cells){.m = m, .shared = 1};
    for (uint32_t k = 0; k < count; k++) columns += sums[k]->columns;
    share *share_of = dm_arena_take(arena, (columns + 1) * sizeof *share_of);
    c->loop = dm_arena_take(arena, (count + 1) * sizeof *c->loop);
    c->slot = dm_arena_take(arena, (count + 1) * sizeof *c->slot);
    c->width = dm_arena_take(arena, (count + 1) * sizeof *c->width);
    if (!share_of || !c->loop || !c->slot || !c->width) return DM_NO_MEMORY;
    for (uint32_t k = 0; k < count; k++) {
        const dm_status status = open_sum(c, sums[k], share_of, &shares, compile, arena);
        if (status != DM_OK) return status;
    }
    return make_lists(c, share_of, shares, arena);
}

/* slopes by kernels, from a block of them to their places, times the factor */
static void run_kernels(const dm_cells *c, uint32_t loop, double *slope, double factor,
                        const double *x, uint32_t from, uint32_t to, double *work) {
    const dm_cell_loop *l = c->loop + loop;
    const uint32_t cells = l->sum->bodies, width = c->width[loop];
    double *block = work, *scratch = work + (size_t)l->outputs * BLOCK;
    for (uint32_t first = from; first < to; first += BLOCK) {
        const uint32_t count = to - first < BLOCK ? to - first : BLOCK;
        dm_cell_loop_run(l, block, BLOCK, x, first, count, scratch);
        for (uint32_t k = 0; k < l->outputs; k++) {
            double *out = slope + c->slot[loop] + width * ((size_t)k * cells + first);
            const double *y = block + (size_t)k * BLOCK;
            for (uint32_t i = 0; width == 1 && i < count; i++) out[i] = factor * y[i];
            for (uint32_t i = 0; width == 2 && i < count; i++) {
                out[2 * i] = factor * y[i];
                out[2 * i + 1] = -(factor * y[i]);
            }
        }
    }
}

/* whole blocks, so that a part has the bits of the whole */
void dm_cells_slopes(const dm_cells *c, double *slope, const double *factor, const double *x,
                     double *work, uint32_t part, uint32_t parts) {
    for (uint32_t k = 0; k < c->loops; k++) {
        const dm_cell_loop *l = c->loop + k;
        if (!l->outputs) continue;
        const uint32_t cells = l->sum->bodies, blocks = (cells + BLOCK - 1) / BLOCK;
        const uint32_t from = (uint32_t)((uint64_t)blocks * part / parts) * BLOCK;
        uint32_t to = (uint32_t)((uint64_t)blocks * (part + 1) / parts) * BLOCK;
        if (to > cells) to = cells;
        if (from >= to) continue;
        if (!l->linear) run_kernels(c, k, slope, factor[k], x, from, to, work);
        for (uint32_t j = 0; l->linear && j < l->outputs; j++)
            dm_cell_linear_run(l->linear + j,
                               slope + c->slot[k] + c->width[k] * ((size_t)j * cells + from),
                               c->width[k], x, from, to - from, factor[k]);
    }
}
