/* constrained_turning.c - reactions that turn with v (nonlinear phi, or a given E(q, v)). At the
 * inner constraint points v is that of the momentum there, which the forces and all impulses up to
 * I_K give by interpolation, P~_k = p0 + h sum_i a^_ki (L_q + f)(i) + sum_m (a^_km / w_m) I_m,
 * L_v(Q~_k, v~_k) = P~_k (Jay 2009): the velocity of the curve is known to the order of the stages
 * only, and so would be the step. The equation is solved for given v~, again and again: they change
 * by a factor h a time. */
#include "integ/constrained/constrained_inside.h"
#include "linalg/solve/newton_limits.h"

#include <math.h>
#include <string.h>

/* Between the ends, and only where some entry of dI/dv can differ from zero. */
int dm_constrained_turns(const dm_constrained *g) {
    return g->K > 1 && g->r_v.count != 0;
}

/* v~ of the curve */
void dm_constrained_turning_guess(dm_constrained *g) {
    for (uint32_t k = 1; k < g->K && dm_constrained_turns(g); k++) {
        dm_constrained_at_constraint(g, g->root, k);
        memcpy(g->inner_v + (k - 1) * (size_t)g->n, g->v, g->n * sizeof *g->v);
    }
}

/* P~_k from the forces and impulses of the last end. */
static void inner_momentum(dm_constrained *g, double *p, uint32_t k) {
    const uint32_t n = g->n, r = g->table.r;
    const double *force = g->inner_force + (k - 1) * r;
    const double *impulse = g->inner_impulse + (k - 1) * (g->K + 1);
    memcpy(p, g->state + n, n * sizeof *p);
    for (uint32_t i = 0; i < r; i++)
        for (uint32_t j = 0; j < n; j++) p[j] += g->h * force[i] * g->slope[2 * i * n + j];
    for (uint32_t m = 0; m <= g->K; m++)
        for (uint32_t j = 0; j < n; j++) p[j] += impulse[m] * g->impulse[m * n + j];
}

/* what a round of new v~ changes: the largest entry, relative to the largest; of entries relative
 * to their own size the largest; and by how much that moves a place in a step, relative to the
 * largest coordinate */
typedef struct {
    double all, each, moves;
} turned;

/* new v~ */
static dm_status renew(dm_constrained *g, turned *change) {
    const uint32_t n = g->n;
    const double beside = DM_NEWTON_BESIDE / fabs(g->h);
    double most = 0.0, size = 0.0, each = 0.0, place = 0.0;
    for (uint32_t k = 1; k < g->K; k++) {
        double *v = g->inner_v + (k - 1) * (size_t)n;
        dm_constrained_at_constraint(g, g->root, k);
        inner_momentum(g, g->dp, k);
        memcpy(g->dq, v, n * sizeof *v);
        const dm_status status = dm_legendre_inverse(g->m, v, g->x, g->dp, g->x[2 * n], g->scratch);
        if (status != DM_OK) return status;
        for (uint32_t j = 0; j < n; j++) {
            const double dv = fabs(v[j] - g->dq[j]);
            most = dm_constrained_larger(dv, most);
            size = dm_constrained_larger(fabs(v[j]), size);
            place = dm_constrained_larger(fabs(g->x[j]), place);
            if (dv > 0.0) each = fmax(each, dv / (fabs(v[j]) + dv + beside * fabs(g->x[j])));
        }
    }
    *change = (turned){size > 0.0 ? most / size : most, each, fabs(g->h) * most / place};
    return DM_OK;
}

/* Every round solves the equation again with the velocities of the last; they are settled when a
 * round changes them by round-off, or changes that small stop shrinking: small beside the largest
 * velocity, or, since constraints know places and so leave v the round-off of q over h, where they
 * would move no place. */
dm_status dm_constrained_turning_end(dm_constrained *g, const dm_stepper *stepper) {
    enum { SWEEPS = 60 };
    static const double NOISE = 1e-13; /* a change that small may stall */
    static const double STILL = 1e-14; /* and one that moves places by so little */
    static const double LOOSE = 16.0;  /* times the tolerance, for entries by their own size */
    turned change = {INFINITY, INFINITY, INFINITY}, last;
    dm_status status = dm_constrained_finish(g, stepper);
    for (int k = 0; status == DM_OK && k < SWEEPS; k++) {
        last = change;
        status = renew(g, &change);
        if (status != DM_OK) return status;
        const int settled =
            change.each <= LOOSE * stepper->tolerance || change.each >= 0.5 * last.each;
        const int done = (change.all <= stepper->tolerance && settled) ||
                         (change.all >= last.all && (change.all < NOISE || change.moves < STILL));
        status = dm_constrained_newton(g, stepper);
        if (status == DM_OK) status = dm_constrained_finish(g, stepper);
        if (done) return status;
    }
    g->residual = change.all * g->mass_size;
    return status == DM_OK ? DM_NO_CONVERGENCE : status;
}
