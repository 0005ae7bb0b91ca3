/* smith.c - elimination in integers, the smallest entry as pivot. */
#include "dec/homology/smith.h"

#include <string.h>

dm_status dm_smith_open(dm_smith *s, dm_arena *arena, uint32_t m, uint32_t n) {
    const size_t of_rows = (size_t)m * m + 1, of_columns = (size_t)n * n + 1;
    *s = (dm_smith){.m = m, .n = n};
    s->D = dm_arena_take(arena, ((size_t)m * n + 1) * sizeof *s->D);
    s->U = dm_arena_take(arena, of_rows * sizeof *s->U);
    s->W = dm_arena_take(arena, of_rows * sizeof *s->W);
    s->V = dm_arena_take(arena, of_columns * sizeof *s->V);
    s->X = dm_arena_take(arena, of_columns * sizeof *s->X);
    if (!s->D || !s->U || !s->W || !s->V || !s->X) return DM_NO_MEMORY;
    memset(s->D, 0, ((size_t)m * n + 1) * sizeof *s->D);
    return DM_OK;
}

static void set_unit(int64_t *a, uint32_t n) {
    memset(a, 0, (size_t)n * n * sizeof *a);
    for (uint32_t i = 0; i < n; i++) a[(size_t)i * n + i] = 1;
}

/* ---- row and column operations on a matrix of `columns` columns; 0: overflow ---- */

/* *to += q x; INT64_MIN, which has no modulus, counts as overflow */
static int add_product(int64_t *to, int64_t q, int64_t x) {
    int64_t y = 0;
    return !__builtin_mul_overflow(q, x, &y) && !__builtin_add_overflow(*to, y, to) &&
           *to != INT64_MIN;
}

/* row i += q row j */
static int add_row(int64_t *a, uint32_t columns, uint32_t i, uint32_t j, int64_t q) {
    int64_t *to = a + (size_t)i * columns;
    const int64_t *from = a + (size_t)j * columns;
    for (uint32_t c = 0; c < columns; c++)
        if (from[c] && !add_product(to + c, q, from[c])) return 0;
    return 1;
}

/* column i += q column j */
static int add_column(int64_t *a, uint32_t rows, uint32_t columns, uint32_t i, uint32_t j,
                      int64_t q) {
    for (uint32_t r = 0; r < rows; r++) {
        int64_t *row = a + (size_t)r * columns;
        if (row[j] && !add_product(row + i, q, row[j])) return 0;
    }
    return 1;
}

static void swap_rows(int64_t *a, uint32_t columns, uint32_t i, uint32_t j) {
    for (uint32_t c = 0; c < columns; c++) {
        const int64_t x = a[(size_t)i * columns + c];
        a[(size_t)i * columns + c] = a[(size_t)j * columns + c];
        a[(size_t)j * columns + c] = x;
    }
}

static void swap_columns(int64_t *a, uint32_t rows, uint32_t columns, uint32_t i, uint32_t j) {
    for (uint32_t r = 0; r < rows; r++) {
        int64_t *row = a + (size_t)r * columns;
        const int64_t x = row[i];
        row[i] = row[j];
        row[j] = x;
    }
}

/* ---- the same on A with what keeps account of it: D = U A V, U W = 1, V X = 1 ---- */

static int combine_rows(dm_smith *s, uint32_t i, uint32_t j, int64_t q) {
    return add_row(s->D, s->n, i, j, q) && add_row(s->U, s->m, i, j, q) &&
           add_column(s->W, s->m, s->m, j, i, -q);
}

static int combine_columns(dm_smith *s, uint32_t i, uint32_t j, int64_t q) {
    return add_column(s->D, s->m, s->n, i, j, q) && add_column(s->V, s->n, s->n, i, j, q) &&
           add_row(s->X, s->n, j, i, -q);
}

