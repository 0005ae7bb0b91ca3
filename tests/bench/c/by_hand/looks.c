/* looks - what it costs a run by hand to see that d2L/dv2 keeps its signs: the double spherical
 * pendulum in angles (newton_models.c) by midpoint, gauss(2), lobatto(3), with Newton's method for
 * the velocities of all stages to round-off from those of the step before: without looks; with one
 * when a value could have vanished by how fast the least one fell, and steps made again, one by one
 * with a look at each, where it moved so far between two looks that it may have been behind zero
 * (src/run/inertia/inertia_look.c); and so where each coordinate is judged by its own size, not by
 * the largest. Arguments: rule 1 to 3, one of these, 0 to 2, steps: that run once, to count its
 * instructions (callgrind, --toggle-collect=run).
 *   cc -O2 -mavx2 -mfma -Itests/bench/c -o looks tests/bench/c/by_hand/looks.c \
 *      tests/bench/c/newton_models.c -lm */
#define _POSIX_C_SOURCE 199309L
#include "newton.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = 4, S = 3, ALL = S * N, TURNS = 40, LATEST = 512, ITERATIONS = 50 };

typedef enum { NEVER, LOOKS, SIZES, POLICIES } policy;
static const char *const names[] = {"no looks", "looks", "and own sizes"};

/* ---- rules ---- */

/* Q_i = q + h sum_j a_ij V_j, P_i = p + h sum_j A_ij F_j, weights b, nodes c */
typedef struct {
    const char *name;
    int s;
    double a[S][S], A[S][S], b[S], c[S];
} rule;

#define R3 1.7320508075688772
#define GAUSS2                                                                                     \
    {                                                                                              \
        {0.25, 0.25 - R3 / 6}, {                                                                   \
            0.25 + R3 / 6, 0.25                                                                    \
        }                                                                                          \
    }
static const rule rules[] =
    {{"midpoint", 1, {{0.5}}, {{0.5}}, {1.0}, {0.5}},
     {"gauss(2)", 2, GAUSS2, GAUSS2, {0.5, 0.5}, {0.5 - R3 / 6, 0.5 + R3 / 6}},
     {"lobatto(3)",
      3,
      {{0}, {5.0 / 24, 1.0 / 3, -1.0 / 24}, {1.0 / 6, 2.0 / 3, 1.0 / 6}},
      {{1.0 / 6, -1.0 / 6, 0}, {1.0 / 6, 1.0 / 3, 0}, {1.0 / 6, 5.0 / 6, 0}},
      {1.0 / 6, 2.0 / 3, 1.0 / 6},
      {0, 0.5, 1}}};

/* a run: its rule, state, velocities of stages, derivatives there */
typedef struct {
    const rule *r;
    int own; /* is each velocity judged by its own size? */
    double h, q[N], p[N], V[ALL], ahead[S][S];
    derivatives at[S];
} stepper;

/* What the polynomial of the velocities of a step has at the nodes of the next one. */
static void find_ahead(stepper *x) {
    const rule *r = x->r;
    for (int i = 0; i < r->s; i++)
        for (int j = 0; j < r->s; j++) {
            x->ahead[i][j] = 1.0;
            for (int k = 0; k < r->s; k++)
                if (k != j) x->ahead[i][j] *= (1.0 + r->c[i] - r->c[k]) / (r->c[j] - r->c[k]);
        }
}

static void guess(stepper *x) {
    double next[ALL] = {0};
    for (int i = 0; i < x->r->s; i++)
        for (int j = 0; j < x->r->s; j++)
            for (int k = 0; k < N; k++) next[i * N + k] += x->ahead[i][j] * x->V[j * N + k];
    memcpy(x->V, next, sizeof next);
}

/* A x = b in place, partial pivoting; 0 when singular */
static int solve(double A[ALL][ALL], double *b, int n) {
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(A[i][k]) > fabs(A[pivot][k])) pivot = i;
        if (A[pivot][k] == 0.0) return 0;
        for (int j = k; j < n && pivot != k; j++) {
            const double x = A[k][j];
            A[k][j] = A[pivot][j], A[pivot][j] = x;
        }
        const double x = b[k], inverse = 1.0 / A[k][k];
        b[k] = b[pivot], b[pivot] = x;
        for (int i = k + 1; i < n; i++) {
            const double f = A[i][k] * inverse;
            for (int j = k + 1; j < n; j++) A[i][j] -= f * A[k][j];
            b[i] -= f * b[k];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int j = i + 1; j < n; j++) b[i] -= A[i][j] * b[j];
        b[i] /= A[i][i];
    }
    return 1;
}

/* R = p + h sum_j A_ij F_j - L_v at the stages, and minus its derivative in V */
static void equation(const stepper *x, double *R, double J[ALL][ALL]) {
    const rule *r = x->r;
    const double h = x->h;
    for (int i = 0; i < r->s; i++)
        for (int k = 0; k < N; k++) {
            R[i * N + k] = x->p[k] - x->at[i].Lv[k];
            for (int j = 0; j < r->s; j++) R[i * N + k] += h * r->A[i][j] * x->at[j].Lq[k];
        }
    for (int i = 0; i < r->s; i++)
        for (int k = 0; k < r->s; k++)
            for (int y = 0; y < N; y++)
                for (int z = 0; z < N; z++) {
                    double sum = h * (r->a[i][k] * x->at[i].Lqv[z * N + y] -
                                      r->A[i][k] * x->at[k].Lqv[y * N + z]);
                    for (int j = 0; j < r->s; j++)
                        sum -= h * h * r->A[i][j] * r->a[j][k] * x->at[j].Lqq[y * N + z];
                    J[i * N + y][k * N + z] = sum + (i == k ? x->at[i].Lvv[y * N + z] : 0.0);
                }
}

