/* rounds.c - one sum as a loop over its rounds. A block of 64 rounds is evaluated at once, in 8 or
 * 4 lanes as far as whole groups go, and then added in the order of the rounds; values of sums
 * are added with compensation in eight partial sums that do not wait for each other. So the
 * size of a block and the number of partial sums are part of the bits, lanes are not. */
#include "chain/rounds.h"

#include "algebra/derive.h"
#include "code/native/jit.h"
#include "numbers/compensated.h"

#include <string.h>

/* rounds of a block; columns of a term; partial sums */
enum { BLOCK = DM_LOOP_BLOCK, COLUMNS = DM_LOOP_COLUMNS, LANES = 8 };

/* ---- making loops ---- */

/* over pairs: all shifts from one on */
static dm_status make_pairs(dm_rounds *l, const dm_node *roots, int slopes, dm_compile *compile,
                            dm_arena *arena) {
    l->pairs = dm_arena_take(arena, sizeof *l->pairs);
    if (!l->pairs) return DM_NO_MEMORY;
    const dm_status status =
        dm_pairs_open(l->pairs, l->sum, roots, l->outputs, l->column, slopes, compile, arena);
    l->one.operations = l->pairs->loop.one.operations;
    return status;
}

/* lanes only where the backend is native: its bits are the same then */
static dm_status make_loop(dm_rounds *l, const dm_node *roots, int slopes, dm_compile *compile,
                           dm_arena *arena) {
    dm_graph *term = l->sum->term;
    if (l->sum->from < l->sum->to || l->sum->within > 0.0)
        return make_pairs(l, roots, slopes, compile, arena);
    const uint32_t lanes = dm_jit_lanes();
    dm_status status = compile(&l->one, term, roots, l->outputs, arena);
    l->lanes = 0;
    if (status != DM_OK || lanes < 4 || strcmp(l->one.backend, "jit") != 0) return status;
    status = dm_jit_build_lanes(&l->many, term, roots, l->outputs, lanes, arena);
    if (status == DM_OK) l->lanes = lanes;
    return status == DM_NO_NATIVE ? DM_OK : status;
}

dm_status dm_rounds_of_value(dm_rounds *l, const dm_sum *s, dm_compile *compile, dm_arena *arena) {
    *l = (dm_rounds){.sum = s, .outputs = 1};
    return make_loop(l, &s->value, 0, compile, arena);
}

/* those that vanish have no kernel */
dm_status dm_rounds_of_slopes(dm_rounds *l, const dm_sum *s, uint32_t m, dm_compile *compile,
                              dm_arena *arena) {
    dm_node all[COLUMNS], roots[COLUMNS];
    *l = (dm_rounds){.sum = s};
    dm_gradient(s->term, s->value, 0, s->columns, all);
    for (uint32_t c = 0; c < s->columns; c++) {
        if (!all[c] || s->column[c].data || s->column[c].first >= m) continue;
        l->column[l->outputs] = (uint8_t)c;
        roots[l->outputs++] = all[c];
    }
    return l->outputs ? make_loop(l, roots, 1, compile, arena) : dm_graph_status(s->term);
}

/* ---- running them ---- */

/* what column c reads in round i */
static const double *entry_of(const dm_sum *s, const dm_column *c, const double *x, uint32_t i,
                              uint32_t shift) {
    return (c->data ? c->data : x) + dm_sum_entry(s, c, i, shift);
}

/* out[output][BLOCK] of the rounds [i, i + count), count <= BLOCK */
static void eval_one_by_one(const dm_rounds *l, double *out, const double *x, uint32_t i,
                            uint32_t count, uint32_t shift) {
    double in[COLUMNS], y[COLUMNS];
    const dm_sum *s = l->sum;
    dm_kernel_prepare(&l->one, y);
    for (uint32_t r = 0; r < count; r++) {
        for (uint32_t c = 0; c < s->columns; c++)
            in[c] = *entry_of(s, s->column + c, x, i + r, shift);
        dm_kernel_eval(&l->one, in, y);
        for (uint32_t k = 0; k < l->outputs; k++) out[k * BLOCK + r] = y[k];
    }
}

/* where the columns of a block are: entry of round r at from[r * step], or from[index[r] * step] */
typedef struct {
    const double *from;
    const uint32_t *index;
    uint32_t step;
} view;

/* 0 where a column wraps around within the block */
static int find_views(const dm_rounds *l, view *views, const double *x, uint32_t i, uint32_t count,
                      uint32_t shift) {
    const dm_sum *s = l->sum;
    for (uint32_t c = 0; c < s->columns; c++) {
        const dm_column *column = s->column + c;
        const uint32_t body = i + (column->partner ? shift : 0);
        if (column->index) {
            const double *from = (column->data ? column->data : x) + column->first;
            views[c] = (view){from, column->index + i, column->step};
            continue;
        }
        if (column->step && body < s->bodies && body + count > s->bodies) return 0;
        views[c] = (view){entry_of(s, column, x, i, shift), NULL, column->step};
    }
    return 1;
}

