/* three Lagrangians with derivatives by hand */
#include "newton.h"

#include <math.h>
#include <string.h>

/* L = v^2/2 + 1/r - J2 / (2 r^3) (3 z^2/r^2 - 1): with c = J2/2,
 * V = -1/r - c/r^3 + 3 c z^2/r^5 as f(r) + z^2 g(r) */
static void satellite(derivatives *d, const double *q, const double *v) {
    const double c = 0.025, z = q[2], z2 = z * z;
    const double r2 = q[0] * q[0] + q[1] * q[1] + z2, i2 = 1.0 / r2, i1 = sqrt(i2);
    const double i3 = i1 * i2, i5 = i3 * i2, i7 = i5 * i2, i9 = i7 * i2;
    /* with D = (1/r) d/dr: V_q = q (Df + z^2 Dg) + 2 z g e_z */
    const double first = i3 + 3.0 * c * i5 - 15.0 * c * z2 * i7;
    const double second = -3.0 * i5 - 15.0 * c * i7 + 105.0 * c * z2 * i9;
    const double g = 3.0 * c * i5, Dg = -15.0 * c * i7;
    for (int i = 0; i < 3; i++) {
        d->Lv[i] = v[i];
        d->Lq[i] = -first * q[i];
        for (int j = 0; j < 3; j++) {
            d->Lqq[3 * i + j] = -second * q[i] * q[j] - (i == j ? first : 0.0);
            d->Lqv[3 * i + j] = 0.0;
            d->Lvv[3 * i + j] = i == j ? 1.0 : 0.0;
        }
    }
    d->Lq[2] -= 2.0 * z * g;
    for (int i = 0; i < 3; i++) {
        d->Lqq[3 * i + 2] -= 2.0 * z * Dg * q[i];
        d->Lqq[6 + i] -= 2.0 * z * Dg * q[i];
    }
    d->Lqq[8] -= 2.0 * g;
}

const implicit_model newton_satellite = {"J2 satellite",   3,        0.05, {1.1, 0.0, 0.1},
                                         {0.0, 0.95, 0.2}, satellite};

/* a rod at polar angle a, azimuth b with rates x, y moves with (radial, tangential, up)
 * (x cos a, y sin a, x sin a) in the frame of its azimuth; derivatives in a, x, y */
typedef struct {
    double w[3], a[3], x[3], y[3], ax[3], ay[3]; /* second derivative in a twice is -w */
} rod;

static rod rod_at(double s, double c, double x, double y) {
    return (rod){{c * x, s * y, s * x}, {-s * x, c * y, c * x}, {c, 0.0, s},
                 {0.0, s, 0.0},         {-s, 0.0, c},           {0.0, c, 0.0}};
}

static void turn(double *w, double s, double c) {
    const double x = w[0], y = w[1];
    w[0] = c * x - s * y, w[1] = s * x + c * y;
}

