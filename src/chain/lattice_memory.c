/* lattice_memory.c - arrays of a lattice: where they are, what is beyond their ends, states in
 * and out. Behind each other: scalars (8 copies each), the buffer of slopes, the arrays with
 * `pad` groups before and behind. Entries that no body has are copies of others, or zero.
 * Speed: P8-fpu-1024: 12.7x, against loops over rounds (chain/loops.h). */
#include "chain/lattice_inside.h"

#include <string.h>

enum { GROUP = DM_ARRAY_GROUP };

uint32_t dm_lattice_arrays(dm_lattice *l) {
    l->arrays += l->block;
    return l->arrays - l->block;
}

/* Beyond the end of an array its first bodies come again, and beyond the ends of a part those of
 * its neighbours. */
static void fill_ends(const dm_lattice *l, double *x) {
    const uint32_t all = l->depth * GROUP, n = l->bodies;
    for (uint32_t i = n; i < all; i++) x[dm_lattice_at(l, i)] = x[dm_lattice_at(l, i - n)];
    for (uint32_t k = 0; k < l->pad; k++) {
        double *behind = x + (size_t)(l->depth + k) * GROUP;
        memcpy(behind, x + (size_t)k * GROUP + 1, (GROUP - 1) * sizeof *x);
        behind[GROUP - 1] = x[dm_lattice_at(l, all - n + k)];
        const uint32_t j = l->depth - 1 - k;
        double *before = x - (size_t)(k + 1) * GROUP;
        memcpy(before + 1, x + (size_t)j * GROUP, (GROUP - 1) * sizeof *x);
        before[0] = x[dm_lattice_at(l, n - 1 - k)];
    }
}

void dm_lattice_fill_ends(dm_lattice *l) {
    for (uint32_t c = 0; c < l->block; c++) fill_ends(l, l->space + (size_t)c * l->pitch);
}

/* numbers that differ from body to body, once: they do not change */
static void fill_data(dm_lattice *l) {
    for (const struct dm_lattice_data *d = l->data; d < l->data + l->columns; d++) {
        double *to = l->space + (size_t)d->array * l->pitch;
        dm_column own = *d->column;
        own.partner = 0;
        for (uint32_t i = 0; i < d->sum->bodies; i++)
            to[dm_lattice_at(l, i)] = own.data[dm_sum_entry(d->sum, &own, i, 0)];
        fill_ends(l, to);
    }
}

/* At most: sums whose columns need no array of their own take less. */
size_t dm_lattice_work(const dm_source *from, uint32_t n, uint32_t arrays) {
    dm_lattice l = {.source = from, .n = n};
    uint32_t columns = 0;
    if (!from->sums || dm_sum_over_cells(from->sums) || dm_sum_over_near(from->sums) ||
        !dm_lattice_layout(&l))
        return 0;
    for (const dm_sum *s = dm_sums(from->sums); s; s = s->next) columns += s->columns;
    return (size_t)(arrays * l.block + columns) * l.pitch + (size_t)columns * l.row +
           (size_t)(DM_LATTICE_SCALARS + 1 + 2 * l.pad) * GROUP;
}

/* zero where no body is: the numbers, the buffer, both ends of every array */
static void clear(const dm_lattice *l) {
    const uint32_t first = l->depth > GROUP ? l->depth - GROUP : 0;
    const size_t before = (size_t)l->pad * GROUP;
    const size_t behind = (size_t)(l->depth - first + l->pad) * GROUP;
    memset(l->scalars, 0, (size_t)(l->space - l->scalars) * sizeof *l->scalars);
    for (uint32_t a = 0; a < l->arrays; a++) {
        double *x = l->space + (size_t)a * l->pitch;
        memset(x - before, 0, before * sizeof *x);
        memset(x + (size_t)first * GROUP, 0, behind * sizeof *x);
    }
}

/* from the first line of the caches on */
void dm_lattice_place(dm_lattice *l, double *work) {
    const uintptr_t line = GROUP * sizeof *work;
    l->scalars = work + (line - (uintptr_t)work % line) % line / sizeof *work;
    l->buffer = l->scalars + (size_t)DM_LATTICE_SCALARS * GROUP;
    l->space = l->buffer + (size_t)l->slots * l->row + (size_t)l->pad * GROUP;
    clear(l);
    fill_data(l);
}

