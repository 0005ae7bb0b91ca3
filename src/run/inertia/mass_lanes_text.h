/* mass_lanes_text.h - pivots of d2L/dv2 and quiet looks for W members; a text for the files of
 * mass_lanes.h. */
#ifndef DM_MASS_LANES_TEXT_H
#define DM_MASS_LANES_TEXT_H

#include "linalg/pivots_text.h"
#include "run/inertia/course_text.h"
#include "run/inertia/mass_lanes.h"

/* A = the mass, scaled: its lower triangle */
INLINE void scale_mass(double *A, const double *M, const double *scale, uint32_t n) {
#pragma GCC unroll 4
    for (uint32_t i = 0; i < n; i++)
#pragma GCC unroll 4
        for (uint32_t j = 0; j <= i; j++, M += W)
            store(A + (i * n + j) * (size_t)W, load(scale + i * W) * load(M) * load(scale + j * W));
}

/* n is that of w */
INLINE uint32_t find_with_rows(const dm_mass_lanes *w, uint32_t n, const double *scale, double far,
                               uint32_t asked) {
    V small[PIVOTS_WRITTEN_OUT * PIVOTS_WRITTEN_OUT], least, all;
    double *A = n <= PIVOTS_WRITTEN_OUT ? (double *)small : w->A;
    scale_mass(A, w->M, scale, n);
    const I fine = find_pivots(A, n, far, mask_of(asked), &least, &all);
    store(w->least, least);
    store(w->all, all);
    return bits_of(fine);
}

INLINE uint32_t find_pivots_of_mass(const dm_mass_lanes *w, const double *scale, double far,
                                    uint32_t asked) {
    switch (w->n) {
    case 1:
        return find_with_rows(w, 1, scale, far, asked);
    case 2:
        return find_with_rows(w, 2, scale, far, asked);
    case 3:
        return find_with_rows(w, 3, scale, far, asked);
    case 4:
        return find_with_rows(w, 4, scale, far, asked);
    default:
        return find_with_rows(w, w->n, scale, far, asked);
    }
}

/* Lanes that are not asked may hold anything. */
INLINE uint32_t look_quietly(dm_inertia_seen *seen, const double *least, const double *all,
                             const double *between, const double *t, long done, uint32_t asked) {
    const kind k = {0};
    course c = load_course(seen);
    _Alignas(8 * W) double steps[W];
#pragma GCC unroll 8
    for (uint32_t l = 0; l < W; l++) {
        const int known = (asked >> l & 1) && seen[l].negative == 0;
        steps[l] = known ? (double)(done - seen[l].looked) : 0.0;
    }
    const V since = load(steps);
    const move w = move_since(k, &c, load(least), load(all), since);
    const I one = WHERE(since == same(1.0));
    I line = sees_line(k, &c, &w);
    if (between) {
        const V valley = same(DM_INERTIA_VALLEY) * larger_of(w.was, w.is);
        line &= not_of(w.whole & WHERE(load(between) >= valley));
    }
    const I turns = one & (jumps(&w) | WHERE(c.left <= same(NEAR)));
    const V part = same(DM_INERTIA_PART);
    const I strange = not_of(one) & (WHERE(w.is < part * w.was) | WHERE(w.was < part * w.is));
    const I quiet =
        WHERE(since > same(0.0)) & not_of(line | turns | strange | has_grown(c.ones, load(all)));
    const uint32_t out = asked & bits_of(quiet);
    if (!out) return 0;
    note(k, &c, load(least), load(all), &w);
    store_course(k, seen, &c, done, t, out);
    return out;
}

#endif
