/* P1: Kepler, H = v^2/2 - 1/r, from the pericentre, 100 periods */
#include "bound.h"

enum { N = 2 };
static const double T = 628.31853071795864769;

INLINE void attraction(double *a, const double *q) {
    const double w = -inverse_cube(q[0] * q[0] + q[1] * q[1]);
    a[0] = w * q[0], a[1] = w * q[1];
}

INLINE void attraction_v(double *a, const double *q, const double *v) {
    (void)v;
    attraction(a, q);
}

INLINE void attraction8(v8 *a, const v8 *q, const v8 *v) {
    const v8 w = -inverse_cube8(q[0] * q[0] + q[1] * q[1]);
    (void)v;
    a[0] = w * q[0], a[1] = w * q[1];
}

INLINE void start(double *q, double *v, double e) {
    q[0] = 1.0 - e, q[1] = 0.0;
    v[0] = 0.0, v[1] = sqrt((1.0 + e) / (1.0 - e));
}

/* Logarithmic Hamiltonian (Mikkola & Tanikawa 1999; Preto & Tremaine 1999):
 * log(v^2/2 + B) - log(1/r) with B = -H, in a fictitious time whose unit is dt = r ds here.
 * Drift q' = v / (v^2/2 + B), t' = 1 / (v^2/2 + B); kick v' = -q / r^2. */
typedef struct {
    double x, y, u, v, t; /* position, velocity, time */
    double r2, s, v2;     /* |q|^2, q.v, |v|^2 + 2 B, carried along: shorter chains */
} orbit;

static const double BINDING = 0.5;

INLINE void products(orbit *o) {
    o->r2 = o->x * o->x + o->y * o->y;
    o->s = o->x * o->u + o->y * o->v;
    o->v2 = o->u * o->u + (o->v * o->v + 2.0 * BINDING);
}

/* |v - w q|^2 = v^2 - w (2 q.v - w q^2), and w q^2 = h needs no division to be known */
INLINE void kick_log(orbit *o, double h) {
    const double w = h / o->r2, d = 2.0 * o->s - h;
    o->u -= w * o->x, o->v -= w * o->y;
    o->v2 -= w * d;
    o->s -= h;
}

/* likewise |q + w v|^2 with w v^2 = 2 h - 2 B w */
INLINE void drift_log(orbit *o, double h) {
    const double w = 2.0 * h / o->v2, d = 2.0 * (o->s + h);
    o->x += w * o->u, o->y += w * o->v, o->t += w;
    o->r2 += w * (d - 2.0 * BINDING * w);
    o->s += 2.0 * h - 2.0 * BINDING * w;
}

INLINE void pairs_log(orbit *o, const double *kick, const double *drift, int pairs) {
    products(o); /* anew in every step: round-off does not pile up */
    for (int k = 0; k < pairs; k++) {
        kick_log(o, kick[k]);
        drift_log(o, drift[k]);
    }
}

/* a whole step of another length: the last drift is twice the lead */
static void step_log(orbit *o, const splitting *table, double h) {
    double kick[KICKS], drift[KICKS];
    for (int k = 0; k < table->pairs; k++) {
        kick[k] = h * table->kick[k];
        drift[k] = h * table->drift[k];
    }
    products(o);
    drift_log(o, h * table->lead);
    pairs_log(o, kick, drift, table->pairs);
    products(o);
    drift_log(o, -h * table->lead);
}

/* fictitious time to t from dt/ds = r, r' = q.v, r'' = r (v^2 + q.a) */
static double fictitious(const orbit *o, double t) {
    const double r = sqrt(o->r2), second = r * (o->v2 - 2.0 * BINDING) - 1.0;
    double s = (t - o->t) / r;
    for (int k = 0; k < 4; k++)
        s -= (s * (r + s * (o->s / 2.0 + s * second / 6.0)) - (t - o->t)) /
             (r + s * (o->s + s * second / 2.0));
    return s;
}

