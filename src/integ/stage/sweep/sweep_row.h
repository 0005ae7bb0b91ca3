/* sweep_row.h - the functions of a dm_sweep_row, once for every width and kind of processor.
 * Wanted: ROW (name), W (width), V (vector of W doubles), H (of W/2, for sums over lanes), HOW
 * (target of the functions), TOTALS(x, y): the sums over lanes of two vectors H, FINISH and COPY
 * where the end of a step is done in another way, MADD(a, b, c): a b + c, with one rounding where
 * the processor has it, LESSER(a, b): the lesser entries of two vectors H, b where one is NaN.
 * FOUR_TOTALS(a, b, c, d), if there is one: the sums
 * over lanes of four vectors V, for the end of a step of four rows at once. */
#define JOINED(a, b) a##_##b
#define JOIN(a, b) JOINED(a, b)
#define OWN(name) JOIN(name, ROW)
#define INLINE static inline __attribute__((always_inline))

#define BITS JOIN(bits, ROW)
typedef long long BITS __attribute__((vector_size(8 * W)));
#define HALF_BITS JOIN(half_bits, ROW)
typedef long long HALF_BITS __attribute__((vector_size(4 * W)));
#define LOAD(x) (*(const V *)(const void *)(x))
#define SAME(x) ((x) - (V){0})

/* sum over the lanes of a vector H, pairwise */
HOW INLINE double OWN(total)(const double *x) {
    return W == 8 ? (x[0] + x[2]) + (x[1] + x[3]) : x[0] + x[1];
}

/* sum_m c_m u_m, on to a base unless that is NULL; even and odd columns are summed apart, as
 * neither waits for the other */
HOW INLINE void OWN(inner)(V *sum, const V *base, const V *c, const double *u, uint32_t columns) {
    V even = c[0] * u[0], odd = c[1] * u[1];
    if (base) even = MADD(c[0], SAME(u[0]), *base);
    if (columns > 2) even = MADD(c[2], SAME(u[2]), even);
    if (columns > 3) odd = MADD(c[3], SAME(u[3]), odd);
    if (columns > 4) even = MADD(c[4], SAME(u[4]), even);
    if (columns > 5) odd = MADD(c[5], SAME(u[5]), odd);
    if (columns > 6) even = MADD(c[6], SAME(u[6]), even);
    if (columns > 7) odd = MADD(c[7], SAME(u[7]), odd);
    *sum = even + odd;
}

/* columns and measured are constants where this is called, so that everything unrolls; measured: 2
 * by units */
HOW INLINE double OWN(walk)(const dm_sweep *a, uint32_t columns, int measured) {
    const dm_sweep at = *a; /* nothing of it changes by what is written */
    const V *from = (const V *)(const void *)at.column;
    V moved = {0}, c[8] = {from[0], from[1]};
    if (columns > 2) c[2] = from[2];
    if (columns > 3) c[3] = from[3];
    if (columns > 4) c[4] = from[4];
    if (columns > 5) c[5] = from[5];
    if (columns > 6) c[6] = from[6];
    if (columns > 7) c[7] = from[7];
    for (uint32_t k = 0; k < at.rows; k++) {
        const size_t row = (size_t)k * W;
        const V base = LOAD(at.base + row);
        V *x = (V *)(void *)(at.x + row), sum;
        OWN(inner)(&sum, at.factor ? NULL : &base, c, at.u + row, columns);
        if (at.factor) sum = MADD(SAME(at.factor[k]), sum, base);
        sum = at.start[k] + sum;
        if (measured) {
            const V d = sum - *x, counts = d * (measured > 1 ? at.unit[k] : 1.0);
            moved = MADD(counts, d, moved);
        }
        *x = sum;
    }
    const H *half = (const H *)(const void *)&moved, sum = half[0] + half[1];
    return measured ? OWN(total)((const double *)&sum) : 0.0;
}

/* the half with the last stage in it is enough; what is zero is no number, and not the least */
HOW INLINE double OWN(walk_first)(const dm_sweep *a, uint32_t columns, double *own, double *least) {
    enum { HALF = W / 2 };
    const dm_sweep at = *a;
    const uint32_t last = columns - 1, lane = last % HALF;
    const V *from = (const V *)(const void *)at.column;
    H size = {0}, smallest = INFINITY - (H){0};
    V c[8];
    for (uint32_t m = 0; m < columns; m++) c[m] = from[m];
    for (uint32_t k = 0; k < at.rows; k++) {
        const size_t row = (size_t)k * W;
        const V base = LOAD(at.base + row), start = SAME(at.start[k]);
        V sum;
        OWN(inner)(&sum, at.factor ? NULL : &base, c, at.u + row, columns);
        if (at.factor) sum = MADD(SAME(at.factor[k]), sum, base);
        sum = start + sum;
        const H x = ((const H *)(const void *)&sum)[last / HALF];
        const H from_here = ((const H *)(const void *)&start)[0];
        const H squares = from_here * from_here + x * x;
        const H counts = (H)((HALF_BITS)squares | (HALF_BITS)(squares == (H){0}));
        own[k] = squares[lane];
        size += squares;
        smallest = LESSER(counts, smallest);
        *(V *)(void *)(at.x + row) = sum;
    }
    *least = smallest[lane];
    return size[lane];
}

HOW INLINE double OWN(choose)(const dm_sweep *a, int measured) {
    if (a->columns == W) return OWN(walk)(a, W, measured);
    if (a->columns == W - 1) return OWN(walk)(a, W - 1, measured);
    if (a->columns == W - 2) return OWN(walk)(a, W - 2, measured);
    return OWN(walk)(a, W == 8 ? W - 3 : 2, measured);
}

HOW static void OWN(put)(const dm_sweep *a) {
    OWN(choose)(a, 0);
}

HOW static double OWN(set)(const dm_sweep *a, double *own, double *least) {
    if (a->columns == W) return OWN(walk_first)(a, W, own, least);
    if (a->columns == W - 1) return OWN(walk_first)(a, W - 1, own, least);
    if (a->columns == W - 2) return OWN(walk_first)(a, W - 2, own, least);
    return OWN(walk_first)(a, W == 8 ? W - 3 : 2, own, least);
}

HOW static double OWN(move)(const dm_sweep *a) {
    return a->unit ? OWN(choose)(a, 2) : OWN(choose)(a, 1);
}

/* two roundings also where one would do: by a decimal step, as h v / 2 of lobatto(3), it has a
 * mean, and J drifts */
HOW static void OWN(line)(double *base, const double *low, const double *v, const dm_parts *c,
                          uint32_t rows) {
    const V top = LOAD(c->top), rest = LOAD(c->rest);
    for (uint32_t k = 0; k < rows; k++) {
        const V x = SAME(v[k]);
        *(V *)(void *)(base + (size_t)k * W) = top * x + (rest * x + SAME(low[k]));
    }
}

#include "integ/stage/sweep/sweep_end_row.h"

#ifndef COPY
#define COPY copy_state
#endif

static const dm_sweep_row ROW = {W, OWN(put), OWN(set), OWN(move), OWN(line), FINISH, COPY};

#undef INLINE
#undef LOAD
#undef BITS
#undef SAME
#undef OWN
#undef JOIN
#undef JOINED
#undef ROW
#undef W
#undef V
#undef H
#undef HOW
#undef MADD
#undef LESSER
#undef HALF_BITS
#undef TOTALS
#undef FINISH
#undef FOUR_TOTALS
#undef COPY
