/* looks - what it costs a run by hand to see that d2L/dv2 keeps its signs: midpoint steps of the
 * double spherical pendulum in angles (newton_models.c) with Newton's method to round-off: without
 * looks; with one at every state; with one when a value could have vanished by how fast the least
 * one fell; and so with steps made again, one by one with a look at each, where the least value
 * moved so far between two looks that it may have been behind zero (src/run/inertia/inertia_look.c).
 *   cc -O2 -Itests/bench/c -o looks tests/bench/c/by_hand/looks.c tests/bench/c/newton.c \
 *      tests/bench/c/newton_models.c -lm */
#define _POSIX_C_SOURCE 199309L
#include "newton.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { N = 4, TURNS = 60, LATEST = 512 };

typedef enum { NEVER, EVERY, DUE, AGAIN, POLICIES } policy;
static const char *const names[] = {"no looks", "at every state", "when due", "and again"};

typedef struct {
    double least;     /* the pivot next to zero at the last look */
    long looked, due; /* steps done then, and when the next look is due */
    double rate, way; /* how fast its logarithm moved, a step, and in how many */
    int strange;      /* it moved far since the look before */
    long looks, again, lost;
    double q[NEWTON_N], p[NEWTON_N], v[NEWTON_N]; /* the state then */
} seen;

/* d2L/dv2 in units that have ones on its diagonal where every rod is level: lower triangle */
static void mass(double M[N][N], const double *q) {
    const double s1 = sin(q[0]), c1 = cos(q[0]), s2 = sin(q[2]), c2 = cos(q[2]);
    const double sd = sin(q[3] - q[1]), cd = cos(q[3] - q[1]), unit = sqrt(0.5);
    M[0][0] = 1.0, M[1][1] = s1 * s1, M[2][2] = 1.0, M[3][3] = s2 * s2;
    M[1][0] = M[3][2] = 0.0;
    M[2][0] = unit * (c1 * cd * c2 + s1 * s2), M[3][0] = -unit * c1 * sd * s2;
    M[2][1] = unit * s1 * sd * c2, M[3][1] = unit * s1 * cd * s2;
}

/* pivots of M = L D L^T: how many are negative, and the size of the least */
static int pivots(double M[N][N], double *least) {
    int negative = 0;
    *least = INFINITY;
    for (int j = 0; j < N; j++) {
        const double inverse = 1.0 / M[j][j];
        negative += M[j][j] < 0.0;
        *least = fmin(*least, fabs(M[j][j]));
        for (int i = j + 1; i < N; i++) {
            const double f = M[i][j] * inverse;
            for (int k = j + 1; k <= i; k++) M[i][k] -= f * M[k][j];
        }
    }
    return negative;
}

/* have all pivots their signs? */
static int is_positive(const double *q, double *least) {
    double M[N][N];
    mass(M, q);
    return pivots(M, least) == 0;
}

/* Steps until a mass of positions vanishes that fell from `before` in so many steps: like (t0 -
 * t)^(2/3), since M v^2 stays finite. */
static double left(double before, double now, double since) {
    return before > now ? since / (before / now * sqrt(before / now) - 1.0) : INFINITY;
}

/* Steps that may come before the next look, so that the value moves by little meanwhile: by how
 * fast its logarithm moved, and how that changed. */
static double still_steps(seen *s, double least, double since) {
    static const double LITTLE = 0.3, SURELY = 0.25;
    const double rate = log(least / s->least) / since;
    const double bend = s->way > 0.0 ? 2.0 * (rate - s->rate) / (since + s->way) : 0.0;
    const double now = fabs(rate + 0.5 * bend * since);
    const double steps = 2.0 * LITTLE / (now + sqrt(now * now + 2.0 * LITTLE * fabs(bend)));
    s->rate = rate, s->way = since;
    return fmin(steps, fmax(since + 1.0, fmin(2.0 * since, SURELY * steps)));
}

/* one look after so many steps */
static void look(seen *s, const double *q, long done) {
    double least = 0;
    const double since = (double)(done - s->looked);
    s->lost += !is_positive(q, &least);
    const double ratio = fmin(s->least / least, least / s->least);
    const double back = left(least, s->least, since) + since; /* one that grew may fall as fast */
    const double safe = 0.5 * fmin(left(s->least, least, since), back);
    s->strange = since > 1.0 && ratio < 0.63;
    s->due = done + (long)fmax(1.0, fmin(fmin(safe, LATEST), still_steps(s, least, since)));
    s->least = least, s->looked = done, s->looks++;
}

/* the steps since the look before once more, with a look at each */
static void repeat(seen *s, const implicit_model *m, long steps, long *iterations) {
    implicit_model own = *m;
    double least;
    memcpy(own.v, s->v, sizeof own.v);
    for (long k = 0; k < steps; k++) {
        double q0[N];
        memcpy(q0, s->q, sizeof q0);
        newton_run(s->q, s->p, &own, 1, iterations);
        for (int i = 0; i < N; i++) own.v[i] = (s->q[i] - q0[i]) / own.h;
        s->lost += !is_positive(s->q, &least);
        s->again++, s->looks++;
    }
}

static double run(policy how, long steps, seen *s, long *iterations) {
    implicit_model m = newton_pendulum;
    derivatives d;
    double q[NEWTON_N], p[NEWTON_N], q0[N];
    m.lagrangian(&d, m.q, m.v);
    memcpy(q, m.q, sizeof q), memcpy(p, d.Lv, sizeof p);
    *s = (seen){.due = 1};
    if (how != NEVER) is_positive(q, &s->least);
    for (long k = 1; k <= steps; k++) {
        if (how == AGAIN && k == s->looked + 1) {
            memcpy(s->q, q, sizeof q), memcpy(s->p, p, sizeof p);
            memcpy(s->v, m.v, sizeof m.v);
        }
        memcpy(q0, q, sizeof q0);
        if (!newton_run(q, p, &m, 1, iterations)) return NAN;
        for (int i = 0; i < N; i++) m.v[i] = (q[i] - q0[i]) / m.h; /* the next guess */
        if (how == NEVER || (how != EVERY && k < s->due)) continue;
        const long since = k - s->looked;
        look(s, q, k);
        if (how == AGAIN && s->strange) repeat(s, &m, since, iterations);
    }
    return q[0];
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

int main(void) {
    static const long lengths[] = {200, 1000, 20000};
    for (int l = 0; l < 3; l++) {
        const double steps = (double)lengths[l];
        double best[POLICIES] = {INFINITY, INFINITY, INFINITY, INFINITY};
        seen s[POLICIES];
        for (int turn = 0; turn < TURNS; turn++)
            for (int how = NEVER; how < POLICIES; how++) {
                long iterations = 0;
                const double t = now();
                if (!isfinite(run((policy)how, lengths[l], s + how, &iterations))) return 1;
                best[how] = fmin(best[how], now() - t);
            }
        for (int how = NEVER; how < POLICIES; how++)
            printf("%6.0f steps, %-14s %7.1f ns a step  %.2f  looks %.3f  again %.3f  lost %ld\n",
                   steps, names[how], best[how] / steps, best[how] / best[NEVER],
                   (double)s[how].looks / steps, (double)s[how].again / steps, s[how].lost);
    }
    return 0;
}