/* from a state near t to the position at t: a step of the method, a small one of order 6, Taylor */
static void land(double *out, orbit o, const splitting *table, double t) {
    const splitting *rest[2] = {table, &bench_log_splittings[3]};
    for (int k = 0; k < 2; k++) {
        products(&o);
        step_log(&o, rest[k], fictitious(&o, t));
    }
    const double left = t - o.t, w = -inverse_cube(o.x * o.x + o.y * o.y);
    out[0] = o.x + left * (o.u + 0.5 * left * w * o.x);
    out[1] = o.y + left * (o.v + 0.5 * left * w * o.y);
}

INLINE void log_run(double *out, const bench_method *m, long steps, double e) {
    const splitting *table = m->table;
    const double h = T / BENCH_OUTPUTS / (double)steps, lead = h * table->lead;
    double kick[KICKS], drift[KICKS], q[N], v[N];
    for (int k = 0; k < table->pairs; k++) {
        kick[k] = h * table->kick[k];
        drift[k] = h * table->drift[k];
    }
    start(q, v, e);
    orbit o = {.x = q[0], .y = q[1], .u = v[0], .v = v[1]};
    products(&o);
    drift_log(&o, lead);
    for (int row = 0; row < BENCH_OUTPUTS;) {
        pairs_log(&o, kick, drift, table->pairs);
        while (row < BENCH_OUTPUTS && o.t >= T / BENCH_OUTPUTS * (row + 1)) {
            orbit whole = o;
            drift_log(&whole, -lead);
            land(out + N * row, whole, table, T / BENCH_OUTPUTS * (row + 1));
            row++;
        }
    }
}

#define FOR_ECCENTRICITY(name, e)                                                                  \
    static void name##_split(double *out, const bench_method *m, long steps) {                     \
        double q[N], v[N];                                                                         \
        start(q, v, e);                                                                            \
        split(out, m->table, steps, N, attraction, q, v, T);                                       \
    }                                                                                              \
    static void name##_gauss(double *out, const bench_method *m, long steps) {                     \
        double q[N], v[N];                                                                         \
        start(q, v, e);                                                                            \
        GAUSS_CASES(out, m, N, 0, steps, attraction8, q, v, T)                                     \
    }                                                                                              \
    static void name##_rk8(double *out, const bench_method *m, long steps) {                       \
        double q[N], v[N];                                                                         \
        (void)m;                                                                                   \
        start(q, v, e);                                                                            \
        rk8(out, steps, N, attraction_v, q, v, T);                                                 \
    }                                                                                              \
    static void name##_stoermer(double *out, const bench_method *m, long steps) {                  \
        double q[N], v[N];                                                                         \
        start(q, v, e);                                                                            \
        STOERMER_CASES(out, m, N, steps, attraction8, q, v, T)                                     \
    }                                                                                              \
    static void name##_log(double *out, const bench_method *m, long steps) {                       \
        log_run(out, m, steps, e);                                                                 \
    }                                                                                              \
    static const bench_method name[] =                                                             \
        {{"log-sofspa(10)", name##_log, &bench_log_splittings[6], 0},                              \
         {"log-suzuki-umeno(8)", name##_log, &bench_log_splittings[5], 0},                         \
         {"log-kahan-li(8)", name##_log, &bench_log_splittings[4], 0},                             \
         {"log-kahan-li(6)", name##_log, &bench_log_splittings[3], 0},                             \
         {"log-verlet", name##_log, &bench_log_splittings[0], 0},                                  \
         GAUSS_METHODS(name##_gauss),                                                              \
         SPLITTING_METHODS(name##_split),                                                          \
         {"rk8", name##_rk8, NULL, 0},                                                             \
         STOERMER_METHODS(name##_stoermer),                                                        \
         {NULL, NULL, NULL, 0}};

FOR_ECCENTRICITY(round_orbit, 0.6)
FOR_ECCENTRICITY(long_orbit, 0.9)

const bench_problem bench_kepler[] = {{"P1-0.6", N, round_orbit},
                                      {"P1-0.9", N, long_orbit},
                                      {NULL, 0, NULL}};
