/* lie_equation.c - the step equation of lie.h and its exact matrix. */
#include "integ/lie/lie_inside.h"

#include <math.h>
#include <string.h>

/* out[d] = h sum_j a_j V_j */
static void combine(double *out, const dm_lie *e, const double *a, double factor, const double *V) {
    memset(out, 0, e->d * sizeof *out);
    for (uint32_t j = 0; j < e->s; j++)
        for (uint32_t k = 0; k < e->d; k++) out[k] += factor * a[j] * V[j * e->d + k];
}

/* xi and its rate at point i, behind g0 */
static void place_point(dm_lie *e, uint32_t i, const double *V) {
    double *xi = e->x + e->n;
    combine(xi, e, e->a + i * e->s, e->h, V);
    combine(xi + e->d, e, e->D + i * e->s, 1.0, V);
    e->x[e->n + 2 * e->d] = e->t + e->c[i] * e->h;
    if (e->s == 1) e->x[e->n + 2 * e->d + 1] = e->h * e->a[i];
}

/* of a straight curve: R += b dL/dV, P += h b L_e */
static void add_line(dm_lie *e, double *R, double *size, uint32_t i, const double *y) {
    for (uint32_t k = 0; k < e->d; k++) {
        const double term = e->b[i] * y[e->d + k];
        e->gain[k] += e->h * e->b[i] * y[k];
        R[k] += term;
        size[k] += fabs(term);
    }
}

/* derivatives of what it adds */
static void add_line_curve(dm_lie *e, double *J, uint32_t i) {
    const uint32_t d = e->d;
    const double *rows = e->curve + 2 * (size_t)d, b = e->b[i];
    for (uint32_t k = 0; k < d * d; k++) {
        e->mu_V[k] += e->h * b * rows[k];
        J[k] += b * rows[d * d + k];
    }
}

/* R += b [h a_j L_xi + d_j L_rate], P += h b L_e; the size of the terms in size[m] */
static void add_slopes(dm_lie *e, double *R, double *size, uint32_t i, const double *y) {
    const uint32_t d = e->d;
    const double b = e->b[i], hb = e->h * b;
    for (uint32_t k = 0; k < d; k++) e->gain[k] += hb * y[k];
    for (uint32_t j = 0; j < e->s; j++) {
        const double of_xi = hb * e->a[i * e->s + j], of_rate = b * e->D[i * e->s + j];
        for (uint32_t k = 0; k < d; k++) {
            const double one = of_xi * y[d + k], other = of_rate * y[2 * d + k];
            R[j * d + k] += one + other;
            size[j * d + k] += fabs(one) + fabs(other);
        }
    }
}

/* rows of `slopes` beginning at `row`, derivatives in V_j, times f, into J[rows..][j d ..] */
static void add_block(dm_lie *e, double *J, const double *rows, double f, uint32_t i, uint32_t j) {
    const uint32_t d = e->d, m = e->m;
    const double of_xi = f * e->h * e->a[i * e->s + j], of_rate = f * e->D[i * e->s + j];
    for (uint32_t k = 0; k < d; k++)
        for (uint32_t l = 0; l < d; l++)
            J[k * m + j * d + l] += of_xi * rows[k * 2 * d + l] + of_rate * rows[k * 2 * d + d + l];
}

/* derivatives of what add_slopes adds */
static void add_curves(dm_lie *e, double *J, uint32_t i) {
    const uint32_t d = e->d;
    const double *rows = e->curve + 3 * d, b = e->b[i], hb = e->h * b;
    for (uint32_t j = 0; j < e->s; j++) {
        add_block(e, e->mu_V, rows, hb, i, j);
        for (uint32_t k = 0; k < e->s; k++) {
            double *row = J + (size_t)k * d * e->m;
            add_block(e, row, rows + 2 * d * d, hb * e->a[i * e->s + k], i, j);
            add_block(e, row, rows + 4 * d * d, b * e->D[i * e->s + k], i, j);
        }
    }
}

/* what a point gives the equation */
static void add_point(dm_lie *e, double *R, double *J, double *size, uint32_t i) {
    const double *y = J ? e->curve : e->slope;
    if (e->s == 1) {
        add_line(e, R, size, i, y);
        if (J) add_line_curve(e, J, i);
        return;
    }
    add_slopes(e, R, size, i, y);
    if (J) add_curves(e, J, i);
}