static void bring_pivot(dm_smith *s, uint32_t t, uint32_t row, uint32_t column) {
    if (row != t) {
        swap_rows(s->D, s->n, row, t);
        swap_rows(s->U, s->m, row, t);
        swap_columns(s->W, s->m, s->m, row, t);
    }
    if (column != t) {
        swap_columns(s->D, s->m, s->n, column, t);
        swap_columns(s->V, s->n, s->n, column, t);
        swap_rows(s->X, s->n, column, t);
    }
}

static void negate_row(dm_smith *s, uint32_t t) {
    for (uint32_t c = 0; c < s->n; c++) s->D[(size_t)t * s->n + c] *= -1;
    for (uint32_t c = 0; c < s->m; c++) s->U[(size_t)t * s->m + c] *= -1;
    for (uint32_t r = 0; r < s->m; r++) s->W[(size_t)r * s->m + t] *= -1;
}

static uint64_t modulus(int64_t x) {
    return x < 0 ? 0 - (uint64_t)x : (uint64_t)x;
}

/* the smallest entry of what is left; 0: there is none */
static int find_pivot(const dm_smith *s, uint32_t t, uint32_t *row, uint32_t *column) {
    uint64_t least = UINT64_MAX;
    for (uint32_t r = t; r < s->m; r++)
        for (uint32_t c = t; c < s->n; c++) {
            const uint64_t size = modulus(s->D[(size_t)r * s->n + c]);
            if (size == 0 || size >= least) continue;
            least = size, *row = r, *column = c;
            if (least == 1) return 1;
        }
    return least != UINT64_MAX;
}

/* the quotient whose remainder is smallest */
static int64_t nearest(int64_t a, int64_t p) {
    const int64_t q = a / p, left = a % p;
    if (modulus(left) <= modulus(p) / 2) return q;
    return q + ((left < 0) == (p < 0) ? 1 : -1);
}

/* Row and column t made as small as the pivot allows; *clean: nothing is left in them. */
static int clear_cross(dm_smith *s, uint32_t t, int *clean) {
    const int64_t p = s->D[(size_t)t * s->n + t];
    *clean = 1;
    for (uint32_t r = t + 1; r < s->m; r++) {
        const int64_t *entry = s->D + (size_t)r * s->n + t;
        if (*entry && !combine_rows(s, r, t, -nearest(*entry, p))) return 0;
        *clean &= *entry == 0;
    }
    for (uint32_t c = t + 1; c < s->n; c++) {
        const int64_t *entry = s->D + (size_t)t * s->n + c;
        if (*entry && !combine_columns(s, c, t, -nearest(*entry, p))) return 0;
        *clean &= *entry == 0;
    }
    return 1;
}

/* A row below with an entry that the pivot does not divide is added to its row; 0: there is none */
static int mix_in(dm_smith *s, uint32_t t, int *fine) {
    const int64_t p = s->D[(size_t)t * s->n + t];
    for (uint32_t r = t + 1; modulus(p) != 1 && r < s->m; r++)
        for (uint32_t c = t + 1; c < s->n; c++)
            if (s->D[(size_t)r * s->n + c] % p != 0) {
                *fine = combine_rows(s, t, r, 1);
                return 1;
            }
    return 0;
}

dm_status dm_smith_form(dm_smith *s, volatile const int *stop) {
    set_unit(s->U, s->m), set_unit(s->W, s->m);
    set_unit(s->V, s->n), set_unit(s->X, s->n);
    uint32_t row = 0, column = 0;
    for (s->rank = 0; s->rank < s->m && s->rank < s->n; s->rank++) {
        const uint32_t t = s->rank;
        int clean = 0, fine = 1;
        if (!find_pivot(s, t, &row, &column)) break;
        bring_pivot(s, t, row, column);
        while (!clean || mix_in(s, t, &fine)) {
            if (stop && *stop) return DM_STOPPED;
            if (!fine || !clear_cross(s, t, &clean)) return DM_TOO_LARGE;
            if (clean) continue;
            find_pivot(s, t, &row, &column);
            bring_pivot(s, t, row, column);
        }
        if (s->D[(size_t)t * s->n + t] < 0) negate_row(s, t);
    }
    return DM_OK;
}