static void evaluate(stepper *x) {
    for (int i = 0; i < x->r->s; i++) {
        double Q[N];
        for (int k = 0; k < N; k++) {
            Q[k] = x->q[k];
            for (int j = 0; j < x->r->s; j++) Q[k] += x->h * x->r->a[i][j] * x->V[j * N + k];
        }
        newton_pendulum.lagrangian(&x->at[i], Q, x->V + i * N);
    }
}

/* The largest change over the size of its own coordinate, or of the largest one: velocities, and
 * what the coordinate has in a step. */
static double change_of(const stepper *x, const double *d) {
    const int n = x->r->s * N;
    double size[N], most = 0.0, out = 0.0;
    for (int i = 0; i < N; i++) size[i] = fabs(x->q[i]) / x->h;
    for (int i = 0; i < n; i++) size[i % N] = fmax(size[i % N], fabs(x->V[i]));
    for (int i = 0; i < N; i++) most = fmax(most, size[i]);
    for (int i = 0; i < n; i++) out = fmax(out, fabs(d[i]) / (x->own ? size[i % N] : most));
    return out;
}

static int step(stepper *x) {
    double R[ALL], J[ALL][ALL], before = INFINITY;
    guess(x);
    for (int k = 0; k < ITERATIONS; k++) {
        evaluate(x);
        equation(x, R, J);
        if (!solve(J, R, x->r->s * N)) return 0;
        for (int i = 0; i < x->r->s * N; i++) x->V[i] += R[i];
        const double change = change_of(x, R);
        if (change <= 4e-15 || (change >= before && change < 1e-12)) break;
        before = change;
    }
    for (int i = 0; i < x->r->s; i++)
        for (int k = 0; k < N; k++) {
            x->q[k] += x->h * x->r->b[i] * x->V[i * N + k];
            x->p[k] += x->h * x->r->b[i] * x->at[i].Lq[k];
        }
    return isfinite(x->q[0]);
}

/* ---- looks ---- */

typedef struct {
    double least;     /* the pivot next to zero at the last look */
    long looked, due; /* steps done then, and when the next look is due */
    double rate, way; /* how fast its logarithm moved, a step, and in how many */
    int strange;      /* it moved far since the look before */
    long looks, again, lost;
    double q[N], p[N], V[ALL]; /* the state then */
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

static void keep(seen *s, const stepper *x) {
    memcpy(s->q, x->q, sizeof s->q), memcpy(s->p, x->p, sizeof s->p);
    memcpy(s->V, x->V, sizeof s->V);
}

/* the steps since the look before once more, with a look at each */
static void repeat(seen *s, const stepper *now, long steps) {
    stepper x = *now;
    double least;
    memcpy(x.q, s->q, sizeof x.q), memcpy(x.p, s->p, sizeof x.p), memcpy(x.V, s->V, sizeof x.V);
    for (long k = 0; k < steps && step(&x); k++) {
        s->lost += !is_positive(x.q, &least);
        s->again++, s->looks++;
    }
}

__attribute__((noinline)) static double run(const rule *r, policy how, long steps, seen *s) {
    stepper x = {.r = r, .own = how == SIZES, .h = newton_pendulum.h};
    newton_pendulum.lagrangian(x.at, newton_pendulum.q, newton_pendulum.v);
    memcpy(x.q, newton_pendulum.q, sizeof x.q), memcpy(x.p, x.at[0].Lv, sizeof x.p);
    for (int i = 0; i < ALL; i++) x.V[i] = newton_pendulum.v[i % N];
    find_ahead(&x);
    *s = (seen){.due = 1};
    if (how != NEVER) is_positive(x.q, &s->least);
    for (long k = 1; k <= steps; k++) {
        if (how != NEVER && k == s->looked + 1) keep(s, &x);
        if (!step(&x)) return NAN;
        if (how == NEVER || k < s->due) continue;
        const long since = k - s->looked;
        look(s, x.q, k);
        if (s->strange) repeat(s, &x, since);
    }
    return x.q[0];
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static int compare(const rule *r, long steps) {
    double best[POLICIES] = {INFINITY, INFINITY, INFINITY};
    seen s[POLICIES];
    for (int turn = 0; turn < TURNS; turn++)
        for (int how = NEVER; how < POLICIES; how++) {
            const double t = now();
            if (!isfinite(run(r, (policy)how, steps, s + how))) return 1;
            best[how] = fmin(best[how], now() - t);
        }
    for (int how = NEVER; how < POLICIES; how++)
        printf("%-10s %5ld steps, %-14s %7.1f ns a step  %.3f  looks %.3f  again %.3f  lost %ld\n",
               r->name, steps, names[how], best[how] / (double)steps, best[how] / best[NEVER],
               (double)s[how].looks / (double)steps, (double)s[how].again / (double)steps,
               s[how].lost);
    return 0;
}

int main(int argc, char **argv) {
    seen s;
    if (argc > 3) {
        const double q = run(rules + atoi(argv[1]) - 1, (policy)atoi(argv[2]), atol(argv[3]), &s);
        printf("%.15g  looks %ld  again %ld\n", q, s.looks, s.again);
        return !isfinite(q);
    }
    for (int r = 0; r < 3; r++)
        if (compare(rules + r, 200) || compare(rules + r, 2000)) return 1;
    return 0;
}
