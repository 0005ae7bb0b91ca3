/* lift_gauge.c - p of a collective lift, of which only J(q, p) = X(q)^T p stands for something:
 * the least one with a momentum, and the way there. */
#include "integ/method/lift_inside.h"

#include "linalg/lu.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

static const double LARGE = 8.0; /* |p|^2 over the least one that is regauged */

static double square(const double *x, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) sum += x[i] * x[i];
    return sum;
}

static uint32_t *pivots(const dm_lift *l) {
    return (uint32_t *)(void *)(l->gram + (size_t)l->d * l->d + l->d);
}

/* the factors of X^T X at q */
static dm_status factor(dm_lift *l, const double *q) {
    const size_t n = l->n, d = l->d;
    double *A = l->gram;
    memcpy(l->in, q, n * sizeof *q);
    dm_kernel_eval(&l->group->directions, l->in, l->X);
    memset(A, 0, d * d * sizeof *A);
    for (size_t i = 0; i < n; i++)
        for (size_t a = 0; a < d; a++)
            for (size_t b = 0; b < d; b++) A[a * d + b] += l->X[i * d + a] * l->X[i * d + b];
    return dm_lu_factor(A, pivots(l), l->d);
}

/* out = X (X^T X)^-1 mu */
static void spread(dm_lift *l, double *out, const double *mu) {
    const size_t n = l->n, d = l->d;
    double *x = l->gram + d * d;
    memcpy(x, mu, d * sizeof *x);
    dm_lu_solve(x, l->gram, pivots(l), l->d);
    for (size_t i = 0; i < n; i++) {
        double sum = 0.0;
        for (size_t a = 0; a < d; a++) sum += l->X[i * d + a] * x[a];
        out[i] = sum;
    }
}

dm_status dm_lift_momentum(dm_lift *l, const double *q, const double *mu) {
    const size_t n = l->n;
    const dm_status status = factor(l, q);
    if (status != DM_OK) return status;
    spread(l, l->lifted + n, mu);
    memset(l->lifted + 3 * n, 0, n * sizeof *l->lifted);
    l->memory[DM_LIFT_BOUND] = LARGE * square(l->lifted + n, n);
    l->memory[DM_LIFT_SINCE] = 0.0;
    return DM_OK;
}

/* ---- the way there, to twice the digits ---- */

/* high + low += x, whichever is larger (Knuth's sum) */
static void add(double *high, double *low, double x) {
    const double sum = *high + x, back = sum - *high;
    *low += (*high - (sum - back)) + (x - back);
    *high = sum;
}

/* high + low += a b: the product to twice the digits by halves of 26 bits (Dekker 1971), which is
 * the same with and without fused products */
static void add_product(double *high, double *low, double a, double b) {
    const double SPLIT = 134217729.0; /* 2^27 + 1 */
    const double ca = SPLIT * a, cb = SPLIT * b, product = a * b;
    const double a1 = ca - (ca - a), b1 = cb - (cb - b), a2 = a - a1, b2 = b - b1;
    *low += ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2;
    add(high, low, product);
}

/* `near` = X^T of the low part of q, by a difference of directions far enough from q */
static void find_near(dm_lift *l, double *near) {
    const double FAR = 67108864.0; /* 2^26: half of the digits */
    const size_t n = l->n, d = l->d;
    for (size_t i = 0; i < n; i++) l->in[i] = l->lifted[i] + FAR * l->lifted[2 * n + i];
    dm_kernel_eval(&l->group->directions, l->in, near);
    for (size_t k = 0; k < n * d; k++) near[k] = (near[k] - l->X[k]) / FAR;
}

/* out = (X + near)^T change */
static void moved(const dm_lift *l, double *out, const double *near, const double *change) {
    const size_t n = l->n, d = l->d;
    for (size_t a = 0; a < d; a++) {
        double high = 0.0, low = 0.0;
        for (size_t i = 0; i < n; i++) {
            add_product(&high, &low, l->X[i * d + a], change[i]);
            low += near[i * d + a] * change[i];
        }
        out[a] = high + low;
    }
}

/* What p has beside the least one with its momentum moves nothing on the group, but grows, and J
 * loses digits by it: it is taken away where |p|^2 is LARGE times that of the least one. Much of it
 * in few steps: later. What is taken away has no momentum to twice the digits: its rounding is the
 * same every time, and J drifted by 2e-18 a step of SE(3). */
dm_status dm_lift_regauge(dm_lift *l) {
    enum { FEW = 16 };
    const size_t n = l->n, d = l->d;
    double *p = l->lifted + n, *low = l->lifted + 3 * n, beside = 0.0;
    double *near = l->gauge, *change = near + n * d, *rest = change + n;
    l->memory[DM_LIFT_SINCE] += 1.0;
    if (square(p, n) <= l->memory[DM_LIFT_BOUND]) return DM_OK;
    memcpy(l->in, l->lifted, 2 * n * sizeof *p);
    dm_kernel_eval(&l->group->momentum, l->in, l->J);
    const dm_status status = factor(l, l->lifted);
    if (status != DM_OK) return status;
    spread(l, change, l->J);
    for (size_t i = 0; i < n; i++) change[i] -= p[i];
    find_near(l, near);
    moved(l, l->J, near, change);
    spread(l, rest, l->J);
    for (size_t i = 0; i < n; i++) {
        beside += change[i] * change[i];
        add(p + i, low + i, change[i]);
        dm_sum_add(p + i, low + i, -rest[i]);
    }
    l->memory[DM_LIFT_BOUND] =
        LARGE * square(p, n) + (l->memory[DM_LIFT_SINCE] < FEW ? 64.0 * beside : 0.0);
    l->memory[DM_LIFT_SINCE] = 0.0;
    return DM_OK;
}
