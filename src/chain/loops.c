/* loops.c - sums as loops over their rounds. A block of 64 rounds is evaluated at once, in 8 or
 * 4 lanes as far as whole groups go, and then added in the order of the rounds; values of sums
 * are added with compensation in eight partial sums that do not wait for each other. So the
 * size of a block and the number of partial sums are part of the bits, lanes are not.
 *
 * Long because values, gradients and the kernels that join them share one record. */
#include "chain/loops.h"

#include "algebra/derive.h"
#include "chain/cells.h"
#include "code/native/jit.h"
#include "graph/analyse.h"
#include "numbers/compensated.h"

#include <string.h>

/* rounds of a block; columns of a term; partial sums */
enum { BLOCK = DM_LOOP_BLOCK, COLUMNS = DM_LOOP_COLUMNS, LANES = 8 };

/* the kernel of a term or of its derivatives, one round or `lanes` rounds at a time */
typedef struct {
    const dm_sum *sum;
    dm_kernel one, many;
    uint32_t lanes; /* 0: one by one */
    uint32_t outputs;
    uint8_t column[COLUMNS]; /* [outputs] what is differentiated for */
} loop;

/* ---- making loops ---- */

/* lanes only where the backend is native: its bits are the same then */
static dm_status make_loop(loop *l, const dm_node *roots, dm_compile *compile, dm_arena *arena) {
    dm_graph *term = l->sum->term;
    const uint32_t lanes = dm_jit_lanes();
    dm_status status = compile(&l->one, term, roots, l->outputs, arena);
    l->lanes = 0;
    if (status != DM_OK || lanes < 4 || strcmp(l->one.backend, "jit") != 0) return status;
    status = dm_jit_build_lanes(&l->many, term, roots, l->outputs, lanes, arena);
    if (status == DM_OK) l->lanes = lanes;
    return status == DM_NO_NATIVE ? DM_OK : status;
}

/* the kernel of the term itself */
static dm_status make_value_loop(loop *l, const dm_sum *s, dm_compile *compile, dm_arena *arena) {
    *l = (loop){.sum = s, .outputs = 1};
    return make_loop(l, &s->value, compile, arena);
}

/* the derivatives for columns that are inputs below m, and do not vanish */
static dm_status make_slope_loop(loop *l, const dm_sum *s, uint32_t m, dm_compile *compile,
                                 dm_arena *arena) {
    dm_node all[COLUMNS], roots[COLUMNS];
    *l = (loop){.sum = s};
    dm_gradient(s->term, s->value, 0, s->columns, all);
    for (uint32_t c = 0; c < s->columns; c++) {
        if (!all[c] || s->column[c].data || s->column[c].first >= m) continue;
        l->column[l->outputs] = (uint8_t)c;
        roots[l->outputs++] = all[c];
    }
    return l->outputs ? make_loop(l, roots, compile, arena) : dm_graph_status(s->term);
}

/* ---- running them ---- */

/* what column c reads in round i */
static const double *entry_of(const dm_sum *s, const dm_column *c, const double *x, uint32_t i,
                              uint32_t shift) {
    return (c->data ? c->data : x) + dm_sum_entry(s, c, i, shift);
}