/* a scalar in all lanes */
void dm_lattice_set(dm_lattice *l, uint32_t slot, double value) {
    double *to = l->scalars + (size_t)slot * GROUP;
    if (memcmp(to, &value, sizeof value) == 0) return; /* a loop would wait for it */
    for (uint32_t k = 0; k < GROUP; k++) to[k] = value;
}

typedef double pair __attribute__((vector_size(16), aligned(8), may_alias));

/* two by two entries change places: parts of n/8 numbers side by side, or back */
static inline void turn(double *to, size_t to_row, const double *from, size_t from_row) {
    const pair a = *(const pair *)(const void *)from;
    const pair b = *(const pair *)(const void *)(from + from_row);
    *(pair *)(void *)to = __builtin_shufflevector(a, b, 0, 2);
    *(pair *)(void *)(to + to_row) = __builtin_shufflevector(a, b, 1, 3);
}

/* depths that go two by two: an even number of each part, if all are there */
static uint32_t in_pairs(const dm_lattice *l) {
    return l->block == 1 && l->bodies == l->depth * GROUP ? l->depth & ~1u : 0;
}

/* the start of every part at once; gives how many depths */
static uint32_t load_start(const dm_lattice *l, double *to, const double *x) {
    const uint32_t even = in_pairs(l);
    for (uint32_t j = 0; j < even; j += 2)
        for (uint32_t lane = 0; lane < GROUP; lane += 2)
            turn(to + (size_t)j * GROUP + lane, GROUP, x + (size_t)lane * l->depth + j, l->depth);
    return even;
}

static uint32_t store_start(const dm_lattice *l, double *x, const double *from) {
    const uint32_t even = in_pairs(l);
    for (uint32_t j = 0; j < even; j += 2)
        for (uint32_t lane = 0; lane < GROUP; lane += 2)
            turn(x + (size_t)lane * l->depth + j, l->depth, from + (size_t)j * GROUP + lane, GROUP);
    return even;
}

/* whole pairs of depths at once, the rest one by one */
void dm_lattice_load(dm_lattice *l, uint32_t first, const double *x) {
    double *to = l->space + (size_t)first * l->pitch;
    for (uint32_t c = 0; c < l->block; c++, to += l->pitch)
        for (uint32_t j = load_start(l, to, x); j < l->depth; j++)
            for (uint32_t lane = 0, i = j; i < l->bodies; lane++, i += l->depth)
                to[(size_t)j * GROUP + lane] = x[(size_t)i * l->block + c];
}

void dm_lattice_store(const dm_lattice *l, double *x, uint32_t first) {
    const double *from = l->space + (size_t)first * l->pitch;
    for (uint32_t c = 0; c < l->block; c++, from += l->pitch)
        for (uint32_t j = store_start(l, x, from); j < l->depth; j++)
            for (uint32_t lane = 0, i = j; i < l->bodies; lane++, i += l->depth)
                x[(size_t)i * l->block + c] = from[(size_t)j * GROUP + lane];
}

typedef double eight __attribute__((vector_size(64), aligned(8), may_alias));

/* entry by entry: 0 * infinity is NaN */
static int are_finite(const double *x, size_t count) {
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) sum += 0.0 * x[i];
    return sum == 0.0;
}

/* What is not finite makes their sum so; a sum of huge ones may be infinite, too. Four groups at a
 * time do not wait for each other. Entries beyond the last body are copies or zero. */
static int is_finite(const dm_lattice *l, const double *x) {
    const size_t all = (size_t)l->depth * GROUP;
    eight sum[4] = {0};
    size_t i = 0;
    for (; i + 4 * GROUP <= all; i += 4 * GROUP)
        for (size_t k = 0; k < 4; k++) sum[k] += *(const eight *)(const void *)(x + i + k * GROUP);
    const eight total = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    return (are_finite((const double *)&total, GROUP) || are_finite(x, i)) &&
           are_finite(x + i, all - i);
}

int dm_lattice_is_finite(const dm_lattice *l, uint32_t first) {
    const double *x = l->space + (size_t)first * l->pitch;
    for (uint32_t c = 0; c < l->block; c++)
        if (!is_finite(l, x + (size_t)c * l->pitch)) return 0;
    return 1;
}
