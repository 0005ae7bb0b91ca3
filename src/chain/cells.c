/* cells.c - the loops of a sum over cells, and which slopes an entry of the gradient adds up. */
#include "chain/cells.h"

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

dm_status dm_cell_loop_make(dm_cell_loop *l, const dm_sum *s, const dm_node *roots,
                            uint32_t outputs, dm_compile *compile, dm_arena *arena) {
    const uint32_t lanes = dm_jit_lanes();
    *l = (dm_cell_loop){.sum = s, .outputs = outputs};
    dm_node *own = dm_arena_take(arena, (outputs + 1) * sizeof *own);
    if (!own) return DM_NO_MEMORY;
    dm_graph *g = cut_down(l, roots, own, arena);
    if (!g) return DM_NO_MEMORY;
    dm_status status = dm_graph_status(g);
    if (status == DM_OK) status = compile(&l->one, g, own, outputs, arena);
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
    size_t slot; /* of cell 0 */
    uint32_t cells;
    int minus;
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

/* loop and shares of one sum; share: room for its columns */
static dm_status open_sum(dm_cells *c, const dm_sum *s, share *shares, uint32_t *count,
                          dm_compile *compile, dm_arena *arena) {
    dm_node slope[DM_SUM_COLUMNS], roots[DM_SUM_COLUMNS];
    uint32_t outputs = 0;
    dm_gradient(s->term, s->value, 0, s->columns, slope);
    for (uint32_t k = 0; k < s->columns; k++) {
        const dm_column *column = s->column + k;
        if (!slope[k] || column->data || column->first >= c->m) continue;
        share *to = shares + (*count)++;
        const uint32_t output = find_output(s->term, roots, &outputs, slope[k], &to->minus);
        to->of = s;
        to->column = column;
        to->slot = c->slots + (size_t)output * s->bodies;
        to->cells = s->bodies;
        to->held = s->held;
        to->coordinates = s->coordinates;
    }
    if (dm_graph_status(s->term) != DM_OK) return dm_graph_status(s->term);
    c->slot[c->loops] = c->slots;
    c->slots += (size_t)outputs * s->bodies;
    if (!outputs) c->loop[c->loops++] = (dm_cell_loop){.sum = s};
    if (!outputs) return DM_OK;
    dm_cell_loop *l = c->loop + c->loops++;
    const dm_status status = dm_cell_loop_make(l, s, roots, outputs, compile, arena);
    const size_t work = dm_cell_loop_work(l);
    if (work > c->work) c->work = work;
    c->shared &= l->one.backend && strcmp(l->one.backend, "jit") == 0;
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
                        (uint32_t)(2 * (shares[j].slot + i)) + (uint32_t)shares[j].minus;
                else
                    c->start[entry + 2]++;
            }
    }
}

/* lists by counting: while they are filled start[i + 1] is the next place of entry i */
static dm_status make_lists(dm_cells *c, const share *shares, uint32_t count, dm_arena *arena) {
    size_t all = 0;
    for (uint32_t k = 0; k < count; k++) all += shares[k].cells;
    if (all > UINT32_MAX || c->slots > INT32_MAX) return DM_TOO_LARGE;
    c->start = dm_arena_take(arena, ((size_t)c->m + 2) * sizeof *c->start);
    c->list = dm_arena_take(arena, (all + 1) * sizeof *c->list);
    if (!c->start || !c->list) return DM_NO_MEMORY;
    memset(c->start, 0, ((size_t)c->m + 2) * sizeof *c->start);
    pass(c, shares, count, NULL);
    for (uint32_t i = 1; i <= c->m; i++) c->start[i + 1] += c->start[i];
    pass(c, shares, count, c->list);
    return DM_OK;
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
    if (!share_of || !c->loop || !c->slot) return DM_NO_MEMORY;
    for (uint32_t k = 0; k < count; k++) {
        const dm_status status = open_sum(c, sums[k], share_of, &shares, compile, arena);
        if (status != DM_OK) return status;
    }
    return make_lists(c, share_of, shares, arena);
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
        double *out = slope + c->slot[k] + from;
        dm_cell_loop_run(l, out, cells, x, from, to - from, work);
        if (factor[k] == 1.0) continue;
        for (uint32_t j = 0; j < l->outputs; j++)
            for (uint32_t i = 0; i < to - from; i++) out[(size_t)j * cells + i] *= factor[k];
    }
}

/* ---- entries ---- */

/* entries with `terms` each, a constant where this is called */
__attribute__((always_inline)) static inline uint32_t alike(double *restrict out,
                                                            const double *restrict slope,
                                                            const uint32_t *restrict list,
                                                            uint32_t count, const uint32_t terms) {
    for (uint32_t i = 0; i < count; i++, list += terms) {
        double sum = 0.0;
        for (uint32_t k = 0; k < terms; k++) sum += dm_cells_term(slope, list[k]);
        out[i] = sum;
    }
    return count;
}

/* how many entries from i on, below end, have as many terms as entry i */
static uint32_t count_alike(const uint32_t *start, uint32_t i, uint32_t end) {
    const uint32_t terms = start[i + 1] - start[i];
    uint32_t count = 1;
    while (i + count < end && start[i + count + 1] - start[i + count] == terms) count++;
    return count;
}

/* runs of entries with two terms (edges of a surface) or six (vertices), which nearly all have */
void dm_cells_entries(const dm_cells *c, double *out, const double *slope, uint32_t first,
                      uint32_t count) {
    const uint32_t *start = c->start, end = first + count;
    for (uint32_t i = first, now; i < end; i += now, out += now) {
        const uint32_t terms = start[i + 1] - start[i], *list = c->list + start[i];
        now = count_alike(start, i, end);
        if (terms == 2)
            alike(out, slope, list, now, 2);
        else if (terms == 6)
            alike(out, slope, list, now, 6);
        else
            alike(out, slope, list, now, terms);
    }
}
