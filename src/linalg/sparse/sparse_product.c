/* sparse_product.c - sums and products of sparse matrices, column by column (Gustavson 1978): a
 * dense column of sums and a list of the rows that it has. Both work in the scratch arena of the
 * result's, in time linear in the multiplications. */
#include "linalg/sparse/sparse.h"

#include <string.h>

/* the column that is being summed; mark[i] = j + 1: row i is in the list of column j */
typedef struct {
    double *sum;   /* [rows] */
    int32_t *mark; /* [rows] */
} dense_column;

/* no row marked: columns are numbered from 1 in marks */
static dm_status open_column(dense_column *c, dm_arena *scratch, int32_t rows) {
    const size_t n = (size_t)rows + 1;
    c->sum = dm_arena_take(scratch, n * sizeof *c->sum);
    c->mark = dm_arena_take(scratch, n * sizeof *c->mark);
    if (!c->sum || !c->mark) return DM_NO_MEMORY;
    memset(c->mark, 0, n * sizeof *c->mark);
    return DM_OK;
}

/* column j of out += factor * column k of A; `to`: entries of out so far */
static int32_t add_column(const dense_column *c, dm_sparse *out, int32_t to, int32_t j,
                          const dm_sparse *A, int32_t k, double factor) {
    for (int32_t p = A->start[k]; p < A->start[k + 1]; p++) {
        const int32_t i = A->row[p];
        const double x = A->value[p] * factor;
        if (c->mark[i] != j + 1)
            c->mark[i] = j + 1, c->sum[i] = x, out->row[to++] = i;
        else
            c->sum[i] += x;
    }
    return to;
}

/* Shell's sort, which is insertion where there are few */
static void sort_rows(int32_t *row, int32_t count) {
    int32_t gap = 1;
    while (count > 32 && gap < count / 3) gap = 3 * gap + 1;
    for (; gap > 0; gap /= 3)
        for (int32_t i = gap; i < count; i++) {
            const int32_t moved = row[i];
            int32_t j = i;
            for (; j >= gap && row[j - gap] > moved; j -= gap) row[j] = row[j - gap];
            row[j] = moved;
        }
}

/* the rows of column j in order with their sums, without those that are 0; where the column ends */
static int32_t close_column(const dense_column *c, dm_sparse *out, int32_t j, int32_t to) {
    int32_t end = out->start[j];
    sort_rows(out->row + end, to - end);
    for (int32_t p = end; p < to; p++) {
        const int32_t row = out->row[p];
        if (c->sum[row] == 0.0) continue;
        out->row[end] = row, out->value[end++] = c->sum[row];
    }
    return out->start[j + 1] = end;
}

/* Column j of a A + b B behind `to` entries of out; without `out` they are only counted. */
static int32_t merge_column(dm_sparse *out, int32_t to, int32_t j, double a, const dm_sparse *A,
                            double b, const dm_sparse *B) {
    int32_t p = A->start[j], q = B->start[j];
    const int32_t ends[2] = {A->start[j + 1], B->start[j + 1]};
    while (p < ends[0] || q < ends[1]) {
        const int32_t i = p < ends[0] ? A->row[p] : INT32_MAX;
        const int32_t k = q < ends[1] ? B->row[q] : INT32_MAX;
        double x = i <= k ? A->value[p++] * a : 0.0;
        if (k <= i) x += B->value[q++] * b;
        if (x == 0.0) continue;
        if (out) out->row[to] = i < k ? i : k, out->value[to] = x;
        to++;
    }
    return to;
}

/* both have ascending rows: the columns are walked side by side, first to count */
dm_status dm_sparse_sum(dm_sparse *out, dm_arena *arena, double a, const dm_sparse *A, double b,
                        const dm_sparse *B) {
    int64_t entries = 0;
    for (int32_t j = 0; j < A->columns; j++) entries += merge_column(NULL, 0, j, a, A, b, B);
    const dm_status status = dm_sparse_room(out, arena, A->rows, A->columns, entries);
    for (int32_t j = 0; status == DM_OK && j < A->columns; j++)
        out->start[j + 1] = merge_column(out, out->start[j], j, a, A, b, B);
    return status;
}

/* how many entries A B has at most: those of its pattern */
static int64_t pattern(const dense_column *c, const dm_sparse *A, const dm_sparse *B) {
    int64_t entries = 0;
    for (int32_t j = 0; j < B->columns; j++)
        for (int32_t q = B->start[j]; q < B->start[j + 1]; q++) {
            const int32_t k = B->row[q];
            for (int32_t p = A->start[k]; p < A->start[k + 1]; p++) {
                if (c->mark[A->row[p]] == j + 1) continue;
                c->mark[A->row[p]] = j + 1;
                entries++;
            }
        }
    memset(c->mark, 0, (size_t)A->rows * sizeof *c->mark);
    return entries;
}

/* A B to the arena, working in its scratch */
static dm_status multiply(dm_sparse *out, dm_arena *arena, dm_arena *scratch, const dm_sparse *A,
                          const dm_sparse *B, volatile const int *stop) {
    dense_column c;
    dm_status status = open_column(&c, scratch, A->rows);
    if (status != DM_OK) return status;
    status = dm_sparse_room(out, arena, A->rows, B->columns, pattern(&c, A, B));
    int32_t to = 0;
    for (int32_t j = 0; status == DM_OK && j < B->columns; j++) {
        for (int32_t q = B->start[j]; q < B->start[j + 1]; q++)
            to = add_column(&c, out, to, j, A, B->row[q], B->value[q]);
        to = close_column(&c, out, j, to);
        if (stop && *stop) status = DM_STOPPED;
    }
    return status;
}

dm_status dm_sparse_product(dm_sparse *out, dm_arena *arena, const dm_sparse *A, const dm_sparse *B,
                            volatile const int *stop) {
    dm_arena *scratch = dm_arena_scratch(arena);
    return scratch ? multiply(out, arena, scratch, A, B, stop) : DM_NO_MEMORY;
}

/* (diag(w) A)^T A */
dm_status dm_sparse_gram(dm_sparse *out, dm_arena *arena, const dm_sparse *A, const double *w,
                         volatile const int *stop) {
    dm_arena *scratch = dm_arena_scratch(arena);
    dm_sparse turned, weighted;
    if (!scratch) return DM_NO_MEMORY;
    dm_status status = dm_sparse_scaled(&weighted, scratch, A, w, NULL);
    if (status == DM_OK) status = dm_sparse_transpose(&turned, scratch, &weighted);
    return status == DM_OK ? multiply(out, arena, scratch, &turned, A, stop) : status;
}