/* in[group][column][lane] of `count` rounds */
__attribute__((always_inline)) static inline void gather(const dm_rounds *l, double *in,
                                                         const view *views, uint32_t count,
                                                         const uint32_t lanes) {
    const uint32_t columns = l->sum->columns;
    for (uint32_t c = 0; c < columns; c++, in += lanes) {
        const view at = views[c];
        double *to = in;
        for (uint32_t r = 0; r < count; r += lanes, to += columns * lanes) {
            if (at.index) {
                for (uint32_t lane = 0; lane < lanes; lane++)
                    to[lane] = at.from[(size_t)at.index[r + lane] * at.step];
                continue;
            }
            if (at.step == 1) {
                memcpy(to, at.from + r, lanes * sizeof *in);
                continue;
            }
            for (uint32_t lane = 0; lane < lanes; lane++)
                to[lane] = at.from[(size_t)(r + lane) * at.step];
        }
    }
}

/* `lanes` is a constant where this is called: copies are then single moves. All is gathered before
 * the first call, since a load of all lanes at once has to wait for the stores of their parts */
__attribute__((always_inline)) static inline void eval_in_lanes(const dm_rounds *l, double *out,
                                                                const view *views, uint32_t count,
                                                                const uint32_t lanes) {
    _Alignas(64) double in[COLUMNS * BLOCK], y[COLUMNS * LANES];
    const double *from = in;
    gather(l, in, views, count, lanes);
    dm_kernel_prepare_lanes(&l->many, lanes, y);
    for (uint32_t r = 0; r < count; r += lanes, from += l->sum->columns * lanes) {
        dm_kernel_eval(&l->many, from, y);
        for (uint32_t k = 0; k < l->outputs; k++)
            memcpy(out + k * BLOCK + r, y + k * lanes, lanes * sizeof *y);
    }
}

static void eval_block(const dm_rounds *l, double *out, const double *x, uint32_t i, uint32_t count,
                       uint32_t shift) {
    view views[COLUMNS];
    uint32_t whole = 0; /* rounds done in lanes */
    if (l->lanes && find_views(l, views, x, i, count, shift)) {
        whole = count - count % l->lanes;
        if (l->lanes == 8)
            eval_in_lanes(l, out, views, whole, 8);
        else
            eval_in_lanes(l, out, views, whole, 4);
    }
    if (whole < count) eval_one_by_one(l, out + whole, x, i + whole, count - whole, shift);
}

/* the smaller of two */
static uint32_t smaller(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* block by block; over pairs row by row */
double dm_rounds_value(const dm_rounds *l, const double *x) {
    _Alignas(64) double y[BLOCK];
    const dm_sum *s = l->sum;
    double sum[LANES] = {0.0}, low[LANES] = {0.0}; /* they do not wait for each other */
    if (l->pairs) return dm_pairs_value(l->pairs, x);
    const uint32_t rounds = dm_sum_rounds(s, s->from);
    for (uint32_t i = 0; i < rounds; i += BLOCK) {
        const uint32_t count = smaller(BLOCK, rounds - i);
        eval_block(l, y, x, i, count, s->from);
        for (uint32_t r = 0; r < count; r++) dm_sum_add(sum + r % LANES, low + r % LANES, y[r]);
    }
    for (uint32_t k = 1; k < LANES; k++) {
        dm_sum_add(sum, low, sum[k]);
        dm_sum_add(sum, low, low[k]);
    }
    return sum[0] + low[0];
}

/* are the entries of column c neighbours in rounds [i, i + count)? */
static int is_run(const dm_sum *s, const dm_column *c, uint32_t i, uint32_t count, uint32_t shift) {
    const uint32_t body = i + (c->partner ? shift : 0);
    return !c->index && c->step == 1 && (body + count <= s->bodies || body >= s->bodies);
}

/* a whole block of neighbours: without look-ups of entries */
static void add_run(double *restrict to, double factor, const double *restrict y) {
    for (uint32_t r = 0; r < BLOCK; r++) to[r] += factor * y[r];
}

/* out[entry of column] += factor y */
static void scatter(const dm_rounds *l, double *out, double factor, const double *y, uint32_t i,
                    uint32_t count, uint32_t shift) {
    const dm_sum *s = l->sum;
    for (uint32_t k = 0; k < l->outputs; k++, y += BLOCK) {
        const dm_column *c = s->column + l->column[k];
        if (count == BLOCK && is_run(s, c, i, count, shift)) {
            add_run(out + dm_sum_entry(s, c, i, shift), factor, y);
            continue;
        }
        for (uint32_t r = 0; r < count; r++) out[dm_sum_entry(s, c, i + r, shift)] += factor * y[r];
    }
}

void dm_rounds_slopes(const dm_rounds *l, double *out, double factor, const double *x) {
    _Alignas(64) double y[COLUMNS * BLOCK];
    const dm_sum *s = l->sum;
    if (l->pairs) {
        dm_pairs_slopes(l->pairs, out, factor, x);
        return;
    }
    const uint32_t rounds = dm_sum_rounds(s, s->from);
    for (uint32_t i = 0; i < rounds; i += BLOCK) {
        const uint32_t count = smaller(BLOCK, rounds - i);
        eval_block(l, y, x, i, count, s->from);
        scatter(l, out, factor, y, i, count, s->from);
    }
}
