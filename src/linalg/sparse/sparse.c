/* sparse.c - what is done to one matrix in compressed columns. */
#include "linalg/sparse/sparse.h"

#include <math.h>
#include <string.h>

dm_status dm_sparse_room(dm_sparse *A, dm_arena *arena, int32_t rows, int32_t columns,
                         int64_t entries) {
    if (entries > INT32_MAX) return DM_TOO_LARGE;
    const size_t count = (size_t)entries;
    A->rows = rows, A->columns = columns;
    A->start = dm_arena_take(arena, ((size_t)columns + 1) * sizeof *A->start);
    A->row = dm_arena_take(arena, (count + 1) * sizeof *A->row);
    A->value = dm_arena_take(arena, (count + 1) * sizeof *A->value);
    if (!A->start || !A->row || !A->value) return DM_NO_MEMORY;
    A->start[0] = 0;
    return DM_OK;
}

/* counts in start[1..n] to places: column j begins at start[j] */
static void add_up(int32_t *start, int32_t n) {
    for (int32_t j = 0; j < n; j++) start[j + 1] += start[j];
}

/* start[j] was moved to the end of column j: back to its beginning */
static void move_back(int32_t *start, int32_t n) {
    for (int32_t j = n; j > 0; j--) start[j] = start[j - 1];
    start[0] = 0;
}

/* entries of one place stand side by side after two transposes: one of them is left */
static void merge(dm_sparse *A) {
    int32_t to = 0, from = 0;
    for (int32_t j = 0; j < A->columns; j++) {
        const int32_t end = A->start[j + 1];
        for (const int32_t first = to; from < end; from++) {
            if (to > first && A->row[to - 1] == A->row[from])
                A->value[to - 1] += A->value[from];
            else
                A->row[to] = A->row[from], A->value[to++] = A->value[from];
        }
        A->start[j + 1] = to;
    }
}

/* By rows first, in the order given, then transposed: equal places meet in that order. */
dm_status dm_sparse_assemble(dm_sparse *A, dm_arena *arena, int32_t rows, int32_t columns,
                             int64_t count, const int32_t *row, const int32_t *column,
                             const double *entries) {
    dm_arena *scratch = dm_arena_scratch(arena);
    dm_sparse by_row;
    if (!scratch) return DM_NO_MEMORY;
    const dm_status status = dm_sparse_room(&by_row, scratch, columns, rows, count);
    if (status != DM_OK) return status;
    memset(by_row.start, 0, ((size_t)rows + 1) * sizeof *by_row.start);
    for (int64_t i = 0; i < count; i++) by_row.start[row[i] + 1]++;
    add_up(by_row.start, rows);
    for (int64_t i = 0; i < count; i++) {
        const int32_t at = by_row.start[row[i]]++;
        by_row.row[at] = column[i], by_row.value[at] = entries[i];
    }
    move_back(by_row.start, rows);
    const dm_status made = dm_sparse_transpose(A, arena, &by_row);
    if (made == DM_OK) merge(A);
    return made;
}

/* by columns: y gathers what every x_j gives */
void dm_sparse_apply(double *y, const dm_sparse *A, const double *x) {
    for (int32_t i = 0; i < A->rows; i++) y[i] = 0.0;
    for (int32_t j = 0; j < A->columns; j++)
        for (int32_t p = A->start[j]; p < A->start[j + 1]; p++) y[A->row[p]] += A->value[p] * x[j];
}

/* every y_j is one sum in the order of the rows: the faster of the two, also for symmetric A */
void dm_sparse_apply_transpose(double *y, const dm_sparse *A, const double *x) {
    for (int32_t j = 0; j < A->columns; j++) {
        double sum = 0.0;
        for (int32_t p = A->start[j]; p < A->start[j + 1]; p++) sum += A->value[p] * x[A->row[p]];
        y[j] = sum;
    }
}

/* Counting sort by rows: entries of a row come in the order of the columns, so that rows of T are
 * ascending whatever they were in A. */
dm_status dm_sparse_transpose(dm_sparse *T, dm_arena *arena, const dm_sparse *A) {
    const int32_t entries = A->start[A->columns];
    const dm_status status = dm_sparse_room(T, arena, A->columns, A->rows, entries);
    if (status != DM_OK) return status;
    memset(T->start, 0, ((size_t)A->rows + 1) * sizeof *T->start);
    for (int32_t p = 0; p < entries; p++)
        if (A->value[p] != 0.0) T->start[A->row[p] + 1]++;
    add_up(T->start, A->rows);
    for (int32_t j = 0; j < A->columns; j++)
        for (int32_t p = A->start[j]; p < A->start[j + 1]; p++) {
            if (A->value[p] == 0.0) continue;
            const int32_t at = T->start[A->row[p]]++;
            T->row[at] = j, T->value[at] = A->value[p];
        }
    move_back(T->start, A->rows);
    return DM_OK;
}

