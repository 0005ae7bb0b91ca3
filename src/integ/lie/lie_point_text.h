/* lie_point_text.h - what the points of a step give the equation of lie.h and its matrix, for W
 * members; a text, see lie_text.h. */
#ifndef DM_LIE_POINT_TEXT_H
#define DM_LIE_POINT_TEXT_H

#include "integ/lie/lie_inside.h"
#include "numbers/lanes_text.h"

/* count numbers of every lane */
INLINE void clear(double *x, size_t count) {
    for (size_t k = 0; k < count; k++) store(x + k * W, (V){0});
}

INLINE void copy_lanes(double *to, const double *from, size_t count) {
    for (size_t k = 0; k < count; k++) store(to + k * W, load(from + k * W));
}

/* *x += y */
INLINE void add_to(double *x, V y) {
    store(x, load(x) + y);
}

/* out[d] = factor sum_j a_j V_j */
INLINE void combine(double *out, const dm_lie *e, const double *a, V factor,
                    const double *velocities) {
    const uint32_t d = e->d;
    for (uint32_t k = 0; k < d; k++) {
        V sum = {0};
        for (uint32_t j = 0; j < e->s; j++)
            sum += factor * a[j] * load(velocities + (j * d + k) * W);
        store(out + k * W, sum);
    }
}

/* Of few bits (numbers/weight.h): 1/40, the double, has products with a mean, and J drifts. What L
 * is then evaluated at is off by round-off alike in all derivatives; the step stays variational. */
INLINE V place_of(V x) {
    const V wide = (0x1p6 + 1.0) * x;
    return wide - (wide - x);
}

/* xi and its rate at point i, behind g0 */
INLINE void place_point(const dm_lie *e, uint32_t i, const double *velocities) {
    const V h = load(e->h);
    double *xi = e->x + e->n * W, *t = xi + 2 * e->d * W;
    combine(xi, e, e->a + i * e->s, h, velocities);
    combine(xi + e->d * W, e, e->D + i * e->s, same(1.0), velocities);
    store(t, e->t + e->c[i] * h);
    if (e->s == 1) store(t + W, place_of(h * e->a[i]));
}

/* of a straight curve: R += b dL/dV, P += h b L_e */
INLINE void add_line(const dm_lie *e, double *R, uint32_t i, const double *y) {
    const V hb = load(e->h) * e->b[i];
    for (uint32_t k = 0; k < e->d; k++) {
        const V term = e->b[i] * load(y + (e->d + k) * W);
        add_to(e->gain + k * W, hb * load(y + k * W));
        add_to(R + k * W, term);
        add_to(e->sizes + k * W, magnitude(term));
    }
}

/* derivatives of what it adds */
INLINE void add_line_curve(const dm_lie *e, double *J, uint32_t i) {
    const uint32_t d = e->d;
    const double *rows = e->curve + 2 * (size_t)d * W;
    const V hb = load(e->h) * e->b[i];
    for (uint32_t k = 0; k < d * d; k++) {
        add_to(e->mu_V + k * W, hb * load(rows + k * W));
        add_to(J + k * W, e->b[i] * load(rows + (d * d + k) * W));
    }
}

/* R += b [h a_j L_xi + d_j L_rate], P += h b L_e; the size of the terms in sizes */
INLINE void add_slopes(const dm_lie *e, double *R, uint32_t i, const double *y) {
    const uint32_t d = e->d;
    const double b = e->b[i];
    const V hb = load(e->h) * b;
    for (uint32_t k = 0; k < d; k++) add_to(e->gain + k * W, hb * load(y + k * W));
    for (uint32_t j = 0; j < e->s; j++) {
        const V of_xi = hb * e->a[i * e->s + j];
        const double of_rate = b * e->D[i * e->s + j];
        for (uint32_t k = 0; k < d; k++) {
            const V one = of_xi * load(y + (d + k) * W);
            const V other = of_rate * load(y + (2 * d + k) * W);
            add_to(R + (j * d + k) * W, one + other);
            add_to(e->sizes + (j * d + k) * W, magnitude(one) + magnitude(other));
        }
    }
}

/* rows of `slopes` beginning at `row`, derivatives in V_j, times f, into J[rows..][j d ..] */
INLINE void add_block(const dm_lie *e, double *J, const double *rows, V f, uint32_t i, uint32_t j) {
    const uint32_t d = e->d, m = e->m;
    const V of_xi = f * load(e->h) * e->a[i * e->s + j], of_rate = f * e->D[i * e->s + j];
    for (uint32_t k = 0; k < d; k++)
        for (uint32_t l = 0; l < d; l++)
            add_to(J + (k * m + j * d + l) * W, of_xi * load(rows + (k * 2 * d + l) * W) +
                                                    of_rate * load(rows + (k * 2 * d + d + l) * W));
}

/* derivatives of what add_slopes adds */
INLINE void add_curves(const dm_lie *e, double *J, uint32_t i) {
    const uint32_t d = e->d;
    const size_t block = 2 * (size_t)d * d * W;
    const double *rows = e->curve + 3 * d * W;
    const V b = same(e->b[i]), hb = load(e->h) * b;
    for (uint32_t j = 0; j < e->s; j++) {
        add_block(e, e->mu_V, rows, hb, i, j);
        for (uint32_t k = 0; k < e->s; k++) {
            double *row = J + (size_t)k * d * e->m * W;
            add_block(e, row, rows + block, hb * e->a[i * e->s + k], i, j);
            add_block(e, row, rows + 2 * block, b * e->D[i * e->s + k], i, j);
        }
    }
}

/* values of a map, with their derivatives into `whole` where that is not NULL */
INLINE const double *eval_map(const dm_lie *e, const dm_group_map *f, const double *in,
                              double *plain, double *whole) {
    if (whole)
        dm_group_map_eval(f, in, whole, W, e->room);
    else
        dm_kernel_eval(&f->plain, in, plain);
    return whole ? whole : plain;
}

/* what a point gives the equation, y where it was evaluated */
INLINE void add_point(const dm_lie *e, double *R, double *J, uint32_t i, const double *y) {
    if (e->s == 1) {
        add_line(e, R, i, y);
        if (J) add_line_curve(e, J, i);
        return;
    }
    add_slopes(e, R, i, y);
    if (J) add_curves(e, J, i);
}

#endif
