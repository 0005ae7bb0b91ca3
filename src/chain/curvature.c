/* curvature.c - pattern and values of the second derivatives of sums over cells. */
#include "chain/curvature.h"

#include "algebra/derive.h"

#include <string.h>

enum { BLOCK = DM_CELL_BLOCK };

/* a column of coordinates that may be moved */
static int is_coordinate(const dm_column *c, uint32_t n) {
    return !c->data && c->first < n;
}

/* second derivatives that do not vanish, as roots of the loop */
static dm_status make_loop(dm_curvature_sum *k, const dm_sum *s, uint32_t n, dm_compile *compile,
                           dm_arena *arena) {
    dm_node slope[DM_SUM_COLUMNS], row[DM_SUM_COLUMNS];
    const uint32_t most = s->columns * (s->columns + 1) / 2;
    uint32_t outputs = 0;
    dm_node *roots = dm_arena_take(arena, (most + 1) * sizeof *roots);
    k->pair = dm_arena_take(arena, (most + 1) * sizeof *k->pair);
    if (!roots || !k->pair) return DM_NO_MEMORY;
    dm_gradient(s->term, s->value, 0, s->columns, slope);
    for (uint32_t a = 0; a < s->columns; a++) {
        if (!slope[a] || !is_coordinate(s->column + a, n)) continue;
        dm_gradient(s->term, slope[a], 0, s->columns, row);
        for (uint32_t b = 0; b <= a; b++) {
            if (!row[b] || !is_coordinate(s->column + b, n)) continue;
            k->pair[outputs][0] = (uint8_t)a;
            k->pair[outputs][1] = (uint8_t)b;
            roots[outputs++] = row[b];
        }
    }
    if (dm_graph_status(s->term) != DM_OK) return dm_graph_status(s->term);
    k->loop = (dm_cell_loop){.sum = s};
    return outputs ? dm_cell_loop_make(&k->loop, s, roots, outputs, compile, arena) : DM_OK;
}

/* the entry of column c in cell i; -1: it is held */
static int32_t entry(const dm_sum *s, uint32_t c, uint32_t i) {
    const size_t at = dm_sum_entry(s, s->column + c, i, 0);
    return s->held && s->held[at] == DM_HELD ? -1 : (int32_t)at;
}

/* all pairs of entries of a sum, both ways; returns how many */
static int64_t add_pairs(const dm_curvature_sum *k, int32_t *row, int32_t *column, int64_t at) {
    const dm_sum *s = k->loop.sum;
    for (uint32_t i = 0; i < s->bodies; i++)
        for (uint32_t o = 0; o < k->loop.outputs; o++) {
            const int32_t a = entry(s, k->pair[o][0], i), b = entry(s, k->pair[o][1], i);
            if (a < 0 || b < 0) continue;
            row[at] = a, column[at++] = b;
            row[at] = b, column[at++] = a;
        }
    return at;
}

