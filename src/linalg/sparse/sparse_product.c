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

/* the sums of column j to its values */
/* rows stay in the order in which they were met */
static void close_column(const dense_column *c, dm_sparse *out, int32_t j, int32_t to) {
    for (int32_t p = out->start[j]; p < to; p++) out->value[p] = c->sum[out->row[p]];
    out->start[j + 1] = to;
}

dm_status dm_sparse_sum(dm_sparse *out, dm_arena *arena, double a, const dm_sparse *A, double b,
                        const dm_sparse *B) {
    dm_arena *scratch = dm_arena_scratch(arena);
    dense_column c;
    dm_sparse raw, turned;
    if (!scratch) return DM_NO_MEMORY;
    const int64_t most = (int64_t)A->start[A->columns] + B->start[B->columns];
    dm_status status = dm_sparse_room(&raw, scratch, A->rows, A->columns, most);
    if (status == DM_OK) status = open_column(&c, scratch, A->rows);
    int32_t to = 0;
    for (int32_t j = 0; status == DM_OK && j < A->columns; j++) {
        to = add_column(&c, &raw, to, j, A, j, a);
        to = add_column(&c, &raw, to, j, B, j, b);
        close_column(&c, &raw, j, to);
    }
    if (status == DM_OK) status = dm_sparse_transpose(&turned, scratch, &raw);
    return status == DM_OK ? dm_sparse_transpose(out, arena, &turned) : status;
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

/* A B, rows of a column in the order in which they are met, in the scratch arena */
static dm_status multiply(dm_sparse *raw, dm_arena *scratch, const dm_sparse *A, const dm_sparse *B,
                          volatile const int *stop) {
    dense_column c;
    dm_status status = open_column(&c, scratch, A->rows);
    if (status != DM_OK) return status;
    status = dm_sparse_room(raw, scratch, A->rows, B->columns, pattern(&c, A, B));
    int32_t to = 0;
    for (int32_t j = 0; status == DM_OK && j < B->columns; j++) {
        for (int32_t q = B->start[j]; q < B->start[j + 1]; q++)
            to = add_column(&c, raw, to, j, A, B->row[q], B->value[q]);
        close_column(&c, raw, j, to);
        if (stop && *stop) status = DM_STOPPED;
    }
    return status;
}

dm_status dm_sparse_product(dm_sparse *out, dm_arena *arena, const dm_sparse *A, const dm_sparse *B,
                            volatile const int *stop) {
    dm_arena *scratch = dm_arena_scratch(arena);
    dm_sparse raw, turned;
    if (!scratch) return DM_NO_MEMORY;
    dm_status status = multiply(&raw, scratch, A, B, stop);
    if (status == DM_OK) status = dm_sparse_transpose(&turned, scratch, &raw);
    return status == DM_OK ? dm_sparse_transpose(out, arena, &turned) : status;
}

/* The transpose of the product is the product: once is enough to order its rows. */
dm_status dm_sparse_gram(dm_sparse *out, dm_arena *arena, const dm_sparse *A, const double *w,
                         volatile const int *stop) {
    dm_arena *scratch = dm_arena_scratch(arena);
    dm_sparse turned, weighted, raw;
    if (!scratch) return DM_NO_MEMORY;
    dm_status status = dm_sparse_transpose(&turned, scratch, A);
    if (status == DM_OK) status = dm_sparse_scaled(&weighted, scratch, A, w, NULL);
    if (status == DM_OK) status = multiply(&raw, scratch, &turned, &weighted, stop);
    return status == DM_OK ? dm_sparse_transpose(out, arena, &raw) : status;
}