/* b = dtau_R(xi1)^T mu, and where they are asked for its derivatives */
static const double *pull(dm_lie *e, const double *V, int with_curve) {
    combine(e->xi, e, e->beta, e->h, V);
    memcpy(e->in, e->xi, e->d * sizeof *e->in);
    memcpy(e->in + e->d, e->mu, e->d * sizeof *e->in);
    double *out = with_curve ? e->pull : e->pulled;
    dm_kernel_eval(with_curve ? &e->group->pull : &e->group->pulled, e->in, out);
    return out;
}

/* R -= beta_j b */
static void subtract_end(dm_lie *e, double *R, double *size, const double *pulled) {
    for (uint32_t j = 0; j < e->s; j++)
        for (uint32_t k = 0; k < e->d; k++) {
            R[j * e->d + k] -= e->beta[j] * pulled[k];
            size[j * e->d + k] += fabs(e->beta[j] * pulled[k]);
        }
}

/* Row k of b by all V, into out[m]: through xi1, and through the entries of mu that see V. */
static void row_of_end(const dm_lie *e, double *out, uint32_t k, const uint32_t *seeing,
                       uint32_t count) {
    const uint32_t d = e->d, m = e->m;
    const double *in_xi = e->pull + d + k * 2 * d, *in_mu = in_xi + d;
    for (uint32_t j = 0; j < e->s; j++)
        for (uint32_t i = 0; i < d; i++) out[j * d + i] = e->h * e->beta[j] * in_xi[i];
    for (uint32_t l = 0; l < count; l++) {
        const double weight = in_mu[seeing[l]], *row = e->mu_V + (size_t)seeing[l] * m;
        for (uint32_t c = 0; c < m; c++) out[c] += weight * row[c];
    }
}

/* Which entries of mu see V; none of the group does where L does not see g. */
static uint32_t find_seeing(const dm_lie *e, uint32_t *seeing) {
    uint32_t count = 0;
    for (uint32_t l = 0; l < e->d; l++) {
        const double *row = e->mu_V + (size_t)l * e->m;
        uint32_t c = 0;
        while (c < e->m && row[c] == 0.0) c++;
        if (c < e->m) seeing[count++] = l;
    }
    return count;
}

/* its derivatives, through xi1 and mu */
static void subtract_end_curves(dm_lie *e, double *J) {
    const uint32_t d = e->d, m = e->m, count = find_seeing(e, e->seeing);
    for (uint32_t k = 0; k < d; k++) {
        row_of_end(e, e->row, k, e->seeing, count);
        for (uint32_t j = 0; j < e->s; j++) {
            double *to = J + (size_t)(j * d + k) * m;
            for (uint32_t c = 0; c < m; c++) to[c] -= e->beta[j] * e->row[c];
        }
    }
}

static double largest(const double *x, uint32_t count) {
    double most = 0.0;
    for (uint32_t i = 0; i < count; i++) most = fmax(most, x[i]);
    return most;
}

dm_status dm_lie_equation(void *lie, double *R, double *J, const double *V) {
    dm_lie *e = lie;
    const uint32_t m = e->m;
    double *size = e->sizes;
    memset(R, 0, m * sizeof *R);
    memset(size, 0, m * sizeof *size);
    memset(e->gain, 0, e->d * sizeof *e->gain);
    if (J) memset(J, 0, (size_t)m * m * sizeof *J);
    if (J) memset(e->mu_V, 0, (size_t)e->d * m * sizeof *e->mu_V);
    for (uint32_t i = 0; i < e->r; i++) {
        place_point(e, i, V);
        dm_kernel_eval(J ? e->around : e->at, e->x, J ? e->curve : e->slope);
        add_point(e, R, J, size, i);
    }
    for (uint32_t k = 0; k < e->d; k++) e->mu[k] = e->state[e->n + k] + e->gain[k];
    subtract_end(e, R, size, pull(e, V, J != NULL));
    if (J) subtract_end_curves(e, J);
    e->size = largest(size, m);
    return DM_OK;
}
