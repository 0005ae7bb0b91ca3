/* lie_joints_turning.c - reactions that turn with v (nonlinear phi, or a given E(g, xi)). At the
 * inner constraint points v is that of the momentum there, which what w is the sum of gives by
 * interpolation, P~_k = Ad*_tau(xi_k) (p0 + h sum_i a^_ki L_e(i) + sum_m (a^_km / w_m) I_e(m)), as
 * in constrained/constrained_turning.c. */
#include "integ/lie/lie_joints_inside.h"

#include <math.h>
#include <string.h>

/* Between the ends, and only where E sees v. */
int dm_lie_joints_turn(const dm_lie_joints *e) {
    return e->K > 1 && e->joints->turns;
}

/* rates of the curve */
void dm_lie_joints_turning_guess(dm_lie_joints *e) {
    for (uint32_t k = 1; k < e->K && dm_lie_joints_turn(e); k++)
        for (uint32_t i = 0; i < e->d; i++) {
            double *v = e->v + k * e->n;
            v[i] = 0.0;
            for (uint32_t j = 0; j < e->s; j++)
                v[i] += e->nodes.d[k * e->s + j] * e->z[j * e->d + i];
        }
}

/* place and momentum at an inner constraint point into out[n + d + arcs] */
static void inner_state(dm_lie_joints *e, double *out, uint32_t k) {
    const uint32_t d = e->d, r = e->at.count;
    const double *force = e->inner_force + (k - 1) * r;
    const double *impulse = e->inner_impulse + (k - 1) * (e->K + 1);
    double *p = e->w;
    memcpy(p, e->state + e->n, d * sizeof *p);
    for (uint32_t i = 0; i < r; i++)
        for (uint32_t j = 0; j < d; j++) p[j] += e->h * force[i] * e->of_e[i * d + j];
    for (uint32_t m = 0; m <= e->K; m++)
        for (uint32_t j = 0; j < d; j++) p[j] += impulse[m] * e->of_e[(r + m) * d + j];
    memset(e->xi, 0, d * sizeof *e->xi);
    for (uint32_t j = 0; j < e->s; j++)
        for (uint32_t i = 0; i < d; i++)
            e->xi[i] += e->h * e->nodes.a[k * e->s + j] * e->z[j * d + i];
    dm_lie_joints_carry(e, out, e->xi, p, 1.0);
}

/* I_K carried back to g0, which w is about */
static void keep_last(dm_lie_joints *e, double *out) {
    const double *last = e->reaction + e->k;
    memcpy(e->w, last, e->d * sizeof *last);
    dm_lie_joints_carry(e, out, e->xi, e->w, -1.0);
    memcpy(e->of_e + (e->at.count + e->K) * e->d, out + e->n, e->d * sizeof *out);
}

/* new velocities; the largest change of an entry, relative to the largest */
static dm_status renew(dm_lie_joints *e, double *change) {
    const uint32_t n = e->n, d = e->d;
    double most = 0.0, size = 0.0, *p = e->work + dm_legendre_work(e->model), *old = p + n;
    keep_last(e, e->end);
    for (uint32_t k = 1; k < e->K; k++) {
        double *v = e->v + k * n;
        inner_state(e, e->end, k);
        memset(p, 0, n * sizeof *p);
        memcpy(p, e->end + n, d * sizeof *p);
        memcpy(old, v, d * sizeof *v);
        memset(v + d, 0, (n - d) * sizeof *v);
        const double t = e->t + e->nodes.c[k] * e->h;
        const dm_status status = dm_legendre_inverse(e->model, v, e->end, p, t, e->work);
        if (status != DM_OK) return status;
        for (uint32_t j = 0; j < d; j++) {
            most = fmax(most, fabs(v[j] - old[j]));
            size = fmax(size, fabs(v[j]));
        }
    }
    *change = size > 0.0 ? most / size : most;
    return DM_OK;
}

/* Every round solves the equation again with the velocities of the last; they are settled when a
 * round changes them by round-off, or changes that small stop shrinking. */
dm_status dm_lie_joints_turning_end(dm_lie_joints *e, const dm_stepper *s) {
    enum { SWEEPS = 60 };
    static const double NOISE = 1e-13; /* a change that small may stall */
    double change = INFINITY;
    for (int k = 0; k < SWEEPS; k++) {
        const double last = change;
        dm_newton_report report = {0};
        dm_status status = renew(e, &change);
        if (status != DM_OK) return status;
        status = dm_lie_joints_newton(e, s, &report);
        if (status == DM_OK) status = dm_lie_joints_finish(e, s);
        if (status != DM_OK) return status;
        if (change <= s->tolerance || (change >= last && change < NOISE)) return DM_OK;
    }
    e->residual = change * e->mass;
    return DM_NO_CONVERGENCE;
}