/* out[output][BLOCK] of the rounds [i, i + count), count <= BLOCK */
static void eval_one_by_one(const loop *l, double *out, const double *x, uint32_t i, uint32_t count,
                            uint32_t shift) {
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
static int find_views(const loop *l, view *views, const double *x, uint32_t i, uint32_t count,
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
__attribute__((always_inline)) static inline void gather(const loop *l, double *in,
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
__attribute__((always_inline)) static inline void eval_in_lanes(const loop *l, double *out,
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

static void eval_block(const loop *l, double *out, const double *x, uint32_t i, uint32_t count,
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

/* sum over shifts and rounds, block by block */
static double sum_value(const loop *l, const double *x) {
    _Alignas(64) double y[BLOCK];
    const dm_sum *s = l->sum;
    double sum[LANES] = {0.0}, low[LANES] = {0.0}; /* they do not wait for each other */
    for (uint32_t shift = s->from; shift <= s->to; shift++) {
        const uint32_t rounds = dm_sum_rounds(s, shift);
        for (uint32_t i = 0; i < rounds; i += BLOCK) {
            const uint32_t count = smaller(BLOCK, rounds - i);
            eval_block(l, y, x, i, count, shift);
            for (uint32_t r = 0; r < count; r++) dm_sum_add(sum + r % LANES, low + r % LANES, y[r]);
        }
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
static void scatter(const loop *l, double *out, double factor, const double *y, uint32_t i,
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

/* out += factor dS/dx */
static void add_slopes(const loop *l, double *out, double factor, const double *x) {
    _Alignas(64) double y[COLUMNS * BLOCK];
    const dm_sum *s = l->sum;
    for (uint32_t shift = s->from; shift <= s->to; shift++) {
        const uint32_t rounds = dm_sum_rounds(s, shift);
        for (uint32_t i = 0; i < rounds; i += BLOCK) {
            const uint32_t count = smaller(BLOCK, rounds - i);
            eval_block(l, y, x, i, count, shift);
            scatter(l, out, factor, y, i, count, shift);
        }
    }
}

/* ---- whole kernels ---- */

/* what an expression with sums needs: the graph's part takes x, then the sums */
typedef struct {
    dm_kernel outer;
    double *x; /* [inputs of the graph]: x and the values of the sums */
    double *y; /* [outputs of `outer`]: what does not vanish, then the factors */
    uint32_t inputs, values, slopes, m, direct;
    loop *value;       /* [values] sums that the outer kernel reads */
    loop *slope;       /* [slopes] */
    uint32_t *at;      /* [direct] number of the output */
    dm_cells *cells;   /* slopes of sums over cells, behind the others, or NULL */
    double *cell_work; /* their scratch, then the slopes */
} whole;

/* values of sums first, then the straight-line kernel */
static void eval_outer(const whole *w, const double *x, double *y) {
    memcpy(w->x, x, w->inputs * sizeof *x);
    for (uint32_t k = 0; k < w->values; k++)
        w->x[w->value[k].sum->input] = sum_value(w->value + k, x);
    dm_kernel_eval(&w->outer, w->x, y);
}

/* one output */
static void eval_value(const void *pool, const double *x, double *out) {
    eval_outer(pool, x, out);
}

/* sums over cells, entry by entry */
static void add_cells(const whole *w, double *out, const double *x) {
    double *slope = w->cell_work + w->cells->work;
    dm_cells_slopes(w->cells, slope, w->y + w->direct + w->slopes, x, w->cell_work, 0, 1);
    for (uint32_t i = 0; i < w->m; i++) out[i] += dm_cells_entry(w->cells, slope, i);
}

/* direct derivatives, then those by way of the sums */
static void eval_gradient(const void *pool, const double *x, double *out) {
    const whole *w = pool;
    if (w->outer.eval) eval_outer(w, x, w->y);
    memset(out, 0, w->m * sizeof *out);
    for (uint32_t k = 0; k < w->direct; k++) out[w->at[k]] = w->y[k];
    for (uint32_t k = 0; k < w->slopes; k++) add_slopes(w->slope + k, out, w->y[w->direct + k], x);
    if (w->cells) add_cells(w, out, x);
}

/* of the graph */
static uint32_t count_sums(const dm_graph *g) {
    uint32_t count = 0;
    for (const dm_sum *s = dm_sums(g); s; s = s->next) count++;
    return count;
}

/* with room for everything, NULL without memory */
static whole *new_whole(dm_graph *g, uint32_t m, uint32_t outputs, dm_arena *arena) {
    const uint32_t sums = count_sums(g), inputs = dm_graph_inputs(g);
    whole *w = dm_arena_take(arena, sizeof *w);
    if (!w) return NULL;
    *w = (whole){.inputs = dm_sum_first(g), .m = m};
    w->x = dm_arena_take(arena, inputs * sizeof *w->x);
    w->y = dm_arena_take(arena, (outputs + 1) * sizeof *w->y);
    w->at = dm_arena_take(arena, (outputs + 1) * sizeof *w->at);
    w->value = dm_arena_take(arena, (sums + 1) * sizeof *w->value);
    w->slope = dm_arena_take(arena, (sums + 1) * sizeof *w->slope);
    if (!w->x || !w->y || !w->at || !w->value || !w->slope) return NULL;
    memset(w->x, 0, inputs * sizeof *w->x);
    return w;
}

/* the kernel of roots[m] and the loops of the sums that they depend on */
static dm_status make_outer(whole *w, dm_graph *g, const dm_node *roots, uint32_t m,
                            dm_compile *compile, dm_arena *arena) {
    dm_status status = DM_OK;
    for (const dm_sum *s = dm_sums(g); s && status == DM_OK; s = s->next)
        if (dm_depends(g, roots, m, s->input, 1))
            status = make_value_loop(w->value + w->values++, s, compile, arena);
    w->outer.backend = "tape";
    return status == DM_OK && m ? compile(&w->outer, g, roots, m, arena) : status;
}

/* operations of one evaluation, saturated */
static uint32_t operations(const whole *w) {
    double count = w->outer.operations;
    for (uint32_t k = 0; k < w->values; k++)
        count += dm_sum_all_rounds(w->value[k].sum) * (w->value[k].one.operations + 1.0);
    for (uint32_t k = 0; k < w->slopes; k++)
        count += dm_sum_all_rounds(w->slope[k].sum) *
                 (w->slope[k].one.operations + 2.0 * w->slope[k].outputs);
    return count < UINT32_MAX ? (uint32_t)count : UINT32_MAX;
}

dm_status dm_loops_value(dm_kernel *out, dm_graph *g, dm_node root, dm_compile *compile,
                         dm_arena *arena) {
    whole *w = new_whole(g, 1, 1, arena);
    if (!w) return DM_NO_MEMORY;
    const dm_status status = make_outer(w, g, &root, 1, compile, arena);
    if (status != DM_OK) return status;
    *out = w->outer;
    out->eval = eval_value;
    out->pool = w;
    out->inputs = w->inputs;
    out->operations = operations(w);
    return DM_OK;
}

const dm_kernel *dm_loops_outer(const dm_kernel *value, const double **x) {
    const whole *w = value->pool;
    *x = w->x;
    return &w->outer;
}

/* loops of the sums that f depends on; their factors df/dS behind the direct parts in roots */
static dm_status make_slopes(whole *w, dm_graph *g, dm_node root, dm_node *roots,
                             dm_compile *compile, dm_arena *arena) {
    dm_status status = DM_OK;
    for (const dm_sum *s = dm_sums(g); s && status == DM_OK; s = s->next) {
        dm_node factor;
        dm_gradient(g, root, s->input, 1, &factor);
        if (!factor || s->cells) continue;
        status = make_slope_loop(w->slope + w->slopes, s, w->m, compile, arena);
        if (w->slope[w->slopes].outputs) roots[w->direct + w->slopes++] = factor;
    }
    return status;
}

/* the same for sums over cells, all together; their factors come last */
static dm_status make_cells(whole *w, dm_graph *g, dm_node root, dm_node *roots, uint32_t *factors,
                            dm_compile *compile, dm_arena *arena) {
    const dm_sum **sums = dm_cells_sums(g, root, roots + w->direct + w->slopes, factors, arena);
    if (sums && !*factors) return DM_OK;
    w->cells = sums ? dm_arena_take(arena, sizeof *w->cells) : NULL;
    if (!w->cells) return DM_NO_MEMORY;
    const dm_status status = dm_cells_open(w->cells, sums, *factors, w->m, compile, arena);
    const size_t room = w->cells->work + w->cells->slots + 1;
    w->cell_work = status == DM_OK ? dm_arena_take(arena, room * sizeof *w->cell_work) : NULL;
    return status == DM_OK && !w->cell_work ? DM_NO_MEMORY : status;
}

/* constants need no kernel at run time */
static void drop_constant_outer(whole *w, uint32_t m) {
    uint32_t fixed = 0;
    dm_kernel_prepare(&w->outer, w->y);
    for (uint32_t i = 0; i < m; i++) fixed += w->outer.fixed && w->outer.fixed[i];
    if (fixed == m) w->outer.eval = NULL;
}

dm_status dm_loops_gradient(dm_kernel *out, dm_graph *g, dm_node root, const dm_node *nodes,
                            uint32_t m, dm_compile *compile, dm_arena *arena) {
    const uint32_t most = m + count_sums(g);
    whole *w = new_whole(g, m, most, arena);
    dm_node *roots = dm_arena_take(arena, (most + 1) * sizeof *roots);
    if (!w || !roots) return DM_NO_MEMORY;
    for (uint32_t i = 0; i < m; i++) {
        if (!nodes[i]) continue;
        w->at[w->direct] = i;
        roots[w->direct++] = nodes[i];
    }
    uint32_t factors = 0;
    dm_status status = make_slopes(w, g, root, roots, compile, arena);
    if (status == DM_OK) status = make_cells(w, g, root, roots, &factors, compile, arena);
    const uint32_t roots_count = w->direct + w->slopes + factors;
    if (status == DM_OK) status = make_outer(w, g, roots, roots_count, compile, arena);
    if (status != DM_OK) return status;
    drop_constant_outer(w, roots_count);
    *out = (dm_kernel){.eval = eval_gradient,
                       .pool = w,
                       .inputs = w->inputs,
                       .outputs = m,
                       .operations = operations(w),
                       .backend = w->outer.backend};
    return DM_OK;
}

const dm_cells *dm_loops_cells(const dm_kernel *gradient) {
    if (gradient->eval != eval_gradient) return NULL;
    const whole *w = gradient->pool;
    return w->direct || w->slopes ? NULL : w->cells;
}

const double *dm_loops_factors(const dm_kernel *gradient, const double *x) {
    const whole *w = gradient->pool;
    if (w->outer.eval) eval_outer(w, x, w->y);
    return w->y;
}
