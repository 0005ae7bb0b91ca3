/* trial_energy.c - whether the energy stays with curves that may be others than those of the
 * motion. Of two scales with the frequency of the motion it swings by a thousandth of the kinetic
 * energy, also where curves miss the momentum at their ends; off by a percent, or beside a second
 * fast one, it grows from step to step until nothing of the start is left. Spaces that are not
 * linear have many roots, and some have none near the motion. */
#include "integ/trial/trial_inside.h"

#include <math.h>
#include <string.h>

/* |H - H of the start| over the largest v . L_v so far: above, the motion is lost. Measured of two
 * scales: with the right frequency 0.03 and less, where the energy grows 0.2 to 0.8; where nothing
 * but motion has been gained it is a half. */
static const double LOST = 0.2, LOST_CURVE = 0.4;

void dm_trial_watch_begin(dm_trial *e) {
    const int autonomous = (e->m->structure & DM_AUTONOMOUS) && e->m->has & DM_WANT_ENERGY;
    const int watched = e->row->phases || !e->k->linear;
    e->began = watched && autonomous ? NAN : INFINITY;
    e->twice = e->drift = 0.0;
}

/* H at (q, v), v found from p; NaN where there is none. */
static double energy_at(dm_trial *e, const double *q, const double *p, double t) {
    const uint32_t n = e->n;
    double *v = e->x + n, H = NAN;
    memset(v, 0, n * sizeof *v);
    if (dm_legendre_inverse(e->m, v, q, p, t, e->scratch) != DM_OK) return NAN;
    memcpy(e->x, q, n * sizeof *q);
    e->x[2 * n] = t;
    dm_kernel_eval(&e->m->energy, e->x, &H);
    return H;
}

/* Where the energy of the start, or of the end, cannot be had nothing is said. */
dm_status dm_trial_watch(dm_trial *e, const double *q, const double *p) {
    if (isinf(e->began)) return DM_OK;
    if (isnan(e->began)) e->began = energy_at(e, e->q0, e->p0, e->t);
    const double off = fabs(energy_at(e, q, p, e->t + e->h) - e->began);
    double end = 0.0;
    for (uint32_t i = 0; i < e->n; i++) end += e->x[e->n + i] * p[i];
    e->twice = fmax(e->twice, fmax(fabs(end), dm_trial_kinetic(e)));
    if (off > 0.0 && e->twice > 0.0) e->drift = fmax(e->drift, off / e->twice);
    return e->drift > (e->row->phases ? LOST : LOST_CURVE) ? DM_BLOW_UP : DM_OK;
}