/* where (row, column) is among the values */
static int32_t find(const dm_sparse *A, int32_t row, int32_t column) {
    int32_t low = A->start[column], high = A->start[column + 1] - 1;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (A->row[middle] < row)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* places of all second derivatives of one sum */
static dm_status find_places(dm_curvature_sum *k, const dm_sparse *A, dm_arena *arena) {
    const dm_sum *s = k->loop.sum;
    const size_t all = (size_t)s->bodies * k->loop.outputs;
    for (int side = 0; side < 2; side++) {
        k->place[side] = dm_arena_take(arena, (all + 1) * sizeof(int32_t));
        if (!k->place[side]) return DM_NO_MEMORY;
    }
    for (uint32_t i = 0; i < s->bodies; i++)
        for (uint32_t o = 0; o < k->loop.outputs; o++) {
            const size_t at = (size_t)i * k->loop.outputs + o;
            const int32_t a = entry(s, k->pair[o][0], i), b = entry(s, k->pair[o][1], i);
            const int none = a < 0 || b < 0, own = k->pair[o][0] == k->pair[o][1];
            k->place[0][at] = none ? -1 : find(A, a, b);
            k->place[1][at] = none || own ? -1 : find(A, b, a);
        }
    return DM_OK;
}

/* the pattern, with all of the diagonal, from a list that has most entries several times */
static dm_status assemble(dm_sparse *A, const dm_curvature *c, uint32_t n, dm_arena *arena) {
    int64_t most = n;
    for (uint32_t k = 0; k < c->sums; k++)
        most += 2 * (int64_t)c->sum[k].loop.outputs * c->sum[k].loop.sum->bodies;
    int32_t *row = dm_arena_take(arena, (size_t)most * sizeof *row);
    int32_t *column = dm_arena_take(arena, (size_t)most * sizeof *column);
    double *one = dm_arena_take(arena, (size_t)most * sizeof *one);
    if (!row || !column || !one) return DM_NO_MEMORY;
    for (int32_t i = 0; i < (int32_t)n; i++) row[i] = column[i] = i;
    int64_t count = n;
    for (uint32_t k = 0; k < c->sums; k++) count = add_pairs(c->sum + k, row, column, count);
    for (int64_t i = 0; i < count; i++) one[i] = 1.0;
    return dm_sparse_assemble(A, arena, (int32_t)n, (int32_t)n, count, row, column, one);
}

/* The list and what sorts it go at once: they are several times the matrix. */
static dm_status make_pattern(dm_curvature *c, uint32_t n, dm_arena *arena) {
    dm_arena aside;
    dm_sparse A;
    dm_arena_init(&aside, arena->allocate, arena->ud);
    dm_status status = assemble(&A, c, n, &aside);
    if (status == DM_OK) status = dm_sparse_room(&c->A, arena, (int32_t)n, (int32_t)n, A.start[n]);
    if (status == DM_OK) {
        memcpy(c->A.start, A.start, ((size_t)n + 1) * sizeof *A.start);
        memcpy(c->A.row, A.row, (size_t)A.start[n] * sizeof *A.row);
    }
    dm_arena_release(&aside);
    return status;
}

dm_status dm_curvature_open(dm_curvature *c, const dm_sum *const *sums, uint32_t count, uint32_t n,
                            dm_compile *compile, dm_arena *arena) {
    size_t work = 0;
    *c = (dm_curvature){.sums = count, .constant = 1};
    c->sum = dm_arena_take(arena, (count + 1) * sizeof *c->sum);
    if (!c->sum) return DM_NO_MEMORY;
    memset(c->sum, 0, (count + 1) * sizeof *c->sum);
    for (uint32_t k = 0; k < count; k++) {
        const dm_status status = make_loop(c->sum + k, sums[k], n, compile, arena);
        if (status != DM_OK) return status;
        const dm_cell_loop *l = &c->sum[k].loop;
        for (uint32_t j = 0; j < l->columns; j++)
            c->constant &= sums[k]->column[l->column[j]].data != NULL;
        const size_t need = dm_cell_loop_work(l) + (size_t)l->outputs * BLOCK;
        if (need > work) work = need;
    }
    c->work = dm_arena_take(arena, (work + 1) * sizeof *c->work);
    if (!c->work) return DM_NO_MEMORY;
    dm_status status = make_pattern(c, n, arena);
    for (uint32_t k = 0; k < count && status == DM_OK; k++)
        status = find_places(c->sum + k, &c->A, arena);
    return status;
}

/* second derivatives of one block of cells to their places */
static void add_block(const dm_curvature_sum *k, double *value, double factor, const double *y,
                      uint32_t first, uint32_t count) {
    const uint32_t outputs = k->loop.outputs;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t o = 0; o < outputs; o++) {
            const size_t at = (size_t)(first + i) * outputs + o;
            const double x = factor * y[o * BLOCK + i];
            if (k->place[0][at] >= 0) value[k->place[0][at]] += x;
            if (k->place[1][at] >= 0) value[k->place[1][at]] += x;
        }
}

void dm_curvature_at(const dm_curvature *c, const double *factor, const double *x) {
    memset(c->A.value, 0, (size_t)c->A.start[c->A.columns] * sizeof *c->A.value);
    for (uint32_t k = 0; k < c->sums; k++) {
        const dm_curvature_sum *s = c->sum + k;
        const uint32_t cells = s->loop.sum->bodies;
        double *y = c->work, *scratch = y + (size_t)s->loop.outputs * BLOCK;
        if (!s->loop.outputs) continue;
        for (uint32_t i = 0; i < cells; i += BLOCK) {
            const uint32_t count = cells - i < BLOCK ? cells - i : BLOCK;
            dm_cell_loop_run(&s->loop, y, BLOCK, x, i, count, scratch);
            add_block(s, c->A.value, factor[k], y, i, count);
        }
    }
}
