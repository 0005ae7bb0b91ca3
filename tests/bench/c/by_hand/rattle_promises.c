/* rattle_promises - what it costs RATTLE by hand (bench/c/rattle.c: the double spherical pendulum
 * in R^6) to keep what dmlua promises of it: low parts of q and v, so that nothing drifts, as
 * before; Newton's method goes on until each coordinate has settled by its own size, where one is
 * much smaller than others; a step in which the volume of the rows of G leaves a range is looked
 * into (there is none here). Arguments: 0 without the last two, 1 with, steps.
 *   cc -O2 -mavx2 -mfma -o rattle_promises tests/bench/c/by_hand/rattle_promises.c -lm
 *   valgrind --tool=callgrind --toggle-collect=run ./rattle_promises 1 20000    # and 5000; 0 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double GRAVITY = 9.81, H = 0.01;

typedef struct {
    double q[6], v[6], q_low[6], v_low[6];
    double volume; /* of the last step */
    long looked;
} state;

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void add(double *high, double *low, double d) {
    const double old = *high, e = *low + d;
    *high = old + e;
    *low = e + (old - *high);
}

/* rods: the first from the pivot, the second from mass to mass */
static void rods(double *a, double *b, const double *q) {
    for (int i = 0; i < 3; i++) a[i] = q[i], b[i] = q[3 + i] - q[i];
}

/* x of the 2 x 2 system by Cramer's rule; its determinant */
static double solve(double *x, const double *A, const double *b) {
    const double all = A[0] * A[3] - A[1] * A[2], inverse = 1.0 / all;
    x[0] = (A[3] * b[0] - A[1] * b[1]) * inverse;
    x[1] = (A[0] * b[1] - A[2] * b[0]) * inverse;
    return all;
}

/* G^T l, G = (a, 0; -b, b) */
static void pull(double *out, const double *a, const double *b, const double *l) {
    for (int i = 0; i < 3; i++) out[i] = a[i] * l[0] - b[i] * l[1], out[3 + i] = b[i] * l[1];
}

/* have the changes of y settled, each by its own size? */
static int are_settled(const double *q, const double *y, double change, double size) {
    double least = INFINITY;
    for (int i = 0; i < 6; i++) {
        const double own = q[i] * q[i] + y[i] * y[i];
        least = own < least && own > 0.0 ? own : least;
    }
    return least * 0x1p20 >= size || change * change <= 1e-31 * least;
}

/* is some |y| much smaller than others? */
static int has_small(const double *y, double size) {
    double least = fabs(y[0]);
    for (int i = 1; i < 6; i++) least = fabs(y[i]) < least ? fabs(y[i]) : least;
    return !(least * least * 0x1p19 > size);
}

/* multipliers of the drift; two iterations serve, as the changes say */
static int drift(state *s, double *u, double *y, double *l, const double *a, const double *b,
                 double *a1, double *b1, int promises) {
    double d[2] = {0.0, 0.0}, before = INFINITY, force[6], volume = 0.0;
    pull(force, a, b, l);
    for (int i = 0; i < 6; i++) y[i] = s->q[i] + (s->q_low[i] + H * (u[i] + force[i]));
    for (int k = 0; k < 50; k++) {
        rods(a1, b1, y);
        const double g[2] = {0.5 * (1.0 - dot(a1, a1)), 0.5 * (1.0 - dot(b1, b1))};
        const double ab = dot(a1, b), ba = dot(b1, a);
        const double J[4] = {H * dot(a1, a), -H * ab, -H * ba, 2.0 * H * dot(b1, b)};
        volume = solve(d, J, g);
        l[0] += d[0], l[1] += d[1];
        pull(force, a, b, d);
        double change = 0.0, size = 0.0;
        for (int i = 0; i < 6; i++) {
            const double move = H * force[i];
            y[i] += move, change += move * move, size += y[i] * y[i];
        }
        const int done = change <= 1e-31 * size ||
                         (k && change * change * change <= 1e-37 * size * before * before);
        before = change;
        if (!done || (promises && has_small(y, size) && !are_settled(s->q, y, change, size)))
            continue;
        if (promises && !(volume > 0.5 * s->volume && volume < 2.0 * s->volume))
            s->looked++, s->volume = volume;
        rods(a1, b1, y);
        return 1;
    }
    return 0;
}

/* v + G^T l with G v = 0 */
static void tangent(const double *v, double *l, const double *a, const double *b) {
    double relative[3];
    for (int i = 0; i < 3; i++) relative[i] = v[3 + i] - v[i];
    const double ab = dot(a, b);
    const double A[4] = {dot(a, a), -ab, -ab, 2.0 * dot(b, b)};
    const double r[2] = {-dot(a, v), -dot(b, relative)};
    solve(l, A, r);
}

static inline __attribute__((always_inline)) int steps_of(state *s, long steps, int promises) {
    double a[3], b[3], a1[3], b1[3], l[2] = {0.0, 0.0}, u[6], y[6], d[6], m[2];
    rods(a, b, s->q);
    for (long step = 0; step < steps; step++) {
        for (int i = 0; i < 6; i++) u[i] = s->v[i] + (i % 3 == 2 ? -0.5 * H * GRAVITY : 0.0);
        if (!drift(s, u, y, l, a, b, a1, b1, promises)) return 0;
        pull(d, a, b, l);
        for (int i = 0; i < 6; i++) {
            const double kick = d[i] + (i % 3 == 2 ? -0.5 * H * GRAVITY : 0.0);
            add(s->q + i, s->q_low + i, H * (u[i] + d[i]));
            y[i] = kick + (i % 3 == 2 ? -0.5 * H * GRAVITY : 0.0), u[i] = s->v[i] + y[i];
        }
        for (int i = 0; i < 3; i++) a[i] = a1[i], b[i] = b1[i];
        tangent(u, m, a, b);
        pull(d, a, b, m);
        for (int i = 0; i < 6; i++) add(s->v + i, s->v_low + i, y[i] + d[i]);
    }
    return 1;
}

int run(state *s, long steps, int promises);
__attribute__((noinline)) int run(state *s, long steps, int promises) {
    return promises ? steps_of(s, steps, 1) : steps_of(s, steps, 0);
}

int main(int count, char **argument) {
    state s = {.q = {0.6, 0.0, -0.8, 0.6, 0.6, -1.6}, .v = {0.0, 1.0, 0.0, 0.5, 1.0, 0.0}};
    if (count < 3 || !run(&s, atol(argument[2]), atoi(argument[1]))) return 1;
    const double *q = s.q;
    printf("%.15g %.15g %.15g %.15g %.15g %.15g, %ld looks\n", q[0], q[1], q[2], q[3], q[4], q[5],
           s.looked);
    return 0;
}
