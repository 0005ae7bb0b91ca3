/* routh_pendulum - a midpoint step (gauss(1)) of the double spherical pendulum of
 * tests/bench/routh.lua by hand, to round-off: in (r1, r2, phi) at the momentum mu, theta' from
 * it; the same with the sum for theta; in (theta, r1, r2, phi), all four velocities solved for.
 * A Newton step with exact derivatives, then chords, from the polynomial through the last six
 * steps. cc -O3 -march=native -o routh_pendulum tests/bench/c/by_hand/routh_pendulum.c -lm */
#define _GNU_SOURCE /* sincos */
#include "routh_race.h"

#include <math.h>

enum { TERMS = 6 };
enum { THETA, R1, R2, PHI };

typedef double v4 __attribute__((vector_size(32)));
#define INLINE static inline __attribute__((always_inline))

static const double m1 = 2, m2 = 1.5, l1 = 1, l2 = 0.75, g = 9.8, h = 0.02;
static const double q0[4] = {0, 0.6, 0.45, 0.6435}, v0[4] = {3.5, 0, 0, 0};

/* what is kept of the last steps is V in all three; low-order parts of q and p */
typedef struct {
    double q[4], p[4], q_low[4], p_low[4];
    double last[TERMS][4];
    long iterations;
} orbit;

/* a place and a velocity, and their changes in up to four directions, a lane each */
typedef struct {
    double x[4], V[4];
    v4 dx[4], dV[4];
} point;

/* L_q and L_v there, and their changes */
typedef struct {
    double q[4], v[4];
    v4 dq[4], dv[4];
} slopes;

INLINE void add(double *high, double *low, double d) {
    const double e = *low + d, sum = *high + e;
    *low = e + (*high - sum);
    *high = sum;
}

/* r / sqrt(l^2 - r^2), by which a rod falls, with two derivatives */
INLINE void fall(double f[3], double r, double l) {
    const double i2 = 1.0 / (l * l - r * r), i = sqrt(i2);
    f[0] = r * i, f[1] = l * l * i * i2, f[2] = 3.0 * r * i2 * f[1];
}

/* what both forms need of a place */
typedef struct {
    double c, s, f1[3], f2[3];
} place;

INLINE place look(const double *x) {
    place at;
    sincos(x[PHI], &at.s, &at.c);
    fall(at.f1, x[R1], l1);
    fall(at.f2, x[R2], l2);
    return at;
}

/* horizontal velocities (v1, a) and (v2, b) along and across the rods, b with the turn of the
 * frame in it; B is the second one in the first frame, A the first one in the second: T = M
 * (v1^2 + a^2)/2 + m2 (v2^2 + b^2)/2 + m2 (v1 Bx + a By) + vertical */
