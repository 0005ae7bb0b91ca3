/* mass_lanes_text.h - pivots of d2L/dv2 and quiet looks for W members; a text for the files of
 * mass_lanes.h. */
#ifndef DM_MASS_LANES_TEXT_H
#define DM_MASS_LANES_TEXT_H

#include "linalg/pivots_text.h"
#include "run/inertia/mass_lanes.h"
#include "run/inertia/urgent_text.h"

#include <string.h>

/* A = the mass, scaled: its lower triangle */
INLINE void scale_mass(double *A, const double *M, const double *scale, uint32_t n) {
#pragma GCC unroll 4
    for (uint32_t i = 0; i < n; i++)
#pragma GCC unroll 4
        for (uint32_t j = 0; j <= i; j++, M += W)
            store(A + (i * n + j) * (size_t)W, load(scale + i * W) * load(M) * load(scale + j * W));
}

/* Block b of n rows, whose M lies there. */
INLINE uint32_t find_with_rows(const dm_mass_lanes *w, uint32_t b, uint32_t n, const double *M,
                               const double *scale, double far, uint32_t asked) {
    V small[PIVOTS_WRITTEN_OUT * PIVOTS_WRITTEN_OUT], least, all;
    double *A = n <= PIVOTS_WRITTEN_OUT ? (double *)small : w->A;
    scale_mass(A, M, scale, n);
    const I fine = find_pivots(A, n, far, mask_of(asked), &least, &all);
    store(w->least + b * W, least);
    store(w->all + b * W, all);
    return bits_of(fine);
}

INLINE uint32_t find_pivots_of_block(const dm_mass_lanes *w, uint32_t b, uint32_t n,
                                     const double *M, const double *scale, double far,
                                     uint32_t asked) {
    switch (n) {
    case 1:
        return find_with_rows(w, b, 1, M, scale, far, asked);
    case 2:
        return find_with_rows(w, b, 2, M, scale, far, asked);
    case 3:
        return find_with_rows(w, b, 3, M, scale, far, asked);
    case 4:
        return find_with_rows(w, b, 4, M, scale, far, asked);
    default:
        return find_with_rows(w, b, n, M, scale, far, asked);
    }
}

INLINE uint32_t find_pivots_of_mass(const dm_mass_lanes *w, const double *scale, double far,
                                    uint32_t asked) {
    const double *M = w->M;
    for (uint32_t b = 0; b < w->blocks.count && asked; b++) {
        const uint32_t n = dm_block_size(&w->blocks, b);
        asked = find_pivots_of_block(w, b, n, M, scale, far, asked);
        M += (size_t)n * (n + 1) / 2 * W, scale += n * (size_t)W;
    }
    return asked;
}

/* The lanes in which nothing comes of what is found of block b, whose last look is c, but the next
 * one. */
INLINE I is_quiet(const course *c, const move *w, const dm_mass_found *f, uint32_t b) {
    const I one = WHERE(w->since == same(1.0));
    I line = sees_line((kind){0}, c, w);
    if (f->between) {
        const V half = same(DM_INERTIA_VALLEY), between = load(f->between + b * W);
        const V most = larger_of(w->was, w->is), least = lesser(w->was, w->is);
        const I level = WHERE(between >= half * most) & WHERE(half * between <= least) &
                        WHERE(most <= same(DM_INERTIA_THROWN) * least);
        line &= not_of(w->whole & level);
    }
    const I turns = one & (jumps(w) | WHERE(c->left <= same(NEAR)));
    const V part = same(DM_INERTIA_PART);
    const I strange = not_of(one) & (WHERE(w->is < part * w->was) | WHERE(w->was < part * w->is));
    return not_of(line | turns | strange | has_grown(c->ones, load(f->all + b * W)));
}

/* steps since the last look; none where that has no meaning */
INLINE V steps_since(const dm_inertia_seen *seen, long done, uint32_t asked) {
    _Alignas(8 * W) double steps[W];
#pragma GCC unroll 8
    for (uint32_t l = 0; l < W; l++) {
        const int known = (asked >> l & 1) && seen[l].negative == 0;
        steps[l] = known ? (double)(done - seen[l].looked) : 0.0;
    }
    return load(steps);
}

/* what block b of a lane becomes */
INLINE void store_noted(const course *c, const dm_mass_found *f, uint32_t b, uint32_t lane) {
    double *first = (double *)(void *)f->course + lane * f->apart;
    store_course((dm_inertia_course *)(void *)first + b, c, lane);
}

/* Lanes that are not asked may hold anything. */
INLINE uint32_t look_quietly(const dm_mass_lanes *w, dm_inertia_seen *seen, const dm_mass_found *f,
                             long done, uint32_t asked) {
    const V since = steps_since(seen, done, asked);
    const uint32_t count = w->blocks.count;
    urgent u = none_urgent();
    course c;
    asked &= bits_of(WHERE(since > same(0.0)));
    for (uint32_t b = 0; b < count; b++) {
        const V least = load(f->least + b * W), all = load(f->all + b * W);
        c = load_course(f->course + b, f->apart);
        const move m = move_since((kind){0}, &c, least, all, since);
        asked &= bits_of(is_quiet(&c, &m, f, b));
        if (!asked) return 0;
        note((kind){0}, &c, least, all, &m);
        take_urgent(&u, &c);
        if (count > 1) memcpy(w->noted + b * sizeof c / sizeof(double), &c, sizeof c);
    }
    for (uint32_t b = 0; b < count; b++) {
        if (count > 1) memcpy(&c, w->noted + b * sizeof c / sizeof(double), sizeof c);
#pragma GCC unroll 8
        for (uint32_t l = 0; l < W; l++)
            if (asked >> l & 1) store_noted(&c, f, b, l);
    }
#pragma GCC unroll 8
    for (uint32_t l = 0; l < W; l++)
        if (asked >> l & 1) store_urgent((kind){0}, seen + l, &u, l, done, f->t[l]);
    return asked;
}

#endif
