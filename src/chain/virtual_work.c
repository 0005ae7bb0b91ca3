/* virtual_work.c - the loops of the forces, block by block. */
#include "chain/virtual_work.h"

#include "algebra/derive.h"
#include "graph/analyse.h"

#include <string.h>

enum { BLOCK = DM_CELL_BLOCK };

/* ---- making the loops ---- */

/* no value, rate or time is in a root */
static int depends_on_data(const dm_sum *s, dm_node root) {
    for (uint32_t c = 0; c < s->columns; c++)
        if (!s->column[c].data && dm_depends(s->term, &root, 1, c, 1)) return 0;
    return 1;
}

/* the derivatives of one force by the values and rates of its cell, behind the other outputs */
static dm_status add_slopes(dm_work *w, dm_work_sum *k, dm_node force, uint32_t first,
                            dm_node *roots, uint32_t *outputs) {
    dm_graph *term = k->sum->term;
    dm_node row[DM_SUM_COLUMNS];
    dm_gradient(term, force, 0, k->sum->columns, row);
    for (uint32_t c = 0; c < k->sum->columns; c++) {
        const dm_column *column = k->sum->column + c;
        if (!row[c] || column->data || column->varied || column->first >= 2 * w->n || !column->step)
            continue;
        const int is_rate = column->first >= w->n;
        k->output[*outputs] = (dm_work_output){first, column->first % w->n % w->values,
                                               is_rate ? DM_WORK_BY_V : DM_WORK_BY_Q};
        roots[(*outputs)++] = row[c];
        *(is_rate ? &w->reads_v : &w->reads_q) = 1;
        w->constant &= depends_on_data(k->sum, row[c]);
    }
    return dm_graph_status(term);
}

/* Forces are the derivatives of the work by the displacements; behind them come their own by the
 * values and rates of the cell, which Newton's methods ask for. */
static dm_status open_sum(dm_work *w, dm_work_sum *k, dm_compile *compile, dm_arena *arena) {
    const dm_sum *s = k->sum;
    /* a force of every column, and its derivatives by all others, at most */
    const uint32_t most = s->columns * (s->columns + 1);
    dm_node slope[DM_SUM_COLUMNS];
    uint32_t forces = 0, outputs;
    dm_node *roots = dm_arena_take(arena, (most + 1) * sizeof *roots);
    k->output = dm_arena_take(arena, (most + 1) * sizeof *k->output);
    if (!roots || !k->output) return DM_NO_MEMORY;
    dm_gradient(s->term, s->value, 0, s->columns, slope);
    for (uint32_t c = 0; c < s->columns; c++) {
        if (!s->column[c].varied || !slope[c]) continue;
        w->values = s->column[c].step;
        k->cell = s->column[c].index;
        k->output[forces] = (dm_work_output){s->column[c].first, 0, DM_WORK_FORCE};
        roots[forces++] = slope[c];
    }
    outputs = forces;
    dm_status status = dm_graph_status(s->term);
    for (uint32_t a = 0; a < forces && status == DM_OK; a++)
        status = add_slopes(w, k, roots[a], k->output[a].first, roots, &outputs);
    if (status == DM_OK && forces)
        status = dm_cell_loop_make(&k->force, s, roots, forces, compile, arena);
    if (status == DM_OK && forces)
        status = dm_cell_loop_make(&k->slopes, s, roots, outputs, compile, arena);
    return status;
}

/* Blocks of outputs, then what the loops want. */
static size_t room_of(const dm_work_sum *k) {
    const size_t a = dm_cell_loop_work(&k->force), b = dm_cell_loop_work(&k->slopes);
    return (size_t)k->slopes.outputs * BLOCK + (a > b ? a : b);
}

dm_status dm_work_open(dm_work *w, const dm_graph *g, uint32_t n, dm_compile *compile,
                       dm_arena *arena) {
    uint32_t most = 0;
    for (const dm_sum *s = dm_sums(g); s; s = s->next) most += s->work != 0;
    *w = (dm_work){.n = n, .values = 1, .shared = 1, .constant = 1};
    w->sum = dm_arena_take(arena, (most + 1) * sizeof *w->sum);
    if (!w->sum) return DM_NO_MEMORY;
    for (const dm_sum *s = dm_sums(g); s; s = s->next) {
        if (!s->work) continue;
        dm_work_sum *k = w->sum + w->sums;
        *k = (dm_work_sum){.sum = s};
        const dm_status status = open_sum(w, k, compile, arena);
        if (status != DM_OK) return status;
        if (!k->force.outputs) continue;
        const size_t room = room_of(k);
        if (room > w->room) w->room = room;
        w->shared &= k->force.one.backend && strcmp(k->force.one.backend, "jit") == 0;
        w->sums++;
    }
    return DM_OK;
}

/* ---- running them ---- */

/* the first body of a sum whose cell is `cell` or a later one */
static uint32_t first_body(const dm_work_sum *k, uint32_t cell) {
    uint32_t low = 0, high = k->sum->bodies;
    if (!k->cell) return cell < high ? cell : high;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (k->cell[middle] < cell)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* what one output of `count` bodies from `body` on belongs to */
static void add_output(const dm_work *w, const dm_work_sum *k, const dm_work_output *o, double *to,
                       uint32_t first, const double *y, uint32_t body, uint32_t count) {
    const uint8_t *held = k->sum->held;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t cell = k->cell ? k->cell[body + i] : body + i;
        const uint32_t entry = o->first + w->values * cell;
        if (held && held[entry]) continue;
        const size_t row = entry - first;
        to[o->by == DM_WORK_FORCE ? row : row * w->values + o->at] += y[i];
    }
}

/* sum by sum, so an entry adds its forces up in one order whatever the block */
void dm_work_force(const dm_work *w, double *f, double *f_q, double *f_v, const double *x,
                   uint32_t first, uint32_t count, double *scratch) {
    double *const to[] = {f, f_q, f_v};
    memset(f, 0, count * sizeof *f);
    if (f_q) memset(f_q, 0, (size_t)count * w->values * sizeof *f_q);
    if (f_q) memset(f_v, 0, (size_t)count * w->values * sizeof *f_v);
    for (uint32_t s = 0; s < w->sums; s++) {
        const dm_work_sum *k = w->sum + s;
        const dm_cell_loop *loop = f_q ? &k->slopes : &k->force;
        const uint32_t end = first_body(k, (first + count) / w->values);
        double *y = scratch, *rest = scratch + (size_t)loop->outputs * BLOCK;
        for (uint32_t body = first_body(k, first / w->values); body < end;) {
            const uint32_t now = end - body < BLOCK ? end - body : BLOCK;
            dm_cell_loop_run(loop, y, BLOCK, x, body, now, rest);
            for (uint32_t o = 0; o < loop->outputs; o++)
                add_output(w, k, k->output + o, to[k->output[o].by], first, y + o * BLOCK, body,
                           now);
            body += now;
        }
    }
}

size_t dm_work_room(const dm_work *w) {
    return w ? w->room + (size_t)w->values * BLOCK : 0;
}

void dm_work_add(const dm_work *w, double *f, const double *x, double *scratch) {
    const uint32_t unit = w ? w->values * BLOCK : 0, n = w ? w->n : 0;
    for (uint32_t i = 0; i < n; i += unit) {
        const uint32_t count = n - i < unit ? n - i : unit;
        dm_work_force(w, scratch, NULL, NULL, x, i, count, scratch + unit);
        for (uint32_t k = 0; k < count; k++) f[i + k] += scratch[k];
    }
}