INLINE void differentiate(slopes *o, const point *z, const place *at, int with_changes) {
    const double M = m1 + m2, c = at->c, s = at->s, *x = z->x, *V = z->V;
    const double t1 = V[THETA], t2 = t1 + V[PHI], a = x[R1] * t1, b = x[R2] * t2;
    const double v1 = V[R1], v2 = V[R2];
    const double Bx = v2 * c - b * s, By = v2 * s + b * c, Ax = v1 * c + a * s, Ay = a * c - v1 * s;
    const double P2 = m2 * (at->f1[0] * v1 + at->f2[0] * v2), P1 = m1 * at->f1[0] * v1 + P2;
    const double k1 = M * a + m2 * By, k2 = m2 * (b + Ay), e1 = at->f1[1] * v1, e2 = at->f2[1] * v2;
    o->v[R1] = M * v1 + m2 * Bx + at->f1[0] * P1;
    o->v[R2] = m2 * (v2 + Ax) + at->f2[0] * P2;
    o->v[PHI] = x[R2] * k2;
    o->v[THETA] = x[R1] * k1 + o->v[PHI];
    o->q[R1] = t1 * k1 + e1 * P1 - M * g * at->f1[0];
    o->q[R2] = t2 * k2 + e2 * P2 - m2 * g * at->f2[0];
    o->q[PHI] = m2 * (a * Bx - v1 * By);
    if (!with_changes) return;
    const v4 *dx = z->dx, *dV = z->dV, dt1 = dV[THETA], dt2 = dt1 + dV[PHI];
    const v4 da = dx[R1] * t1 + x[R1] * dt1, db = dx[R2] * t2 + x[R2] * dt2;
    const v4 dv1 = dV[R1], dv2 = dV[R2];
    const v4 dBx = dv2 * c - db * s - By * dx[PHI], dBy = dv2 * s + db * c + Bx * dx[PHI];
    const v4 dAx = dv1 * c + da * s + Ay * dx[PHI], dAy = da * c - dv1 * s - Ax * dx[PHI];
    const v4 dz1 = at->f1[0] * dv1 + e1 * dx[R1], dz2 = at->f2[0] * dv2 + e2 * dx[R2];
    const v4 dP2 = m2 * (dz1 + dz2), dP1 = m1 * dz1 + dP2;
    const v4 dk1 = M * da + m2 * dBy, dk2 = m2 * (db + dAy);
    const v4 de1 = at->f1[2] * v1 * dx[R1] + at->f1[1] * dv1,
             de2 = at->f2[2] * v2 * dx[R2] + at->f2[1] * dv2;
    o->dv[R1] = M * dv1 + m2 * dBx + at->f1[1] * P1 * dx[R1] + at->f1[0] * dP1;
    o->dv[R2] = m2 * (dv2 + dAx) + at->f2[1] * P2 * dx[R2] + at->f2[0] * dP2;
    o->dv[PHI] = dx[R2] * k2 + x[R2] * dk2;
    o->dv[THETA] = dx[R1] * k1 + x[R1] * dk1 + o->dv[PHI];
    o->dq[R1] = dt1 * k1 + t1 * dk1 + de1 * P1 + e1 * dP1 - M * g * at->f1[1] * dx[R1];
    o->dq[R2] = dt2 * k2 + t2 * dk2 + de2 * P2 + e2 * dP2 - m2 * g * at->f2[1] * dx[R2];
    o->dq[PHI] = m2 * (da * Bx + a * dBx - dv1 * By - v1 * dBy);
}

/* theta' = (mu - A) / I, L_theta' = I theta' + A, and its changes */
INLINE void turn(point *z, const place *at, double mu, int with_changes) {
    const double M = m1 + m2, *x = z->x, *V = z->V, c = at->c, s = at->s;
    const double b = x[R2] * V[PHI], By = V[R2] * s + b * c, k2 = m2 * (b - V[R1] * s);
    const double cross = m2 * x[R1] * x[R2],
                 I = M * x[R1] * x[R1] + m2 * x[R2] * x[R2] + 2.0 * cross * c;
    const double A = m2 * x[R1] * By + x[R2] * k2, i = 1.0 / I;
    z->V[THETA] = (mu - A) * i;
    if (!with_changes) return;
    const v4 *dx = z->dx, *dV = z->dV, db = dx[R2] * V[PHI] + x[R2] * dV[PHI];
    const v4 dBy = dV[R2] * s + db * c + (V[R2] * c - b * s) * dx[PHI];
    const v4 dk2 = m2 * (db - dV[R1] * s - V[R1] * c * dx[PHI]);
    const v4 dA = m2 * (dx[R1] * By + x[R1] * dBy) + dx[R2] * k2 + x[R2] * dk2;
    const v4 dI = 2.0 * ((M * x[R1] + m2 * x[R2] * c) * dx[R1] + m2 * (x[R2] + x[R1] * c) * dx[R2] -
                         cross * s * dx[PHI]);
    z->dV[THETA] = -(dA + z->V[THETA] * dI) * i;
}

/* J[4][4] = l u in place, the diagonal of u inverted */
INLINE void factor_4(double J[4][4]) {
    for (int j = 0; j < 4; j++) {
        J[j][j] = 1.0 / J[j][j];
        for (int i = j + 1; i < 4; i++) {
            J[i][j] *= J[j][j];
            for (int k = j + 1; k < 4; k++) J[i][k] -= J[i][j] * J[j][k];
        }
    }
}

INLINE void solve_4(double *d, double J[4][4]) {
    for (int i = 1; i < 4; i++)
        for (int k = 0; k < i; k++) d[i] -= J[i][k] * d[k];
    for (int i = 4; i-- > 0;) {
        for (int k = i + 1; k < 4; k++) d[i] -= J[i][k] * d[k];
        d[i] *= J[i][i];
    }
}