static double dot(const double *x, const double *y) {
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

/* the derivative in the difference of azimuths: u . (dw/db) */
static double across(const double *u, const double *w) {
    return u[1] * w[0] - u[0] * w[1];
}

static void set(double *M, int i, int j, double x) {
    M[4 * i + j] = M[4 * j + i] = x;
}

/* u1'.u2', the part of L that couples the rods (f first, g second, in the frame of the first) */
static void coupling(derivatives *d, const rod *f, const rod *g) {
    const double W = dot(f->w, g->w), across0 = across(f->w, g->w);
    d->Lq[0] += dot(f->a, g->w), d->Lq[1] -= across0;
    d->Lq[2] += dot(f->w, g->a), d->Lq[3] += across0;
    d->Lv[0] += dot(f->x, g->w), d->Lv[1] += dot(f->y, g->w);
    d->Lv[2] += dot(f->w, g->x), d->Lv[3] += dot(f->w, g->y);

    const double horizontal = W - f->w[2] * g->w[2];
    const double ab = across(f->a, g->w), ba = across(f->w, g->a);
    d->Lqq[0] -= W, d->Lqq[10] -= W;
    d->Lqq[5] -= horizontal, d->Lqq[15] -= horizontal;
    set(d->Lqq, 1, 3, horizontal);
    set(d->Lqq, 0, 1, -ab), set(d->Lqq, 0, 3, ab), set(d->Lqq, 0, 2, dot(f->a, g->a));
    set(d->Lqq, 1, 2, -ba), set(d->Lqq, 2, 3, ba);

    const double vx[4] = {across(f->x, g->w), across(f->y, g->w), across(f->w, g->x),
                          across(f->w, g->y)};
    for (int j = 0; j < 4; j++) d->Lqv[4 + j] -= vx[j], d->Lqv[12 + j] += vx[j];
    d->Lqv[0] += dot(f->ax, g->w), d->Lqv[1] += dot(f->ay, g->w);
    d->Lqv[2] += dot(f->a, g->x), d->Lqv[3] += dot(f->a, g->y);
    d->Lqv[8] += dot(f->x, g->a), d->Lqv[9] += dot(f->y, g->a);
    d->Lqv[10] += dot(f->w, g->ax), d->Lqv[11] += dot(f->w, g->ay);
    set(d->Lvv, 0, 2, dot(f->x, g->x)), set(d->Lvv, 0, 3, dot(f->x, g->y));
    set(d->Lvv, 1, 2, dot(f->y, g->x)), set(d->Lvv, 1, 3, dot(f->y, g->y));
}

/* m/2 (x^2 + sin^2 a y^2) + m g cos a of rod i = 0, 1 */
static void own(derivatives *d, int i, double m, double s, double c, const double *v) {
    const double x = v[2 * i], y = v[2 * i + 1], g = 9.81;
    const int a = 10 * i, b = a + 5;
    d->Lq[2 * i] = m * (s * c * y * y - g * s), d->Lq[2 * i + 1] = 0.0;
    d->Lv[2 * i] = m * x, d->Lv[2 * i + 1] = m * s * s * y;
    d->Lqq[a] = m * ((c * c - s * s) * y * y - g * c);
    d->Lqv[a + 1] = 2.0 * m * s * c * y;
    d->Lvv[a] = m, d->Lvv[b] = m * s * s;
}

/* double spherical pendulum: rods 1, masses 1, angles (polar, azimuth) twice */
static void pendulum(derivatives *d, const double *q, const double *v) {
    const double s1 = sin(q[0]), c1 = cos(q[0]), s2 = sin(q[2]), c2 = cos(q[2]);
    const double sd = sin(q[3] - q[1]), cd = cos(q[3] - q[1]);
    const rod f = rod_at(s1, c1, v[0], v[1]);
    rod g = rod_at(s2, c2, v[2], v[3]);
    double *turned[] = {g.w, g.a, g.x, g.y, g.ax, g.ay};
    for (int i = 0; i < 6; i++) turn(turned[i], sd, cd);
    memset(d->Lqq, 0, 16 * sizeof(double));
    memset(d->Lqv, 0, 16 * sizeof(double));
    memset(d->Lvv, 0, 16 * sizeof(double));
    own(d, 0, 2.0, s1, c1, v);
    own(d, 1, 1.0, s2, c2, v);
    coupling(d, &f, &g);
}

const implicit_model newton_pendulum =
    {"double spherical pendulum", 4, 0.01, {1.0, 0.0, 0.7, 0.4}, {0.0, 1.5, 0.0, 2.0}, pendulum};

/* three bodies of mass 1 on the figure of eight (Chenciner & Montgomery 2000) */
static void bodies(derivatives *d, const double *q, const double *v) {
    memset(d, 0, sizeof *d);
    for (int i = 0; i < 9; i++) d->Lv[i] = v[i], d->Lvv[10 * i] = 1.0;
    for (int i = 3; i < 9; i += 3)
        for (int j = 0; j < i; j += 3) {
            const double x[3] = {q[i] - q[j], q[i + 1] - q[j + 1], q[i + 2] - q[j + 2]};
            const double i2 = 1.0 / dot(x, x), i3 = i2 * sqrt(i2), i5 = 3.0 * i3 * i2;
            for (int k = 0; k < 3; k++) {
                d->Lq[i + k] -= i3 * x[k], d->Lq[j + k] += i3 * x[k];
                for (int l = 0; l < 3; l++) {
                    const double H = i5 * x[k] * x[l] - (k == l ? i3 : 0.0);
                    d->Lqq[9 * (i + k) + i + l] += H, d->Lqq[9 * (j + k) + j + l] += H;
                    d->Lqq[9 * (i + k) + j + l] -= H, d->Lqq[9 * (j + k) + i + l] -= H;
                }
            }
        }
}

const implicit_model newton_bodies = {"three bodies",
                                      9,
                                      0.01,
                                      {0.97000436, -0.24308753, 0.0, -0.97000436, 0.24308753, 0.0,
                                       0.0, 0.0, 0.0},
                                      {0.466203685, 0.43236573, 0.0, 0.466203685, 0.43236573, 0.0,
                                       -0.93240737, -0.86473146, 0.0},
                                      bodies};
