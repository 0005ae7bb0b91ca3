/* avi_cells.c - what a cell reads and kicks, and its slopes. Linear ones (chain/cell_linear.h) have
 * the order of their loops, others go by the kernel of one cell, whose inputs are put together
 * here. */
#include "algebra/derive.h"
#include "field/avi/avi_inside.h"

#include <string.h>

enum { OF_DATA = 0xff, OF_TIME = 0xfe }; /* a column that is no entry of q */

/* an entry of q, which a kick may move */
static int is_coordinate(const dm_column *c, uint32_t n) {
    return !c->data && c->step && c->first < n;
}

/* the place of a column among the entries that a cell reads, a new one where it has none */
static uint8_t place_of(dm_avi_sum *s, uint8_t column) {
    for (uint32_t r = 0; r < s->reads; r++)
        if (s->by[r] == column) return (uint8_t)r;
    s->by[s->reads] = column;
    return (uint8_t)s->reads++;
}

/* the output that is this root or, *minus, its opposite; a new one where there is none */
static uint8_t output_of(dm_graph *term, dm_node *roots, uint32_t *outputs, dm_node root,
                         uint8_t *minus) {
    const dm_node opposite = dm_neg(term, root);
    for (uint32_t k = 0; k < *outputs; k++) {
        *minus = roots[k] == opposite;
        if (roots[k] == root || *minus) return (uint8_t)k;
    }
    *minus = 0;
    roots[*outputs] = root;
    return (uint8_t)(*outputs)++;
}

/* the entries of all cells, and where the columns of the loop and the terms of linear outputs are
 * among them */
static dm_status lay_entries(dm_avi_sum *s, uint32_t n, dm_arena *arena) {
    const dm_cell_loop *l = &s->loop;
    for (uint32_t c = 0; c < l->columns; c++) {
        const dm_column *column = s->sum->column + l->column[c];
        s->place[c] = column->data               ? OF_DATA
                      : is_coordinate(column, n) ? place_of(s, l->column[c])
                                                 : OF_TIME;
    }
    for (uint32_t o = 0; l->linear && o < l->outputs; o++)
        for (uint32_t t = 0; t < l->linear[o].terms; t++) {
            const dm_linear_term *term = l->linear[o].term + t;
            for (uint32_t r = 0; r < s->reads; r++) {
                const dm_column *c = s->sum->column + s->by[r];
                if (c->index == term->index && c->first == term->first && c->step == term->step)
                    s->term[o][t] = (uint8_t)r;
            }
        }
    s->entry = dm_arena_take(arena, ((size_t)s->sum->bodies * s->reads + 1) * sizeof *s->entry);
    if (!s->entry) return DM_NO_MEMORY;
    uint32_t *to = s->entry;
    for (uint32_t i = 0; i < s->sum->bodies; i++)
        for (uint32_t r = 0; r < s->reads; r++)
            *to++ = (uint32_t)dm_sum_entry(s->sum, s->sum->column + s->by[r], i, 0);
    return DM_OK;
}

dm_status dm_avi_sum_open(dm_avi_sum *s, const dm_sum *sum, uint32_t n, dm_compile *compile,
                          dm_arena *arena) {
    dm_node slope[DM_SUM_COLUMNS], roots[DM_SUM_COLUMNS];
    uint32_t outputs = 0;
    dm_gradient(sum->term, sum->value, 0, sum->columns, slope);
    *s = (dm_avi_sum){.sum = sum};
    for (uint32_t c = 0; c < sum->columns; c++) {
        if (!slope[c] || !is_coordinate(sum->column + c, n)) continue;
        dm_avi_kick *k = s->kick + s->kicks++;
        k->entry = place_of(s, (uint8_t)c);
        k->output = output_of(sum->term, roots, &outputs, slope[c], &k->minus);
    }
    if (!outputs) return dm_graph_status(sum->term);
    dm_status status = dm_cell_loop_make(&s->loop, sum, roots, outputs, compile, arena);
    if (status != DM_OK) return status;
    s->in = dm_arena_take(arena, (s->loop.columns + 1) * sizeof *s->in);
    s->y = dm_arena_take(arena, outputs * sizeof *s->y);
    s->term = dm_arena_take(arena, outputs * sizeof *s->term);
    if (!s->in || !s->y || !s->term) return DM_NO_MEMORY;
    if (!s->loop.linear) dm_kernel_prepare(&s->loop.one, s->y);
    return lay_entries(s, n, arena);
}

/* one linear output, in the order of dm_cell_linear_run */
static double linear_slope(const dm_avi *a, const dm_cell_linear *l, const uint8_t *term,
                           const uint32_t *entry, uint32_t i) {
    double sum = a->at[entry[term[0]]].x;
    for (uint32_t t = 1; t < l->terms; t++) sum += l->term[t].sign * a->at[entry[term[t]]].x;
    return l->weight ? (sum * l->weight[i]) * l->scale : sum * l->scale;
}

void dm_avi_slopes(const dm_avi *a, const dm_avi_sum *s, uint32_t i, double t) {
    const dm_cell_loop *l = &s->loop;
    const uint32_t *entry = s->entry + (size_t)i * s->reads;
    for (uint32_t o = 0; l->linear && o < l->outputs; o++)
        s->y[o] = linear_slope(a, l->linear + o, s->term[o], entry, i);
    if (l->linear) return;
    for (uint32_t c = 0; c < l->columns; c++) {
        const dm_column *column = s->sum->column + l->column[c];
        s->in[c] = s->place[c] == OF_DATA   ? column->data[dm_sum_entry(s->sum, column, i, 0)]
                   : s->place[c] == OF_TIME ? t
                                            : a->at[entry[s->place[c]]].x;
    }
    dm_kernel_eval(&l->one, s->in, s->y);
}