/* three rows by the adjugate: one division, and J becomes its own inverse */
INLINE void factor_3(double J[4][4]) {
    double C[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            const double *a = J[(k + 1) % 3], *b = J[(k + 2) % 3];
            C[i][k] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
        }
    const double i = 1.0 / (J[0][0] * C[0][0] + J[0][1] * C[1][0] + J[0][2] * C[2][0]);
    for (int k = 0; k < 9; k++) J[k / 3][k % 3] = C[k / 3][k % 3] * i;
}

INLINE void solve_3(double *d, double J[4][4]) {
    const double a = d[0], b = d[1], c = d[2];
    for (int i = 0; i < 3; i++) d[i] = J[i][0] * a + J[i][1] * b + J[i][2] * c;
}

/* what is left does not count, as in linalg/solve/newton.c, or is round-off that stays: |dx| now and
 * before */
INLINE int is_last(double now, double before) {
    return now <= 4e-15 || now / before * now <= 4e-20 || (now < 1e-13 && 4.0 * now > before);
}

/* V after those of the last steps by the polynomial through them */
INLINE void foresee(double *V, const orbit *o) {
    for (int k = 0; k < 4; k++)
        V[k] = 6.0 * (o->last[0][k] + o->last[4][k]) - 15.0 * (o->last[1][k] + o->last[3][k]) +
               20.0 * o->last[2][k] - o->last[5][k];
}

/* L_v(m, V) - p - h/2 L_q(m, V) = 0, m = q + h/2 V, for V from `first` on */
INLINE void step(orbit *o, int first, int with_theta) {
    const double e = 0.5 * h;
    const int n = 4 - first;
    double J[4][4], d[4], before = 0;
    point z = {0};
    slopes L = {0};
    foresee(z.V, o);
    for (int k = first; k < 4; k++) {
        z.dV[k][k - first] = 1.0;
        if (k != THETA) z.dx[k] = e * z.dV[k];
    }
    for (int i = 0; i < 20; i++) {
        for (int k = 1; k < 4; k++) z.x[k] = o->q[k] + (o->q_low[k] + e * z.V[k]);
        const place at = look(z.x);
        if (first) turn(&z, &at, o->p[THETA], i == 0);
        differentiate(&L, &z, &at, i == 0);
        for (int k = first; k < 4; k++)
            d[k - first] = o->p[k] + (o->p_low[k] + e * L.q[k]) - L.v[k];
        if (i == 0) {
            for (int k = first; k < 4; k++)
                for (int j = 0; j < n; j++) J[k - first][j] = L.dv[k][j] - e * L.dq[k][j];
            n == 3 ? factor_3(J) : factor_4(J);
        }
        n == 3 ? solve_3(d, J) : solve_4(d, J);
        double now = 0;
        for (int k = 0; k < n; k++) now = fmax(now, fabs(d[k])), z.V[first + k] += d[k];
        o->iterations++;
        if (is_last(now, i ? before : 10.0 * now)) break;
        before = now;
    }
    for (int i = TERMS - 1; i > 0; i--)
        for (int k = 0; k < 4; k++) o->last[i][k] = o->last[i - 1][k];
    for (int k = 0; k < 4; k++) o->last[0][k] = z.V[k];
    for (int k = with_theta ? 0 : 1; k < 4; k++) {
        add(o->p + k, o->p_low + k, h * L.q[k]);
        add(o->q + k, o->q_low + k, h * z.V[k]);
    }
}

static race_end run(int how) {
    orbit o = {.iterations = 0};
    point z = {0};
    slopes L;
    for (int k = 0; k < 4; k++) z.x[k] = q0[k], z.V[k] = v0[k];
    const place at = look(z.x);
    differentiate(&L, &z, &at, 0);
    for (int k = 0; k < 4; k++) o.q[k] = q0[k], o.p[k] = L.v[k];
    for (int i = 0; i < TERMS; i++)
        for (int k = 0; k < 4; k++) o.last[i][k] = v0[k];
    if (how == 0)
        for (long k = 0; k < STEPS; k++) step(&o, 1, 0);
    else if (how == 1)
        for (long k = 0; k < STEPS; k++) step(&o, 1, 1);
    else
        for (long k = 0; k < STEPS; k++) step(&o, 0, 1);
    return (race_end){o.iterations, o.q[R1]};
}

int main(void) {
    race(run, "r1");
    return 0;
}
