/* lie_text.h - the step equation of lie.h and its exact matrix for W members, unknown velocities
 * V[s][d][W]; a text for files that have numbers/lanes_text.h, which for one member is
 * lie_equation.c. */
#ifndef DM_LIE_TEXT_H
#define DM_LIE_TEXT_H

#include "integ/lie/lie_point_text.h"

/* b = dtau_R(xi1)^T mu, and where they are asked for its derivatives */
INLINE const double *pull_end(const dm_lie *e, const double *velocities, int with_curve) {
    combine(e->xi, e, e->beta, load(e->h), velocities);
    copy_lanes(e->in, e->xi, e->d);
    copy_lanes(e->in + e->d * W, e->mu, e->d);
    return eval_map(e, &e->group->pull, e->in, e->pulled, with_curve ? e->pull : NULL);
}

/* R -= beta_j b */
INLINE void subtract_end(const dm_lie *e, double *R, const double *pulled) {
    for (uint32_t j = 0; j < e->s; j++)
        for (uint32_t k = 0; k < e->d; k++) {
            const V term = e->beta[j] * load(pulled + k * W);
            add_to(R + (j * e->d + k) * W, -term);
            add_to(e->sizes + (j * e->d + k) * W, magnitude(term));
        }
}

/* Which entries of mu see V in some lane, and in which; none of the group does where L does not see
 * g. */
INLINE uint32_t find_seeing(const dm_lie *e) {
    uint32_t count = 0;
    for (uint32_t l = 0; l < e->d; l++) {
        const double *row = e->mu_V + (size_t)l * e->m * W;
        I sees = mask_of(0);
        for (uint32_t c = 0; c < e->m; c++) {
            sees |= WHERE(load(row + c * W) != (V){0});
            if (W == 1 && some(sees)) break;
        }
        if (!some(sees)) continue;
        store(e->sees + count * W, pick(sees, same(1.0), (V){0}));
        e->seeing[count++] = l;
    }
    return count;
}

/* Row k of b by all V, into row[m]: through xi1, and through the entries of mu that see V. */
INLINE void find_row_of_end(const dm_lie *e, uint32_t k, uint32_t count) {
    const uint32_t d = e->d, m = e->m;
    const double *in_xi = e->pull + (d + k * 2 * d) * W, *in_mu = in_xi + d * W;
    for (uint32_t j = 0; j < e->s; j++)
        for (uint32_t i = 0; i < d; i++)
            store(e->row + (j * d + i) * W, load(e->h) * e->beta[j] * load(in_xi + i * W));
    for (uint32_t l = 0; l < count; l++) {
        const I sees = WHERE(load(e->sees + l * W) != (V){0});
        const V weight = load(in_mu + e->seeing[l] * W);
        const double *row = e->mu_V + (size_t)e->seeing[l] * m * W;
        for (uint32_t c = 0; c < m; c++) {
            const V x = load(e->row + c * W);
            store(e->row + c * W, pick_some(sees, x + weight * load(row + c * W), x));
        }
    }
}

/* its derivatives, through xi1 and mu */
INLINE void subtract_end_curves(const dm_lie *e, double *J) {
    const uint32_t d = e->d, m = e->m, count = find_seeing(e);
    for (uint32_t k = 0; k < d; k++) {
        find_row_of_end(e, k, count);
        for (uint32_t j = 0; j < e->s; j++) {
            double *to = J + (size_t)(j * d + k) * m * W;
            for (uint32_t c = 0; c < m; c++)
                add_to(to + c * W, -(e->beta[j] * load(e->row + c * W)));
        }
    }
}

/* p0 + P, with the low part of p0: without it what a step leaves out of the turn of p has a mean */
INLINE V find_momentum(const dm_lie *e, uint32_t k) {
    const V p = load(e->state + (e->n + k) * W), gain = load(e->gain + k * W);
    if (e->last != &e->group->change) return p + gain;
    return p + (load(e->state + (3 * e->n + k) * W) + gain);
}

INLINE void find_momenta(const dm_lie *e, uint32_t d) {
    for (uint32_t k = 0; k < d; k++) store(e->mu + k * W, find_momentum(e, k));
}

/* That of one velocity and one point where L does not see g; d of *e, a constant where it is
 * known. */
INLINE V find_free_equation(const dm_lie *e, uint32_t d, double *R, double *J,
                            const double *velocities) {
    const V h = load(e->h);
    const double *b = e->pull + d * W;
    double *last = e->in + 2 * d * W;
    V largest = {0};
    clear(e->gain, d);
    find_momenta(e, d);
    copy_lanes(e->in, velocities, d);
    copy_lanes(e->in + d * W, e->mu, d);
    store(last, e->t + e->c[0] * h);
    store(last + W, place_of(h * e->a[0]));
    store(last + 2 * W, h);
    dm_kernel_eval(J ? &e->group->free_matrix : &e->group->free, e->in, e->pull);
    copy_lanes(R, e->pull, d);
    if (J) copy_lanes(J, e->pull + 2 * d * W, d * d);
    for (uint32_t k = 0; k < d; k++) largest = larger_of(magnitude(load(b + k * W)), largest);
    return 2.0 * largest;
}

/* R[m] at V[m], unless J is NULL the matrix J[m*m], and P and p0 + P; the size of the largest
 * term. */
INLINE V find_equation(const dm_lie *e, double *R, double *J, const double *velocities) {
    const uint32_t d = e->d, m = e->m;
    V largest = {0};
    if (e->is_free) return find_free_equation(e, d, R, J, velocities);
    clear(R, m);
    clear(e->sizes, m);
    clear(e->gain, d);
    if (J) clear(J, (size_t)m * m);
    if (J) clear(e->mu_V, (size_t)d * m);
    for (uint32_t i = 0; i < e->r; i++) {
        place_point(e, i, velocities);
        add_point(e, R, J, i, eval_map(e, e->at, e->x, e->slope, J ? e->curve : NULL));
    }
    find_momenta(e, d);
    subtract_end(e, R, pull_end(e, velocities, J != NULL));
    if (J) subtract_end_curves(e, J);
    for (uint32_t k = 0; k < m; k++) largest = larger_of(load(e->sizes + k * W), largest);
    return largest;
}

#endif