/* products that are 0, of a factor 0 or by underflow, are not stored */
dm_status dm_sparse_scaled(dm_sparse *out, dm_arena *arena, const dm_sparse *A, const double *left,
                           const double *right) {
    const dm_status status = dm_sparse_room(out, arena, A->rows, A->columns, A->start[A->columns]);
    if (status != DM_OK) return status;
    int32_t to = 0;
    for (int32_t j = 0; j < A->columns; j++) {
        for (int32_t p = A->start[j]; p < A->start[j + 1]; p++) {
            double x = A->value[p];
            if (left) x *= left[A->row[p]];
            if (right) x *= right[j];
            if (x == 0.0) continue;
            out->row[to] = A->row[p], out->value[to++] = x;
        }
        out->start[j + 1] = to;
    }
    return DM_OK;
}

/* rows that stay get new numbers in their order, the others -1 */
dm_status dm_sparse_pick(dm_sparse *out, dm_arena *arena, const dm_sparse *A,
                         const unsigned char *keep_row, const unsigned char *keep_column) {
    dm_arena *scratch = dm_arena_scratch(arena);
    int32_t *number =
        scratch ? dm_arena_take(scratch, ((size_t)A->rows + 1) * sizeof *number) : NULL;
    int32_t rows = 0, columns = 0, to = 0;
    int64_t entries = 0;
    if (!number) return DM_NO_MEMORY;
    for (int32_t i = 0; i < A->rows; i++) number[i] = !keep_row || keep_row[i] ? rows++ : -1;
    for (int32_t j = 0; j < A->columns; j++) {
        if (keep_column && !keep_column[j]) continue;
        columns++;
        for (int32_t p = A->start[j]; p < A->start[j + 1]; p++) entries += number[A->row[p]] >= 0;
    }
    const dm_status status = dm_sparse_room(out, arena, rows, columns, entries);
    if (status != DM_OK) return status;
    columns = 0;
    for (int32_t j = 0; j < A->columns; j++) {
        if (keep_column && !keep_column[j]) continue;
        for (int32_t p = A->start[j]; p < A->start[j + 1]; p++)
            if (number[A->row[p]] >= 0)
                out->row[to] = number[A->row[p]], out->value[to++] = A->value[p];
        out->start[++columns] = to;
    }
    return DM_OK;
}

/* column j of A, negative and `down` rows further down, behind `to` entries of out */
static int32_t copy_below(dm_sparse *out, int32_t to, const dm_sparse *A, int32_t j, int32_t down) {
    for (int32_t p = A->start[j]; p < A->start[j + 1]; p++)
        out->row[to] = A->row[p] + down, out->value[to++] = -A->value[p];
    return to;
}

/* upper columns: r and -D; lower ones: -D^T, whose rows are numbers of upper unknowns */
dm_status dm_sparse_saddle(dm_sparse *out, dm_arena *arena, const double *r, const dm_sparse *D) {
    dm_arena *scratch = dm_arena_scratch(arena);
    dm_sparse T;
    const int32_t upper = D->columns, lower = D->rows;
    if (!scratch) return DM_NO_MEMORY;
    if ((int64_t)upper + lower >= INT32_MAX) return DM_TOO_LARGE;
    dm_status status = dm_sparse_transpose(&T, scratch, D);
    const int64_t entries = 2 * (int64_t)D->start[upper] + upper;
    if (status == DM_OK) status = dm_sparse_room(out, arena, upper + lower, upper + lower, entries);
    if (status != DM_OK) return status;
    int32_t to = 0;
    for (int32_t j = 0; j < upper; j++) {
        if (r[j] != 0.0) out->row[to] = j, out->value[to++] = r[j];
        out->start[j + 1] = to = copy_below(out, to, D, j, upper);
    }
    for (int32_t i = 0; i < lower; i++)
        out->start[upper + i + 1] = to = copy_below(out, to, &T, i, 0);
    return DM_OK;
}

void dm_sparse_diagonal(double *diagonal, const dm_sparse *A) {
    for (int32_t j = 0; j < A->columns && j < A->rows; j++) {
        diagonal[j] = 0.0;
        for (int32_t p = A->start[j]; p < A->start[j + 1]; p++)
            if (A->row[p] == j) diagonal[j] = A->value[p];
    }
}

/* both have ascending rows: the columns are walked side by side */
double dm_sparse_asymmetry(const dm_sparse *A, const dm_sparse *T) {
    double largest = 0.0, worst = 0.0;
    for (int32_t j = 0; j < A->columns; j++) {
        int32_t p = A->start[j], q = T->start[j];
        while (p < A->start[j + 1] || q < T->start[j + 1]) {
            const int32_t i = p < A->start[j + 1] ? A->row[p] : INT32_MAX;
            const int32_t k = q < T->start[j + 1] ? T->row[q] : INT32_MAX;
            const double a = i <= k ? A->value[p++] : 0.0, t = k <= i ? T->value[q++] : 0.0;
            largest = fmax(largest, fabs(a));
            worst = fmax(worst, fabs(a - t));
        }
    }
    return largest > 0.0 ? worst / largest : 0.0;
}

int dm_sparse_is_within(const dm_sparse *A, const double *r, const double *size, double part,
                        double *terms) {
    memset(terms, 0, (size_t)A->rows * sizeof *terms);
    for (int32_t j = 0; j < A->columns; j++)
        for (int32_t p = A->start[j]; p < A->start[j + 1]; p++)
            terms[A->row[p]] += fabs(A->value[p]) * size[j];
    for (int32_t i = 0; i < A->rows; i++)
        if (!(fabs(r[i]) <= part * terms[i])) return 0;
    return 1;
}
